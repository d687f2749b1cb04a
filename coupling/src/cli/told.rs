//! Errors and warnings on standard error, and where the guide explains them.

use std::collections::BTreeSet;
use std::sync::Mutex;

use super::{Exit, say};
use crate::messages::{Code, Coded, with_code};
use crate::scene::error::SceneError;

/// Codes of all messages that were printed, for the line at the end of a command.
static TOLD: Mutex<BTreeSet<Code>> = Mutex::new(BTreeSet::new());

/// Keeps the code of a printed message.
pub(crate) fn keep(code: Code) {
    if let Ok(mut told) = TOLD.lock() {
        told.insert(code);
    }
}

/// A printed message with its code.
pub(crate) fn coded(message: &impl Coded) -> String {
    keep(message.code());
    with_code(&message.to_string(), message.code())
}

/// Reports wrong usage or input.
pub(crate) fn refused(fault: impl Coded) -> Exit {
    say(&format!("error: {}", coded(&fault)));
    Exit::BadInput
}

/// Reports arguments that cannot be used, with those that can be.
pub(crate) fn misused(fault: &clap::Error) -> Exit {
    let text = fault.render().to_string();
    keep(Code::UnusableArgument);
    say(&with_code(text.trim_end(), Code::UnusableArgument));
    way_on().iter().for_each(|line| say(line));
    Exit::BadInput
}

/// Reports a failure.
pub(crate) fn failed(fault: impl Coded) -> Exit {
    say(&format!("error: {}", coded(&fault)));
    Exit::Failed
}

/// Reports a doubt.
pub(crate) fn warn(doubt: impl Coded) {
    say(&format!("warning: {}", coded(&doubt)));
}

/// Prints the problems of a scene, a line each.
pub(crate) fn problems(found: &SceneError) {
    found.located().iter().for_each(|one| keep(one.code));
    say(&found.to_string());
}

/// The command that explains all messages that were printed, if there were any.
pub(crate) fn way_on() -> Option<String> {
    let told = TOLD.lock().ok()?;
    let codes: Vec<&str> = told.iter().map(|code| code.as_str()).collect();
    (!codes.is_empty()).then(|| format!("more on these: riprap explain {}", codes.join(" ")))
}
