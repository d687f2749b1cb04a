//! Rock masses cut by joint sets.

use crate::setup::*;
use riprap_dda::{
    BlockQuality, Isometry, JointError, JointSet, Polyhedron, SliverLimits, Vec3, cut_by_joints,
    merge_slivers, volume,
};

fn set(dip_deg: f64, direction_deg: f64, spacing: f64) -> JointSet {
    JointSet {
        dip: dip_deg.to_radians(),
        dip_direction: direction_deg.to_radians(),
        spacing,
        origin: Vec3::zeros(),
        persistence: 1.0,
        scatter: 0.0,
        spacing_scatter: 0.0,
    }
}

fn total(blocks: &[Polyhedron]) -> f64 {
    blocks.iter().map(volume).sum()
}

/// Dip direction clockwise from north (+y), dip down from the horizontal.
#[test]
fn geologists_angles() {
    let close = |a: Vec3, b: [f64; 3]| assert!((a - Vec3::from(b)).norm() < 1e-15, "{a} {b:?}");
    close(set(0.0, 123.0, 1.0).normal(), [0.0, 0.0, 1.0]);
    // Dips east at 90: its normal points east.
    close(set(90.0, 90.0, 1.0).normal(), [1.0, 0.0, 0.0]);
    // Dips north at 45: a sphere rolls to +y.
    let half = 0.5_f64.sqrt();
    close(set(45.0, 0.0, 1.0).normal(), [0.0, half, half]);
}

/// Three sets at right angles cut a box into nx ny nz boxes.
#[test]
fn orthogonal_sets() {
    let body = cuboid([0.0; 3], [4.0, 3.0, 2.0]);
    let sets = [
        set(90.0, 90.0, 0.5),
        set(90.0, 0.0, 1.0),
        set(0.0, 0.0, 0.4),
    ];
    let blocks = cut_by_joints(vec![body], &sets, 1, 1000).unwrap().blocks;
    assert_eq!(blocks.len(), 8 * 3 * 5);
    for block in &blocks {
        assert!(
            (volume(block) - 0.5 * 0.4).abs() < 1e-12,
            "{}",
            volume(block)
        );
        assert_eq!((block.n_faces(), block.vertices().len()), (6, 8));
        let quality = BlockQuality::of(block);
        assert!((quality.shortest_edge - 0.4).abs() < 1e-12);
        assert!((quality.aspect - (0.25 + 1.0 + 0.16_f64).sqrt() / 0.4).abs() < 1e-9);
    }
}

/// Ten thousand irregular blocks: volumes add up to 1e-12, every block is a closed polyhedron; far from the origin too.
#[test]
fn ten_thousand_blocks() {
    let mut sets = [
        set(60.0, 100.0, 1.0),
        set(70.0, 210.0, 1.1),
        set(25.0, 330.0, 0.9),
    ];
    for set in &mut sets {
        set.scatter = 0.03;
        set.spacing_scatter = 0.3;
        set.origin = Vec3::new(0.3, 0.2, 0.1);
    }
    for shift in [0.0, 1e4] {
        let offset = Vec3::repeat(shift);
        let body = Polyhedron::cuboid(offset, offset + Vec3::repeat(21.5)).unwrap();
        let sets = sets.map(|set| JointSet {
            origin: set.origin + offset,
            ..set
        });
        let blocks = cut_by_joints(vec![body], &sets, 7, 20_000).unwrap().blocks;
        let error = (total(&blocks) / 21.5_f64.powi(3) - 1.0).abs();
        println!("{} blocks", blocks.len());
        assert!(blocks.len() > 10_000);
        // Far away the corners themselves are rounded to 1e-12 of a block.
        assert_below("volume", error, if shift == 0.0 { 1e-12 } else { 1e-9 });
        for block in &blocks {
            assert_eq!(
                block.vertices().len() + block.n_faces(),
                block.n_edges() + 2
            );
        }
    }
}

#[test]
fn seeds_and_persistence() {
    let cut = |persistence: f64, seed: u64| {
        let body = cuboid([0.0; 3], [8.0; 3]);
        let sets = [set(50.0, 80.0, 1.0), set(60.0, 200.0, 1.0)].map(|set| JointSet {
            persistence,
            scatter: 0.02,
            ..set
        });
        cut_by_joints(vec![body], &sets, seed, 10_000)
            .unwrap()
            .blocks
    };
    assert_eq!(cut(0.0, 1).len(), 1);
    assert!(cut(0.5, 1) == cut(0.5, 1) && cut(0.5, 1) != cut(0.5, 2));
    let (half, all) = (cut(0.5, 1).len(), cut(1.0, 1).len());
    assert!(1 < half && half < all, "{half} {all}");
}

