//! Blocks and water: impacts, what leaves, squeezed water, light and heavy blocks, particles in odd places, threads.

use riprap_sph::Vec3;

use crate::row::{Failure, Length, Row, Trial, sweep};
use crate::tank::{G, Tank, advance, cuboid, max_speed, n_particles, on_threads, take, world};

pub const TRIALS: &[Trial] = &[
    Trial {
        id: "X07",
        subject: "impact of block on water",
        run: impact,
    },
    Trial {
        id: "X17",
        subject: "outside of the domain",
        run: outside,
    },
    Trial {
        id: "X18",
        subject: "water squeezed to nothing",
        run: squeezed,
    },
    Trial {
        id: "X19",
        subject: "light body and density ratio",
        run: density_ratio,
    },
    Trial {
        id: "X23",
        subject: "threads",
        run: threads,
    },
    Trial {
        id: "particle",
        subject: "particle on an edge, on a face, inside a block",
        run: odd_places,
    },
];

fn impact(_: Length) -> Result<Vec<Row>, Failure> {
    let mut figures = Vec::new();
    let margin = sweep(&[1.0, 10.0, 100.0, 300.0, 1000.0], 2, |speed| {
        let mut tank = Tank::new(1.0, 0.5, 0.025);
        tank.height = 2.0;
        tank.blocks = cuboid(
            "stone",
            &format!("material: \"m\", velocity: (0, 0, {:?})", -speed),
            [0.4, 0.52, 0.6, 0.72],
        );
        let mut world = tank.world().map_err(|e| e.to_string())?;
        let stone = world.blocks.n_blocks() - 1;
        let n = n_particles(&world);
        // until it would be at the bottom, slowed down or not
        advance(&mut world, 0.4 / speed, |_| {}).map_err(|e| e.to_string())?;
        let deep = world.extremes().max_wall_penetration_over_spacing;
        let residual = world.momentum_residual();
        let energy = world.energy();
        let brought = 0.5 * world.blocks.mass(stone) * speed * speed;
        let gone = n - n_particles(&world);
        figures.push(format!(
            "{speed:.0} m/s: penetration {deep:.2} dp, {} put back, {gone} left, P off by {residual:.0e}, unexplained {:.1e} of the energy, speed left {:.2}",
            world.extremes().particles_pushed_back,
            energy.residual.abs() / brought,
            world.blocks.velocity(stone).norm() / speed
        ));
        if deep > 1.0 || residual > 1e-6 {
            return Err(format!("penetration {deep:.2} dp, P off by {residual:.0e}"));
        }
        if energy.residual.abs() / brought > 0.05 {
            return Err(format!(
                "{:.0} % of the energy unexplained",
                100.0 * energy.residual.abs() / brought
            ));
        }
        Ok(())
    });
    let is_met = margin.last_good.is_some_and(|x| x >= 99.0);
    Ok(vec![Row {
        pushed: "speed of a block of 8 spacings that hits water flat".to_owned(),
        swept: "1 to 1000 m/s".to_owned(),
        holds: margin.holds("m/s"),
        past: margin.past(),
        theory: "sound of ten times the speed: Mach 0.1; no particle in the block, P kept"
            .to_owned(),
        measured: figures.join("; "),
        missed: (!is_met).then(|| margin.past.clone()),
        ..Row::default()
    }])
}

fn outside(_: Length) -> Result<Vec<Row>, Failure> {
    let scene = |leaving: &str| {
        let mut tank = Tank::new(1.0, 0.3, 0.05);
        tank.domain = format!("leaving: {leaving}");
        tank.height = 0.4;
        // half of it is beyond the right end of the domain, on the way out; water splashes over the left wall
        tank.blocks = cuboid(
            "stone",
            "material: \"m\", velocity: (2, 0, 0)",
            [1.1, 0.5, 1.3, 0.7],
        );
        tank.regions = Some(
            "(name: \"water\", shape: Box(min: (0, 0, 0), max: (1.0, 0.1, 0.3)), velocity: (-4, 0, 2))".to_owned(),
        );
        tank
    };
    let mut world = scene("Remove").world()?;
    let n = n_particles(&world);
    advance(&mut world, 0.5, |_| {})?;
    let gone = n - n_particles(&world);
    let removed = world.extremes().blocks_removed;
    let booked = world
        .water
        .as_ref()
        .map_or(0, |w| w.fluid.removed().count as usize);
    let residual = world.momentum_residual();
    let mut strict = scene("Fail").world()?;
    let said = advance(&mut strict, 0.5, |_| {})
        .err()
        .map_or("nothing".to_owned(), |e| e.to_string());
    let is_met =
        gone == booked && removed == 1 && residual < 1e-8 && said.contains("left the domain");
    Ok(vec![Row {
        pushed: "a block half outside of the domain on its way out, water thrown over its edge"
            .to_owned(),
        swept: "0.5 s; `Remove` and `Fail`".to_owned(),
        holds: "all of the range".to_owned(),
        past: format!("with Fail: \"{said}\""),
        theory: "what leaves is removed, counted and booked".to_owned(),
        measured: format!(
            "{gone} of {n} particles gone, {booked} booked, {removed} block, P off by {residual:.0e}"
        ),
        missed: (!is_met).then(|| "not counted as it left".to_owned()),
        ..Row::default()
    }])
}

