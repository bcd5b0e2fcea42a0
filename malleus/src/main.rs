//! The program: runs one command. Its exit code is 0 if the command is done, 1 if it failed, and 2
//! if the command line is wrong.

mod arguments;
mod commands;

use std::path::PathBuf;
use std::process::ExitCode;

use arguments::{Arguments, Command, DemoArguments};
use clap::Parser;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let done = match arguments.command {
        None => commands::demo::run(&DemoArguments { out: PathBuf::from("malleus-demo"), json: false }),
        Some(Command::Demo(arguments)) => commands::demo::run(&arguments),
        Some(Command::Play(arguments)) => commands::play::run(&arguments),
        Some(Command::Fit(arguments)) => commands::fit::run(&arguments),
        Some(Command::Separate(arguments)) => commands::separate::run(&arguments),
        Some(Command::Surface(arguments)) => commands::surface::run(&arguments),
        Some(Command::Shape(arguments)) => commands::shape::run(&arguments),
        Some(Command::Motion(command)) => commands::motion::run(&command),
        Some(Command::Study(command)) => commands::study::run(&command),
        Some(Command::Kit(command)) => commands::kit::run(&command),
        Some(Command::Board(command)) => commands::board::run(&command),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("malleus: {error}");
            ExitCode::FAILURE
        }
    }
}
