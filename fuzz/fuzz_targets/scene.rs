//! Scenes, as `riprap check` reads, checks and resolves them: on a small machine, with no files beside them.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use riprap::memory::Available;
use riprap::scene::access::{FilesFrom, Access};

fuzz_target!(|text: &str| {
    let reach = Access {
        folder: Path::new("no such folder"),
        files: FilesFrom::SceneFolder,
        memory: Some(Available { bytes: 40_000_000 }),
    };
    let _ = riprap::scene::load_text("x.ron", text, &[], &reach);
});
