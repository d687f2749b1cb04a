//! Needles, slivers and spin.

use riprap_dda::{
    Blocks, Deformability, DeformableModel, Elastic, Material, Settings, StressLaw, Vec3,
};

use crate::rock::{Random, down, floor, free, placed, rock, system};
use crate::row::{Failure, Length, Row, Trial, decades, sweep};

pub const TRIALS: &[Trial] = &[
    Trial {
        id: "X04",
        subject: "needle and sliver",
        run: slender,
    },
    Trial {
        id: "X14",
        subject: "fast spin",
        run: fast_spin,
    },
    Trial {
        id: "spin",
        subject: "block at 10,000 rad/s",
        run: rad_10000,
    },
];

/// A body of given sides dropped askew from half its length with spin, and five of them across each other; what is wrong.
fn dropped(sides: [f64; 3], random: &mut Random, energy: &mut f64) -> Result<(), String> {
    let words = |e: Failure| e.to_string();
    let (longest, thinnest) = (
        sides.iter().copied().fold(0.0, f64::max),
        sides.iter().copied().fold(f64::INFINITY, f64::min),
    );
    let volume: f64 = sides.iter().product();
    let mass = 2500.0 * volume;
    // as a scene chooses it: an overlap of 2 % of the cube root of the volume, or a quarter of the thickness, at the speed of
    // the fall
    let speed = (2.0 * 9.81 * longest).sqrt();
    let stiffness = mass * (speed / (0.02 * volume.cbrt()).min(0.25 * thinnest)).powi(2);
    for is_stack in [false, true] {
        let material = Material {
            contact_stiffness: stiffness,
            restitution: 0.2,
            ..rock()
        };
        let mut definitions = vec![floor().map_err(words)?];
        let n = if is_stack { 5 } else { 1 };
        for k in 0..n {
            let shape = if is_stack {
                let turn = Vec3::z() * (f64::from(k) * 0.5 * std::f64::consts::FRAC_PI_2 * 1.1);
                let place =
                    Vec3::z() * (thinnest * (f64::from(k) + 0.5) + 1e-3 * thinnest * f64::from(k));
                placed(sides, place, turn)
            } else {
                placed(sides, Vec3::z() * longest, random.vector() * 0.5)
            };
            let mut stone = free(shape.map_err(words)?, [0.0; 3]);
            if !is_stack {
                stone.angular_velocity = random.vector() * (10.0 / longest);
            }
            definitions.push(stone);
        }
        let mut blocks = system(definitions, material, down()).map_err(words)?;
        let start = blocks.energies().balance();
        let brought = mass * 9.81 * longest;
        let (mut time, end) = (0.0, if is_stack { 0.3 } else { 1.0 } * longest.sqrt());
        let mut n_steps = 0_u64;
        while time < end {
            let dt = blocks.critical_time_step().dt.min(1e-3);
            blocks
                .advance(time, dt, 1)
                .map_err(|e| format!("{}: {e}", if is_stack { "stack" } else { "drop" }))?;
            time += dt;
            n_steps += 1;
            if n_steps > 1_500_000 {
                return Err(format!("the step falls to {dt:.0e} s: not run to its end"));
            }
            for b in 1..blocks.n_blocks() {
                let low = (blocks.parts_of(b).map(|p| blocks.part_aabb(p).0.z)).fold(0.0, f64::min);
                // a tip may go as deep as the limit of overlap, half the thickness
                if low < -0.6 * volume.cbrt() || blocks.centroid(b).z < -0.5 * thinnest {
                    return Err("it goes through the floor".to_owned());
                }
            }
        }
        let off = (blocks.energies().balance() - start).abs() / brought;
        *energy = energy.max(off);
        if off > 0.1 {
            return Err(format!(
                "{}: the energy is {:.0} % off",
                if is_stack { "stack" } else { "drop" },
                100.0 * off
            ));
        }
    }
    Ok(())
}

