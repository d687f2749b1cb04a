//! `riprap compare`: records, and surfaces of any kind, against closed forms.

use std::fmt::Write as _;
use std::path::Path;

use crate::support::{riprap, words};

#[test]
fn compare_gives_figures_and_json() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, scale: f64| {
        let path = folder.path().join(name);
        let rows: String = (0..200)
            .map(|i| {
                let t = f64::from(i) * 0.05;
                format!("{t},{}\n", scale * t.sin())
            })
            .collect();
        std::fs::write(&path, format!("time [s],g1 [m]\n{rows}")).unwrap();
        path
    };
    let (a, b) = (write("a.csv", 1.1), write("b.csv", 1.0));
    let output = riprap(&[
        "compare",
        a.to_str().unwrap(),
        b.to_str().unwrap(),
        "--json",
    ]);
    assert!(output.status.success(), "{}", words(&output));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let report = json.get(0).unwrap_or(&json);
    // a reference of two columns needs no names, nor a heading
    let bare = folder.path().join("bare.csv");
    let text = std::fs::read_to_string(&b).unwrap();
    std::fs::write(
        &bare,
        text.replacen("time [s],g1 [m]", "# digitised from a figure", 1),
    )
    .unwrap();
    let again = riprap(&[
        "compare",
        a.to_str().unwrap(),
        bare.to_str().unwrap(),
        "--column",
        "g1",
        "--json",
    ]);
    assert_eq!(again.stdout, output.stdout, "{}", words(&again));
    // 1.1 sin t against sin t: the peak is 0.1 too high, sampled every 0.05 s
    assert!(
        (report["peak_error"].as_f64().unwrap() - 0.1).abs() < 1e-3,
        "{json}"
    );
    assert!(
        (report["correlation"].as_f64().unwrap() - 1.0).abs() < 1e-12,
        "{json}"
    );
}

/// A reference of a laboratory: its own names, separators and units, or none.
#[test]
fn a_reference_has_columns_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let wave = |t: f64| 0.1 * t.sin();
    let table = |head: &str, row: &dyn Fn(f64) -> String| -> String {
        let rows = (0..200).map(|i| row(0.05 * f64::from(i)) + "\n");
        head.to_owned() + &rows.collect::<String>()
    };
    let run = file(
        "gauges.csv",
        &table("time [s],g1 [m],p1 [Pa]\n", &|t| {
            format!("{t},{},{}", 1.1 * wave(t), 9810.0 * wave(t))
        }),
    );
    let compared = |reference: &str, more: &[&str]| {
        riprap(&[&["compare", &run, reference, "--json"], more].concat())
    };
    let peak = |reference: &str, more: &[&str]| -> f64 {
        let output = compared(reference, more);
        assert!(output.status.success(), "{reference}: {}", words(&output));
        let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        found[0]["peak_error"].as_f64().unwrap()
    };
    // crests of 0.11 and 0.1 m, sampled every 0.05 s; in the unit of the run, whatever that of the reference
    let close = |found: f64| assert!((found - 0.01).abs() < 1e-4, "{found}");
    let own = file(
        "own.csv",
        &table("# tank 3\nt [ms],x [m],eta [mm]\n", &|t| {
            format!("{},7,{}", 1e3 * t, 1e3 * wave(t))
        }),
    );
    let column = ["--column", "g1", "--reference-column"];
    let with = |more: &[&'static str]| [&column[..], more].concat();
    close(peak(&own, &with(&["eta"])));
    close(peak(&own, &with(&["ETA [mm]", "--reference-time", "t"])));
    close(peak(&own, &with(&["3", "--reference-time", "1"])));
    // German spreadsheet, and a line of units
    let comma = |x: f64| format!("{x:.6}").replace('.', ",");
    let semicolons = file(
        "messung.csv",
        &table("\u{feff}Zeit;Auslenkung\ns;cm\n", &|t| {
            format!("{};{}", comma(t), comma(100.0 * wave(t)))
        }),
    );
    close(peak(
        &semicolons,
        &with(&["Auslenkung", "--reference-time", "Zeit"]),
    ));
    let tabs = file(
        "lab.tsv",
        &table("time (s)\teta (m)\n", &|t| format!("{t}\t{}", wave(t))),
    );
    close(peak(&tabs, &with(&["eta"])));
    let bare = file(
        "bare.txt",
        &table("", &|t| format!("  {t}   {}  NaN", wave(t))),
    );
    close(peak(&bare, &with(&["2"])));
    let pressure = file(
        "p.csv",
        &table("t [s],PT1 (kPa)\n", &|t| format!("{t},{}", 9.81 * wave(t))),
    );
    let found = peak(&pressure, &["--column", "p1", "--reference-column", "PT1"]);
    assert!(found.abs() < 1e-6, "{found}");

    for (reference, more, expected) in [
        (
            &own,
            with(&["etta"]),
            "no column `etta`, or several; its columns: 1 `t [ms]`, 2 `x [m]`, 3 `eta [mm]`",
        ),
        (&bare, with(&["eta"]), "its columns: 1, 2, 3"),
        (
            &pressure,
            with(&["PT1"]),
            "column `PT1 (kPa)` is in kPa, and the run in m; convertible are m, mm",
        ),
        (
            &own,
            vec!["--reference-column", "eta"],
            "name a column of the run with --column; its columns: time [s], g1 [m], p1 [Pa]",
        ),
        (&own, vec!["--column", "g1"], "--reference-column"),
        (
            &semicolons,
            with(&["Auslenkung", "--reference-time", "4"]),
            "no column `4`",
        ),
    ] {
        let output = compared(reference, &more);
        assert_eq!(output.status.code(), Some(2));
        assert!(
            words(&output).contains(expected),
            "{expected}: {}",
            words(&output)
        );
    }
    let broken = file("broken.csv", "t,eta\n0,1\n1,wet\n");
    let told = words(&compared(&broken, &with(&["eta"])));
    assert!(told.contains("line 3: `wet` is not a number"), "{told}");
}

