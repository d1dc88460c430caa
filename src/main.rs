//! The `barwave` command.

/// Parameter studies allocate and free many small objects on all threads, which takes a sixth of the time with the allocator of the system. Huge
/// pages are disabled: filling them with zeros takes a tenth of a short run, and a long run gains nothing from them.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> std::process::ExitCode {
    barwave::cli::main()
}
