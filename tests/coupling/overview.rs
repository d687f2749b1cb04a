//! The page of a run, from made-up data; the pages stay in the target folder, to be looked at.

use base64::Engine;
use riprap::observe::maps::MapExtremes;
use riprap::overview::plan::{Footprint, FromAbove, Mark, Plan};
use riprap::overview::{Outline, Overview, Record, Snapshot, svg};
use riprap::scene::terrain::grid::Grid;
use std::path::Path;

/// Writes a page where the build keeps temporary files, after what every page must fulfill.
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
        ..Record::default()
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
            peaks: Vec::new(),
            along: String::new(),
            view: ([-0.1, -0.1], [6.1, 1.5]),
            plan: None,
        },
    );
    assert_eq!(pictures(&page).len(), 3);
    assert!(
        page.contains(">t = 1.250 s<")
            && page.contains(">change of energy [10³ J]<")
            && page.contains(">gauges [m]<")
    );
    assert!(!page.contains("exaggeration"));
}

/// A flume of 100 m by 1.2 m: exaggerated upward, and the factor is stated.
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
            peaks: Vec::new(),
            along: String::new(),
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
            peaks: Vec::new(),
            along: String::new(),
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
            peaks: Vec::new(),
            along: String::new(),
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
        peaks: Vec::new(),
        along: String::new(),
        view: ([f64::NAN, 0.0], [1.0, f64::INFINITY]),
        ..Overview::default()
    };
    keep("nonsense.svg", &nonsense);
}

/// Heights over 2 km by 1.6 km with the point (-1000, -800) in the corner.
fn over_the_plan(spacing: f64, height: impl Fn(f64, f64) -> f64) -> Grid {
    let mut grid = Grid {
        n: [2000.0, 1600.0].map(|length| (length / spacing) as usize),
        corner: [-1000.0 + 0.5 * spacing, -800.0 + 0.5 * spacing],
        spacing,
        heights: Vec::new(),
    };
    let heights = grid.points().map(|point| grid.place(point));
    grid.heights = heights.map(|[x, y]| height(x, y)).collect();
    grid
}

/// A lake between slopes, a wave from the middle of it, and `n` blocks on the western slope.
fn lake(n: u16, roughness: f64) -> Plan {
    let noise = |x: f64, y: f64| (12.9898 * x + 78.233 * y).sin() * 43_758.547 % 1.0;
    let ground = over_the_plan(5.0, |x, y| 0.5 * x.abs() - 200.0 + roughness * noise(x, y));
    let water = over_the_plan(20.0, |_, _| 0.0);
    let view = |time: f64| {
        let surface = water.points().map(|point| {
            let [x, y] = water.place(point);
            let wave = 4.0 * time * (x.hypot(y) / 60.0).cos() * (-x.hypot(y) / 300.0).exp();
            if x.abs() < 400.0 {
                wave as f32
            } else {
                f32::NAN
            }
        });
        let blocks = (0..n).map(|i| {
            let [x, y] = [
                f32::from(i % 70) * 6.0 - 800.0,
                f32::from(i / 70) * 9.0 - 300.0,
            ];
            Footprint {
                points: vec![[x, y], [x + 5.0, y + 1.0], [x + 5.0, y + 7.0], [x, y + 8.0]],
                is_under_water: x > -400.0,
            }
        });
        FromAbove {
            time,
            surface: surface.collect(),
            blocks: blocks.collect(),
        }
    };
    let wet = |value: &dyn Fn(f64, f64) -> f64| {
        over_the_plan(20.0, |x, y| {
            if x.abs() < 410.0 {
                value(x, y)
            } else {
                f64::NAN
            }
        })
    };
    Plan {
        view: ([-1000.0, -800.0], [1000.0, 800.0]),
        origin: [400_000.0, 6_900_000.0, 12.0],
        still_level: Some(0.0),
        views: vec![view(0.0), view(1.0)],
        maps: Some(MapExtremes {
            at_start: wet(&|_, _| 0.0),
            highest: wet(&|x, y| 5.0 * (-x.hypot(y) / 500.0).exp()),
            arrival: wet(&|x, y| x.hypot(y) / 40.0),
        }),
        marks: vec![
            Mark::Point {
                name: "mid <lake>".into(),
                at: [0.0, 0.0],
            },
            Mark::Line {
                name: "run_up".into(),
                from: [400.0, 100.0],
                to: [900.0, 100.0],
            },
        ],
        ground,
        water,
    }
}

