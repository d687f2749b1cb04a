//! VTK meshes, legacy and XML; the first byte tells which.
#![no_main]

use libfuzzer_sys::fuzz_target;
use riprap::scene::mesh::{solid_from, surface_from, survey_from};

fuzz_target!(|content: &[u8]| {
    // a legacy file begins with `#`, an XML file with `<`
    let extension = if content.starts_with(b"#") {
        "vtk"
    } else {
        "vtp"
    };
    let _ = survey_from(content, extension, 1.0);
    let _ = solid_from(content, extension, 1.0);
    let _ = surface_from(content, extension, 0.001);
});
