//! `riprap report`: pages from run folders made up here, read as a browser reads them, and shown in one.
//!
//! RIPRAP_REQUIRE_CHROMIUM=1 makes the absence of Chromium a failure instead of a skipped check.

use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::process::Command;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::read::ZlibDecoder;
use riprap::report::{report, report_in};
use riprap::vtk::{self, Array, PolyData, Values};
use serde_json::Value;

use crate::support::synthetic_run::{self, Experiment, Result};
use crate::support::{riprap, run, words};

const LIMIT: u64 = 8_000_000;

/// Text of an element of a page by its id.
fn element<'a>(page: &'a str, id: &str) -> Option<&'a str> {
    let (_, rest) = page.split_once(&format!(" id=\"{id}\">"))?;
    rest.split_once("</script>").map(|(text, _)| text)
}

fn meta(page: &str) -> Value {
    serde_json::from_str(element(page, "meta").unwrap()).unwrap()
}

/// Frames of codes of an element, as the page's script unpacks them.
fn unpacked(page: &str, id: &str, n: usize, components: usize, has_speeds: bool) -> Vec<Vec<u16>> {
    let bytes = STANDARD.decode(element(page, id).unwrap()).unwrap();
    let mut raw = Vec::new();
    ZlibDecoder::new(bytes.as_slice())
        .read_to_end(&mut raw)
        .unwrap();
    let size = n * components * 2 + usize::from(has_speeds) * n;
    let mut frames: Vec<Vec<u16>> = Vec::new();
    for frame in raw.chunks(size) {
        let mut codes = vec![0_u16; n * components];
        for k in 0..n * components {
            let (c, i) = (k / n, k % n);
            let z = u16::from(frame[2 * c * n + i]) | u16::from(frame[(2 * c + 1) * n + i]) << 8;
            let reference = match frames.last() {
                Some(before) => before[k],
                None if 0 < i => codes[k - 1],
                None => 0,
            };
            codes[k] = reference.wrapping_add((z >> 1) ^ 0_u16.wrapping_sub(z & 1));
        }
        frames.push(codes);
    }
    frames
}

/// A run in a folder, and its page.
fn made(experiment: &Experiment, limit: u64) -> Result<(tempfile::TempDir, String)> {
    let folder = tempfile::tempdir()?;
    synthetic_run::write(folder.path(), experiment, "", 0)?;
    let file = folder.path().join("report.html");
    let summary = report(folder.path(), &file, limit)?;
    let page = fs::read_to_string(&file)?;
    assert_eq!(summary.size, page.len() as u64);
    Ok((folder, page))
}

fn numbers(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .unwrap()
        .iter()
        .map(|x| x.as_f64().unwrap())
        .collect()
}

#[test]
fn particles_are_where_they_were_within_half_a_quantum() {
    let (folder, page) = made(&synthetic_run::tank(0.05), LIMIT).unwrap();
    let meta = meta(&page);
    let water = &meta["water"];
    assert_eq!(water["kind"], "particles");
    let n = water["items"].as_u64().unwrap() as usize;
    let (lo, step) = (numbers(&water["lo"]), numbers(&water["step"]));
    let absent = water["absent"].as_u64().unwrap() as u16;
    let frames = unpacked(&page, "water", n, 3, true);
    assert_eq!(frames.len(), 5);
    for (k, frame) in frames.iter().enumerate() {
        let written = vtk::read(&folder.path().join(format!("water_{k:05}.vtp"))).unwrap();
        let shown = (0..n).filter(|&i| frame[i] < absent);
        let mut shown: Vec<[f64; 3]> = shown
            .map(|i| [0, 1, 2].map(|c| lo[c] + f64::from(frame[c * n + i]) * step[c]))
            .collect();
        assert_eq!(shown.len(), written.points.len());
        // the page has them in an order of its own: each written one takes the nearest shown one away
        for x in &written.points {
            let off = |y: &[f64; 3]| {
                (0..3)
                    .map(|c| (y[c] - f64::from(x[c])).abs() / step[c])
                    .fold(0.0, f64::max)
            };
            let place = (0..shown.len()).min_by(|&a, &b| off(&shown[a]).total_cmp(&off(&shown[b])));
            let nearest = shown.swap_remove(place.unwrap());
            // single precision of the file
            assert!(off(&nearest) < 0.51, "{x:?} {nearest:?}");
        }
    }
}

