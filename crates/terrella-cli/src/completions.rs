//! `terrella completions`

use super::{command, print};
use clap::Args;
use clap_complete::Shell;

/// Arguments of `terrella completions`.
#[derive(Debug, Args)]
#[command(
    after_help = "The script completes commands, options and their values. Print it again after an update of the program. \
    docs/command.md names the folder that each shell reads."
)]
pub struct CompletionsArgs {
    /// Shell
    #[arg(value_enum)]
    shell: Shell,
}

/// Prints the script.
pub fn run(args: &CompletionsArgs) -> anyhow::Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command(), "terrella", &mut script);
    print(&String::from_utf8(script)?)
}
