//! Ratios of mass and size, and speed.

use riprap_dda::{Blocks, Material, Random, Settings, Vec3};

use crate::rock::{
    G, angular_momentum, body, cuboid, down, floor, free, on_slope, placed, rock, run, system,
};
use crate::row::{Failure, Length, Row, Trial, decades, sweep};

pub const TRIALS: &[Trial] = &[
    Trial {
        id: "X03",
        subject: "mass ratio",
        run: mass_ratio,
    },
    Trial {
        id: "X07",
        subject: "impact of block on block",
        run: impact,
    },
    Trial {
        id: "size",
        subject: "size ratio",
        run: size_ratio,
    },
    Trial {
        id: "slope",
        subject: "1000 blocks at 100 m/s onto a slope",
        run: onto_slope,
    },
];

/// Two cubes of different density on top of each other, let go in their places of rest: where they come to rest over the
/// places of statics, relative to the overlap of the heavy one, and the steps that took.
fn stacked(ratio: f64, is_heavy_above: bool) -> Result<(f64, u64), String> {
    let words = |e: Failure| e.to_string();
    let stiffness = 1e3 * 2500.0 * G * ratio;
    let of = |density: f64| Material {
        density,
        contact_stiffness: stiffness,
        restitution: 0.2,
        ..rock()
    };
    let mut lower = free(cuboid([0.0; 3], [1.0; 3]).map_err(words)?, [0.0; 3]);
    let mut upper = free(
        cuboid([0.0, 0.0, 1.0], [1.0, 1.0, 2.0]).map_err(words)?,
        [0.0; 3],
    );
    if is_heavy_above {
        upper.material = 1;
    } else {
        lower.material = 1;
    }
    let settings = Settings {
        gravity: down(),
        ..Settings::default()
    };
    let materials = vec![of(2500.0), of(2500.0 * ratio)];
    let definitions = vec![floor().map_err(words)?, lower, upper];
    let mut blocks = Blocks::new(definitions, materials, settings).map_err(|e| e.to_string())?;
    // periods of the heavy one on its spring
    let springs = if is_heavy_above { 2.0 } else { 1.0 };
    let period = std::f64::consts::TAU * (springs * 2500.0 * ratio / stiffness).sqrt();
    let mut n = run(&mut blocks, 4.0 * period, 1.0, 1e-2).map_err(|e| e.to_string())?;
    // where a light block carries a heavy one the dashpots are those of the light one, and it swings on: means over
    // whole periods
    let (mut time, mut lower, mut upper) = (0.0, 0.0, 0.0);
    while time < 8.0 * period {
        let dt = blocks
            .critical_time_step()
            .dt
            .min(1e-2)
            .min(8.0 * period - time + 1e-12 * period);
        blocks.advance(time, dt, 1).map_err(|e| e.to_string())?;
        time += dt;
        n += 1;
        lower += blocks.centroid(1).z * dt;
        upper += blocks.centroid(2).z * dt;
    }
    let (lower, upper) = (lower / time, upper / time);
    let weight = |b: usize| blocks.mass(b) * G;
    let below = (weight(1) + weight(2)) / stiffness;
    let between = weight(2) / stiffness;
    let off = (0.5 - below - lower)
        .abs()
        .max((1.5 - below - between - upper).abs());
    Ok((off / below, n))
}

fn mass_ratio(length: Length) -> Result<Vec<Row>, Failure> {
    let last = length.choose(1e7, 1e10);
    let mut rows = Vec::new();
    for (what, is_heavy_above) in [("light on heavy", false), ("heavy on light", true)] {
        let mut worst = 0.0_f64;
        let mut cost = Vec::new();
        let margin = sweep(&decades(1.0, last, 10.0), 2, |ratio| {
            let (off, n) = stacked(ratio, is_heavy_above)?;
            if ratio <= 1.001e6 {
                worst = worst.max(off);
            }
            cost.push(format!("{n}"));
            if off > 0.01 {
                return Err(format!("at rest {:.1} % off m g/K", 100.0 * off));
            }
            Ok(())
        });
        let is_met = worst < 0.01 && margin.last_good.is_some_and(|x| x >= 0.99e6);
        rows.push(Row {
            pushed: format!("mass ratio of two 1 m cubes on a floor, {what}"),
            swept: format!("1 to {last:.0e}"),
            holds: margin.holds(""),
            past: margin.past(),
            theory: "overlaps Σ m g/K; steps grow as √ratio".to_owned(),
            measured: format!(
                "to 1e6 at rest within {worst:.1e} of m g/K (asked 1e-2); steps by decade {}",
                cost.join(", ")
            ),
            missed: (!is_met).then(|| "statics off below a ratio of 1e6".to_owned()),
            ..Row::default()
        });
    }
    Ok(rows)
}

