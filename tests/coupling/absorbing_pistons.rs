//! Pistons that absorb: what comes back to a wave maker leaves through it, and a flume between two of them has waves of one
//! direction.

use std::f64::consts::PI;
use std::path::Path;

use nalgebra::{Complex, Matrix2, Vector2};
use riprap::files::table::read_table;
use riprap::run::build;
use riprap::scene::access::Access;
use riprap::scene::load_text;

use crate::support::run;

/// Waves of kh = 1, two spacings high on ten spacings of water.
const HEIGHT: f64 = 0.2;
const PERIOD: f64 = 2.298_75;
const WAVE_NUMBER: f64 = 1.0;
/// Length of the flume, two and a quarter wave lengths: between two walls waves of this period pile up and cancel in turn.
const LENGTH: f64 = 14.1;
const GAUGES: u32 = 11;

fn flume(absorb: bool, end: &str) -> String {
    let gauges: String = (1..=GAUGES)
        .map(|k| {
            let x = LENGTH * f64::from(k) / f64::from(GAUGES + 1);
            format!("SurfaceElevation(name: \"g{k}\", x: {x}, y: 0.5),")
        })
        .collect();
    format!(
        "(title: \"flume\",
          domain: (min: (-1.5, 0, -0.5), max: (15.6, 1, 2.5), dimensions: Two),
          materials: [(name: \"rock\", density: 2600, friction_angle_deg: 35)],
          blocks: [
              (name: \"paddle\", material: \"rock\", shape: Box(min: (-0.5, -0.5, 0), max: (0, 1.5, 1.8)),
               motion: Waves(direction: (1, 0, 0), absorb: {absorb}, waves: Regular(height: {HEIGHT}, period: {PERIOD}))),
              (name: \"floor\", material: \"rock\", motion: Fixed, shape: Box(min: (-1.5, -0.5, -0.4), max: (15.6, 1.5, 0))),
              (name: \"end\", material: \"rock\", motion: {end}, shape: Box(min: ({LENGTH}, -0.5, 0), max: (14.6, 1.5, 1.8))),
          ],
          fluid: (resolution: Spacing(0.1), regions: [
              (name: \"flume\", shape: Box(min: (0, 0, 0), max: ({LENGTH}, 1, 1)))]),
          time: (duration: {}),
          gauges: [{gauges}],
          output: (frame_interval: 30, gauge_interval: 0.05))",
        12.0 * PERIOD
    )
}

const ABSORBS: &str = "Waves(direction: (-1, 0, 0), absorb: true, waves: Still(period: 2.29875))";

/// Heights of the waves that go away from the paddle and that come back, over periods of a record of gauges: amplitudes of the
/// period at each gauge, and the two waves of theory's length that fit them best.
fn waves(folder: &Path, (from, to): (f64, f64)) -> (f64, f64) {
    let table = read_table(&folder.join("gauges.csv")).unwrap();
    let rows: Vec<usize> = (0..table.values[0].len())
        .filter(|&row| {
            let t = table.values[0][row] / PERIOD;
            from <= t && t < to
        })
        .collect();
    let (mut normal, mut right) = (Matrix2::zeros(), Vector2::zeros());
    // the outermost gauges see the near fields of the pistons
    for k in 2..GAUGES {
        let x = LENGTH * f64::from(k) / f64::from(GAUGES + 1);
        let of = |row: &usize| {
            let phase = -2.0 * PI * table.values[0][*row] / PERIOD;
            Complex::from_polar(table.values[k as usize][*row], phase)
        };
        let sum: Complex<f64> = rows.iter().map(of).sum();
        let amplitude = sum * (2.0 / rows.len() as f64);
        let away = Complex::from_polar(1.0, -WAVE_NUMBER * x);
        let shape = Vector2::new(away, away.conj());
        normal += shape.conjugate() * shape.transpose();
        right += shape.conjugate() * amplitude;
    }
    let found = normal.try_inverse().unwrap() * right;
    (2.0 * found[0].norm(), 2.0 * found[1].norm())
}

fn ran(name: &str, scene: &str) -> std::path::PathBuf {
    let folder = std::env::temp_dir().join(format!("riprap_{name}_{}", std::process::id()));
    let case = folder.with_extension("ron");
    std::fs::write(&case, scene).unwrap();
    run(&case, &folder, &[]);
    std::fs::remove_file(&case).unwrap();
    folder
}

/// Between two pistons that absorb there is one wave, of the height asked for. Linear theory has 1 % reflected, ten rows of
/// particles 4 %; a height of two spacings loses 5 % on its way.
#[test]
fn a_flume_between_two_pistons_has_waves_of_one_direction() {
    let folder = ran("both_absorb", &flume(true, ABSORBS));
    let (away, back) = waves(&folder, (6.0, 12.0));
    println!(
        "height {away:.4} m, back {back:.4} m: {:.1} %",
        100.0 * back / away
    );
    assert!((away / HEIGHT - 1.0).abs() < 0.08, "{away}");
    assert!(back < 0.07 * away, "{back} of {away}");
    std::fs::remove_dir_all(folder).unwrap();
}

/// With a wall at the end the paddle goes on making its wave for as long as it absorbs, and the wave of a paddle that does not
/// meets its own: by theory its height falls by half here.
#[test]
fn a_paddle_that_absorbs_keeps_its_wave_before_a_wall() {
    let height = |absorb: bool| {
        let folder = ran(&format!("wall_{absorb}"), &flume(absorb, "Fixed"));
        let found = waves(&folder, (9.0, 12.0));
        std::fs::remove_dir_all(folder).unwrap();
        println!(
            "absorbs {absorb}: {:.4} m away, {:.4} m back",
            found.0, found.1
        );
        found.0 / HEIGHT
    };
    assert!((height(true) - 1.0).abs() < 0.1);
    assert!(height(false) < 0.7);
}

/// A run that absorbs goes on from its bytes to the same bits.
#[test]
fn a_piston_that_absorbs_goes_on_from_its_bytes() {
    let access = Access::of(Path::new("."));
    let text = flume(true, ABSORBS);
    let (scene, _) = load_text("flume.ron", &text, &[], &access).unwrap();
    let mut whole = build(&scene).unwrap();
    let advance = |world: &mut riprap::world::World| {
        for _ in 0..150 {
            let step = world.next_step(scene.duration).unwrap();
            world.step(step).unwrap();
        }
    };
    advance(&mut whole);
    let bytes = whole.save(Vec::new()).unwrap();
    let mut resumed = build(&scene).unwrap();
    assert!(resumed.read(&bytes).unwrap().is_empty());
    advance(&mut whole);
    advance(&mut resumed);
    assert_eq!(resumed.state_hash(), whole.state_hash());
    assert_eq!(resumed.energy(), whole.energy());
}

/// `check` says that a piston absorbs; one without waves that does not absorb is refused.
#[test]
fn pistons_say_whether_they_absorb() {
    let access = Access::of(Path::new("."));
    let (scene, _) = load_text("flume.ron", &flume(true, ABSORBS), &[], &access).unwrap();
    let told = |k: usize| scene.wave_makers[k].description(Some(0.1));
    assert!(told(0).ends_with("absorbs what comes back"), "{}", told(0));
    assert!(
        told(1).starts_with("no waves, absorbs those that come"),
        "{}",
        told(1)
    );
    let still = ABSORBS.replace("absorb: true, ", "");
    let refused = load_text("flume.ron", &flume(true, &still), &[], &access).unwrap_err();
    let words = format!("{refused:?}");
    assert!(
        words.contains("a piston without waves stands still"),
        "{words}"
    );
}
