//! Clouds of points from LAS, LAZ and tables, as terrain.
#![no_main]

use libfuzzer_sys::fuzz_target;
use riprap::scene::cloud::cloud_of;

fuzz_target!(|content: &[u8]| {
    if let Ok(cloud) = cloud_of(content) {
        let _ = cloud.grid(None);
    }
});
