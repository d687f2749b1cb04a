//! PLY meshes, as blocks, as surfaces and for a look.
#![no_main]

use libfuzzer_sys::fuzz_target;
use riprap::scene::mesh::{solid_from, surface_from, survey_from};

fuzz_target!(|content: &[u8]| {
    let _ = survey_from(content, "ply", 1.0);
    let _ = solid_from(content, "ply", 1.0);
    let _ = surface_from(content, "ply", 0.001);
});