#[test]
fn blocks_are_where_they_were() {
    let (folder, page) = made(&synthetic_run::tank(0.1), LIMIT).unwrap();
    let blocks = &meta(&page)["blocks"];
    assert_eq!(blocks["ids"], serde_json::json!([3]));
    let (lo, step) = (numbers(&blocks["lo"]), numbers(&blocks["step"]));
    let first = vtk::read(&folder.path().join("blocks_00000.vtp")).unwrap();
    let middle = |points: &[[f32; 3]]| {
        [0, 1, 2].map(|c| points.iter().map(|x| f64::from(x[c])).sum::<f64>() / points.len() as f64)
    };
    let start = middle(&first.points);
    for (k, pose) in unpacked(&page, "poses", 1, 7, false).iter().enumerate() {
        let written = vtk::read(&folder.path().join(format!("blocks_{k:05}.vtp"))).unwrap();
        let center = [0, 1, 2].map(|c| lo[c] + f64::from(pose[c]) * step[c]);
        let part = |c: usize| -1.0 + f64::from(pose[c]) * 2.0 / 65534.0;
        let (q, w) = (nalgebra::Vector3::new(part(3), part(4), part(5)), part(6));
        for (from, to) in first.points.iter().zip(&written.points) {
            let local = nalgebra::Vector3::from_fn(|c, _| f64::from(from[c]) - start[c]);
            let turned = local + 2.0 * q.cross(&(q.cross(&local) + w * local));
            for c in 0..3 {
                let off = center[c] + turned[c] - f64::from(to[c]);
                // quanta of 2 m/65534, of the quaternion times the size of the block, and single precision
                assert!(off.abs() < 4e-5, "frame {k}: {off}");
            }
        }
    }
}

#[test]
fn a_page_is_the_same_each_time_and_needs_no_network() {
    let (folder, page) = made(&synthetic_run::tank(0.1), LIMIT).unwrap();
    let again = folder.path().join("again.html");
    report(folder.path(), &again, LIMIT).unwrap();
    assert_eq!(fs::read_to_string(again).unwrap(), page);
    for (k, _) in page.match_indices("http") {
        let rest = &page[k..page.len().min(k + 40)];
        assert!(rest.starts_with("http://www.w3.org/"), "{rest}");
    }
    // a title is text
    let case = fs::read_to_string(folder.path().join("case.ron")).unwrap();
    let evil = case.replace("synthetic", "</script><b>&");
    fs::write(folder.path().join("case.ron"), evil).unwrap();
    let file = folder.path().join("report.html");
    report(folder.path(), &file, LIMIT).unwrap();
    let page = fs::read_to_string(file).unwrap();
    assert!(page.contains("<h1>&lt;/script&gt;&lt;b&gt;&amp;") && !page.contains("</script><b>"));
    assert!(
        meta(&page)["title"]
            .as_str()
            .unwrap()
            .starts_with("</script><b>&")
    );
}