/// A reference from a spreadsheet with decimal commas is the same reference, and a bad line is named.
#[test]
fn a_reference_is_the_same_in_every_dialect() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name).display().to_string();
    let write = |name: &str, text: &str| {
        std::fs::write(folder.path().join(name), text).unwrap();
        place(name)
    };
    let rows = |columns: &str, comma: &str, end: &str| -> String {
        let number = |x: f64| format!("{x:?}").replace('.', comma);
        let row = |k: i32| {
            let t = 0.25 * f64::from(k);
            format!("{}{columns}{}{end}", number(t), number(0.5 * t * t))
        };
        (0..9).map(row).collect()
    };
    let computed = write(
        "a.csv",
        &format!("time [s],g1 [m]\n{}", rows(",", ".", "\n")),
    );
    let compared = |reference: &str| {
        let output = riprap(&["compare", &computed, reference, "--json"]);
        assert!(output.status.success(), "{}", words(&output));
        output.stdout
    };
    let expected = compared(&computed);
    for text in [
        format!("\u{feff}time [s];g1 [m]\r\n{}", rows(";", ",", "\r\n")),
        format!(
            "# from a figure\ntime [s]\tg1 [m]\n{}",
            rows("\t", ",", "\n")
        ),
        format!("time [s]   g1 [m]\n\n{}", rows("   ", ".", "\n")),
        format!("\"time [s]\",\"g1 [m]\"\n{}", rows(",", ".", "\n")),
    ] {
        assert!(compared(&write("b.csv", &text)) == expected, "{text}");
    }
    let bad = write("c.csv", "time [s];g1 [m]\n0;0,5\n# gap\n1;0,5;3\n");
    let output = riprap(&["compare", &computed, &bad]);
    assert!(
        words(&output).contains("line 4: 3 values, expected 2"),
        "{}",
        words(&output)
    );
}

/// Raster of 41 x 31 points 2 m apart about the map's (412000, 6904000).
fn raster(path: &Path, height: impl Fn(f64, f64) -> f64) {
    let mut text =
        "ncols 41\nnrows 31\nxllcenter 412000\nyllcenter 6904000\ncellsize 2\nNODATA_value -9999\n"
            .to_owned();
    for j in (0..31).rev() {
        let row = (0..41).map(|i| format!("{:?}", height(2.0 * f64::from(i), 2.0 * f64::from(j))));
        text += &(row.collect::<Vec<_>>().join(" ") + "\n");
    }
    std::fs::write(path, text).unwrap();
}

