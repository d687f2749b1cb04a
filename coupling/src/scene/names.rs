//! Blocks and materials by name: looked up once, numbers from there on.

use std::collections::BTreeMap;

use super::file::SceneFile;

/// Blocks and materials by name.
pub(super) struct Names<'a> {
    blocks: BTreeMap<&'a str, usize>,
    materials: BTreeMap<&'a str, usize>,
}

impl<'a> Names<'a> {
    pub(super) fn of(file: &'a SceneFile) -> Self {
        Self {
            blocks: numbers(file.blocks.iter().map(|block| block.name.as_str())),
            materials: numbers(file.materials.iter().map(|material| material.name.as_str())),
        }
    }

    /// Number of a block, whose name validation has verified.
    pub(super) fn block(&self, name: &str) -> usize {
        self.blocks.get(name).copied().unwrap_or(0)
    }

    /// Number of a material, whose name validation has verified.
    pub(super) fn material(&self, name: &str) -> usize {
        self.materials.get(name).copied().unwrap_or(0)
    }
}

/// Position of each name; of the first where there are several.
fn numbers<'a>(names: impl Iterator<Item = &'a str>) -> BTreeMap<&'a str, usize> {
    let mut numbers = BTreeMap::new();
    for (number, name) in names.enumerate() {
        numbers.entry(name).or_insert(number);
    }
    numbers
}
