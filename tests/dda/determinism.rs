//! The same bits for any number of threads; the same motion for any order and frame.

use crate::{conservation::pile, setup::*};
use riprap_dda::{Blocks, Isometry, Material, Motion, Settings, Vec3};

fn bits(blocks: &Blocks) -> Vec<u64> {
    let mut bits = Vec::new();
    blocks.for_each_state_f64(&mut |x| bits.push(x.to_bits()));
    bits
}

#[test]
fn threads_do_not_change_a_bit() {
    let run_on = |n: usize| {
        on_threads(n, || {
            let mut blocks = blocks(pile(50), rock(), down());
            run_steps(&mut blocks, 0.9, 3000);
            // Enough to wake the threads.
            assert!(blocks.contacts().len() > 100, "{}", blocks.contacts().len());
            bits(&blocks)
        })
    };
    let one = run_on(1);
    assert_eq!(one, run_on(2));
    assert_eq!(one, run_on(4));
}

#[test]
fn asking_changes_nothing() {
    let make = || blocks(pile(9), rock(), down());
    let (mut asked, mut left) = (make(), make());
    for k in 0..200 {
        asked.advance(f64::from(k) * 1e-3, 1e-3, 4).unwrap();
        left.advance(f64::from(k) * 1e-3, 1e-3, 4).unwrap();
        let _ = (
            asked.critical_time_step(),
            asked.energies(),
            asked.contacts().len(),
            asked.world_polygons(7),
        );
    }
    assert_eq!(bits(&asked), bits(&left));
}

/// Two free boxes and a floor, in another order and in a turned frame: the same motion.
#[test]
fn order_and_frame_do_not_matter() {
    let material = Material {
        restitution: 0.3,
        contact_stiffness: 1e7,
        ..rock()
    };
    let motion_of = |order: [usize; 3], frame: Isometry| {
        let shapes = [
            cuboid([-5.0, -5.0, -1.0], [5.0, 5.0, 0.0]),
            cuboid([0.0, 0.0, 0.05], [0.5, 0.5, 0.4]),
            cuboid([-0.2, -0.2, -0.2], [0.2, 0.3, 0.2]).transformed(&Isometry::new(
                Vec3::new(0.2, 0.2, 0.9),
                Vec3::new(0.4, 0.3, 0.0),
            )),
        ];
        let definitions = order
            .iter()
            .map(|&k| {
                let motion = if k == 0 { Motion::Fixed } else { Motion::Free };
                block(shapes[k].transformed(&frame), motion)
            })
            .collect();
        let settings = Settings {
            gravity: frame.rotation * down(),
            ..Settings::default()
        };
        let mut blocks = Blocks::new(definitions, vec![material], settings).unwrap();
        run_steps(&mut blocks, 0.35, 4000);
        assert!(blocks.contact_updates() > 0);
        [1, 2].map(|k| {
            let b = order.iter().position(|&o| o == k).unwrap();
            (frame.inverse() * blocks.pose(b) * frame)
                .translation
                .vector
        })
    };
    let plain = motion_of([0, 1, 2], Isometry::identity());
    let cases = [
        ("order", motion_of([2, 1, 0], Isometry::identity())),
        (
            "frame",
            motion_of(
                [0, 1, 2],
                Isometry::new(Vec3::new(3.0, -2.0, 1.0), Vec3::new(0.7, -0.4, 1.9)),
            ),
        ),
    ];
    for (name, other) in cases {
        let error = (plain[0] - other[0])
            .norm()
            .max((plain[1] - other[1]).norm());
        // Round-off grown by an impact and some rocking.
        assert_below(name, error, 1e-8);
    }
}

/// A slide with friction and a stack that settles, with both kinds of stiffness, in a turned frame and with the blocks
/// shuffled: the same to 1e-9 of the size.
#[test]
fn slide_and_stack_in_any_order_and_frame() {
    let slab = || cuboid([-5.0, -5.0, -1.0], [5.0, 5.0, 0.0]);
    // Sunk in a little: round-off shall not decide whether they touch in the first step.
    let sunk = 1e-5;
    let slide = vec![
        slab(),
        cuboid([0.0, 0.0, -sunk], [0.5, 0.4, 0.1]),
        cuboid([-1.0, 0.1, -sunk], [-0.6, 0.5, 0.2]),
        cuboid([0.2, 1.0, -sunk], [0.6, 1.3, 0.15]),
    ];
    // Each one a little off the one below, and smaller by `less`.
    let stack = |less: f64| -> Vec<_> {
        let boxes = (0..4).map(|k| {
            let (x, z) = (0.03 * f64::from(k % 2), 0.4 * f64::from(k) - sunk);
            let width = 0.5 - less * f64::from(k);
            cuboid([x, -x, z], [x + width, width - x, z + 0.4 + 0.5 * sunk])
        });
        std::iter::once(slab()).chain(boxes).collect()
    };
    let (pyramid, column) = (stack(0.01), stack(0.0));
    for joint_stiffness in [None, Some(1e8)] {
        let material = Material {
            friction_angle: 0.3,
            contact_stiffness: 1e7,
            joint_stiffness,
            ..rock()
        };
        for (name, shapes, gravity) in [
            ("slide", &slide, on_slope(0.5)),
            ("stack", &pyramid, down()),
            ("stack of equals", &column, down()),
        ] {
            let n = shapes.len();
            let motion_of = |order: &[usize], frame: Isometry| -> Vec<Vec3> {
                let definitions = order
                    .iter()
                    .map(|&k| {
                        let motion = if k == 0 { Motion::Fixed } else { Motion::Free };
                        block(shapes[k].transformed(&frame), motion)
                    })
                    .collect();
                let settings = Settings {
                    gravity: frame.rotation * gravity,
                    ..Settings::default()
                };
                let mut blocks = Blocks::new(definitions, vec![material], settings).unwrap();
                run_steps(&mut blocks, 1.0, 5000);
                (1..n)
                    .map(|k| {
                        let b = order.iter().position(|&o| o == k).unwrap();
                        (frame.inverse() * blocks.pose(b) * frame)
                            .translation
                            .vector
                    })
                    .collect()
            };
            let sorted: Vec<usize> = (0..n).collect();
            let mut shuffled = sorted.clone();
            shuffled.rotate_left(2);
            shuffled.swap(0, 1);
            let turned = Isometry::new(Vec3::new(3.0, -2.0, 1.0), Vec3::new(0.7, -0.4, 1.9));
            let plain = motion_of(&sorted, Isometry::identity());
            for (what, other) in [
                ("order", motion_of(&shuffled, Isometry::identity())),
                ("frame", motion_of(&sorted, turned)),
            ] {
                let error = plain
                    .iter()
                    .zip(&other)
                    .map(|(a, b)| (a - b).norm())
                    .fold(0.0, f64::max);
                let scaling = joint_stiffness.map_or("N/m", |_| "Pa/m");
                assert_below(
                    &format!("{name}, {what}, {scaling}, sizes"),
                    error / 0.5,
                    1e-9,
                );
            }
        }
    }
}