fn slender(length: Length) -> Result<Vec<Row>, Failure> {
    let mut rows = Vec::new();
    for (name, asked, sides) in [
        (
            "needle a:1:1",
            100.0,
            (|a: f64| [1.0, 1.0 / a, 1.0 / a]) as fn(f64) -> [f64; 3],
        ),
        ("sliver 1:1:1/a", 1000.0, |a: f64| [1.0, 1.0, 1.0 / a]),
    ] {
        let mut energy = 0.0_f64;
        let aspects = decades(10.0, length.choose(1e4, 1e6), 10.0_f64.sqrt());
        let margin = sweep(&aspects, 2, |a| {
            // drawn again for each, so that every aspect sees the same drops
            let mut random = Random::new(3);
            let mut off = 0.0;
            let n = 3;
            for _ in 0..n {
                dropped(sides(a), &mut random, &mut off)?;
            }
            if a <= asked * 1.01 {
                energy = energy.max(off);
            }
            Ok(())
        });
        let is_met = margin.last_good.is_some_and(|a| a >= 0.99 * asked);
        rows.push(Row {
            pushed: format!("slenderness: {name}, dropped askew with spin, five stacked"),
            swept: format!("a = 10 to {:.0e}", aspects.last().copied().unwrap_or(0.0)),
            holds: margin.holds(""),
            past: margin.past(),
            theory: "no missed contact: nothing below the floor; tips are light: ω² = K (1/m + r²/J) = 4 K/m, dt half of a cube's".to_owned(),
            measured: format!("energy off by {energy:.1e} of m g l up to a = {asked}"),
            missed: (!is_met).then(|| margin.past.clone()),
            ..Row::default()
        });
    }
    // a needle that deforms: the step of its fastest strain mode
    let mut figures = Vec::new();
    let mut is_met = true;
    for (name, sides) in [("needle", [1.0, 0.01, 0.01]), ("sliver", [1.0, 1.0, 1e-3])] {
        let mut share = Vec::new();
        for factor in [0.99, 1.01] {
            let blocks = stretched(sides, None, factor)?;
            share.push(blocks);
        }
        is_met &= share[0] < 10.0 && share[1] > 1e3;
        figures.push(format!(
            "{name}: strain grows by {:.1e} at 0.99 of the bound, {:.1e} at 1.01",
            share[0], share[1]
        ));
    }
    rows.push(Row {
        pushed: "step of a needle and a sliver with one strain (affine12)".to_owned(),
        swept: "0.99 and 1.01 of the bound, 5000 steps".to_owned(),
        holds: "to the bound".to_owned(),
        past: "the strain grows and the run stops with `compressed to a strain`".to_owned(),
        theory: "ω² = 12 (λ + 2μ…)/(ρ d²) of the thinnest side governs".to_owned(),
        measured: figures.join("; "),
        missed: (!is_met).then(|| "the bound is not the limit".to_owned()),
        ..Row::default()
    });
    Ok(rows)
}

/// Largest strain of a free elastic box over its first, after 5000 steps of a share of its bound.
fn stretched(sides: [f64; 3], spin: Option<Vec3>, share: f64) -> Result<f64, Failure> {
    let mut blocks = elastic_box(sides, spin)?;
    let push = nalgebra::Matrix3::from_fn(|i, j| if i == j { 1.0 } else { 0.3 });
    blocks.apply_stretch(0, push, 1e-9);
    let dt = blocks.critical_time_step().dt;
    let mut first = 0.0_f64;
    let mut largest = 0.0_f64;
    for k in 0..5000_u32 {
        if blocks.advance(f64::from(k) * dt, share * dt, 1).is_err() {
            return Ok(f64::INFINITY);
        }
        let size = blocks
            .strain(0)
            .map_or(0.0, |e| e.iter().map(|x| x * x).sum::<f64>().sqrt());
        if k < 20 {
            first = first.max(size);
        }
        largest = largest.max(size);
    }
    Ok(largest / first)
}

fn elastic_box(sides: [f64; 3], spin: Option<Vec3>) -> Result<Blocks, Failure> {
    let material = Material {
        elastic: Some(Elastic {
            young_modulus: 1e9,
            poisson_ratio: 0.25,
            viscosity: 0.0,
        }),
        ..rock()
    };
    let mut body = free(placed(sides, Vec3::zeros(), Vec3::zeros())?, [0.0; 3]);
    body.angular_velocity = spin.unwrap_or_else(Vec3::zeros);
    body.deformability = Some(Deformability {
        model: DeformableModel::Affine12(StressLaw::SaintVenantKirchhoff),
        ..Deformability::default()
    });
    let settings = Settings {
        gravity: Vec3::zeros(),
        time_step_factor: 1.0,
        ..Settings::default()
    };
    Ok(Blocks::new(vec![body], vec![material], settings)?)
}