#[test]
fn frames_are_left_out_until_it_fits_and_the_page_says_so() {
    let experiment = Experiment {
        times: (0..17).map(|k| 0.05 * f64::from(k)).collect(),
        ..synthetic_run::tank(0.03)
    };
    let (folder, whole) = made(&experiment, LIMIT).unwrap();
    let limit = whole.len() as u64 / 2;
    let file = folder.path().join("report.html");
    let summary = report(folder.path(), &file, limit).unwrap();
    assert!(summary.size <= limit, "{} for {limit}", summary.size);
    let times = meta(&fs::read_to_string(file).unwrap())["water"]["times"].clone();
    assert!(times.as_array().unwrap().len() < 17, "{times}");
    assert!(
        summary
            .description
            .contains("of 17, for the size of this file"),
        "{}",
        summary.description
    );
    // more than that many particles in space are a surface
    let (_folder, page) = made(&synthetic_run::tank(0.014), LIMIT).unwrap();
    let water = meta(&page)["water"].clone();
    assert_eq!(water["kind"], "surface");
    let size = water["size"].as_array().unwrap();
    let n = (size[0].as_u64().unwrap() * size[1].as_u64().unwrap()) as usize;
    let (lo, step) = (numbers(&water["lo"])[0], numbers(&water["step"])[0]);
    let absent = water["absent"].as_u64().unwrap() as u16;
    let frames = unpacked(&page, "water", n, 1, true);
    let (corner, cell) = (numbers(&water["corner"]), water["cell"].as_f64().unwrap());
    let mut n_wet = 0;
    for (i, &code) in frames[0]
        .iter()
        .enumerate()
        .filter(|(_, code)| **code < absent)
    {
        let x = corner[0] + cell * ((i % size[0].as_u64().unwrap() as usize) as f64 + 0.5);
        let expected = 0.3 + (synthetic_run::tank(0.014).surface)(x, 0.0);
        let off = lo + f64::from(code) * step - expected;
        n_wet += 1;
        // particles are shaken by a quarter of half a spacing, in cells of one and a half, whose surface slopes by up to 0.4
        assert!(off.abs() < 1.0 * 0.014, "{x} {off}");
    }
    assert!(n_wet * 10 > 5 * n, "{n_wet} of {n}");
}

/// Maps of a shore at x = 100 m on ground that rises by one in ten: a wave of 3 m, and land flooded for 20 m.
fn maps() -> PolyData {
    let points: Vec<[f32; 3]> = (0..30 * 20)
        .map(|k| [(5 * (k % 30)) as f32, (5 * (k / 30)) as f32, 0.0])
        .map(|[x, y, _]| [x, y, 0.1 * (x - 100.0)])
        .collect();
    let at = |value: fn(f32) -> f32| points.iter().map(|x| value(x[0])).collect();
    let array = |name: &str, values: Vec<f32>| Array {
        name: name.into(),
        components: 1,
        values: Values::F32(values),
    };
    let dry = f32::NAN;
    PolyData {
        point_data: vec![
            array(
                "MaximumElevation",
                at(|x| {
                    if x <= 120.0 {
                        3.0 * (x / 120.0)
                    } else {
                        f32::NAN
                    }
                }),
            ),
            array(
                "FirstArrival",
                at(|x| if x <= 120.0 { 0.1 * x } else { f32::NAN }),
            ),
            array(
                "InundationDepth",
                at(|x| {
                    if (101.0..=120.0).contains(&x) {
                        2.0
                    } else {
                        f32::NAN
                    }
                }),
            ),
            array("Empty", vec![dry; 600]),
        ],
        points,
        ..PolyData::default()
    }
}

