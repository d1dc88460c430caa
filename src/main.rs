//! The `barwave` command.

/// Sweeps make and free many small objects on all threads, for which the system's allocator takes a sixth of the time. Without huge pages:
/// to fill those with zeros takes a tenth of a short run, and a long one gains nothing by them.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> std::process::ExitCode {
    barwave::cli::main()
}