fn size_ratio(length: Length) -> Result<Vec<Row>, Failure> {
    let words = |e: Failure| e.to_string();
    let mut worst = 0.0_f64;
    let margin = sweep(&decades(10.0, length.choose(1e3, 1e4), 10.0), 1, |ratio| {
        // a small cube slides and tumbles across a large one, and comes to rest on it
        let side = 1.0 / ratio;
        let material = Material {
            restitution: 0.3,
            contact_stiffness: 1e3 * 2500.0 * G,
            ..rock()
        };
        let large = free(cuboid([0.0; 3], [1.0; 3]).map_err(words)?, [0.0; 3]);
        let turn = Vec3::new(0.3, 0.2, 0.1);
        let place = Vec3::new(0.5, 0.5, 1.0 + 2.0 * side);
        let small = free(
            placed([side; 3], place, turn).map_err(words)?,
            [0.5 * (G * side).sqrt(), 0.0, 0.0],
        );
        let mut blocks = system(
            vec![floor().map_err(words)?, large, small],
            material,
            down(),
        )
        .map_err(words)?;
        run(&mut blocks, 20.0 * (side / G).sqrt(), 1.0, 1e-3).map_err(|e| e.to_string())?;
        let height = (blocks.centroid(2).z - blocks.centroid(1).z - 0.5) / side;
        let speed = blocks.velocity(2).norm() / (G * side).sqrt();
        worst = worst.max((height - 0.5).abs());
        if (height - 0.5).abs() > 0.01 || speed > 0.05 {
            return Err(format!(
                "it stands {height:.3} sides high and moves at {speed:.2} √(g side)"
            ));
        }
        Ok(())
    });
    let is_met = margin.last_good.is_some_and(|x| x >= 999.0);
    Ok(vec![Row {
        pushed: "size ratio: a cube dropped askew onto a free 1 m cube on a floor, one stiffness for all".to_owned(),
        swept: format!("1:10 to 1:{:.0e}, the mass ratio its cube", length.choose(1e3, 1e4)),
        holds: margin.holds(""),
        past: margin.past(),
        theory: "rests half a side above".to_owned(),
        measured: format!("height off by {worst:.1e} sides"),
        missed: (!is_met).then(|| "fails before 1:1000".to_owned()),
        ..Row::default()
    }])
}

fn impact(_: Length) -> Result<Vec<Row>, Failure> {
    let words = |e: Failure| e.to_string();
    let mut rows = Vec::new();
    // the stiffness that a scene would choose: an overlap of 2 % at that speed
    for (what, sides, stiffness_at) in [
        (
            "1 m cubes, stiffness of a scene that knows the speed",
            [1.0, 1.0, 1.0],
            None,
        ),
        (
            "1 m cubes, stiffness for 10 m/s",
            [1.0, 1.0, 1.0],
            Some(10.0),
        ),
        (
            "plates 1 m by 1 mm, stiffness of a scene that knows the speed",
            [1.0, 1.0, 1e-3],
            None,
        ),
    ] {
        let volume: f64 = sides.iter().product();
        let size = volume.cbrt();
        let (mut momentum, mut slowest, mut fewest) = (0.0_f64, f64::INFINITY, u64::MAX);
        let mut passed = false;
        let margin = sweep(&decades(1.0, 1e7, 10.0), 8, |speed| {
            let known: f64 = stiffness_at.unwrap_or(speed);
            let material = Material {
                restitution: 0.5,
                contact_stiffness: 2500.0
                    * volume
                    * (known / (0.02 * size).min(0.25 * sides[2])).powi(2),
                ..rock()
            };
            let turn = Vec3::new(0.02, 0.01, 0.3);
            let at =
                |z: f64, turn: Vec3| placed(sides, Vec3::new(0.0, 0.0, z), turn).map_err(words);
            let upper = free(at(3.0, turn)?, [0.0, 0.0, -speed]);
            let lower = free(at(0.0, -turn)?, [0.0; 3]);
            let mut blocks = system(vec![lower, upper], material, Vec3::zeros()).map_err(words)?;
            let (p, l) = (blocks.momentum(), angular_momentum(&blocks));
            let n = run(&mut blocks, 6.0 / speed, 1.0, 0.1 / speed).map_err(|e| e.to_string())?;
            fewest = fewest.min(n);
            let error = (blocks.momentum() - p).norm() / p.norm();
            let turned = (angular_momentum(&blocks) - l).norm() / p.norm();
            momentum = momentum.max(error).max(turned);
            let apart = blocks.centroid(1).z - blocks.centroid(0).z;
            slowest = slowest.min((blocks.velocity(1).z - blocks.velocity(0).z) / speed);
            if apart < 0.0 {
                passed = true;
                return Err("they pass through each other".to_owned());
            }
            Ok(())
        });
        let is_met = !passed
            && momentum < 1e-11
            && (stiffness_at.is_some() || margin.last_good.is_some_and(|x| x >= 99.0));
        rows.push(Row {
            pushed: format!("speed of a block that hits a free block, {what}"),
            swept: "1 to 1e7 m/s".to_owned(),
            holds: margin.holds("m/s"),
            past: margin.past(),
            theory: "no step goes farther than half the margin of the search (2.5 % of the size, 12 % of the thickness); overlap v √(m/K)".to_owned(),
            measured: format!("P and L to {momentum:.0e} (asked 1e-12 rel), they part at {slowest:.2} v at least, {fewest} steps at least"),
            missed: (!is_met).then(|| "tunnelling, momentum or less than 100 m/s".to_owned()),
            ..Row::default()
        });
    }
    Ok(rows)
}

