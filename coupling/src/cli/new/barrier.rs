//! Grains that run down a chute against a barrier.

use super::digits::{rounded, significant, up_to};
use super::{Draft, GRAVITY, Target};

/// Friction of grains among each other and on the chute; degrees.
const FRICTION: f64 = 30.0;
const FRICTION_OF_CHUTE: f64 = 22.0;
/// Number of grains.
const GRAINS: f64 = 300.0;

/// Write the scene of grains that run down a chute against a barrier.
#[derive(Debug, clap::Args)]
pub(super) struct Options {
    #[command(flatten)]
    pub target: Target,
    /// Length of the chute from the gate to the barrier; m.
    #[arg(long, value_name = "M", default_value_t = 5.0)]
    length: f64,
    /// Inclination of the chute; degrees.
    #[arg(long, value_name = "DEG", default_value_t = 35.0)]
    angle: f64,
    /// Mean diameter of the grains; m.
    #[arg(long, value_name = "M", default_value_t = 0.1)]
    diameter: f64,
    /// Width of the chute; m. Ten diameters when left out.
    #[arg(long, value_name = "M")]
    width: Option<f64>,
    /// Height of the barrier; m. Eight diameters when left out.
    #[arg(long, value_name = "M")]
    height: Option<f64>,
}

pub(super) fn draft(options: &Options) -> Result<Draft, String> {
    let Options {
        length,
        angle,
        diameter,
        ..
    } = *options;
    let width = options
        .width
        .unwrap_or_else(|| significant(10.0 * diameter, 3));
    let height = options
        .height
        .unwrap_or_else(|| significant(8.0 * diameter, 3));
    for (name, value) in [
        ("--length", length),
        ("--diameter", diameter),
        ("--width", width),
        ("--height", height),
    ] {
        if !(0.0 < value && value.is_finite()) {
            return Err(format!("{name} must be above 0, got {value}"));
        }
    }
    if !(FRICTION_OF_CHUTE + 2.0..=75.0).contains(&angle) {
        return Err(format!(
            "--angle must be {} to 75 degrees: the grains have a friction of {FRICTION_OF_CHUTE} degrees on the chute; got {angle}",
            FRICTION_OF_CHUTE + 2.0
        ));
    }
    if length < 10.0 * diameter || width < 3.0 * diameter {
        return Err(format!(
            "--length must be at least 10 and --width 3 diameters of {diameter} m"
        ));
    }
    Ok(Draft {
        scene: scene(options, [width, height]),
        beside: Vec::new(),
        notes: Vec::new(),
    })
}

fn scene(options: &Options, [width, height]: [f64; 2]) -> String {
    let Options {
        length,
        angle,
        diameter,
        ..
    } = *options;
    let neat = |value: f64| significant(value, 3);
    let (sin, cos) = angle.to_radians().sin_cos();
    let [along, down] = [sin, cos].map(|share| rounded(GRAVITY * share, 4));
    let [least, most] = [0.8, 1.2].map(|share| neat(share * diameter));
    // sites of the lattice across, and as many rows along and up as the number needs
    let site = most * 1.04;
    let across = (width / site).floor();
    let rows = (GRAINS / across).sqrt().ceil();
    let [reach, pile] = [neat(rows * site * 1.02), neat(rows * site * 1.02)];
    let wall = neat(2.0 * diameter);
    let [behind, beyond] = [neat(reach + wall), rounded(length + wall, 4)];
    let side = neat(height.max(pile) + 2.0 * diameter);
    let acceleration = GRAVITY * (sin - FRICTION_OF_CHUTE.to_radians().tan() * cos);
    let time = (2.0 * (length + reach) / acceleration).sqrt();
    format!(
        r#"// Grains run down a chute against a barrier; written by `riprap new barrier`.
//
// x runs down the chute, z stands on it: gravity is tilted by {angle} degrees instead of the chute. Lengths in meters. Dry.
(
    title: "Grains against a barrier",
    // {angle} degrees: 9.81 m/s2 times sine along the chute, times cosine onto it
    gravity: ({along}, 0, -{down}),
    // grains that jump over the barrier leave the domain behind it
    domain: (min: (-{back}, -{wall}, -{wall}), max: ({far}, {far_side}, {sky})),
    materials: [
        // rolling friction stands for edges that spheres do not have; restitution of rock on rock
        (name: "grain", density: 2650, friction_angle_deg: {FRICTION}, restitution: 0.4, rolling_friction: 0.1),
        (name: "chute", density: 2650, friction_angle_deg: {FRICTION_OF_CHUTE}, restitution: 0.4),
    ],
    blocks: [
        (name: "bed", material: "chute", motion: Fixed, shape: Box(min: (-{behind}, -{wall}, -{wall}), max: ({beyond}, {side_end}, 0))),
        // walls end where the barrier begins: an edge inside of another fixed block would count as part of its surface
        (name: "right", material: "chute", motion: Fixed, shape: Box(min: (-{behind}, -{wall}, 0), max: ({length}, 0, {side}))),
        (name: "left", material: "chute", motion: Fixed, shape: Box(min: (-{behind}, {width}, 0), max: ({length}, {side_end}, {side}))),
        (name: "back", material: "chute", motion: Fixed, shape: Box(min: (-{behind}, 0, 0), max: (-{reach}, {width}, {side}))),
        // rigid; its load is the gauge below
        (name: "barrier", material: "chute", motion: Fixed, shape: Box(min: ({length}, -{wall}, 0), max: ({beyond}, {side_end}, {height}))),
    ],
    // as many as fit behind x = 0 on a lattice, about {GRAINS}; sizes differ by a fifth either way
    grains: [(name: "grain", material: "grain", region: Box(min: (-{reach}, 0, 0), max: (0, {width}, {pile})),
              diameter: ({least}, {most}), seed: 1)],
    // the last grains take {time:.1} s to the barrier, sliding from rest; then they settle for half as long
    time: (duration: {duration}),
    gauges: [BlockForce(name: "barrier", block: "barrier")],
)
"#,
        back = neat(behind + diameter),
        far = rounded(length + wall + 10.0 * diameter, 4),
        far_side = rounded(width + wall, 4),
        side_end = rounded(width + wall, 4),
        sky = neat(side + 10.0 * diameter),
        duration = significant(up_to(1.5 * time, 0.1), 3),
    )
}
