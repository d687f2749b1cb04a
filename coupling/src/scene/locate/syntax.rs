//! Languages that scenes are written in.

use std::path::Path;

/// Language of a scene: the same types, checks and messages in each.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Syntax {
    /// Rusty Object Notation, with names for kinds and fields.
    #[default]
    Ron,
    /// RFC 8259, without comments.
    Json,
    /// YAML 1.2, one document without anchors and tags.
    Yaml,
}

impl Syntax {
    /// The one that the name of a file tells by `.json`, `.yaml` or `.yml`; else RON.
    pub fn of(name: &str) -> Self {
        let extension = Path::new(name).extension().and_then(|e| e.to_str());
        match extension.map(str::to_lowercase).as_deref() {
            Some("json") => Self::Json,
            Some("yaml" | "yml") => Self::Yaml,
            _ => Self::Ron,
        }
    }
}
