//! Entry point of the desktop app, the page and the command line.

#[cfg(target_arch = "wasm32")]
fn main() {
    #[cfg(feature = "app")]
    implant_preview::platform::page::run();
}

#[cfg(not(target_arch = "wasm32"))]
fn main() -> std::process::ExitCode {
    #[cfg(feature = "command-line")]
    if let implant_preview::platform::command_line::Next::Exit(code) =
        implant_preview::platform::command_line::run()
    {
        return code;
    }
    #[cfg(feature = "app")]
    if let Err(error) = implant_preview::platform::desktop::run() {
        #[expect(clippy::print_stderr, reason = "without a window, standard error is left")]
        {
            eprintln!("implant-preview: the window cannot be opened: {error}");
        }
        return std::process::ExitCode::FAILURE;
    }
    std::process::ExitCode::SUCCESS
}