fn squeezed(_: Length) -> Result<Vec<Row>, Failure> {
    let mut figures = Vec::new();
    let spacing = 0.02;
    let margin = sweep(&[4.0, 2.0, 1.0, 0.5, 0.1, 0.0, -0.5], 0, |gap| {
        // a plate comes down on the floor within 0.5 s, to a gap in spacings
        let start = 0.12;
        let way = start - gap * spacing;
        let mut tank = Tank::new(1.0, 0.3, spacing);
        tank.blocks = cuboid(
            "plate",
            &format!(
                "material: \"m\", motion: Sinusoid(direction: (0, 0, -1), amplitude: {:?}, period: 2.0)",
                way
            ),
            [0.35, start, 0.65, start + 0.06],
        );
        let mut world = tank.world().map_err(|e| e.to_string())?;
        let n = n_particles(&world);
        let mut pressure = 0.0_f64;
        let mut fastest = 0.0_f64;
        advance(&mut world, 0.55, |world| {
            if let Some(water) = &world.water {
                pressure = water
                    .fluid
                    .particles()
                    .pressure
                    .iter()
                    .copied()
                    .fold(pressure, f64::max);
            }
            fastest = fastest.max(max_speed(world));
        })
        .map_err(|e| e.to_string())?;
        figures.push(format!(
            "{gap} dp: p to {:.1} ρ g H, speed to {fastest:.1} m/s, {} put back, {} of {n} gone",
            pressure / (1000.0 * G * 0.3),
            world.extremes().particles_pushed_back,
            n - n_particles(&world)
        ));
        if !pressure.is_finite() || fastest > 20.0 {
            return Err(format!("speed {fastest:.1} m/s"));
        }
        Ok(())
    });
    let is_met = margin.last_good.is_some_and(|gap| gap <= 0.0);
    Ok(vec![Row {
        pushed: "gap between a plate that comes down and the floor under water".to_owned(),
        swept: "4 to 0 spacings, and half a spacing into the floor".to_owned(),
        holds: margin
            .last_good
            .map_or("nothing".to_owned(), |x| format!("{x} dp")),
        past: margin.past(),
        theory:
            "water squeezed at w v/(2 gap), at the last by what finds no place; pressure finite"
                .to_owned(),
        measured: figures.join("; "),
        missed: (!is_met).then(|| margin.past.clone()),
        ..Row::default()
    }])
}

/// A square that is let go half under water; what is wrong.
fn floats(ratio: f64, end: f64, figures: &mut Vec<String>) -> Result<(), String> {
    let side = 0.2;
    let mut tank = Tank::new(1.0, 0.5, 0.025);
    tank.materials = format!(
        "(name: \"light\", density: {:?}, friction_angle_deg: 20)",
        1000.0 * ratio
    );
    tank.height = 1.5;
    tank.blocks = cuboid("body", "material: \"light\"", [0.4, 0.4, 0.6, 0.6]);
    let mut world = tank.world().map_err(|e| e.to_string())?;
    let body = world.blocks.n_blocks() - 1;
    let mut fastest = 0.0_f64;
    let mut highest = 0.0_f64;
    advance(&mut world, end, |world| {
        fastest = fastest.max(world.blocks.velocity(body).norm());
        highest = highest.max(world.blocks.centroid(body).z);
    })
    .map_err(|e| e.to_string())?;
    let z = world.blocks.centroid(body).z;
    let energy = world.energy();
    // what it can give: its lift over half its side
    let scale = (1.0 + ratio) * 1000.0 * side * side * 0.1 * G * side;
    let unexplained = energy.residual.abs() / scale;
    let draught = 0.5 + ratio * side * side - ratio * side + 0.5 * side;
    let off = if ratio < 0.95 {
        (z - draught).abs() / side
    } else if ratio > 1.05 {
        (z - 0.5 * side).abs() / side
    } else {
        0.0
    };
    figures.push(format!("{ratio}: fastest {fastest:.2} m/s, at rest {off:.2} sides off, unexplained {unexplained:.2}"));
    // a body without mass is shot up by its lift to no more than what it displaces can give
    let most = 3.0 * (2.0 * G * side).sqrt();
    if fastest > most {
        return Err(format!("it moves at {fastest:.1} m/s"));
    }
    if end > 1.0 && off > 0.25 {
        return Err(format!("{off:.2} sides off its place of rest"));
    }
    Ok(())
}