#[test]
fn maps_are_pictures_with_a_legend_over_the_land() {
    let (folder, page) = made(&synthetic_run::tank(0.1), LIMIT).unwrap();
    assert!(!page.contains("id=\"maps\""));
    let file = folder.path().join("report.html");
    let again = |data: &PolyData, limit: u64| {
        vtk::write(&folder.path().join("maps.vtp"), data).unwrap();
        let summary = report(folder.path(), &file, limit).unwrap();
        (fs::read_to_string(&file).unwrap(), summary)
    };
    let (page, summary) = again(&maps(), LIMIT);
    assert_eq!(page.matches("<figure>").count(), 3);
    for words in [
        "<b>Highest water</b> <span class=\"soft\">elevation, m</span>",
        "<b>First arrival of the wave</b>",
        "<b>Inundation depth</b>",
        "maximum_elevation.tif",
        "id=\"map-shore\" d=\"M",
        // of 150 m
        "</i>20 m</div>",
    ] {
        assert!(page.contains(words), "{words}");
    }
    assert!(
        summary
            .description
            .ends_with("maps of highest water, first arrival of the wave, inundation depth")
    );
    // legends: arrivals from 0 to 12 s
    let (_, key) = page.split_once("<b>First arrival").unwrap();
    let (key, _) = key.split_once("</figure>").unwrap();
    assert!(
        key.contains("left:0.0%\">0<") && key.contains("left:100.0%\">12<"),
        "{key}"
    );
    assert_eq!(again(&maps(), LIMIT).0, page);
    // where nothing was flooded, the page says so; and a small file has small pictures
    let whole = page.len();
    let mut calm = maps();
    calm.point_data[2].values = Values::F32(vec![f32::NAN; 600]);
    let (page, _) = again(&calm, LIMIT);
    assert!(page.contains("No water came to land") && page.matches("<figure>").count() == 2);
    let (_, summary) = again(&maps(), 150_000);
    assert!(summary.size <= 150_000, "{}", summary.size);
    // a quarter of the file is theirs, less than the 20 kB that they would take
    let (small, _) = again(&maps(), 40_000);
    assert!(small.len() < whole, "{} of {whole}", small.len());
    // in other colors: turbo from #30123b to #7a0403, at an opacity of 0.8 over the bed, as the maps show them
    let other = folder.path().join("turbo.html");
    report_in(folder.path(), &other, LIMIT, "turbo".parse().unwrap()).unwrap();
    let other = fs::read_to_string(other).unwrap();
    assert!(other.contains("#4e3759") && other.contains("#892c2c"));
}

/// A tile of 2 m² that looks along an axis, with its normal in the direction of the sign.
fn tile(data: &mut PolyData, x: f32, is_reversed: bool) {
    let first = data.points.len() as i32;
    data.points
        .extend([[x, 0.0, 0.0], [x, 1.0, 0.0], [x, 1.0, 2.0], [x, 0.0, 2.0]]);
    let mut corners = vec![first, first + 1, first + 2, first + 3];
    if is_reversed {
        corners.reverse();
    }
    data.polygons.connectivity.extend(corners);
    data.polygons.offsets.push(data.points.len() as i32);
}

#[test]
fn forces_are_told_by_body_source_and_face() {
    let folder = tempfile::tempdir().unwrap();
    synthetic_run::write(folder.path(), &synthetic_run::tank(0.1), "", 0).unwrap();
    let sources = [
        "pressure",
        "shear",
        "joint_water",
        "pushed_back",
        "contact",
        "attached",
        "restrained",
        "gravity",
        "gained",
        "residual",
    ];
    let axes = [
        "fx [N]", "fy [N]", "fz [N]", "mx [N m]", "my [N m]", "mz [N m]",
    ];
    let columns = sources
        .iter()
        .flat_map(|s| axes.iter().map(move |a| format!("{s}_{a}")));
    let head: Vec<String> = ["time [s]", "block [-]"]
        .map(str::to_owned)
        .into_iter()
        .chain(columns)
        .collect();
    let row = |time: f64, force: f64| {
        let zeros = vec!["0.0"; 54].join(",");
        format!("{time},3,{force},0,-500,0,25.5,0,{zeros}\n")
    };
    let text = format!(
        "{}\n{}{}{}",
        head.join(","),
        row(0.1, 10.0),
        row(0.2, -12_000.0),
        row(0.3, 7.0)
    );
    fs::write(folder.path().join("forces.csv"), text).unwrap();
    let mut frames = vtk::Collection::new(folder.path(), "faces");
    for (k, pressure) in [1000.0, 4000.0, 2000.0].into_iter().enumerate() {
        let mut data = PolyData::default();
        tile(&mut data, 0.0, true);
        tile(&mut data, 1.0, false);
        let array = |name: &str, values| Array {
            name: name.into(),
            components: 1,
            values,
        };
        data.cell_data = vec![
            array("BlockId", Values::I32(vec![3, 3])),
            array("Pressure", Values::F32(vec![pressure, 0.5 * pressure])),
        ];
        let name = format!("faces_{k:05}.vtp");
        vtk::write(&folder.path().join(&name), &data).unwrap();
        frames.push(0.1 * k as f64, name).unwrap();
    }
    let file = folder.path().join("report.html");
    report(folder.path(), &file, LIMIT).unwrap();
    let page = fs::read_to_string(file).unwrap();
    let row = |cells: &[&str]| {
        let cells: String = cells
            .iter()
            .map(|cell| format!("<td>{cell}</td>"))
            .collect();
        format!("<tr>{cells}</tr>")
    };
    for cells in [
        // √(12² + 0.5²) kN
        &[
            "block 3",
            "pressure of water",
            "12.01",
            "0.2000",
            "-12.00",
            "0",
            "-0.5000",
            "25.50",
            "0.1000",
        ][..],
        &[
            "block 3", "−x", "8.000", "0.1000", "2.000", "4.000", "4.000", "0.1000",
        ],
        &[
            "block 3", "+x", "4.000", "0.1000", "2.000", "2.000", "2.000", "0.1000",
        ],
    ] {
        assert!(page.contains(&row(cells)), "{cells:?}");
    }
    assert!(
        page.contains("<th>largest force, kN</th>")
            && page.contains("<th>largest pressure, kPa</th>")
    );
    assert!(page.contains("Means over 0.1000 s"));
}

