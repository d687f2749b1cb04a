//! Columns, rest, long runs, subnormal numbers.

use riprap_dda::{
    Blocks, Deformability, DeformableModel, Elastic, Material, Motion, Settings, StaticDamping,
    StressLaw, Vec3,
};

use crate::rock::{G, body, cuboid, down, floor, free, placed, rock, run, system, take};
use crate::row::{Failure, Length, Row, Trial, sweep};
use crate::tank::busy;

pub const TRIALS: &[Trial] = &[
    Trial {
        id: "X06",
        subject: "column of 50 and 100 blocks",
        run: column,
    },
    Trial {
        id: "X08",
        subject: "zero gravity, blocks",
        run: nothing,
    },
    Trial {
        id: "X12",
        subject: "subnormals, blocks",
        run: subnormals,
    },
    Trial {
        id: "X13",
        subject: "a million steps, blocks",
        run: million,
    },
];

/// `n³` of the tallest column that stands over `K a/(m g)`: 7.84 of a rod under its own weight times the bending stiffness of
/// a contact, a third of which sits in its corners.
const BUCKLING: f64 = 7.84 * (1.0 / 3.0 / 4.0 + 2.0 / 3.0 / 12.0);

/// A column of unit cubes in equilibrium on springs of `K a/(m g) = stiffness`, each cube off its place by a share of its
/// side at random.
fn standing(n: u32, stiffness: f64, offset: f64) -> Result<Blocks, Failure> {
    let material = Material {
        contact_stiffness: stiffness * 2500.0 * G,
        restitution: 0.2,
        ..rock()
    };
    let mut random = crate::rock::Random::new(5);
    let mut definitions = vec![floor()?];
    let mut sunk = 0.0;
    for k in 0..n {
        sunk += f64::from(n - k) / stiffness;
        let (x, y) = (offset * random.vector().x, offset * random.vector().y);
        let z = f64::from(k) - sunk;
        definitions.push(free(
            cuboid([x, y, z], [x + 1.0, y + 1.0, z + 1.0])?,
            [0.0; 3],
        ));
    }
    system(definitions, material, down())
}

/// How far the cubes of a column move sideways; none if it falls.
fn drift(n: u32, stiffness: f64, steps: u64) -> Result<Option<f64>, Failure> {
    let mut blocks = standing(n, stiffness, 1e-3)?;
    let before: Vec<Vec3> = (1..=n as usize).map(|b| blocks.centroid(b)).collect();
    let mut most = 0.0_f64;
    for _ in 0..20 {
        if take(&mut blocks, steps / 20, 1e-2).is_err() {
            return Ok(None);
        }
        for (b, x) in (1..).zip(&before) {
            let moved = blocks.centroid(b) - x;
            most = most.max(moved.norm());
        }
        if most > 0.2 {
            return Ok(None);
        }
    }
    Ok(Some(most))
}

