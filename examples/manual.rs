//! Writes the manual pages of all commands, and what completes them in bash, zsh and fish, into a folder:
//!
//!     cargo run --release --example manual -- FOLDER

use clap::CommandFactory;
use clap_complete::Shell;
use nagata::cli::Cli;
use std::io::{Error, Result};
use std::path::PathBuf;

fn main() -> Result<()> {
    let folder = std::env::args_os().nth(1).map(PathBuf::from).ok_or_else(|| Error::other("which folder?"))?;
    std::fs::create_dir_all(&folder)?;
    // The libraries are those of the machine that it is built on.
    let mut command = Cli::command().version(env!("CARGO_PKG_VERSION"));
    for shell in [Shell::Bash, Shell::Zsh, Shell::Fish] {
        clap_complete::generate_to(shell, &mut command, "nagata", &folder)?;
    }
    clap_mangen::generate_to(command, &folder)
}
