//! A comparison of surfaces as text, as a table and as JSON.

use std::fmt::Write;

use super::{Differences, Distances, SurfaceComparison};

/// Quantity, value and unit of each row.
fn rows(found: &SurfaceComparison) -> Vec<(&'static str, f64, &'static str)> {
    let SurfaceComparison {
        area,
        cell,
        n_points,
        height,
        fill,
        cut,
        to_second,
        to_first,
        hausdorff,
    } = found;
    let Differences {
        mean,
        rms,
        most,
        largest,
    } = height;
    let ways = |names: [&'static str; 4], of: &Distances| {
        let Distances {
            mean,
            rms,
            most,
            largest,
        } = of;
        let values = [*mean, *rms, *most, *largest];
        names
            .into_iter()
            .zip(values)
            .map(|(name, value)| (name, value, "m"))
    };
    let mut rows = vec![
        ("common area", *area, "m2"),
        ("cell", *cell, "m"),
        ("points", *n_points as f64, ""),
        ("height difference mean", *mean, "m"),
        ("height difference rms", *rms, "m"),
        ("height difference 95 %", *most, "m"),
        ("height difference largest", *largest, "m"),
        ("fill: first above second", *fill, "m3"),
        ("cut: second above first", *cut, "m3"),
    ];
    let names = [
        "distance first to second mean",
        "distance first to second rms",
        "distance first to second 95 %",
        "distance first to second largest",
    ];
    rows.extend(ways(names, to_second));
    let names = [
        "distance second to first mean",
        "distance second to first rms",
        "distance second to first 95 %",
        "distance second to first largest",
    ];
    rows.extend(ways(names, to_first));
    rows.push(("Hausdorff distance", *hausdorff, "m"));
    rows
}

/// The comparison as text: a line per quantity. Height differences are those of the first less the second.
pub fn text(found: &SurfaceComparison) -> String {
    let mut text = String::new();
    for (name, value, unit) in rows(found) {
        // writing to a `String` cannot fail
        let _ = match unit {
            "" => writeln!(text, "  {name:<33}{value}"),
            "m2" | "m3" => writeln!(text, "  {name:<33}{value:.6e} {unit}"),
            _ => writeln!(text, "  {name:<33}{value:+.4} {unit}"),
        };
    }
    text
}

/// The comparison as a table, all digits.
pub fn table(found: &SurfaceComparison) -> String {
    let mut text = "quantity,value,unit\n".to_owned();
    for (name, value, unit) in rows(found) {
        let _ = writeln!(text, "{name},{value},{unit}");
    }
    text
}

/// The comparison as JSON.
///
/// # Errors
///
/// As of `serde_json`; not expected for numbers.
pub fn json(found: &SurfaceComparison) -> Result<String, serde_json::Error> {
    serde_json::to_string_pretty(found)
}
