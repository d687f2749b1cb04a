//! The page of a run, from made-up data; the pages stay in the target folder, to be looked at.

use base64::Engine;
use riprap::overview::{Outline, Overview, Record, Snapshot, svg};
use std::path::Path;

/// Writes a page where the build keeps temporary files, after what every page must fulfil.
fn keep(name: &str, overview: &Overview) -> String {
    let page = svg(overview);
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::write(&path, &page).unwrap();
    println!("{}: {} kB", path.display(), page.len() / 1000);
    assert!(page.len() < 500_000, "{} bytes", page.len());
    for bad in ["NaN", "inf", "\u{1}"] {
        // Base64 may spell anything.
        assert!(
            without_pictures(&page)
                .iter()
                .all(|text| !text.contains(bad)),
            "{bad} in {name}"
        );
    }
    assert_eq!(page, svg(overview), "the same data give the same page");
    page
}

fn without_pictures(page: &str) -> Vec<&str> {
    page.lines()
        .filter(|line| !line.starts_with("<image"))
        .collect()
}

/// Sizes of the pictures, as the PNG decoder sees them.
fn pictures(page: &str) -> Vec<(u32, u32)> {
    page.split("base64,")
        .skip(1)
        .map(|rest| {
            let text = &rest[..rest.find('"').unwrap()];
            let bytes = base64::engine::general_purpose::STANDARD
                .decode(text)
                .unwrap();
            let mut reader = png::Decoder::new(std::io::Cursor::new(bytes))
                .read_info()
                .unwrap();
            let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
            let info = reader.next_frame(&mut pixels).unwrap();
            (info.width, info.height)
        })
        .collect()
}

fn rectangle(min: [f32; 2], max: [f32; 2], is_fixed: bool) -> Outline {
    Outline {
        points: vec![min, [max[0], min[1]], max, [min[0], max[1]]],
        is_fixed,
    }
}

/// Water up to `surface(x)` in a tank, `spacing` apart; speed as a function of place.
fn water(
    width: f32,
    spacing: f32,
    surface: impl Fn(f32) -> f32,
    speed: impl Fn(f32, f32) -> f32,
) -> Snapshot {
    let mut snapshot = Snapshot::default();
    for i in 0..(width / spacing) as usize {
        let x = (i as f32 + 0.5) * spacing;
        for k in 0..(surface(x) / spacing) as usize {
            let z = (k as f32 + 0.5) * spacing;
            snapshot.positions.push([x, 0.0, z]);
            snapshot.speeds.push(speed(x, z));
        }
    }
    snapshot
}

fn record(name: &str, unit: &str, n: usize, end: f64, value: impl Fn(f64) -> f64) -> Record {
    let time: Vec<f64> = (0..=n).map(|i| end * i as f64 / n as f64).collect();
    Record {
        name: name.into(),
        unit: unit.into(),
        value: time.iter().map(|&t| value(t)).collect(),
        time,
    }
}

