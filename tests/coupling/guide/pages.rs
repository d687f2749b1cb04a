//! Pages of the guide, cut into blocks of code and words.

use std::fs;
use std::path::{Path, PathBuf};

/// A page written in Markdown.
pub struct Page {
    /// Path below `docs/`.
    pub name: String,
    text: String,
    /// Fenced blocks, in order.
    pub blocks: Vec<Block>,
}

/// A fenced block.
pub struct Block {
    /// Word after its fence.
    pub language: String,
    /// Content.
    pub text: String,
}

impl Block {
    /// Whether it is a complete scene.
    pub fn is_scene(&self) -> bool {
        let first = self
            .text
            .lines()
            .map(str::trim)
            .find(|line| !line.is_empty() && !line.starts_with("//"));
        self.language == "ron" && first == Some("(") && self.text.contains("\n    title: ")
    }
}

impl Page {
    /// Whether it is made from the schema of scenes, with tests of its own.
    pub fn is_generated(&self) -> bool {
        self.name.starts_with("reference/scene/")
    }

    /// Lines outside of fenced blocks, with their number from 1.
    pub fn prose(&self) -> impl Iterator<Item = (usize, &str)> {
        let mut is_inside = false;
        self.text.lines().enumerate().filter_map(move |(i, line)| {
            let is_fence = line.trim_start().starts_with("```");
            is_inside ^= is_fence;
            (!is_inside && !is_fence).then_some((i + 1, line))
        })
    }

    /// Words in back ticks outside of fenced blocks.
    pub fn code_spans(&self) -> Vec<String> {
        let prose: Vec<&str> = self.prose().map(|(_, line)| line).collect();
        let spans = prose.join("\n");
        spans
            .split('`')
            .skip(1)
            .step_by(2)
            .map(|span| span.replace('\n', " "))
            .collect()
    }
}

/// Folder of the guide.
pub fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs")
}

/// All pages, by name.
pub fn pages() -> Vec<Page> {
    let mut files = Vec::new();
    collect(&docs(), &mut files);
    files.sort();
    assert!(files.len() > 20, "{files:?}");
    files.iter().map(|path| read(path)).collect()
}

fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(&path, files);
        } else if path.extension().is_some_and(|extension| extension == "md") {
            files.push(path);
        }
    }
}

fn read(path: &Path) -> Page {
    let text = fs::read_to_string(path).unwrap();
    let name = path
        .strip_prefix(docs())
        .unwrap()
        .to_str()
        .unwrap()
        .to_owned();
    let mut blocks = Vec::new();
    let mut open: Option<Block> = None;
    for line in text.lines() {
        match (line.strip_prefix("```"), open.take()) {
            (Some(language), None) => {
                open = Some(Block {
                    language: language.to_owned(),
                    text: String::new(),
                })
            }
            (Some(_), Some(block)) => blocks.push(block),
            (None, Some(mut block)) => {
                block.text.push_str(line);
                block.text.push('\n');
                open = Some(block);
            }
            (None, None) => {}
        }
    }
    assert!(open.is_none(), "{name}: a block of code is not closed");
    Page { name, text, blocks }
}
