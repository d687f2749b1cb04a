//! Momentum and energy of water, walls and blocks that move.

use super::*;

/// A basin with a piston and a free block in the water, `thickness` spacings thick.
fn stirred(walls: &'static str, precision: &str, thickness: f64) -> Case {
    let dp = 0.05;
    let (l, w, h) = (14.0 * dp, 10.0 * dp, 8.0 * dp);
    let mut blocks = basin([l, w, h + 4.0 * dp], 4.0 * dp);
    let piston = cuboid([0.0, 0.0, 0.0], [3.0 * dp, w, h + 4.0 * dp]);
    let sway =
        "motion: Sinusoid(direction: (1.0, 0.0, 0.0), amplitude: 0.01, period: 0.2, ramp: 0.1)";
    blocks.push(block("piston", &piston, sway));
    let cube = cuboid(
        [7.0 * dp, 3.0 * dp, 3.0 * dp],
        [11.0 * dp, 7.0 * dp, (3.0 + thickness) * dp],
    );
    blocks.push(block("cube", &cube, ""));
    Case {
        domain: [
            [-5.0 * dp, -5.0 * dp, -5.0 * dp],
            [l + 5.0 * dp, w + 5.0 * dp, h + 8.0 * dp],
        ],
        gravity: G,
        blocks,
        spacing: dp,
        regions: below(h, [5.0 * dp, 5.0 * dp, 1.6 * dp]),
        walls,
        more: [
            String::new(),
            String::new(),
            format!("precision: {precision}"),
        ],
    }
}

#[test]
fn momentum_is_accounted_for_with_prescribed_and_free_blocks() {
    // the plate of a spacing is a thin solid between walls of particles
    let walls = [
        ("Penalty", 3.0),
        ("Particles", 3.0),
        ("Particles", 1.0),
        ("Integral", 3.0),
    ];
    for (walls, thickness) in walls {
        for (precision, bound) in [("Single", 1e-6), ("Double", 1e-10)] {
            let mut world = stirred(walls, precision, thickness).world();
            for _ in 0..100 {
                let step = world.next_step(1.0).unwrap();
                world.step(step).unwrap();
            }
            let residual = world.momentum_residual();
            println!("momentum {walls:9} {thickness} dp, {precision}: {residual:.1e}");
            assert!(residual < bound, "{walls} {precision}: {residual}");
        }
    }
}

/// Blocks that move give what the water gets and what is lost by names, of which one is the walls' own.
#[test]
fn energy_is_accounted_for_with_prescribed_and_free_blocks() {
    for (walls, slip) in [
        ("Particles", "Free"),
        ("Particles", "None"),
        ("Integral", "Free"),
        ("Integral", "None"),
    ] {
        let mut case = stirred(walls, "Double", 3.0);
        case.more[1] = format!("slip: {slip}");
        case.more[2] = format!("precision: Double, {}", calm(0.4));
        let mut world = case.world();
        for _ in 0..200 {
            let step = world.next_step(1.0).unwrap();
            world.step(step).unwrap();
        }
        let energy = world.energy();
        println!(
            "energy {walls:9} slip {slip}: work {:.2} J, viscous {:.2} J, at walls {:+.3} J, unexplained {:+.1e} J",
            energy.external_work, energy.viscous, energy.at_walls, energy.residual
        );
        // of the stepping, in which a stroke takes 70 steps: 0.3 % at most
        assert!(
            energy.residual.abs() < 0.005 * energy.external_work,
            "{energy:?}"
        );
    }
}

#[test]
fn walls_are_placed_where_blocks_are() {
    // a free block falls through water: both kinds of walls slow it alike
    let speeds = ["Particles", "Integral"].map(|walls| {
        let mut world = stirred(walls, "Single", 3.0).world();
        while world.time() < 0.15 {
            let step = world.next_step(1.0).unwrap();
            world.step(step).unwrap();
        }
        let speed = world.blocks.velocity(world.blocks.n_blocks() - 1);
        println!("velocity of the cube at 0.15 s, {walls}: {speed:.4?}");
        speed
    });
    let difference: Vec3 = speeds[0] - speeds[1];
    assert!(difference.norm() < 0.1 * speeds[0].norm(), "{speeds:?}");
}
