//! `reeldown`: how likely is a viscous-brake reel-down to miss a limit, and what drives it?

use std::process::ExitCode;

fn main() -> ExitCode {
    reeldown::cli::main()
}
