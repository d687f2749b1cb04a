//! Terrain from ESRI ASCII grids.
#![no_main]

use libfuzzer_sys::fuzz_target;
use riprap::scene::raster::terrain_from;

fuzz_target!(|content: &[u8]| {
    let _ = terrain_from(content, (0.0, 0.0));
});