fn column(length: Length) -> Result<Vec<Row>, Failure> {
    let mut rows = Vec::new();
    let mut figures = Vec::new();
    let mut is_met = true;
    for n in [50, 100] {
        let steps = 100_000;
        let found = drift(n, 1e7, steps)?;
        let text = found.map_or("it falls".to_owned(), |x| format!("{x:.1e} m"));
        is_met &= found.is_some_and(|x| x < 1e-3);
        figures.push(format!("{n} cubes, {steps} steps: {text}"));
    }
    // the lowest frequency of the chain, from the sway of the top as it is let go
    let n = 50_u32;
    let frequency = lowest_frequency(n)?;
    let expected =
        2.0 * (1e7 * G).sqrt() * (std::f64::consts::PI / (2.0 * (2.0 * f64::from(n) + 1.0))).sin();
    let off = frequency / expected - 1.0;
    is_met &= off.abs() < 0.01;
    rows.push(Row {
        pushed: "column of unit cubes, each up to 1e-3 off its place, K = 1e7 m g/a".to_owned(),
        swept: "50 and 100 cubes, 1e5 steps".to_owned(),
        holds: "all of the range".to_owned(),
        past: "see the next row".to_owned(),
        theory: "stands up to n³ = 1.089 K a/(m g), 221 cubes; lowest frequency 2 √(K/m) sin(π/(2 (2n + 1)))".to_owned(),
        measured: format!("moves {} (asked 1e-3 L); lowest frequency off by {off:.1e}", figures.join(", ")),
        missed: (!is_met).then(|| "falls, drifts or has another frequency".to_owned()),
        ..Row::default()
    });
    // how stiff it must be to stand: the buckling of a column of blocks on springs
    let n = 20_u32;
    let limit = f64::from(n).powi(3) / BUCKLING;
    let stiffnesses: Vec<f64> = [4.0, 2.0, 1.5, 1.25, 1.0, 0.8, 0.6, 0.4, 0.2]
        .iter()
        .map(|x| x * limit)
        .collect();
    let softest = sweep(&stiffnesses, 3, |stiffness| {
        match drift(n, stiffness, 60_000) {
            Ok(Some(_)) => Ok(()),
            Ok(None) => Err("it buckles and falls".to_owned()),
            Err(error) => Err(error.to_string()),
        }
    });
    let ratio = softest.last_good.unwrap_or(f64::INFINITY) / limit;
    rows.push(Row {
        pushed: "stiffness of a column of 20 cubes, down, each up to 1e-3 off its place".to_owned(),
        swept: format!("K a/(m g) from {:.1e} to {:.1e}", stiffnesses[0], stiffnesses[8]),
        holds: softest.holds("m g/a"),
        past: softest.past(),
        theory: format!("a rod under its weight, n³ = 7.84 EI/(m g a²), EI/a³ = K (1/3 · 1/4 + 2/3 · 1/12), a third of the stiffness in the corners: {limit:.2e} m g/a"),
        measured: format!("limit {ratio:.2} of theory"),
        missed: (!(0.8..1.25).contains(&ratio)).then(|| "not the buckling load".to_owned()),
        ..Row::default()
    });
    rows.push(at_chosen_stiffness(length)?);
    Ok(rows)
}

/// A column at the stiffness that a scene chooses.
fn at_chosen_stiffness(length: Length) -> Result<Row, Failure> {
    let mut chosen = Vec::new();
    let margin = sweep(&[10.0, 20.0, 50.0, 70.0, 100.0], length.choose(0, 2), |n| {
        let n = n.round() as u32;
        let mut random = crate::rock::Random::new(5);
        let mut cubes = String::new();
        for k in 0..n {
            let (x, y) = (1e-3 * random.vector().x, 1e-3 * random.vector().y);
            cubes += &format!(
                "(name: \"c{k}\", material: \"rock\", shape: Box(min: ({x:?}, {y:?}, {k}), max: ({:?}, {:?}, {}))),",
                x + 1.0,
                y + 1.0,
                k + 1
            );
        }
        let text = format!(
            "(title: \"column\", domain: (min: (-200, -200, -1), max: (200, 200, 200)),\n\
             materials: [(name: \"rock\", density: 2500, friction_angle_deg: 30, restitution: 0.2)],\n\
             blocks: [(name: \"floor\", material: \"rock\", motion: Fixed, shape: Box(min: (-9, -9, -1), max: (9, 9, 0))), {cubes}],\n\
             time: (duration: 100.0))"
        );
        let scene = crate::tank::scene(&text).map_err(|e| e.to_string())?;
        let stiffness = scene.materials[0].contact_stiffness / (2500.0 * G);
        chosen.push(format!(
            "{n}: K = {stiffness:.1e} m g/a, stands to {:.0}",
            (BUCKLING * stiffness).cbrt()
        ));
        let mut world = riprap::run::build(&scene).map_err(|e| e.to_string())?;
        // some times √(height/g), in which what buckles grows
        let end = 6.0 * (f64::from(n) / G).sqrt();
        while world.time() < end {
            let step = world.next_step(100.0).map_err(|e| e.to_string())?;
            world
                .step(step)
                .map_err(|e| format!("at t = {:.1} s: {e}", world.time()))?;
            let top = world.blocks.centroid(n as usize);
            if (top.x - 0.5).abs().max((top.y - 0.5).abs()) > 0.3 {
                return Err(format!("it buckles, at t = {:.1} s", world.time()));
            }
        }
        Ok(())
    });
    let is_met = margin.last_good.is_some_and(|n| n >= 99.0);
    Ok(Row {
        pushed: "column of unit cubes at the stiffness that a scene chooses".to_owned(),
        swept: "10 to 100 cubes, 6 √(n a/g)".to_owned(),
        holds: margin.holds("cubes"),
        past: margin.past(),
        theory: "chosen for an overlap of 0.1 % of one cube's weight, and of 2 % at the speed of a fall to the bottom of the domain".to_owned(),
        measured: chosen.join("; "),
        missed: (!is_met).then(|| "a column of 100 needs a stiffness given by hand".to_owned()),
        ..Row::default()
    })
}

