//! CSV tables, and one column of them by name.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use riprap::table::table_from;

fuzz_target!(|text: &str| {
    if let Ok(table) = table_from(Path::new("x.csv"), text) {
        for column in &table.columns {
            let _ = table.column(&column.header());
            let _ = table.unit(&column.name);
        }
    }
});
