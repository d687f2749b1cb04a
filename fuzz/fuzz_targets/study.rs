//! Studies of `riprap trade`, by themselves: their scenes are not read.
#![no_main]

use libfuzzer_sys::fuzz_target;
use riprap::trade::plan::read_text;

fuzz_target!(|text: &str| {
    let _ = read_text("x.ron", text);
});