const FLUME: &str = r#"(
    title: "flume",
    domain: (min: (-1, 0, -0.5), max: (11, 1, 2), dimensions: Two),
    materials: [(name: "rock", density: 2600, friction_angle_deg: 35)],
    blocks: [
        (name: "paddle", material: "rock", shape: Box(min: (-0.4, 0, 0), max: (0, 1, 1.5)),
         motion: Waves(direction: (1, 0, 0), waves: Solitary(height: 0.1))),
        (name: "floor", material: "rock", motion: Fixed, shape: Box(min: (-1, 0, -0.5), max: (11, 1, 0.13))),
        (name: "end", material: "rock", motion: Fixed, shape: Box(min: (10, 0, 0.13), max: (11, 1, 1.5))),
    ],
    fluid: (resolution: Spacing(0.125), regions: [(name: "flume", shape: Below(level: 0.63, seed: (5, 0.5, 0.4)))]),
    gauges: [SurfaceElevation(name: "before", x: 1, y: 0.5), SurfaceElevation(name: "behind", x: -0.7, y: 0.5)],
    time: (duration: 0.2),
)"#;

#[test]
fn gauges_before_a_wave_maker_have_their_theory() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("flume.ron");
    fs::write(&case, FLUME).unwrap();
    let out = folder.path().join("out");
    run(&case, &out, &[]);
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    let gauges = meta(&page)["gauges"].clone();
    let theory = numbers(&gauges[0]["theory"]);
    assert_eq!(theory.len(), gauges[0]["t"].as_array().unwrap().len());
    // still water, and the foot of a wave of 0.1 m
    assert!(
        theory.iter().all(|z| (0.629..0.73).contains(z)),
        "{theory:?}"
    );
    assert!(gauges[1]["theory"].is_null());
}

/// Chromium; `None` where it may be absent.
fn chromium() -> Option<PathBuf> {
    let names = ["chromium", "chromium-browser", "google-chrome"];
    let found = names.into_iter().find(|name| {
        Command::new(name)
            .arg("--version")
            .output()
            .is_ok_and(|o| o.status.success())
    });
    let is_required = std::env::var("RIPRAP_REQUIRE_CHROMIUM").is_ok_and(|value| value == "1");
    assert!(
        found.is_some() || !is_required,
        "no chromium, and RIPRAP_REQUIRE_CHROMIUM=1"
    );
    found.map(PathBuf::from)
}