fn density_ratio(length: Length) -> Result<Vec<Row>, Failure> {
    let end = length.choose(2.0, 5.0);
    let mut rows = Vec::new();
    for (what, ratios, asked) in [
        (
            "down",
            [1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 1e-3, 1e-4],
            0.05,
        ),
        (
            "up",
            [1.0, 2.0, 5.0, 10.0, 20.0, 100.0, 1e3, 1e4, 1e5],
            20.0,
        ),
    ] {
        let mut figures = Vec::new();
        let margin = sweep(&ratios, 0, |ratio| floats(ratio, end, &mut figures));
        let reached = |x: f64| {
            if asked < 1.0 {
                x <= asked * 1.01
            } else {
                x >= asked * 0.99
            }
        };
        let is_met = margin.last_good.is_some_and(reached);
        rows.push(Row {
            pushed: format!("density of a square of 8 spacings over that of water, {what}, let go half under water"),
            swept: format!("1 to {:?}, {end} s", ratios[8]),
            holds: margin.holds("of water's"),
            past: margin.past(),
            theory: "floats at its draught, or lies on the floor; a staggered scheme without added mass fails where the water that moves with it, about half of what it displaces, weighs more than the body: ratio 0.5".to_owned(),
            measured: figures.join("; "),
            missed: (!is_met).then(|| margin.past.clone()),
            ..Row::default()
        });
    }
    Ok(rows)
}

const WALLS: [&str; 3] = ["Penalty", "Particles", "Integral"];

fn threads(length: Length) -> Result<Vec<Row>, Failure> {
    let steps = length.choose(150, 1000);
    let mut hashes = Vec::new();
    let mut is_met = true;
    for walls in WALLS {
        let mut tank = Tank::new(1.0, 0.5, 0.0125);
        tank.materials = "(name: \"light\", density: 500, friction_angle_deg: 20)".to_owned();
        tank.blocks = cuboid(
            "body",
            "material: \"light\", velocity: (0, 0, -1)",
            [0.4, 0.52, 0.6, 0.7],
        ) + &cuboid("rock", "material: \"m\"", [0.1, 0.6, 0.2, 0.7]);
        tank.more = format!("interface: (walls: {walls}),");
        let text = tank.text();
        let mut found = Vec::new();
        for n in [1, 2, 8] {
            let hash = on_threads(n, || -> Result<String, Failure> {
                let mut world = world(&text)?;
                take(&mut world, steps, 1.0)?;
                Ok(world.state_hash())
            })??;
            found.push(hash);
        }
        is_met &= found.windows(2).all(|pair| pair[0] == pair[1]);
        hashes.push(format!("{walls}: {}", found.join(" ")));
    }
    // more blocks than one thread takes at a time
    let grains = "(title: \"grains\", domain: (min: (-3, -3, -1), max: (3, 3, 9)),\n\
         materials: [(name: \"glass\", density: 2500, friction_angle_deg: 20, restitution: 0.5)],\n\
         blocks: [(name: \"floor\", material: \"glass\", motion: Fixed, shape: Box(min: (-2, -2, -1), max: (2, 2, 0)))],\n\
         grains: [(name: \"bead\", material: \"glass\", diameter: (0.08, 0.1), count: 1500, velocity: (0, 0, -1),\n\
         region: Box(min: (-0.6, -0.6, 0), max: (0.6, 0.6, 4)))],\n\
         time: (duration: 1.0))";
    let mut found = Vec::new();
    for n in [1, 2, 8] {
        let hash = on_threads(n, || -> Result<String, Failure> {
            let mut world = world(grains)?;
            for _ in 0..2 * steps {
                let step = world.next_step(1.0)?;
                world.step(step)?;
            }
            Ok(world.state_hash())
        })??;
        found.push(hash);
    }
    is_met &= found.windows(2).all(|pair| pair[0] == pair[1]);
    hashes.push(format!("1500 balls: {}", found.join(" ")));
    Ok(vec![Row {
        pushed: "threads".to_owned(),
        swept: format!(
            "1, 2, 8; two blocks in 3,200 particles with each kind of wall, {steps} steps; 1500 balls, {} steps",
            2 * steps
        ),
        holds: "all of the range".to_owned(),
        past: "not reached".to_owned(),
        theory: "the same bits".to_owned(),
        measured: hashes.join("; "),
        missed: (!is_met).then(|| "hashes differ".to_owned()),
        ..Row::default()
    }])
}

