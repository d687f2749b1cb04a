//! Elevations from GeoTIFF files.
#![no_main]

use libfuzzer_sys::fuzz_target;
use riprap::scene::geotiff::raster_from;

fuzz_target!(|content: &[u8]| {
    let _ = raster_from(content);
});
