//! `riprap explain`.

use super::{Exit, refused, show};
use crate::messages::{Code, Message, guide};
use crate::scene::parse::suggestion;

/// Explain errors and warnings by the codes behind them.
#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// Codes as they are printed, e.g. overlapping-blocks; all are listed when left out.
    #[arg(value_name = "CODE")]
    codes: Vec<String>,
}

pub(crate) fn execute(arguments: &Arguments) -> Exit {
    if arguments.codes.is_empty() {
        show(&guide::index());
        return Exit::Done;
    }
    let found: Result<Vec<Code>, Message> = arguments.codes.iter().map(|text| code(text)).collect();
    match found {
        Ok(codes) => {
            let entries: Vec<String> = codes.into_iter().map(guide::entry).collect();
            show(&entries.join("\n\n"));
            Exit::Done
        }
        Err(message) => refused(message),
    }
}

/// The code that a text names, in brackets or without.
fn code(text: &str) -> Result<Code, Message> {
    let name = text.trim_matches(['[', ']', ',']);
    let names: Vec<&str> = Code::ALL.iter().map(|code| code.as_str()).collect();
    let found = Code::ALL.iter().find(|code| code.as_str() == name);
    found.copied().ok_or_else(|| {
        let message = format!(
            "no message has the code `{name}`{}",
            suggestion(name, &names)
        );
        Message::new(Code::UnusableArgument, message)
    })
}
