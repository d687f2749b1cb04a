//! Scenes, as `riprap check` reads, checks and resolves them; with no files beside them.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let _ = riprap::scene::load_text("x.ron", text, &[], Path::new("no such folder"));
});