fn fast_spin(_: Length) -> Result<Vec<Row>, Failure> {
    let mut volume = 0.0_f64;
    let mut worst = String::new();
    let margin = sweep(
        &[0.1, 0.5, 1.0, 2.0, 3.0, 6.0, 10.0, 100.0, 1000.0],
        0,
        |turn| {
            for (sides, tolerance) in [([1.0, 1.0, 1.0], 1e-9), ([1.0, 0.6, 0.3], 1e-9)] {
                let words = |e: Failure| e.to_string();
                let mut stone = free(
                    placed(sides, Vec3::zeros(), Vec3::zeros()).map_err(words)?,
                    [0.0; 3],
                );
                stone.angular_velocity = Vec3::new(0.3, 0.2, 1.0).normalize() * 10.0;
                let mut blocks = system(vec![stone], rock(), Vec3::zeros()).map_err(words)?;
                let (energy, angular) = (blocks.kinetic_energy(0), blocks.spin_momentum(0));
                let extent = |blocks: &Blocks| {
                    let points = blocks.part_points(0);
                    // edges of the box: their triple product is its volume
                    let (a, far) = (points[0], &points);
                    let mut sides: Vec<Vec3> = far.iter().map(|x| x - a).collect();
                    sides.sort_by(|x, y| x.norm().total_cmp(&y.norm()));
                    sides[1]
                        .dot(&sides[2].cross(&sides.get(3).copied().unwrap_or_else(Vec3::z)))
                        .abs()
                };
                let before = extent(&blocks);
                let dt = turn / 10.0;
                let mut most = 0.0_f64;
                for k in 0..2000_u32 {
                    blocks
                        .advance(f64::from(k) * dt, dt, 1)
                        .map_err(|e| e.to_string())?;
                    most = most.max((blocks.kinetic_energy(0) / energy - 1.0).abs());
                }
                if before > 1e-6 {
                    volume = volume.max((extent(&blocks) / before - 1.0).abs());
                }
                let l = (blocks.spin_momentum(0) - angular).norm() / angular.norm();
                worst = format!("energy {most:.1e}, L {l:.0e}");
                if volume > tolerance || l > 1e-10 {
                    return Err(format!("volume {volume:.1e}, L {l:.1e}"));
                }
                if most > 0.1 {
                    return Err(format!(
                        "sides {sides:?}: the energy is {:.0} % off, if a step this long is taken by hand",
                        100.0 * most
                    ));
                }
            }
            Ok(())
        },
    );
    let mut rows = vec![Row {
        pushed: "spin of a rigid cube and of a box 1 : 0.6 : 0.3 m, free, steps given by hand"
            .to_owned(),
        swept: "0.1 to 1000 rad a step, 2000 steps".to_owned(),
        holds: margin.holds("rad a step"),
        past: margin.past(),
        theory:
            "rotations are exact: volume and L kept at any step, energy of a box to second order"
                .to_owned(),
        measured: format!("volume to {volume:.0e} (asked 1e-9); at the last: {worst}"),
        missed: (!margin.last_good.is_some_and(|x| x >= 0.5)).then(|| margin.past.clone()),
        ..Row::default()
    }];
    // centrifugal stress of an elastic box that spins about z, faster and faster
    let mut off = 0.0_f64;
    let margin = sweep(&decades(1.0, 1e4, 10.0_f64.sqrt()), 6, |w| {
        let mut blocks = elastic_box([1.0; 3], Some(Vec3::z() * w)).map_err(|e| e.to_string())?;
        let dt = 0.5 * blocks.critical_time_step().dt;
        let n = 20_000_u32;
        let mut mean = 0.0;
        for k in 0..n {
            blocks
                .advance(f64::from(k) * dt, dt, 1)
                .map_err(|e| e.to_string())?;
            // the mean of the stresses along the two directions across the axis
            mean += blocks.stress(0).map_or(0.0, |s| 0.5 * (s[0] + s[1])) / f64::from(n);
        }
        let expected = 2500.0 * w * w / 12.0;
        let strain = expected / 1e9;
        let found = (mean / expected - 1.0).abs();
        if strain < 1e-3 && w > 9.0 {
            off = off.max(found);
        }
        if found > 0.05 + 5.0 * strain {
            return Err(format!(
                "the stress is {:.0} % off ρ ω² a²/12",
                100.0 * found
            ));
        }
        Ok(())
    });
    rows.push(Row {
        pushed: "spin of an elastic cube (affine12, E = 1 GPa)".to_owned(),
        swept: "1 to 1e4 rad/s".to_owned(),
        holds: margin.holds("rad/s"),
        past: margin.past(),
        theory: "mean stress across the axis ρ ω² a²/12 while strains are small; Saint Venant's law has no equilibrium beyond strains of the order 1: ω ~ √(12 E/ρ)/a = 2,200 rad/s".to_owned(),
        measured: format!("off by {off:.1e} where the strain is below 1e-3"),
        missed: (off > 0.01).then(|| "stress off by more than 1 %".to_owned()),
        ..Row::default()
    });
    Ok(rows)
}