/// Two parallel tilted planes 0.3 m apart, and two that cross, against closed forms; exchanged they give the same.
#[test]
fn surfaces_are_compared_both_ways() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let compared = |a: &str, b: &str| -> serde_json::Value {
        let output = riprap(&["compare", &file(a), &file(b), "--json"]);
        assert!(output.status.success(), "{}", words(&output));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let tilted = |x: f64, y: f64| 100.0 + 0.75 * x + 0.0 * y;
    raster(&folder.path().join("low.asc"), tilted);
    raster(&folder.path().join("high.asc"), |x, y| tilted(x, y) + 0.3);
    raster(&folder.path().join("crossing.asc"), |x, y| {
        tilted(x, y) + 0.01 * (x - 20.0)
    });
    let of = |found: &serde_json::Value, path: &str| found.pointer(path).unwrap().as_f64().unwrap();
    let close = |found: &serde_json::Value, path: &str, expected: f64, tolerance: f64| {
        let value = of(found, path);
        assert!(
            (value - expected).abs() <= tolerance,
            "{path}: {value}, not {expected}\n{found}"
        );
    };
    // heights of 160 m have round-off of 3e-14 m, areas of 4800 m² take it to 1e-10 m³
    let parallel = compared("high.asc", "low.asc");
    close(&parallel, "/area", 80.0 * 60.0, 1e-9);
    close(&parallel, "/height/mean", 0.3, 1e-12);
    close(&parallel, "/height/rms", 0.3, 1e-12);
    close(&parallel, "/height/most", 0.3, 1e-12);
    close(&parallel, "/fill", 0.3 * 4800.0, 1e-9);
    close(&parallel, "/cut", 0.0, 1e-9);
    // across the planes it is 0.3 cos(atan 0.75) = 0.24 m, at the rim whose foot lies beyond the other it is 0.3 m straight down:
    // a column of 31 points of 41, at the upper rim one way, at the lower the other
    for way in ["to_second", "to_first"] {
        close(&parallel, &format!("/{way}/most"), 0.24, 1e-12);
        close(&parallel, &format!("/{way}/largest"), 0.3, 1e-12);
        close(
            &parallel,
            &format!("/{way}/mean"),
            (40.0 * 0.24 + 0.3) / 41.0,
            1e-12,
        );
    }
    close(&parallel, "/hausdorff", 0.3, 1e-12);
    // 0.01 (x − 20) from 0 to 80: mean 0.2, mean square (0.6³ + 0.2³)/(3 · 0.8), above 60 m · 0.01 · 60²/2, below 60 · 0.01 · 20²/2
    let crossing = compared("crossing.asc", "low.asc");
    close(&crossing, "/height/mean", 0.2, 1e-12);
    let square: f64 = (0.6_f64.powi(3) + 0.2_f64.powi(3)) / 2.4;
    close(&crossing, "/height/rms", square.sqrt(), 1e-12);
    close(&crossing, "/height/largest", 0.6, 1e-12);
    close(&crossing, "/fill", 1080.0, 1e-9);
    close(&crossing, "/cut", 120.0, 1e-9);
    let back = compared("low.asc", "crossing.asc");
    for (path, mirrored, sign) in [
        ("/height/mean", "/height/mean", -1.0),
        ("/height/rms", "/height/rms", 1.0),
        ("/fill", "/cut", 1.0),
        ("/cut", "/fill", 1.0),
        ("/to_first/mean", "/to_second/mean", 1.0),
        ("/to_second/rms", "/to_first/rms", 1.0),
        ("/hausdorff", "/hausdorff", 1.0),
    ] {
        close(&crossing, path, sign * of(&back, mirrored), 1e-11);
    }
    // the table on the terminal and in the file
    let output = riprap(&["compare", &file("high.asc"), &file("low.asc")]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(
        said.contains("height difference mean           +0.3000 m"),
        "{said}"
    );
    assert!(
        said.contains("fill: first above second         1.440000e3 m3"),
        "{said}"
    );
    let written = std::fs::read_to_string(file("high_compared.csv")).unwrap();
    assert!(
        written.starts_with("quantity,value,unit\ncommon area,4800,m2\n"),
        "{written}"
    );
    // a cloud and a mesh of the same planes
    let mut cloud = String::new();
    for k in 0..2000 {
        let (x, y) = (
            f64::from(k * 7919 % 2003) / 25.0,
            f64::from(k * 104_729 % 1999) / 33.0,
        );
        writeln!(
            cloud,
            "{:?} {:?} {:?}",
            412_000.0 + x,
            6_904_000.0 + y,
            tilted(x, y) + 0.3
        )
        .unwrap();
    }
    std::fs::write(file("high.xyz"), cloud).unwrap();
    let (x, y) = (412_080.0, 6_904_060.0);
    let mesh = format!(
        "v 412000 6904000 100\nv {x} 6904000 160\nv {x} {y} 160\nv 412000 {y} 100\nf 1 2 3 4\n"
    );
    std::fs::write(file("low.obj"), mesh).unwrap();
    let mixed = compared("high.xyz", "low.obj");
    // coordinates of 6.9e6 m have round-off of 1e-9 m
    close(&mixed, "/height/mean", 0.3, 1e-7);
    close(&mixed, "/height/largest", 0.3, 1e-7);
    // apart, and of another system
    std::fs::write(file("far.xyz"), "1 1 1\n2 1 1\n1 2 1\n2 2 1\n3 3 1\n").unwrap();
    let apart = riprap(&["compare", &file("far.xyz"), &file("low.asc")]);
    assert_eq!(apart.status.code(), Some(2));
    assert!(
        words(&apart).contains("no area is covered by both"),
        "{}",
        words(&apart)
    );
}

/// The ground and the blocks at the end of a run, in the coordinates of the map, against a survey of both.
#[test]
fn a_deposit_is_compared_with_a_survey() {
    let folder = tempfile::tempdir().unwrap();
    let scene = r#"(title: "deposit", domain: (min: (-5, -5, -5), max: (85, 65, 20)),
        materials: [(name: "rock", density: 2500, friction_angle_deg: 40)],
        terrain: (sources: [(file: "ground.asc")], origin: (412000, 6904000, 0)),
        blocks: [(name: "ground", material: "rock", motion: Fixed, shape: Terrain),
                 (name: "boulder", material: "rock", shape: Box(min: (20, 20, 3), max: (30, 30, 8)))],
        time: (duration: 0.001))"#;
    raster(&folder.path().join("ground.asc"), |_, _| 3.0);
    raster(&folder.path().join("survey.asc"), |x, y| {
        let is_over = (20.0..=30.0).contains(&x) && (20.0..=30.0).contains(&y);
        if is_over { 8.5 } else { 3.0 }
    });
    let file = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    std::fs::write(file("deposit.ron"), scene).unwrap();
    let run = riprap(&["run", &file("deposit.ron"), "-o", &file("run"), "--quiet"]);
    assert!(run.status.success(), "{}", words(&run));
    let output = riprap(&["compare", &file("run"), &file("survey.asc"), "--json"]);
    assert!(output.status.success(), "{}", words(&output));
    let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    // 6 x 6 points of the survey are on the block, half a meter higher than its top; files of a run have 24 bits, 4e-7 m at 8 m
    let largest = found.pointer("/height/largest").unwrap().as_f64().unwrap();
    assert!((largest - 0.5).abs() < 1e-5, "{found}");
    // on the lattice of 2 m the step of each side is spread over a cell: between 10 x 10 and 14 x 14 m of half a meter
    let cut = found.pointer("/cut").unwrap().as_f64().unwrap();
    assert!((50.0..=98.0).contains(&cut), "{found}");
    assert!(
        found.pointer("/fill").unwrap().as_f64().unwrap() < 1e-3,
        "{found}"
    );
    assert!(folder.path().join("run/compared.csv").exists());
}