fn lowest_frequency(n: u32) -> Result<f64, Failure> {
    let material = Material {
        contact_stiffness: 1e7 * 2500.0 * G,
        restitution: 1.0,
        friction_angle: 0.0,
        ..rock()
    };
    let mut definitions = vec![floor()?];
    let mut sunk = 0.0;
    let omega =
        2.0 * (1e7 * G).sqrt() * (std::f64::consts::PI / (2.0 * (2.0 * f64::from(n) + 1.0))).sin();
    for k in 0..n {
        sunk += f64::from(n - k) / 1e7;
        let z = f64::from(k) - sunk;
        let mut cube = free(cuboid([0.0, 0.0, z], [1.0, 1.0, z + 1.0])?, [0.0; 3]);
        // the shape of the lowest mode, so small that no contact opens
        let place = std::f64::consts::PI * (f64::from(k) + 1.0) / (2.0 * f64::from(n) + 1.0);
        cube.velocity = Vec3::z() * (1e-9 * omega * place.sin());
        definitions.push(cube);
    }
    let mut blocks = system(definitions, material, down())?;
    let dt = 0.5 * blocks.critical_time_step().dt;
    let (mut before, mut crossings, mut time) = (1e-30, Vec::new(), 0.0);
    while crossings.len() < 4 && time < 50.0 / omega {
        blocks.advance(time, dt, 1)?;
        time += dt;
        let now = blocks.velocity(n as usize).z;
        if (before < 0.0) != (now < 0.0) {
            crossings.push(time - dt + dt * before / (before - now));
        }
        before = now;
    }
    let last = crossings.len().saturating_sub(1);
    if last == 0 {
        return Ok(0.0);
    }
    Ok(std::f64::consts::PI * last as f64 / (crossings[last] - crossings[0]))
}

fn nothing(_: Length) -> Result<Vec<Row>, Failure> {
    let mut definitions = vec![floor()?];
    // on the floor, beside and on each other at exactly no gap, and away
    for place in [
        [0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.5, 0.0, 1.0],
        [5.0, 5.0, 5.0],
    ] {
        let far = place.map(|x| x + 1.0);
        definitions.push(free(cuboid(place, far)?, [0.0; 3]));
    }
    let turned = placed(
        [1.0, 0.3, 0.2],
        Vec3::new(-4.0, 0.0, 4.0),
        Vec3::new(0.4, 0.2, 0.7),
    )?;
    definitions.push(free(turned, [0.0; 3]));
    let mut blocks = system(definitions, rock(), Vec3::zeros())?;
    let places = |blocks: &Blocks| -> Vec<u64> {
        (1..blocks.n_blocks())
            .flat_map(|b| {
                let (x, v, q) = (
                    blocks.centroid(b),
                    blocks.velocity(b),
                    blocks.orientation(b),
                );
                let numbers: Vec<u64> = x
                    .iter()
                    .chain(v.iter())
                    .chain(q.coords.iter())
                    // zero has two signs
                    .map(|x| (x + 0.0).to_bits())
                    .collect();
                numbers
            })
            .collect()
    };
    let before = places(&blocks);
    take(&mut blocks, 100_000, 1e-3)?;
    let same = places(&blocks)
        .iter()
        .zip(&before)
        .filter(|(a, b)| a == b)
        .count();
    let changed = before.len() - same;
    Ok(vec![Row {
        pushed: "no gravity, nothing moves: five blocks, three of them at exactly no gap"
            .to_owned(),
        swept: "1e5 steps".to_owned(),
        holds: "all of the range".to_owned(),
        past: "not reached".to_owned(),
        theory: "places, turns and velocities keep their bits".to_owned(),
        measured: format!("{changed} of {} numbers changed", before.len()),
        missed: (changed > 0).then(|| format!("{changed} numbers changed")),
        ..Row::default()
    }])
}