fn rad_10000(_: Length) -> Result<Vec<Row>, Failure> {
    let mut rows = Vec::new();
    for (name, sides) in [
        ("cube", [0.5, 0.5, 0.5]),
        ("box 1 : 0.6 : 0.3 m", [1.0, 0.6, 0.3]),
    ] {
        for is_hit in [false, true] {
            let mut line = String::new();
            let margin = sweep(&decades(1.0, 1e6, 10.0), 3, |w| {
                spun(sides, w, is_hit, &mut line)
            });
            let is_met = margin.last_good.is_some_and(|x| x >= 0.99e4);
            rows.push(Row {
                pushed: format!(
                    "spin of a {name} {}, a scene's own steps",
                    if is_hit {
                        "that drops onto a floor"
                    } else {
                        "in free flight"
                    }
                ),
                swept: "1 to 1e6 rad/s".to_owned(),
                holds: margin.holds("rad/s"),
                past: margin.past(),
                theory: "free: E and L kept; on the floor none gained, nothing below it".to_owned(),
                measured: line,
                missed: (!is_met).then(|| margin.past.clone()),
                ..Row::default()
            });
        }
    }
    Ok(rows)
}

/// A scene of a spinning block, through the scene's own choice of stiffness and step.
fn spun(sides: [f64; 3], w: f64, is_hit: bool, line: &mut String) -> Result<(), String> {
    let half = sides.map(|x| 0.5 * x);
    let height = if is_hit { 1.0 } else { 0.0 };
    let floor = if is_hit {
        "(name: \"floor\", material: \"rock\", motion: Fixed, shape: Box(min: (-20, -20, -1), max: (20, 20, 0))),"
    } else {
        ""
    };
    let duration = if is_hit { 0.6 } else { 1.0 };
    let text = format!(
        "(title: \"spin\", gravity: (0, 0, {}), domain: (min: (-1e6, -1e6, -1e6), max: (1e6, 1e6, 1e6)),\n\
         materials: [(name: \"rock\", density: 2500, friction_angle_deg: 30)],\n\
         blocks: [{floor} (name: \"stone\", material: \"rock\", angular_velocity: ({:?}, {:?}, {:?}),\n\
         shape: Box(min: ({:?}, {:?}, {:?}), max: ({:?}, {:?}, {:?})))],\n\
         numerics: (expected_speed: {:?}), time: (duration: {duration}))",
        if is_hit { -9.81 } else { 0.0 },
        0.2 * w,
        0.3 * w,
        w,
        -half[0],
        -half[1],
        height - half[2],
        half[0],
        half[1],
        height + half[2],
        (w * half.iter().map(|x| x * x).sum::<f64>().sqrt()).max(5.0),
    );
    let mut world = crate::tank::world(&text).map_err(|e| e.to_string())?;
    let stone = world.blocks.n_blocks() - 1;
    let energy = world.blocks.energies();
    let (kinetic, angular) = (energy.kinetic, world.blocks.spin_momentum(stone));
    let mut most = 0.0_f64;
    let mut steps = 0_u64;
    while world.time() < duration {
        let step = world.next_step(duration).map_err(|e| e.to_string())?;
        world.step(step).map_err(|e| e.to_string())?;
        let now = world.blocks.energies().kinetic;
        most = most.max((now - kinetic) / kinetic);
        if !is_hit {
            most = most.max((now / kinetic - 1.0).abs());
        }
        steps += 1;
        if steps > 600_000 {
            return Err(format!("not run to its end: steps of {:.0e} s", step.dt));
        }
    }
    let gained = (world.blocks.energies().balance() - energy.balance()) / energy.balance().abs();
    *line = if is_hit {
        format!("at {w:.0e} rad/s: ledger off by {gained:.1e}, {steps} steps")
    } else {
        let l = (world.blocks.spin_momentum(stone) - angular).norm() / angular.norm();
        format!("at {w:.0e} rad/s: energy off by {most:.1e}, L by {l:.0e}, {steps} steps")
    };
    if is_hit && (gained.abs() > 0.05 || world.blocks.centroid(stone).z < 0.0) {
        return Err(format!(
            "the ledger is {:.1} % off, the stone at z = {:.1} m, silently",
            100.0 * gained,
            world.blocks.centroid(stone).z
        ));
    }
    if !is_hit && most > 0.01 {
        return Err(format!("the energy is {:.1} % off, silently", 100.0 * most));
    }
    Ok(())
}