/// A mass far from the origin comes out like the one near it: what rounding makes of joints that only touch a block draws
/// no chance of persistence.
#[test]
fn shifted_mass_has_the_same_blocks() {
    let scattered = [
        set(50.0, 80.0, 1.0),
        set(60.0, 200.0, 1.0),
        set(20.0, 320.0, 1.3),
    ]
    .map(|set| JointSet {
        persistence: 0.6,
        scatter: 0.05,
        spacing_scatter: 0.2,
        ..set
    });
    // Its joints run along faces of the cube and along those of each other's blocks.
    let aligned = [
        set(90.0, 90.0, 1.0),
        set(90.0, 0.0, 0.8),
        set(0.0, 0.0, 2.0),
        set(90.0, 90.0, 0.5),
    ]
    .map(|set| JointSet {
        persistence: 0.6,
        ..set
    });
    for (name, sets) in [("scattered", &scattered[..]), ("aligned", &aligned[..])] {
        let volumes = |shift: Vec3| -> Vec<f64> {
            let body = Polyhedron::cuboid(shift, shift + Vec3::repeat(8.0)).unwrap();
            let sets: Vec<JointSet> = sets
                .iter()
                .map(|set| JointSet {
                    origin: set.origin + shift,
                    ..*set
                })
                .collect();
            let blocks = cut_by_joints(vec![body], &sets, 5, 20_000).unwrap().blocks;
            blocks.iter().map(volume).collect()
        };
        let (near, far) = (volumes(Vec3::zeros()), volumes(Vec3::new(1e4, -2e4, 5e3)));
        println!("{name}: {} blocks", near.len());
        assert_eq!(near.len(), far.len());
        let worst = near.iter().zip(&far).map(|(a, b)| (a - b).abs());
        // The median block has 0.3 m3; corners far away are rounded to 4e-12 m.
        assert_below("volume", worst.fold(0.0, f64::max), 1e-9);
    }
}

/// Joints lean as a normal distribution in two directions that ends at 3σ: by σ √(π/2) = 1.253 σ in the mean if it had no
/// end, by 1.230 σ with it.
#[test]
fn scatter_ends_at_three_sigma() {
    let sigma = 0.02;
    let body = cuboid([0.0; 3], [1.0, 1.0, 2000.0]);
    // Too far apart to meet each other: every block but the first has its joint for a floor.
    let sets = [JointSet {
        scatter: sigma,
        ..set(0.0, 0.0, 1.0)
    }];
    let blocks = cut_by_joints(vec![body], &sets, 3, 10_000).unwrap().blocks;
    let slopes: Vec<f64> = blocks
        .iter()
        .flat_map(|block| (0..block.n_faces()).map(|face| block.face_normal(face)))
        .filter(|normal| normal.z < -0.9 && normal.z > -1.0)
        .map(|normal| normal.xy().norm() / -normal.z / sigma)
        .collect();
    let mean = slopes.iter().sum::<f64>() / slopes.len() as f64;
    let largest = slopes.iter().copied().fold(0.0, f64::max);
    println!(
        "{} joints lean by {mean:.3} sigma in the mean, {largest:.3} at most",
        slopes.len()
    );
    assert!(slopes.len() > 1950 && 2.8 < largest && largest < 3.0 + 1e-6);
    // The mean of 2000 is uncertain by 0.64/√2000 = 0.014.
    assert!((mean - 1.230).abs() < 0.05, "{mean}");
}

/// A joint through a block that cannot be cut there is counted.
#[test]
fn cuts_that_cannot_be_made_are_counted() {
    let knife = Polyhedron::extrusion(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.01]], 1, 0.0, 1.0).unwrap();
    let joint = JointSet {
        origin: Vec3::new(5e-9, 0.0, 0.0),
        ..set(90.0, 90.0, 10.0)
    };
    let mass = cut_by_joints(knife.clone(), &[joint], 1, 10).unwrap();
    assert_eq!((mass.n_uncut, &mass.blocks), (1, &knife));
}