fn subnormals(_: Length) -> Result<Vec<Row>, Failure> {
    let scene = |speed: f64| -> Result<Blocks, Failure> {
        let material = Material {
            elastic: Some(Elastic {
                young_modulus: 1e8,
                poisson_ratio: 0.2,
                viscosity: 1e4,
            }),
            ..rock()
        };
        let mut definitions = vec![floor()?];
        for k in 0..60 {
            let z = 1.5 * f64::from(k % 6);
            let x = 1.5 * f64::from(k / 6);
            let mut cube = free(
                cuboid([x, 0.0, z], [x + 1.0, 1.0, z + 1.0])?,
                [0.0, 0.0, -speed],
            );
            cube.angular_velocity = Vec3::new(0.1, 0.2, 0.3) * speed;
            if k % 2 == 0 {
                cube.deformability = Some(Deformability {
                    model: DeformableModel::Affine12(StressLaw::Corotational),
                    ..Deformability::default()
                });
            }
            definitions.push(cube);
        }
        let settings = Settings {
            gravity: Vec3::zeros(),
            static_damping: Some(StaticDamping::Kinetic(0.999)),
            ..Settings::default()
        };
        Ok(Blocks::new(definitions, vec![material], settings)?)
    };
    let mut times = Vec::new();
    let mut first = 0.0_f64;
    let mut slowest = 0.0_f64;
    for speed in [1e-3, 1e-100, 1e-300, 1e-307, 1e-312, 1e-320] {
        let mut best = f64::INFINITY;
        for _ in 0..5 {
            let mut blocks = scene(speed)?;
            for k in 0..100_u32 {
                blocks.advance(f64::from(k) * 1e-5, 1e-5, 1)?;
            }
            let begun = busy();
            for k in 0..2000_u32 {
                blocks.advance(f64::from(k) * 1e-5, 1e-5, 1)?;
            }
            best = best.min(busy() - begun);
        }
        if first == 0.0 {
            first = best;
        }
        slowest = slowest.max(best / first);
        times.push(format!("{speed:.0e}: {:.2}", best / first));
    }
    // a block that decays on its dashpot from 1 m/s to below the least normal number
    let mut ball = free(cuboid([0.0; 3], [1.0; 3])?, [1.0, 0.0, 0.0]);
    ball.angular_velocity = Vec3::new(0.0, 0.0, 1.0);
    let settings = Settings {
        gravity: Vec3::zeros(),
        static_damping: Some(StaticDamping::MassProportional(100.0)),
        ..Settings::default()
    };
    let mut blocks = Blocks::new(vec![ball], vec![rock()], settings)?;
    for k in 0..8000_u32 {
        blocks.advance(f64::from(k) * 1e-3, 1e-3, 1)?;
    }
    let path = blocks.centroid(0).x - 0.5;
    let last = blocks.velocity(0).x;
    let is_met = slowest < 2.0;
    Ok(vec![Row {
        pushed: "speeds of 60 blocks, half of them elastic, down to subnormal numbers".to_owned(),
        swept: "1e-3 to 1e-320 m/s, 2000 steps".to_owned(),
        holds: "all of the range".to_owned(),
        past: "not reached".to_owned(),
        theory: "no step slower than twice that at 1e-3 m/s; below 1e-150 m/s damping leaves none"
            .to_owned(),
        measured: format!(
            "time of a step over that at 1e-3 m/s: {}; a block that decays to {last:.0e} m/s has gone {path:.12} m",
            times.join(", ")
        ),
        missed: (!is_met).then(|| format!("{slowest:.1} times slower")),
        ..Row::default()
    }])
}

