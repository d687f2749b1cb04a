//! Collected problems, and checks shared by many parts of a scene.
//!
//! Each takes the path of the checked value and its name in messages. Numbers left out pass.

use crate::messages::Code;
use crate::scene::error::Problem;
use crate::scene::file::{SceneFile, Triple};
use crate::scene::parse::suggestion;

/// Collected problems.
#[derive(Default)]
pub(super) struct Checks {
    pub problems: Vec<Problem>,
}

impl Checks {
    pub fn refuse(&mut self, code: Code, path: impl Into<String>, message: String) {
        self.problems.push(Problem::error(code, path, message));
    }

    pub fn warn(&mut self, code: Code, path: impl Into<String>, message: String) {
        self.problems.push(Problem::warning(code, path, message));
    }

    pub fn positive(&mut self, path: impl Into<String>, what: &str, value: impl Into<Option<f64>>) {
        if let Some(value) = value.into()
            && value <= 0.0
        {
            self.refuse(
                Code::ValueOutOfRange,
                path,
                format!("{what} must be > 0, found {value}"),
            );
        }
    }

    pub fn not_negative(
        &mut self,
        path: impl Into<String>,
        what: &str,
        value: impl Into<Option<f64>>,
    ) {
        if let Some(value) = value.into()
            && value < 0.0
        {
            self.refuse(
                Code::ValueOutOfRange,
                path,
                format!("{what} must be >= 0, found {value}"),
            );
        }
    }

    /// Check of a value above 0 and at most 1.
    pub fn share(&mut self, path: &str, what: &str, value: impl Into<Option<f64>>) {
        if let Some(value) = value.into()
            && !(0.0 < value && value <= 1.0)
        {
            self.refuse(
                Code::ValueOutOfRange,
                path,
                format!("{what} must be above 0 and at most 1, found {value}"),
            );
        }
    }

    /// Check of a direction, of any length but zero.
    pub fn direction(&mut self, path: impl Into<String>, what: &str, value: Triple) {
        if is_zero(value) {
            self.refuse(
                Code::UnusableDirection,
                path,
                format!("{what} has no direction: its length must be > 0, found {value:?}"),
            );
        }
    }

    /// Check of the corners of a box at `path`, refused at its upper corner.
    pub fn extent(&mut self, path: &str, what: &str, (min, max): (Triple, Triple)) {
        if !is_ordered(min, max) {
            self.refuse(
                Code::ValuesOutOfOrder,
                format!("{path}.max"),
                format!("{what}: max {max:?} must exceed min {min:?} in every direction"),
            );
        }
    }

    /// Check that an item of a list is listed once.
    pub fn listed_once<T: PartialEq>(
        &mut self,
        path: &str,
        what: impl std::fmt::Display,
        (list, index): (&[T], usize),
    ) {
        if list[..index].contains(&list[index]) {
            self.refuse(Code::WrittenTwice, path, format!("{what} is listed twice"));
        }
    }

    /// Check that a name is in `materials`.
    pub fn material_exists(&mut self, path: String, what: &str, name: &str, scene: &SceneFile) {
        let names: Vec<&str> = scene.materials.iter().map(|m| m.name.as_str()).collect();
        if !names.contains(&name) {
            self.refuse(
                Code::UnknownName,
                path,
                format!(
                    "{what} `{name}` is not in materials{}",
                    suggestion(name, &names)
                ),
            );
        }
    }

    /// Check that a name is in `blocks`.
    pub fn block_exists(&mut self, path: String, what: &str, name: &str, scene: &SceneFile) {
        let names: Vec<&str> = scene.blocks.iter().map(|b| b.name.as_str()).collect();
        if !names.contains(&name) {
            self.refuse(
                Code::UnknownName,
                path,
                format!(
                    "{what}: there is no block `{name}`{}",
                    suggestion(name, &names)
                ),
            );
        }
    }

    /// Check of a name that others may share, for a table separated by commas.
    pub fn label(&mut self, path: impl Into<String>, name: &str) {
        if name.trim().is_empty() {
            self.refuse(Code::UnusableName, path, "the name is empty".to_owned());
        } else if name.contains([',', '"', '\n', '\r']) {
            let what = format!("the name `{name}` has a comma, quote or line break");
            self.refuse(Code::UnusableName, path, what);
        }
    }

    /// Check that names of a list are unique and fit a table separated by commas.
    pub fn unique<'a>(&mut self, list: &str, names: impl Iterator<Item = &'a str>) {
        let mut seen: Vec<&str> = Vec::new();
        for (index, name) in names.enumerate() {
            let path = format!("{list}[{index}]");
            if name.is_empty() {
                self.refuse(Code::UnusableName, &path, "the name is empty".to_owned());
            }
            if name.contains([',', '"', '\n', '\r']) {
                self.refuse(
                    Code::UnusableName,
                    &path,
                    format!("the name `{name}` has a comma, quote or line break"),
                );
            }
            if seen.contains(&name) {
                self.refuse(
                    Code::UnusableName,
                    &path,
                    format!("the name `{name}` is taken; names in {list} must differ"),
                );
            }
            seen.push(name);
        }
    }
}

pub(super) fn is_zero((x, y, z): Triple) -> bool {
    x == 0.0 && y == 0.0 && z == 0.0
}

pub(super) fn is_ordered(min: Triple, max: Triple) -> bool {
    min.0 < max.0 && min.1 < max.1 && min.2 < max.2
}

/// True for a point in the domain.
pub(super) fn is_inside(x: Triple, scene: &SceneFile) -> bool {
    let (min, max) = (scene.domain.min, scene.domain.max);
    min.0 <= x.0 && x.0 <= max.0 && min.1 <= x.1 && x.1 <= max.1 && min.2 <= x.2 && x.2 <= max.2
}
