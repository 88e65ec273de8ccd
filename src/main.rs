//! The desktop app, the page and the command line: all three start here.

use std::process::ExitCode;

fn main() -> ExitCode {
    #[cfg(all(feature = "command-line", not(target_arch = "wasm32")))]
    if let implant_preview::platform::command_line::Next::Exit(code) =
        implant_preview::platform::command_line::run()
    {
        return code;
    }
    ExitCode::SUCCESS
}