/// The page as the browser leaves it, after its script.
fn shown(chromium: &Path, page: &Path) -> String {
    let url = format!("file://{}", page.display());
    let arguments = [
        "--headless=new",
        "--use-angle=swiftshader",
        "--enable-unsafe-swiftshader",
        "--no-sandbox",
        "--disable-dev-shm-usage",
        "--virtual-time-budget=20000",
        "--dump-dom",
        url.as_str(),
    ];
    let output = Command::new(chromium).args(arguments).output().unwrap();
    String::from_utf8_lossy(&output.stdout).into_owned()
}

/// The script finds all numbers undamaged and WebGL without an error; of a damaged page it says that.
#[test]
fn a_browser_plays_it() {
    let Some(chromium) = chromium() else { return };
    for experiment in [synthetic_run::tank(0.05), synthetic_run::tank(0.014)] {
        let (folder, page) = made(&experiment, LIMIT).unwrap();
        let file = folder.path().join("report.html");
        let dom = shown(&chromium, &file);
        let fault = dom
            .split_once("id=\"fault\"")
            .unwrap()
            .1
            .split_once("</p>")
            .unwrap()
            .0;
        assert!(dom.contains("data-state=\"ready\""), "{fault}");
        let sum = meta(&page)["water"]["checksum"].clone();
        let other = page.replace(&format!("\"checksum\":{sum}"), "\"checksum\":1");
        assert_ne!(other, page);
        fs::write(&file, other).unwrap();
        let dom = shown(&chromium, &file);
        assert!(
            dom.contains("data-state=\"failed\"") && dom.contains("numbers of water are damaged")
        );
    }
}

const DROP: &str = r#"(
    title: "Drop",
    domain: (min: (-0.3, 0, -0.3), max: (0.9, 0.1, 0.9), dimensions: Two),
    materials: [(name: "rock", density: 2400, friction_angle_deg: 30)],
    blocks: [
        (name: "floor", material: "rock", motion: Fixed, shape: Box(min: (-0.3, 0, -0.3), max: (0.9, 0.1, 0))),
        (name: "stone", material: "rock", shape: Box(min: (0, 0, 0.01), max: (0.2, 0.1, 0.2))),
    ],
    gauges: [BlockForce(name: "stone", block: "stone")],
    time: (duration: 0.1),
)"#;

#[test]
fn every_run_leaves_one_unless_told_not_to_and_ends_with_a_verdict() {
    let folder = tempfile::tempdir().unwrap();
    let case = folder.path().join("drop.ron");
    fs::write(&case, DROP).unwrap();
    let out = folder.path().join("out");
    let text = |path: &Path| path.to_str().unwrap().to_owned();
    let output = riprap(&["run", &text(&case), "-o", &text(&out)]);
    assert!(output.status.success(), "{}", words(&output));
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    for line in [
        "energy: ",
        "resolution: blocks without water",
        "to look at: nothing stands out",
        "report.html",
    ] {
        assert!(said.contains(line), "{said}");
    }
    let page = fs::read_to_string(out.join("report.html")).unwrap();
    assert!(page.contains("<td>stone</td>") && page.contains("energy: "));
    let summary = run(&case, &out, &["--force", "--no-report"]);
    assert!(!out.join("report.html").exists());
    assert_eq!(summary["verdict"].as_array().unwrap().len(), 3);
    // from the folder alone, later
    let output = riprap(&[
        "report",
        &text(&out),
        "-o",
        &text(&folder.path().join("later.html")),
    ]);
    assert!(output.status.success(), "{}", words(&output));
    assert!(folder.path().join("later.html").is_file());
    let output = riprap(&["report", &text(&folder.path().join("nothing"))]);
    assert_eq!(output.status.code(), Some(1));
    assert!(
        words(&output).contains("is its folder a run folder")
            || words(&output).contains("cannot read"),
        "{}",
        words(&output)
    );
}