fn million(length: Length) -> Result<Vec<Row>, Failure> {
    let n = length.choose(1_000_000, 1_000_000);
    let mut rows = Vec::new();
    // two blocks without friction that slide about in a box and hit each other and its walls
    for restitution in [1.0, 0.5] {
        let material = Material {
            friction_angle: 0.0,
            restitution,
            ..rock()
        };
        let mut definitions = vec![floor()?];
        for (from, to) in [
            ([-2.0, -2.0, 0.0], [-1.0, 4.0, 2.0]),
            ([4.0, -2.0, 0.0], [5.0, 4.0, 2.0]),
            ([-2.0, -2.0, 0.0], [5.0, -1.0, 2.0]),
            ([-2.0, 3.0, 0.0], [5.0, 4.0, 2.0]),
        ] {
            definitions.push(body(cuboid(from, to)?, Motion::Fixed));
        }
        let sunk = 2500.0 * G / 1e8;
        definitions.push(free(
            cuboid([0.0, 0.0, -sunk], [1.0, 1.0, 1.0 - sunk])?,
            [0.7, 0.1, 0.0],
        ));
        definitions.push(free(
            cuboid([2.0, 0.5, -sunk], [3.0, 1.5, 1.0 - sunk])?,
            [-0.4, 0.3, 0.0],
        ));
        let mut blocks = system(definitions, material, down())?;
        let start = blocks.energies();
        let kinetic = start.kinetic;
        let mut time = 0.0;
        let mut most = 0.0_f64;
        for _ in 0..100 {
            match take(&mut blocks, n / 100, 1e-2) {
                Ok(t) => time += t,
                Err(error) => {
                    rows.push(Row::broken("sliding pair", error.to_string()));
                    return Ok(rows);
                }
            }
            most = most.max((blocks.energies().balance() - start.balance()).abs() / kinetic);
        }
        rows.push(Row {
        pushed: format!("a million steps: two cubes slide about in a box and hit each other and its walls, no friction, e = {restitution}"),
        swept: format!("{n} steps, {time:.0} s"),
        holds: "all of the range".to_owned(),
        past: "not reached".to_owned(),
        theory: "energy slope × run below 1e-3, no growing mode".to_owned(),
        measured: format!("energy off by {most:.1e} of the kinetic energy at most (asked 1e-3)"),
        missed: (most > 1e-3).then(|| format!("energy off by {most:.1e}")),
        ..Row::default()
    });
    }
    let sunk = 2500.0 * G / 1e8;
    // the same with friction comes to rest and stays
    let material = rock();
    let mut blocks = system(
        vec![
            floor()?,
            free(
                cuboid([0.0, 0.0, -sunk], [1.0, 1.0, 1.0 - sunk])?,
                [1.0, 0.3, 0.0],
            ),
        ],
        material,
        down(),
    )?;
    run(&mut blocks, 2.0, 1.0, 1e-2)?;
    let rest = blocks.centroid(1);
    take(&mut blocks, n, 1e-2)?;
    let crept = (blocks.centroid(1) - rest).norm();
    rows.push(Row {
        pushed: "a million steps: a cube that slid to rest under friction".to_owned(),
        swept: format!("{n} steps"),
        holds: "all of the range".to_owned(),
        past: "not reached".to_owned(),
        theory: "it does not creep".to_owned(),
        measured: format!("moves {crept:.1e} m"),
        missed: (crept > 1e-9).then(|| "it creeps".to_owned()),
        ..Row::default()
    });
    // an elastic block that spins and swings
    let material = Material {
        elastic: Some(Elastic {
            young_modulus: 1e9,
            poisson_ratio: 0.25,
            viscosity: 0.0,
        }),
        ..rock()
    };
    let mut stone = free(
        placed([1.0, 0.7, 0.4], Vec3::zeros(), Vec3::zeros())?,
        [0.0; 3],
    );
    stone.angular_velocity = Vec3::new(3.0, 20.0, 5.0);
    stone.deformability = Some(Deformability {
        model: DeformableModel::Affine12(StressLaw::SaintVenantKirchhoff),
        ..Deformability::default()
    });
    let settings = Settings {
        gravity: Vec3::zeros(),
        ..Settings::default()
    };
    let mut blocks = Blocks::new(vec![stone], vec![material], settings)?;
    let start = blocks.energies();
    let angular = blocks.spin_momentum(0);
    let mut most = 0.0_f64;
    for _ in 0..100 {
        take(&mut blocks, n / 100, 1e-2)?;
        let off = (blocks.energies().balance() - start.balance()) / start.kinetic;
        most = most.max(off.abs());
    }
    let l = (blocks.spin_momentum(0) - angular).norm() / angular.norm();
    rows.push(Row {
        pushed: "a million steps: an elastic box tumbles in free flight".to_owned(),
        swept: format!("{n} steps"),
        holds: "all of the range".to_owned(),
        past: "not reached".to_owned(),
        theory: "E and L kept, no growing mode".to_owned(),
        measured: format!("energy off by {most:.1e} at most (asked 1e-3), L by {l:.0e}"),
        missed: (most > 1e-3).then(|| format!("energy off by {most:.1e}")),
        ..Row::default()
    });
    Ok(rows)
}