#[test]
fn a_lake_from_above() {
    let page = keep(
        "lake.svg",
        &Overview {
            title: "Lake".into(),
            plan: Some(lake(300, 2.0)),
            ..Overview::default()
        },
    );
    // the land, once, and what lies over it at the start, at the end and on two maps
    assert_eq!(pictures(&page).len(), 5);
    assert_eq!(page.matches("<use xlink:href=\"#land\"").count(), 4);
    for text in [
        "t = 0.000 s: surface over still water",
        "t = 1.000 s: surface over still water",
        "highest surface over still water",
        "first arrival",
        "mid &lt;lake&gt;",
        "run_up",
        // heights and places are those of the map
        "shore at still water, 12 m",
        "heights every 50 m",
        "blocks under water",
        "400500",
        "6900000",
        "500 m",
    ] {
        assert!(page.contains(&format!(">{text}<")), "{text}");
    }
    // Of the first row, 500 m from the southern edge, the first block is 200 m from the western one, the first under water 602 m: what
    // is under water is drawn first.
    let starts: Vec<[f64; 2]> = page
        .lines()
        .filter(|line| line.starts_with("<path transform"))
        .take(2)
        .map(|path| {
            let start = path.split("d=\"M").nth(1).unwrap();
            let mut numbers = start.split([' ', 'l']).map(|n| n.parse().unwrap());
            [numbers.next().unwrap(), numbers.next().unwrap()]
        })
        .collect();
    let frame = page
        .lines()
        .find(|line| line.contains("<use xlink:href=\"#land\""))
        .unwrap();
    assert!(frame.contains("x=\"76.0\""));
    // 374 px for 2000 m, 299.2 px for 1600 m, to a tenth of a pixel
    for (start, from_the_west) in starts.iter().zip([602.0, 200.0]) {
        assert!((start[0] - from_the_west * 0.187).abs() < 0.06, "{start:?}");
        assert!((start[1] - 1100.0 * 0.187).abs() < 0.06, "{start:?}");
    }
}

/// Noise of 60 m from point to point and 7000 blocks, with many gauges: the worst to compress.
#[test]
fn rough_ground_and_many_blocks_from_above() {
    let page = keep(
        "rough_lake.svg",
        &Overview {
            title: "Rough".into(),
            plan: Some(lake(7000, 60.0)),
            gauges: (0..9)
                .map(|i| {
                    record(&format!("g{i}"), "m", 3000, 60.0, |t| {
                        (t + f64::from(i)).sin()
                    })
                })
                .collect(),
            ..Overview::default()
        },
    );
    assert_eq!(pictures(&page).len(), 5);
}

/// Ground without heights, water without places, blocks without corners.
#[test]
fn nothing_from_above_is_drawn_without_complaint() {
    let mut plan = lake(0, 0.0);
    plan.ground.heights.fill(f64::NAN);
    for map in plan.maps.iter_mut() {
        map.highest.heights.fill(f64::NAN);
        map.arrival.heights.fill(f64::NAN);
    }
    plan.views = vec![FromAbove {
        time: 0.0,
        surface: Vec::new(),
        blocks: vec![Footprint::default()],
    }];
    plan.still_level = None;
    keep(
        "nothing_from_above.svg",
        &Overview {
            plan: Some(plan),
            ..Overview::default()
        },
    );
}
