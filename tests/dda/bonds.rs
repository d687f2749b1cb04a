//! Bonds: strength in bending, shear and tension, what is left of it, what becomes of their energy.

use crate::setup::*;
use riprap_dda::{BlockDefinition, Blocks, JointOverride, Load, Material, Motion, Settings, Vec3};

fn glue(tensile_strength: f64, cohesion: f64) -> Material {
    Material {
        tensile_strength,
        cohesion,
        contact_stiffness: 1e9,
        ..rock()
    }
}

/// Brings up the loads of the blocks over `end` (s), without a jolt, until a bond breaks; the steps are at
/// most `longest` (s).
fn load_slowly(
    blocks: &mut Blocks,
    loads: &[Load],
    end: f64,
    longest: f64,
    mut watch: impl FnMut(&Blocks),
) {
    let mut time = 0.0;
    while time < end && blocks.broken_bonds() == 0 {
        let dt = blocks.critical_time_step().dt.min(longest);
        let share = 0.5 - 0.5 * (std::f64::consts::PI * time / end).cos();
        let now: Vec<Load> = loads
            .iter()
            .map(|load| Load {
                force: load.force * share,
                torque: load.torque * share,
            })
            .collect();
        blocks.apply_impulse(&now, dt);
        blocks.advance(time, dt, 1).unwrap();
        time += dt;
        watch(blocks);
    }
}

/// A wall and n cubes of side h in a row, glued to it and to each other.
fn cantilever(n: usize, h: f64) -> Vec<BlockDefinition> {
    let wall = block(cuboid([-1.0, -2.0, -2.0], [0.0, 2.0, 2.0]), Motion::Fixed);
    let cubes = (0..n).map(|k| {
        let x = k as f64 * h;
        block(cuboid([x, 0.0, 0.0], [x + h, h, h]), Motion::Free)
    });
    std::iter::once(wall).chain(cubes).collect()
}

/// Under its own weight a row of bonded cubes breaks at its root when the edge stress of a beam,
/// σ = 6 M/(b h²) = 3 ρ g L²/h, comes to the tensile strength.
#[test]
fn cantilever_breaks_in_bending() {
    for (n, h) in [(1, 1.0), (3, 0.5)] {
        let length = n as f64 * h;
        let stress = 3.0 * 2500.0 * G * length * length / h;
        for (share, holds) in [(1.0 / 0.97, true), (1.0 / 1.03, false)] {
            let mut blocks = blocks(
                cantilever(n, h),
                glue(share * stress, 1e3 * stress),
                Vec3::zeros(),
            );
            let weight = Load {
                force: down() * blocks.mass(1),
                torque: Vec3::zeros(),
            };
            load_slowly(&mut blocks, &vec![weight; n + 1], 2.0, 1e-3, |_| {});
            println!(
                "{n} cubes, strength {share:.3} of 6 M/(b h²): {} broken",
                blocks.broken_bonds()
            );
            assert_eq!(blocks.broken_bonds(), u64::from(!holds));
        }
    }
}

/// Pulled straight, a bond holds T A.
#[test]
fn direct_tension() {
    let (strength, area) = (2e5, 0.8 * 0.5);
    let ceiling = block(cuboid([-1.0, -1.0, 1.0], [2.0, 2.0, 2.0]), Motion::Fixed);
    let hung = block(cuboid([0.0; 3], [0.8, 0.5, 1.0]), Motion::Free);
    let mut blocks = blocks(vec![ceiling, hung], glue(strength, strength), Vec3::zeros());
    let pull = Load {
        force: Vec3::new(0.0, 0.0, -1.2 * strength * area),
        torque: Vec3::zeros(),
    };
    let mut peak = 0.0_f64;
    load_slowly(&mut blocks, &[Load::default(), pull], 1.0, 1e-4, |b| {
        peak = peak.max(-b.contact_force(0).force.z);
    });
    assert_eq!(blocks.broken_bonds(), 1);
    assert_close("direct tension, T A", peak, strength * area, 1e-2);
}