/// Joint sets that would make a million slivers are rejected before the first cut, with the responsible set.
#[test]
fn too_many_blocks_are_refused() {
    let body = || vec![cuboid([0.0; 3], [10.0; 3])];
    let sets = [
        set(90.0, 90.0, 1.0),
        set(90.0, 0.0, 0.01),
        set(0.0, 0.0, 0.1),
    ];
    let refused = cut_by_joints(body(), &sets, 1, 50_000).unwrap_err();
    assert!(
        matches!(refused, JointError::TooMany { set: 1, .. }),
        "{refused}"
    );
    println!("{refused}");
    // One set and two sets are counted as well; the joints of the third cannot meet.
    let upright = [
        set(90.0, 90.0, 0.01),
        set(90.0, 0.0, 0.01),
        set(90.0, 45.0, 1e9),
    ];
    for (sets, blocks) in [
        (&[set(30.0, 40.0, 1e-5)][..], 1.5705e6), // 10 (√¾ + ½ (sin 40° + cos 40°))/1e-5
        (&upright[..2], 1e6),
        (&upright[..], 1e6),
        (&[set(30.0, 40.0, 1e-5), set(90.0, 0.0, 1e9)][..], 1.5705e6),
    ] {
        match cut_by_joints(body(), sets, 1, 50_000) {
            Err(JointError::TooMany { expected, .. }) => {
                println!("{expected:.4e} of {blocks:e} blocks");
                assert!((expected / blocks - 1.0).abs() < 0.01);
            }
            other => panic!("{other:?}"),
        }
    }
    // Without a bound these would be looked at for ever, and cut nothing.
    let unending = JointSet {
        persistence: 1e-9,
        ..set(0.0, 0.0, 1e-12)
    };
    let refused = cut_by_joints(body(), &[unending], 1, 50_000).unwrap_err();
    assert!(
        refused.to_string().contains("a million joints"),
        "{refused}"
    );
    let wrong = cut_by_joints(body(), &[set(95.0, 0.0, 1.0)], 1, 10)
        .unwrap_err()
        .to_string();
    assert!(wrong.starts_with("joint set 0: dip is 1.658"), "{wrong}");
}

/// The number of blocks that a refusal states is the number that would be made, in the mean over places of the joints.
#[test]
fn refusals_state_the_number_of_blocks() {
    let sets = |origin: Vec3| {
        [
            set(60.0, 100.0, 1.0),
            set(70.0, 210.0, 0.8),
            set(25.0, 330.0, 1.2),
        ]
        .map(|set| JointSet { origin, ..set })
    };
    let body = || vec![cuboid([0.0; 3], [7.0, 8.0, 3.0])];
    let stated = match cut_by_joints(body(), &sets(Vec3::zeros()), 1, 10) {
        Err(JointError::TooMany { expected, .. }) => expected,
        other => panic!("{other:?}"),
    };
    let mut random = Random::new(3);
    let counts: Vec<f64> = (0..40)
        .map(|_| {
            let mass = cut_by_joints(body(), &sets(random.vector() * 10.0), 1, 10_000).unwrap();
            mass.blocks.len() as f64
        })
        .collect();
    let mean = counts.iter().sum::<f64>() / counts.len() as f64;
    // Measured 0.05 %; single places differ by 3 %.
    assert_close("blocks", stated, mean, 0.01);
}

/// Four sets: 2,546 blocks in a cube of nine spacings are made, and far fewer than that allowed are refused. The product
/// of the layers of all sets, 50,920, once refused such a mass.
#[test]
fn four_sets_are_not_overestimated() {
    let sets = [
        set(60.0, 100.0, 1.0),
        set(70.0, 210.0, 1.0),
        set(25.0, 330.0, 1.0),
        set(50.0, 20.0, 1.0),
    ];
    let cut = |limit| cut_by_joints(vec![cuboid([0.0; 3], [9.0; 3])], &sets, 1, limit);
    let n = cut(20_000).unwrap().blocks.len();
    println!("{n} blocks");
    assert!(cut(n).is_ok() && cut(n - 1).is_err() && cut(100).is_err());
}

