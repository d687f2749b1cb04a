//! Scenes with planes of symmetry against the same scenes in whole, and those that are refused.

use std::path::Path;

use crate::support::scene::{resolved, world};
use riprap::scene::error::Severity;
use riprap::scene::resolve::Scene;
use riprap::scene::{parse, validate};
use riprap::world::{StepError, World};
use riprap_sph::Vec3;

const DP: f64 = 0.02;

/// A tank 0.6 m long and 0.4 m wide, or the half of it beyond y = 0: a column of water falls round a pillar in the
/// middle and up a beach, and a paddle moves at its other end.
struct Tank {
    symmetry: &'static str,
    /// Lower ends along y of the water, of what stands, and of the paddle; m.
    from: [f64; 3],
}

const WHOLE: Tank = Tank {
    symmetry: "",
    from: [-0.2, -0.4, -0.2],
};

/// Fixed blocks extend past the plane, by a distance that is not a whole number of spacings.
const HALF: Tank = Tank {
    symmetry: "symmetry: [YMin]",
    from: [0.0, -0.173, -0.17],
};

impl Tank {
    fn text(&self, more: &str) -> String {
        let Self {
            symmetry,
            from: [water, wall, paddle],
        } = self;
        let domain = if symmetry.is_empty() { -0.3 } else { 0.0 };
        let front = if symmetry.is_empty() {
            "(name: \"front\", material: \"m\", motion: Fixed, shape: Box(min: (-0.3, -0.4, -0.2), max: (0.9, -0.2, 0.6))),"
        } else {
            ""
        };
        let pillar = if symmetry.is_empty() {
            -0.04
        } else {
            wall.max(-0.04)
        };
        format!(
            "(title: \"tank\",
            domain: (min: (-0.2, {domain:?}, -0.2), max: (0.8, 0.3, 0.5), {symmetry}),
            materials: [(name: \"m\", density: 2400, friction_angle_deg: 30)],
            blocks: [
                (name: \"floor\", material: \"m\", motion: Fixed, shape: Box(min: (-0.3, {wall:?}, -0.2), max: (0.9, 0.4, 0))),
                (name: \"left\", material: \"m\", motion: Fixed, shape: Box(min: (-0.3, {wall:?}, -0.2), max: (0, 0.4, 0.6))),
                (name: \"right\", material: \"m\", motion: Fixed, shape: Box(min: (0.6, {wall:?}, -0.2), max: (0.9, 0.4, 0.6))),
                (name: \"back\", material: \"m\", motion: Fixed, shape: Box(min: (-0.3, 0.2, -0.2), max: (0.9, 0.4, 0.6))),
                (name: \"pillar\", material: \"m\", motion: Fixed, shape: Box(min: (0.26, {pillar:?}, 0), max: (0.32, 0.04, 0.4))),
                (name: \"beach\", material: \"m\", motion: Fixed,
                 shape: Extrusion(polygon: [(0.4, 0), (0.6, 0), (0.6, 0.12)], axis: Y, from: {wall:?}, to: 0.4)),
                (name: \"paddle\", material: \"m\", shape: Box(min: (0, {paddle:?}, 0), max: (0.04, 0.2, 0.4)),
                 motion: Sinusoid(direction: (1, 0, 0), amplitude: 0.02, period: 0.4)),
                {front}
            ],
            fluid: (dynamic_viscosity: 0.001, resolution: Spacing({DP:?}), regions: [
                (name: \"column\", shape: Box(min: (0.04, {water:?}, 0), max: (0.24, 0.2, 0.2))),
            ]),
            numerics: (precision: Double), {more} time: (duration: 10.0))"
        )
    }

    fn world(&self) -> World {
        world(&self.text(""))
    }
}

/// Place and velocity of every particle before the plane, by id.
fn before_plane(world: &World) -> Vec<[Vec3; 2]> {
    let p = world.water.as_ref().unwrap().fluid.particles();
    let mut order: Vec<usize> = (0..p.len()).collect();
    order.sort_unstable_by_key(|&a| p.id[a]);
    order
        .into_iter()
        .map(|a| [p.position[a], p.velocity[a]])
        .collect()
}

/// Largest difference of place in spacings and of velocity in m/s.
fn difference<'a>(
    found: impl Iterator<Item = &'a [Vec3; 2]>,
    expected: impl Iterator<Item = &'a [Vec3; 2]>,
) -> [f64; 2] {
    found.zip(expected).fold([0.0; 2], |largest, (a, b)| {
        let off = [(a[0] - b[0]).norm() / DP, (a[1] - b[1]).norm()];
        [0, 1].map(|k| {
            if off[k] <= largest[k] {
                largest[k]
            } else {
                off[k]
            }
        })
    })
}

#[test]
fn half_a_tank_is_half_the_tank() {
    let (mut whole, mut half) = (WHOLE.world(), HALF.world());
    let ended = Tank {
        symmetry: "symmetry: [YMin]",
        from: [0.0; 3],
    };
    let mut ended = ended.world();
    for _ in 0..150 {
        let mut step = whole.next_step(1.0).unwrap();
        step.dt *= 0.9;
        for world in [&mut whole, &mut half, &mut ended] {
            world.step(step).unwrap();
        }
    }
    let [all, found, same] = [&whole, &half, &ended].map(before_plane);
    assert_eq!(all.len(), 2 * found.len(), "nothing left");
    // rows of the whole run from −0.2 to 0.2 m in y
    let right = all.chunks(200).flat_map(|layer| &layer[100..]);
    let [place, velocity] = difference(found.iter(), right);
    let [place_ended, _] = difference(same.iter(), found.iter());
    println!(
        "half a tank: place {place:.1e} spacings, velocity {velocity:.1e} m/s; with blocks that end at the plane \
         {place_ended:.1e} spacings off"
    );
    // round-off, grown by 150 steps
    assert!(place < 1e-8 && velocity < 1e-7);
    assert!(place_ended < 1e-8);
    let (m, e) = (half.momentum_residual(), half.energy());
    let of_whole = whole.energy();
    println!(
        "momentum {m:.1e}, of the whole {:.1e}; residual of energy {:.3e} J and {:.3e} J",
        whole.momentum_residual(),
        e.residual,
        of_whole.residual
    );
    // booked with every kick: round-off
    assert!(m < 1e-12, "{m}");
    for (part, all) in [
        (e.kinetic, of_whole.kinetic),
        (e.viscous, of_whole.viscous),
        (e.external_work, of_whole.external_work),
        (e.residual, of_whole.residual),
    ] {
        // half of each, to the round-off of the flow; the ledger sums viscosity in f32
        assert!(
            (2.0 * part - all).abs() < 1e-6 * of_whole.kinetic,
            "{part} {all}"
        );
    }
    for block in 0..7 {
        let [part, all] = [&half, &whole].map(|world| world.fluid_load(block).force);
        // the back wall is in both halves' way by itself
        let share = if block == 3 { 1.0 } else { 2.0 };
        let axis = if block == 3 { [1, 1] } else { [0, 2] };
        for axis in axis {
            let off = (share * part[axis] - all[axis]).abs();
            assert!(
                off < 1e-6 * all.norm().max(1.0),
                "{block} {axis}: {part} {all}"
            );
        }
    }
    // a gauge on the plane reads what one in the middle of the whole does
    let at = Vec3::new(0.15, 0.0, 0.03);
    let [a, b] =
        [&half, &whole].map(|world| world.water.as_ref().unwrap().fluid.sample(&at).unwrap());
    assert!((a.pressure - b.pressure).abs() < 1e-4, "{a:?} {b:?}");
    assert!(a.velocity.y.abs() < 1e-9 && (a.velocity - b.velocity).norm() < 1e-6);
}

/// Two dam breaks that run against each other, or one of them against a plane of symmetry; as a plane, or as a slab of five
/// spacings.
fn bores(is_half: bool, is_slab: bool) -> World {
    let dp = DP;
    let (width, kind) = match is_slab {
        true => (5.0 * DP, "periodic: [Y]"),
        false => (DP, "dimensions: Two"),
    };
    let (end, symmetry) = match is_half {
        true => (0.0, "symmetry: [XMax]"),
        false => (1.3, ""),
    };
    let (right, mirrored) = match is_half {
        true => (String::new(), ""),
        false => (
            String::from(
                "(name: \"right\", material: \"m\", motion: Fixed, shape: Box(min: (1, -1, -0.1), max: (1.3, 2, 0.9))),",
            ),
            "(name: \"other\", shape: Box(min: (0.6, 0, 0), max: (1, 0.5, 0.4))),",
        ),
    };
    let mirrored = mirrored.replace("0.5", &width.to_string());
    world(&format!(
        "(title: \"bores\",
        domain: (min: (-1.3, 0, -0.1), max: ({end:?}, {width:?}, 1.2), {kind}, {symmetry}),
        materials: [(name: \"m\", density: 2400, friction_angle_deg: 30)],
        blocks: [
            (name: \"floor\", material: \"m\", motion: Fixed, shape: Box(min: (-1.3, -1, -0.1), max: (1.3, 2, 0))),
            (name: \"left\", material: \"m\", motion: Fixed, shape: Box(min: (-1.3, -1, -0.1), max: (-1, 2, 0.9))),
            {right}
        ],
        fluid: (resolution: Spacing({dp:?}), regions: [
            (name: \"column\", shape: Box(min: (-1, 0, 0), max: (-0.6, {width:?}, 0.4))), {mirrored}
        ]),
        time: (duration: 2.0))"
    ))
}

/// Flow that converges on a plane of symmetry goes on, and is half of the whole flow: energies, in shares of that of the start, and
/// momentum, in shares of its largest, until the jet that the bores throw up breaks. After it the two halves of the whole differ from
/// each other, too.
#[test]
fn bores_that_meet_on_a_plane_are_half_of_two() {
    for is_slab in [false, true] {
        let [mut whole, mut half] = [false, true].map(|is_half| bores(is_half, is_slab));
        let stored = half.energy().potential;
        let (mut momenta, mut off) = (Vec::new(), [0.0_f64; 2]);
        for k in 1..=12 {
            let time = 0.08 * f64::from(k);
            let [a, b] = [&mut whole, &mut half].map(|world| {
                while world.time() < time {
                    let step = world.next_step(time).unwrap();
                    world.step(step).unwrap();
                }
                let p = world.water.as_ref().unwrap().fluid.particles();
                let left = (0..p.len()).filter(|&i| p.position[i].x < 0.0);
                let momentum: f64 = left.map(|i| p.mass[i] * p.velocity[i].x).sum();
                (world.energy(), momentum)
            });
            off[0] = off[0].max((0.5 * a.0.kinetic - b.0.kinetic).abs() / stored);
            off[0] = off[0].max((0.5 * a.0.potential - b.0.potential).abs() / stored);
            momenta.push((a.1, b.1));
        }
        let largest = momenta.iter().fold(0.0_f64, |m, (a, _)| m.max(a.abs()));
        off[1] = momenta
            .iter()
            .fold(0.0, |m, (a, b)| m.max((a - b).abs() / largest));
        println!(
            "slab {is_slab}: energies {:.2e}, momentum {:.2e}",
            off[0], off[1]
        );
        assert!(off.iter().all(|&off| off < 0.02), "{off:?}");
    }
}

/// Water poured into half a basin.
#[test]
fn a_plane_of_symmetry_closes_a_basin() {
    let poured = |text: String| {
        let column = "Box(min: (0.04, 0.0, 0), max: (0.24, 0.2, 0.2))";
        assert!(text.contains(column));
        text.replace(column, "Below(level: 0.1, seed: (0.2, 0.1, 0.05))")
    };
    let scene = resolved(&poured(HALF.text(""))).unwrap();
    let water = scene.fluid.unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    // the first row stands half a spacing from the plane
    let nearest = water.lattice.positions.iter().map(|x| x.y);
    assert!((nearest.fold(f64::INFINITY, f64::min) - 0.5 * DP).abs() < 1e-12);
    // an upper side takes a spacing that ends there
    let text = poured(HALF.text("")).replace("symmetry: [YMin]", "symmetry: [YMin, YMax]");
    let text = text.replace("max: (0.8, 0.3, 0.5)", "max: (0.8, 0.105, 0.5)");
    let water = resolved(&text).unwrap().fluid.unwrap();
    assert!((water.lattice.spacing[1] - 0.021).abs() < 1e-12);
}

#[test]
fn scenes_with_planes_where_none_can_be_are_refused() {
    let errors = |text: &str| -> Vec<String> {
        let file = parse::read(text).unwrap();
        let mut found = validate::values(&file);
        if found.iter().all(|p| p.severity != Severity::Error) {
            found.extend(
                Scene::resolve(file, Path::new("."))
                    .err()
                    .unwrap_or_default(),
            );
        }
        found
            .into_iter()
            .filter(|p| p.severity == Severity::Error)
            .map(|p| format!("{}: {}", p.path, p.message))
            .collect()
    };
    let text = HALF.text("");
    assert!(errors(&text).is_empty(), "{:?}", errors(&text));
    let with = |domain: &str| text.replace("symmetry: [YMin]", domain);
    let paddle = |motion: &str| {
        let before = "Sinusoid(direction: (1, 0, 0), amplitude: 0.02, period: 0.4)";
        assert!(text.contains(before));
        text.replace(before, motion)
    };
    for (scene, place, said) in [
        (
            with("symmetry: [YMin, YMin]"),
            "domain.symmetry[1]",
            "YMin is listed twice",
        ),
        (
            with("symmetry: [YMin], periodic: [Y]"),
            "domain.symmetry[0]",
            "periodic along Y",
        ),
        (
            with("symmetry: [ZMin]"),
            "domain.symmetry[0]",
            "gravity acts across it",
        ),
        (
            with("symmetry: [YMin], dimensions: Two"),
            "domain.symmetry[0]",
            "nothing depends on y",
        ),
        (
            HALF.text("interface: (walls: Integral),"),
            "interface.walls",
            "mirrored in a plane of symmetry; use Particles",
        ),
        (
            paddle("Sinusoid(direction: (1, 1, 0), amplitude: 0.02, period: 0.4)"),
            "blocks[6].motion",
            "moves across it; let it move along the plane (YMin)",
        ),
        (
            paddle("Free"),
            "blocks[6].motion",
            "would meet its own mirror image; make it Fixed",
        ),
    ] {
        let found = errors(&scene);
        assert!(
            found
                .iter()
                .any(|e| e.starts_with(place) && e.contains(said)),
            "{said}: {found:?}"
        );
    }
    let dry = "(title: \"dry\", domain: (min: (0, 0, 0), max: (1, 1, 1), symmetry: [XMin]),
        materials: [(name: \"m\", density: 2400, friction_angle_deg: 30)],
        blocks: [(name: \"b\", material: \"m\", shape: Box(min: (0.4, 0.4, 0.4), max: (0.5, 0.5, 0.5)))],
        time: (duration: 1.0))";
    assert!(errors(dry)[0].contains("add `fluid`"), "{:?}", errors(dry));
}

#[test]
fn a_free_block_that_comes_to_a_plane_stops_the_run() {
    let block = "(name: \"stone\", material: \"m\", velocity: (0, -2, 0),
        shape: Box(min: (0.4, 0.1, 0.3), max: (0.45, 0.15, 0.35))),
        (name: \"paddle\"";
    let text = HALF.text("").replace("(name: \"paddle\"", block);
    let mut world = world(&text);
    let error = loop {
        let step = world.next_step(1.0).unwrap();
        if let Err(error) = world.step(step) {
            break error;
        }
        assert!(world.time() < 0.1, "it flies 0.1 m at 2 m/s");
    };
    assert!(
        matches!(
            error,
            StepError::AtPlane {
                block,
                axis: 1,
                ..
            } if block.index() == 6
        ),
        "{error}"
    );
}