fn onto_slope(length: Length) -> Result<Vec<Row>, Failure> {
    let mut rows = Vec::new();
    let n = 1000;
    let words = |e: Failure| e.to_string();
    let mut line = String::new();
    let speeds: &[f64] = length.choose(&[100.0], &[10.0, 100.0, 1000.0]);
    let margin = sweep(speeds, 0, |speed| {
        let material = Material {
            restitution: 0.3,
            contact_stiffness: 2500.0 * 0.125 * (speed / (0.02 * 0.5)).powi(2),
            ..rock()
        };
        let dip = 40.0_f64.to_radians();
        let slab = cuboid([-200.0, -50.0, -5.0], [200.0, 50.0, 0.0]).map_err(words)?;
        let mut definitions = vec![body(slab, riprap_dda::Motion::Fixed)];
        let mut random = Random::new(7);
        // straight down in the slope's own frame
        let fall = on_slope(dip) * (speed / G);
        for k in 0..n {
            let place = Vec3::new(
                f64::from(k % 10) * 1.2 - 50.0,
                f64::from(k / 10 % 10) * 1.2 - 6.0,
                f64::from(k / 100) * 1.2 + 2.0,
            );
            let turn = Vec3::new(random.uniform(), random.uniform(), random.uniform()) * 3.0;
            let shape = placed([0.5; 3], place, turn).map_err(words)?;
            definitions.push(free(shape, fall.into()));
        }
        let mut blocks = system(definitions, material, on_slope(dip)).map_err(words)?;
        let before = blocks.energies();
        let kinetic = before.kinetic;
        let p = blocks.momentum();
        let end = 30.0 / speed;
        let steps = run(&mut blocks, end, 1.0, 1e-3).map_err(|e| e.to_string())?;
        let off = (blocks.energies().balance() - before.balance()).abs() / kinetic;
        let momentum = (blocks.momentum() - p - blocks.support_impulse()).norm() / p.norm();
        let below = (1..=n as usize)
            .filter(|&b| blocks.centroid(b).z < 0.0)
            .count();
        line = format!(
            "{speed} m/s: energy off by {:.1e} of the kinetic energy, momentum by {momentum:.0e}, {below} below the slope, deepest overlap {:.1} % of L, {steps} steps",
            off,
            100.0 * blocks.max_overlap_over_size()
        );
        if below > 0 {
            return Err(format!("{below} went through"));
        }
        if off > 0.05 {
            return Err(format!("energy off by {:.0} %", 100.0 * off));
        }
        Ok(())
    });
    rows.push(Row {
        pushed: format!(
            "{n} cubes of 0.5 m at 100 m/s onto a slope of 40 degrees, through each other"
        ),
        swept: format!("{speeds:?} m/s"),
        holds: margin.holds("m/s"),
        past: margin.past(),
        theory: "none below the slope, E and P booked".to_owned(),
        measured: line,
        missed: margin.first_bad.map(|_| margin.past.clone()),
        ..Row::default()
    });
    Ok(rows)
}