fn odd_places(_: Length) -> Result<Vec<Row>, Failure> {
    let mut rows = Vec::new();
    // a fixed and a free block under water, from 0.4 to 0.6
    for (kind, rest) in [("fixed", "motion: Fixed"), ("free", "motion: Free")] {
        let mut figures = Vec::new();
        let mut why = Vec::new();
        for walls in WALLS {
            for (name, place) in [
                ("on a face", [0.4, 0.3]),
                ("on an edge", [0.4, 0.4]),
                ("0.01 dp inside", [0.40025, 0.3]),
                ("1 dp inside", [0.425, 0.3]),
                ("in the middle", [0.5, 0.3]),
                ("on a corner of the floor and the wall", [0.0, 0.0]),
            ] {
                let mut tank = Tank::new(1.0, 0.5, 0.025);
                tank.more = format!("interface: (walls: {walls}),");
                tank.blocks = cuboid(
                    "body",
                    &format!("material: \"m\", {rest}"),
                    [0.4, 0.2, 0.6, 0.4],
                );
                let mut world = tank.world()?;
                let n = n_particles(&world);
                let at = Vec3::new(place[0], 0.05, place[1]);
                if let Some(water) = &mut world.water {
                    let p = &water.fluid.particles().position;
                    let nearest = (0..p.len())
                        .min_by(|&a, &b| (p[a] - at).norm().total_cmp(&(p[b] - at).norm()))
                        .unwrap_or(0);
                    let mut to = at;
                    to.y = p[nearest].y;
                    water.fluid.relocate(nearest, to, Vec3::zeros());
                }
                let put_back = world.extremes().particles_pushed_back;
                let mut fastest = 0.0_f64;
                let outcome = (|| -> Result<(), Failure> {
                    for _ in 0..300 {
                        take(&mut world, 1, 1.0)?;
                        fastest = fastest.max(max_speed(&world));
                    }
                    Ok(())
                })();
                // a free one has sunk by then
                let inside = if kind == "free" {
                    0
                } else {
                    world.water.as_ref().map_or(0, |water| {
                        let p = &water.fluid.particles().position;
                        p.iter()
                            .filter(|x| 0.405 < x.x && x.x < 0.595 && 0.205 < x.z && x.z < 0.395)
                            .count()
                    })
                };
                let put_back = world.extremes().particles_pushed_back - put_back;
                if let Err(error) = outcome {
                    why.push(format!("{walls}, {name}: {error}"));
                }
                if inside > 0 || fastest > 5.0 || n != n_particles(&world) {
                    why.push(format!(
                        "{walls}, {name}: {inside} left inside, speed {fastest:.1} m/s"
                    ));
                }
                figures.push(format!(
                    "{walls}, {name}: {fastest:.2} m/s, {put_back} put back"
                ));
            }
        }
        rows.push(Row {
            pushed: format!("a particle put onto a face, an edge, a corner and into a {kind} block under 0.2 m of water"),
            swept: "3 kinds of walls, 300 steps".to_owned(),
            holds: if why.is_empty() { "all of the range".to_owned() } else { why.join("; ") },
            past: "not reached".to_owned(),
            theory: "put back at the surface, at rest; a spacing out of its place it may go off at some √(p/ρ) = 2 m/s".to_owned(),
            measured: figures.join("; "),
            missed: (!why.is_empty()).then(|| why.join("; ")),
            ..Row::default()
        });
    }
    Ok(rows)
}