/// Direct shear under a normal load: peak c A + N tan φ, then c_r A + N tan φ_r. The strength is that of the material,
/// or what a joint says in its place.
#[test]
fn direct_shear() {
    let of_material = |joint_stiffness| Material {
        friction_angle: 35.0_f64.to_radians(),
        residual_friction_angle: Some(25.0_f64.to_radians()),
        residual_cohesion: 2e4,
        joint_stiffness,
        ..glue(1e5, 1e5)
    };
    let weaker = Material {
        residual_cohesion: 1e3,
        ..of_material(None)
    };
    let said = JointOverride {
        residual_cohesion: Some(2e4),
        ..JointOverride::default()
    };
    for (material, joints) in [
        (of_material(None), vec![]),
        (of_material(Some(1e10)), vec![]),
        (weaker, vec![said]),
    ] {
        let (area, normal) = (1.0 * 0.5, 5e4);
        // Thin, so that what turns it once it slides is small.
        let stone = block(cuboid([0.0; 3], [1.0, 0.5, 0.05]), Motion::Free);
        let settings = Settings {
            gravity: Vec3::zeros(),
            ..Settings::default()
        };
        let bodies = vec![floor(), stone];
        let mut blocks = Blocks::with_joints(bodies, vec![material], &joints, settings).unwrap();
        let peak_expected = 1e5 * area + normal * 35.0_f64.to_radians().tan();
        let residual_expected = 2e4 * area + normal * 25.0_f64.to_radians().tan();
        let press = Load {
            force: Vec3::new(0.0, 0.0, -normal),
            torque: Vec3::zeros(),
        };
        let at_rest = Load::default();
        load_slowly(&mut blocks, &[at_rest, press], 0.2, 1e-5, |_| {});
        // Pushed in the plane of the joint.
        let force = Vec3::new(1.2 * peak_expected, 0.0, 0.0);
        let push = |share: f64| Load {
            force: press.force + force * share,
            torque: Vec3::new(0.0, 0.0, -0.025).cross(&(force * share)),
        };
        let shear = |b: &Blocks| b.contact_force(0).force.x;
        let (mut time, mut peak) = (0.0, 0.0_f64);
        while blocks.broken_bonds() == 0 {
            blocks.apply_impulse(&[at_rest, push(time / 0.5)], 1e-5);
            blocks.advance(time, 1e-5, 1).unwrap();
            time += 1e-5;
            peak = peak.max(shear(&blocks));
        }
        let (mut sum, start) = (0.0, blocks.centroid(1).x);
        for k in 0..1000 {
            blocks.apply_impulse(&[at_rest, push(0.5)], 1e-5);
            blocks.advance(time, 1e-5, 1).unwrap();
            if k >= 500 {
                sum += shear(&blocks) / 500.0;
            }
        }
        println!("slid {:.4} m", blocks.centroid(1).x - start);
        assert_eq!(blocks.broken_bonds(), 1);
        assert_close("peak, c A + N tan φ", peak, peak_expected, 1e-2);
        assert_close("residual, c_r A + N tan φ_r", sum, residual_expected, 1e-2);
    }
}

/// Energy stored in the springs of a breaking bond is booked: hung, in bending, on a slope.
#[test]
fn ledger_of_a_break() {
    let hung = vec![
        block(cuboid([-1.0, -1.0, 1.0], [2.0, 2.0, 2.0]), Motion::Fixed),
        block(cuboid([0.0; 3], [1.0; 3]), Motion::Free),
    ];
    let stone = block(cuboid([0.0; 3], [1.0, 1.0, 0.3]), Motion::Free);
    let steep = on_slope(60.0_f64.to_radians());
    for (name, definitions, gravity, material) in [
        ("hung", hung, down(), glue(1.5 * 2500.0 * G, 1e6)),
        ("bending", cantilever(2, 0.5), down(), glue(1e5, 1e7)),
        (
            "slope",
            vec![floor(), stone],
            steep,
            Material {
                residual_cohesion: 1e3,
                ..glue(1e6, 4.0e3)
            },
        ),
    ] {
        // Lightly damped: let go from rest, the load swings up to nearly twice what it is.
        let material = Material {
            restitution: 0.8,
            ..material
        };
        let mut blocks = blocks(definitions, material, gravity);
        let start = ledger(&blocks.energies());
        let (mut time, mut worst, mut broken_at) = (0.0, 0.0_f64, None);
        let mut scale = 0.0_f64;
        while time < 0.1 {
            blocks.advance(time, 2e-6, 1).unwrap();
            time += 2e-6;
            let e = blocks.energies();
            if blocks.broken_bonds() > 0 && broken_at.is_none() {
                broken_at = Some(time);
                // What the bond held.
                scale = e.damping + e.friction;
            }
            worst = worst.max((ledger(&e) - start).abs());
        }
        println!("{name}: broken at {broken_at:?} s, {scale:.3e} J lost till then");
        assert!(broken_at.is_some());
        // Measured 2e-7 to 2e-6.
        assert_below(&format!("ledger of a break, {name}"), worst / scale, 1e-4);
    }
}

/// Springs without shear stiffness let a glued block slide off: then its bond is gone. It once divided nothing by
/// nothing.
#[test]
fn bond_that_slid_off_is_gone() {
    let material = Material {
        shear_stiffness_ratio: 0.0,
        restitution: 1.0,
        ..glue(1e9, 1e9)
    };
    let base = block(cuboid([0.0, 0.0, -1.0], [1.0, 1.0, 0.0]), Motion::Fixed);
    let stone = block(cuboid([0.0; 3], [1.0, 1.0, 0.2]), Motion::Free);
    // It swings up and down on its springs while it slides.
    let stone = moving(stone, [10.0, 0.0, 0.1]);
    for phase in 0..8 {
        let definitions = vec![base.clone(), stone.clone()];
        let mut blocks = blocks(definitions, material, Vec3::zeros());
        // Breaking at another height each time.
        run_steps(&mut blocks, 0.12, 2000 + 37 * phase);
        assert_eq!(blocks.broken_bonds(), 1);
        assert!(blocks.centroid(1).iter().all(|c| c.is_finite()));
    }
}