/// A mass with slivers: three sets with scatter, and a fourth close to the third.
fn mass_with_slivers() -> Vec<Polyhedron> {
    let sets = [
        set(60.0, 100.0, 1.0),
        set(70.0, 210.0, 1.1),
        set(25.0, 330.0, 0.9),
        set(28.0, 325.0, 3.0),
    ]
    .map(|set| JointSet {
        scatter: 0.05,
        spacing_scatter: 0.4,
        persistence: 0.9,
        ..set
    });
    let body = cuboid([0.0; 3], [9.0, 8.0, 7.0]);
    cut_by_joints(vec![body], &sets, 11, 20_000).unwrap().blocks
}

const LIMITS: SliverLimits = SliverLimits {
    volume_share: 0.05,
    aspect: 12.0,
};

fn median(blocks: &[Polyhedron]) -> f64 {
    let mut volumes: Vec<f64> = blocks.iter().map(volume).collect();
    volumes.sort_by(f64::total_cmp);
    volumes[volumes.len() / 2]
}

/// The volume stays, and no sliver does.
#[test]
fn slivers_are_merged() {
    let blocks = mass_with_slivers();
    let median = median(&blocks);
    let is_sliver = |quality: &BlockQuality| {
        quality.volume < LIMITS.volume_share * median || quality.aspect > LIMITS.aspect
    };
    let n_slivers = blocks
        .iter()
        .filter(|block| is_sliver(&BlockQuality::of(block)))
        .count();
    let merged = merge_slivers(blocks.clone(), &LIMITS).unwrap();
    let n_unions = merged.blocks.iter().filter(|parts| parts.len() > 1).count();
    println!(
        "{} blocks, {n_slivers} slivers; {} merged into {} blocks, {n_unions} of several parts, at most {}",
        blocks.len(),
        merged.n_merged,
        merged.blocks.len(),
        merged.blocks.iter().map(Vec::len).max().unwrap()
    );
    assert!(n_slivers > 100 && n_unions > 0);
    assert_eq!(merged.n_merged + merged.blocks.len(), blocks.len());
    let sum: f64 = merged.blocks.iter().flatten().map(volume).sum();
    assert_below("volume", (sum / 504.0 - 1.0).abs(), 1e-12);
    let left = merged
        .blocks
        .iter()
        .filter(|parts| is_sliver(&BlockQuality::of_union(parts)));
    assert_eq!((left.count(), merged.n_left), (0, 0));
}

/// A turned mass is merged alike: scattered blocks, and equal ones, where rounding would choose among neighbors.
#[test]
fn a_turned_mass_is_merged_alike() {
    let boxes = {
        let body = cuboid([0.0; 3], [4.0, 3.0, 2.0]);
        let sets = [
            set(90.0, 90.0, 1.0),
            set(90.0, 0.0, 1.0),
            set(0.0, 0.0, 0.12),
        ];
        cut_by_joints(vec![body], &sets, 1, 1000).unwrap().blocks
    };
    let limits = SliverLimits {
        volume_share: 0.0,
        aspect: 5.0,
    };
    for (name, blocks, limits) in [
        ("scattered", mass_with_slivers(), LIMITS),
        ("boxes", boxes, limits),
    ] {
        let turn = Isometry::new(Vec3::new(20.0, -30.0, 10.0), Vec3::new(0.3, 1.2, -0.8));
        let turned = blocks
            .iter()
            .map(|block| block.transformed(&turn))
            .collect();
        let volumes = |blocks: Vec<Polyhedron>| -> (usize, Vec<f64>) {
            let merged = merge_slivers(blocks, &limits).unwrap();
            let volumes = merged
                .blocks
                .iter()
                .map(|parts| parts.iter().map(volume).sum());
            (merged.n_merged, volumes.collect())
        };
        let (here, there) = (volumes(blocks), volumes(turned));
        println!("{name}: {} merged, {} blocks", here.0, here.1.len());
        assert_eq!((here.0, here.1.len()), (there.0, there.1.len()));
        let errors = here.1.iter().zip(&there.1).map(|(a, b)| (a - b).abs());
        assert_below("volume", errors.fold(0.0, f64::max), 1e-12);
    }
}

