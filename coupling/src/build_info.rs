//! Identity of this build of the program.

/// Commit that the program was built from, where known.
pub const COMMIT: &str = match option_env!("RIPRAP_COMMIT") {
    Some(commit) => commit,
    None => "unknown",
};
