//! Scenes from text, their worlds, and the pieces of which tests put them together.

use std::path::Path;

use riprap::run::build;
use riprap::scene::error::{Problem, Severity};
use riprap::scene::parse;
use riprap::scene::resolve::Scene;
use riprap::world::World;

/// A scene that names no files.
pub fn resolved(text: &str) -> Result<Scene, Vec<Problem>> {
    resolved_in(Path::new("."), text)
}

/// A scene whose files are in a folder.
pub fn resolved_in(folder: &Path, text: &str) -> Result<Scene, Vec<Problem>> {
    Scene::resolve(parse::read(text).unwrap(), folder)
}

/// The world of a scene that names no files.
pub fn world(text: &str) -> World {
    build(&resolved(text).unwrap()).unwrap()
}

/// Errors of a scene, each with its place in front.
pub fn errors(text: &str) -> Vec<String> {
    let problems = resolved(text).err().unwrap_or_default();
    let errors = problems
        .into_iter()
        .filter(|p| p.severity == Severity::Error);
    errors
        .map(|p| format!("{}: {}", p.path, p.message))
        .collect()
}

/// Steps until a time (s), each at most a thousandth of `duration` (s), and looks after each.
pub fn advance(world: &mut World, until: f64, duration: f64, mut look: impl FnMut(&World)) {
    while world.time() < until {
        let step = world.next_step(duration).unwrap();
        world.step(step).unwrap();
        look(world);
    }
}

/// Numerics of the whole stable step in one of 200 draws: smoothing lengths that differ in their last digits draw from one chaos, once it
/// has had the time to grow.
pub fn whole_step(draw: u32) -> String {
    let more = 10_f64.powf(-8.0 + 4.0 * f64::from(draw) / 200.0);
    let ratio = 1.3 * (1.0 + more);
    format!("time_step_factor: 1.0, smoothing_length_ratio: {ratio:?}")
}

/// A point or a vector.
pub fn triple([x, y, z]: [f64; 3]) -> String {
    format!("({x:?}, {y:?}, {z:?})")
}

/// A block of the material `m`.
pub fn block(name: &str, shape: &str, rest: &str) -> String {
    format!("(name: \"{name}\", material: \"m\", shape: {shape}, {rest}),")
}

/// The shape of a box.
pub fn cuboid(min: [f64; 3], max: [f64; 3]) -> String {
    format!("Box(min: {}, max: {})", triple(min), triple(max))
}

/// Held in its place by forces.
pub const HELD: &str = "hold: (directions: [X, Y, Z], turning: Held)";

/// Fixed from the start.
pub const FIXED: &str = "motion: Fixed";

/// Water up to a level, connected to a seed.
pub fn below(level: f64, seed: [f64; 3]) -> String {
    format!(
        "(name: \"water\", shape: Below(level: {level:?}, seed: {}))",
        triple(seed)
    )
}

/// Five walls round a basin of this inner size, `thickness` thick; they adjoin and do not overlap.
pub fn basin([l, w, h]: [f64; 3], thickness: f64) -> Vec<String> {
    let t = thickness;
    [
        ("floor", [-t, -t, -t], [l + t, w + t, 0.0]),
        ("left", [-t, -t, 0.0], [0.0, w + t, h]),
        ("right", [l, -t, 0.0], [l + t, w + t, h]),
        ("front", [0.0, -t, 0.0], [l, 0.0, h]),
        ("back", [0.0, w, 0.0], [l, w + t, h]),
    ]
    .map(|(name, min, max)| block(name, &cuboid(min, max), FIXED))
    .to_vec()
}

/// A scene of blocks and one body of water.
pub struct Case {
    pub domain: [[f64; 3]; 2],
    pub gravity: f64,
    pub blocks: Vec<String>,
    pub spacing: f64,
    pub regions: String,
    pub walls: &'static str,
    /// Further fields of `domain`, `interface` and `numerics`.
    pub more: [String; 3],
}

impl Case {
    pub fn text(&self) -> String {
        let [domain, interface, numerics] = &self.more;
        format!(
            "(title: \"walls\", gravity: (0.0, 0.0, {:?}), domain: (min: {}, max: {}, {domain}),\n\
             materials: [(name: \"m\", density: 2000.0, friction_angle_deg: 30.0)],\n\
             blocks: [{}],\n\
             fluid: (dynamic_viscosity: 0.001, resolution: Spacing({:?}), regions: [{}]),\n\
             interface: (walls: {}, {interface}), numerics: ({numerics}), time: (duration: 10.0))",
            -self.gravity,
            triple(self.domain[0]),
            triple(self.domain[1]),
            self.blocks.join("\n"),
            self.spacing,
            self.regions,
            self.walls,
        )
    }

    pub fn errors(&self) -> Vec<String> {
        errors(&self.text())
    }

    pub fn world(&self) -> World {
        world(&self.text())
    }
}