/// The same joints through the same mass, all turned about the vertical.
#[test]
fn a_turned_mass_is_cut_and_merged_alike() {
    let merged = |angle_deg: f64| {
        let turn = Isometry::rotation(Vec3::z() * -angle_deg.to_radians());
        let body = cuboid([0.0; 3], [6.0, 5.0, 4.0]).transformed(&turn);
        let sets = [
            set(60.0, 100.0, 1.0),
            set(70.0, 210.0, 1.1),
            set(25.0, 330.0, 0.9),
        ]
        .map(|set| JointSet {
            dip_direction: set.dip_direction + angle_deg.to_radians(),
            spacing_scatter: 0.4,
            persistence: 0.9,
            ..set
        });
        let blocks = cut_by_joints(vec![body], &sets, 2, 20_000).unwrap().blocks;
        let merged = merge_slivers(blocks, &LIMITS).unwrap();
        (merged.n_merged, merged.blocks.len())
    };
    let here = merged(0.0);
    println!("{here:?}");
    assert!(here.0 > 10);
    assert_eq!(here, merged(37.0));
    assert_eq!(here, merged(161.0));
}

/// Joints that scatter do so about their own strike and dip: a turned mass comes out as the same blocks, turned, corner by
/// corner. With axes fixed in space the blocks were others.
#[test]
fn a_turned_mass_with_scatter_has_the_same_blocks() {
    let blocks_at = |angle_deg: f64| {
        let turn = Isometry::rotation(Vec3::z() * -angle_deg.to_radians());
        let body = cuboid([0.0; 3], [6.0, 5.0, 4.0]).transformed(&turn);
        let sets = [
            set(60.0, 100.0, 1.0),
            set(90.0, 210.0, 1.1),
            set(0.0, 330.0, 0.9),
        ]
        .map(|set| JointSet {
            dip_direction: set.dip_direction + angle_deg.to_radians(),
            origin: turn.rotation * Vec3::new(0.3, 0.2, 0.1),
            scatter: 0.1,
            spacing_scatter: 0.4,
            persistence: 0.8,
            ..set
        });
        let blocks = cut_by_joints(vec![body], &sets, 2, 20_000).unwrap().blocks;
        (blocks, turn)
    };
    let (here, _) = blocks_at(0.0);
    for angle in [37.0, 161.0, 290.0] {
        let (there, turn) = blocks_at(angle);
        assert_eq!(here.len(), there.len());
        let mut worst = 0.0_f64;
        for (a, b) in here.iter().zip(&there) {
            assert_eq!(a.vertices().len(), b.vertices().len());
            for (x, y) in a.vertices().iter().zip(b.vertices()) {
                worst = worst.max((turn.rotation * x - y).norm());
            }
        }
        println!("{} blocks, turned by {angle} degrees", here.len());
        // Round-off of some 1e-15 m, more where three joints meet at a small angle.
        assert_below("corners, m", worst, 1e-11);
    }
}

/// A cut is undone as one polyhedron; what is not convex has two parts; what stands apart is left.
#[test]
fn unions_of_slivers() {
    let limits = SliverLimits {
        volume_share: 0.5,
        aspect: f64::INFINITY,
    };
    let cube = cuboid([0.0; 3], [1.0; 3]);
    let counts = |blocks: Vec<Polyhedron>| {
        let merged = merge_slivers(blocks, &limits).unwrap();
        let parts: Vec<usize> = merged.blocks.iter().map(Vec::len).collect();
        (parts, merged.n_merged, merged.n_left)
    };
    let leaf = |length: f64| cuboid([1.0, 0.0, 0.0], [1.0 + length, 1.0, 1.0]);
    assert_eq!(counts(vec![cube.clone(), leaf(1e-6)]), (vec![1], 1, 0));
    let stud = cuboid([1.0, 0.2, 0.2], [1.1, 0.8, 0.8]);
    assert_eq!(counts(vec![cube.clone(), stud]), (vec![2], 1, 0));
    let apart = cuboid([3.0, 0.0, 0.0], [3.1, 1.0, 1.0]);
    let beside = cuboid([1.0, 1.0, 0.0], [1.1, 2.0, 1.0]);
    assert_eq!(
        counts(vec![
            cube.clone(),
            cube.transformed(&Isometry::translation(9.0, 0.0, 0.0)),
            apart,
            beside
        ]),
        (vec![1; 4], 0, 2)
    );
    let wrong = SliverLimits {
        aspect: 1.0,
        ..limits
    };
    let refused = merge_slivers(vec![cube], &wrong).unwrap_err().to_string();
    assert!(
        refused.starts_with("slivers: aspect is 1, must be >= 2"),
        "{refused}"
    );
}
