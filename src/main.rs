//! The `barwave` command.

fn main() -> std::process::ExitCode {
    barwave::cli::main()
}