/// A wave that runs along a tank and throws drops on a mound of blocks: 1.5 m to 1 m, three panels.
#[test]
fn a_breaking_wave() {
    let spacing = 0.02;
    let snapshots = [0.0, 1.25, 2.5].map(|time: f32| {
        let crest = 1.0 + 1.6 * time;
        let hump = move |x: f32| (-(x - crest).powi(2) / 0.15).exp();
        let mut snapshot = water(
            6.0,
            spacing,
            |x| 0.6 + 0.35 * hump(x),
            |x, z| time.min(1.0) * (0.1 + z) * 2.2 * hump(x),
        );
        for i in 0..(60.0 * time) as usize {
            let (a, b) = ((i * 37 % 101) as f32 / 101.0, (i * 53 % 97) as f32 / 97.0);
            snapshot
                .positions
                .push([crest + 0.8 * (a - 0.3), 0.0, 1.0 + 0.5 * b * a]);
            snapshot.speeds.push(2.0 + 4.0 * b);
        }
        snapshot.time = f64::from(time);
        snapshot
            .outlines
            .push(rectangle([-0.1, -0.1], [6.1, 0.0], true));
        for i in 0..24 {
            let (row, column) = (i / 8, i % 8);
            let x = 4.4 + 0.16 * column as f32 + 0.08 * row as f32 + 0.02 * time * (i % 3) as f32;
            let z = 0.17 * row as f32;
            let tilt = 0.02 * ((i * 7) % 5) as f32 * time;
            let points = vec![
                [x, z + tilt],
                [x + 0.15, z],
                [x + 0.15 - tilt, z + 0.15],
                [x + 0.03, z + 0.16],
            ];
            snapshot.outlines.push(Outline {
                points,
                is_fixed: false,
            });
        }
        snapshot
    });
    let wave = |t: f64, arrival: f64| {
        0.6 + 0.35 * (-(t - arrival).powi(2) / 0.06).exp() + 0.003 * (90.0 * t).sin()
    };
    let page = keep(
        "breaking_wave.svg",
        &Overview {
            title: "Breaking wave on a rock mound".into(),
            subtitle: "18 300 particles, spacing 0.020 m; 24 blocks, 2650 kg/m³; 2.5 s simulated in 3 min 12 s on 2 threads; \
                       peak run-up 1.43 m at 2.21 s; largest block displacement 0.09 m (block 17); energy drift 4.1e-3 of \
                       the initial total"
                .into(),
            particle_spacing: f64::from(spacing),
            snapshots: snapshots.into(),
            charts: Vec::new(),
            gauges: vec![
                record("g1, x = 1.5 m", "m", 5000, 2.5, |t| wave(t, 0.3)),
                record("g2, x = 3.0 m", "m", 5000, 2.5, |t| if (0.4..0.6).contains(&t) { f64::NAN } else { wave(t, 1.2) }),
                record("g3, x = 4.5 m, toe of the mound", "m", 5000, 2.5, |t| wave(t, 2.1)),
                record("p1", "Pa", 50_000, 2.5, |t| 9810.0 * wave(t, 2.1) + if (t - 2.2).abs() < 1e-4 { 9000.0 } else { 0.0 }),
            ],
            energy: vec![
                record("kinetic, water", "J", 2000, 2.5, |t| 1200.0 * (t / 2.5).min(1.0) * (1.0 - 0.3 * t / 2.5)),
                record("potential, water", "J", 2000, 2.5, |t| 10_900.0 - 700.0 * t / 2.5),
                record("kinetic, blocks", "J", 2000, 2.5, |t| 30.0 * t),
                record("dissipated", "J", 2000, 2.5, |t| 120.0 * t * t),
                record("total", "J", 2000, 2.5, |t| 10_900.0 + t),
            ],
            view: ([-0.1, -0.1], [6.1, 1.5]),
            plan: None,
        },
    );
    assert_eq!(pictures(&page).len(), 3);
    assert!(
        page.contains(">t = 1.250 s<")
            && page.contains(">energy [10³ J]<")
            && page.contains(">gauges [m]<")
    );
    assert!(!page.contains("exaggeration"));
}

/// A flume of 100 m by 1.2 m: exaggerated upwards, and the factor is stated.
#[test]
fn a_long_flume() {
    let snapshots = [0.0, 30.0, 60.0].map(|time: f32| {
        let wave = move |x: f32| 0.2 * (0.5 * (x - time)).sin();
        let mut snapshot = water(100.0, 0.05, |x| 0.6 + wave(x), |x, _| (5.0 * wave(x)).abs());
        snapshot.time = f64::from(time);
        snapshot.outlines.push(Outline {
            points: vec![[80.0, 0.0], [100.0, 0.0], [100.0, 1.0]],
            is_fixed: true,
        });
        snapshot
    });
    let page = keep(
        "long_flume.svg",
        &Overview {
            title: "Waves in a flume <a & b>".into(),
            subtitle: "first line\nsecond line \u{1} of key figures".into(),
            particle_spacing: 0.05,
            snapshots: snapshots.into(),
            charts: Vec::new(),
            gauges: (0..9)
                .map(|i| {
                    record(&format!("g{i}"), "m", 3000, 60.0, |t| {
                        0.02 * (t + f64::from(i)).sin()
                    })
                })
                .collect(),
            energy: vec![record("total", "J", 100, 60.0, |_| 0.0)],
            view: ([0.0, 0.0], [100.0, 1.2]),
            plan: None,
        },
    );
    assert!(page.contains("vertical exaggeration 10 ×"));
    assert!(page.contains("&lt;a &amp; b&gt;"));
}

/// A tall column, 0.6 m by 1 m, in three dimensions with 200 000 particles of random speed: the worst to compress.
#[test]
fn a_tall_column_of_noise() {
    let snapshots = [0.0, 0.5, 1.0].map(|time: f64| {
        let mut state = 1u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1u32 << 24) as f32
        };
        Snapshot {
            time,
            positions: (0..200_000)
                .map(|_| [0.6 * random(), 0.1 * random(), random()])
                .collect(),
            speeds: (0..200_000).map(|_| random()).collect(),
            outlines: vec![rectangle([0.2, 0.4], [0.35, 0.55], false)],
        }
    });
    let page = keep(
        "tall_column.svg",
        &Overview {
            title: "Column".into(),
            particle_spacing: 0.005,
            snapshots: snapshots.into(),
            view: ([0.0, 0.0], [0.6, 1.0]),
            ..Overview::default()
        },
    );
    assert_eq!(pictures(&page).len(), 3);
}

/// 1500 blocks with eight corners before noise in the water.
#[test]
fn many_blocks() {
    let snapshots = [0.0, 1.0, 2.0].map(|time: f64| {
        let mut snapshot = water(
            10.0,
            0.01,
            |_| 2.0,
            |x, z| (1e4 * (x * x + 3.0 * z)).sin().abs(),
        );
        snapshot.time = time;
        for i in 0..1500u16 {
            let [x, z] = [f32::from(i % 100) * 0.1, f32::from(i / 100) * 0.1];
            let points = (0..8u8).map(|k| {
                let (sin, cos) =
                    (f32::from(k) * std::f32::consts::FRAC_PI_4 + f32::from(i)).sin_cos();
                [x + 0.05 + 0.05 * cos, z + 0.05 + 0.05 * sin]
            });
            snapshot.outlines.push(Outline {
                points: points.collect(),
                is_fixed: false,
            });
        }
        snapshot
    });
    keep(
        "many_blocks.svg",
        &Overview {
            title: "Rubble".into(),
            particle_spacing: 0.01,
            snapshots: snapshots.into(),
            view: ([0.0, 0.0], [10.0, 3.0]),
            ..Overview::default()
        },
    );
}

#[test]
fn nothing_and_nonsense_are_drawn_without_complaint() {
    let page = keep("empty.svg", &Overview::default());
    assert!(page.starts_with("<svg ") && page.ends_with("</svg>\n"));
    let nonsense = Overview {
        title: "Nonsense".into(),
        particle_spacing: f64::NAN,
        snapshots: vec![
            Snapshot {
                time: 1.0,
                positions: vec![[f32::NAN; 3], [1.0; 3]],
                speeds: vec![f32::INFINITY],
                outlines: vec![
                    Outline::default(),
                    rectangle([f32::NAN; 2], [1e30; 2], false),
                ],
            },
            Snapshot::default(),
        ],
        charts: Vec::new(),
        gauges: vec![
            record("gap", "m", 10, 1.0, |_| f64::NAN),
            Record::default(),
            record("large", "m", 10, 1.0, |t| 1e290 * t),
            record("too large", "m", 10, 1.0, |t| f64::MAX * (t - 0.5).signum()),
        ],
        view: ([f64::NAN, 0.0], [1.0, f64::INFINITY]),
        ..Overview::default()
    };
    keep("nonsense.svg", &nonsense);
}
