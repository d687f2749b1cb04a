//! Distance and common plane against parry and brute force.

use crate::setup::*;
use nalgebra::Matrix3;
use parry3d_f64::{
    math::{Pose, Vector},
    query::PointQuery,
    shape::ConvexPolyhedron,
};
use riprap_dda::{
    Isometry, Polyhedron, Vec3, fast_common_plane, gap_along, mass_properties, separating_axes,
};

fn to_parry(body: &Polyhedron) -> ConvexPolyhedron {
    let points: Vec<Vector> = body
        .vertices()
        .iter()
        .map(|x| Vector::new(x.x, x.y, x.z))
        .collect();
    ConvexPolyhedron::from_convex_hull(&points).unwrap()
}

#[test]
fn distance_is_parrys() {
    let mut random = Random::new(1);
    let mut worst = 0.0_f64;
    let (mut n_face, mut n_edge) = (0, 0);
    for _ in 0..100 {
        let hull = random.hull().transformed(&random.placement(1.0));
        let oracle = to_parry(&hull);
        for k in 0..60 {
            // Random points, and points straight over corners and edges.
            let corner = |v: usize| hull.vertices()[v % hull.vertices().len()];
            let x = match k % 3 {
                0 => corner(0) + random.vector() * 1.5,
                1 => {
                    corner(k)
                        + (corner(k) - mass_properties(&hull).centroid) * (random.next() - 0.3)
                }
                _ => 0.5 * (corner(k) + corner(k + 1)) + random.vector() * 0.3,
            };
            let found = hull.surface_point_within(&x, f64::INFINITY).unwrap();
            let expected =
                oracle.distance_to_point(&Pose::IDENTITY, Vector::new(x.x, x.y, x.z), false);
            let is_inside = oracle.contains_local_point(Vector::new(x.x, x.y, x.z));
            // Inside, parry's solver may stop early; the planes give the exact depth.
            let expected = if is_inside {
                (0..hull.n_faces())
                    .map(|f| hull.plane_distance(f, &x))
                    .fold(f64::NEG_INFINITY, f64::max)
            } else {
                expected
            };
            worst = worst.max((found.distance - expected).abs());
            let foot = hull.surface_point_within(&found.point, 1.0).unwrap();
            assert!(
                foot.distance.abs() < 1e-12,
                "the foot is on the surface: {:e}",
                foot.distance
            );
            assert!((found.point + found.normal * found.distance - x).norm() < 1e-12);
            let near = hull.surface_point_within(&x, found.distance.abs() + 1e-9);
            assert!(
                near.is_some(),
                "a cutoff just beyond the distance keeps the point"
            );
            if found.distance > 1e-6 {
                assert!(
                    hull.surface_point_within(&x, found.distance * 0.999)
                        .is_none()
                );
                let is_over_face =
                    (0..hull.n_faces()).any(|f| (hull.face_normal(f) - found.normal).norm() < 1e-9);
                if is_over_face {
                    n_face += 1
                } else {
                    n_edge += 1
                }
            }
        }
    }
    assert!(
        n_face > 500 && n_edge > 500,
        "both kinds occur: {n_face}, {n_edge}"
    );
    // Parry's closest point iterates to some 1e-8; measured below.
    assert_below("distance against parry", worst, 1e-7);
}

/// Every face normal and every cross product of edges, both senses, no pruning.
fn brute_force_gap(a: &Polyhedron, b: &Polyhedron) -> f64 {
    let along = |p: &Polyhedron, e: u32| {
        p.vertices()[p.target(e) as usize] - p.vertices()[p.origin(e) as usize]
    };
    let mut best = f64::NEG_INFINITY;
    let mut consider = |n: Vec3| best = f64::max(best, gap_along(a, b, &n));
    (0..a.n_faces()).for_each(|f| consider(a.face_normal(f)));
    (0..b.n_faces()).for_each(|f| consider(-b.face_normal(f)));
    for e in a.edges() {
        for f in b.edges() {
            let cross = along(a, e).cross(&along(b, f));
            if cross.norm() > 1e-9 * along(a, e).norm() * along(b, f).norm() {
                consider(cross.normalize());
                consider(-cross.normalize());
            }
        }
    }
    best
}

/// D17.
#[test]
fn common_plane_is_exact() {
    let mut random = Random::new(2);
    let (mut n, mut fast_misses, mut misses, mut n_disagree) = (0, 0, 0, 0);
    let (mut fast_worst, mut worst) = (0.0_f64, 0.0_f64);
    while n < 20_000 {
        let a = random.hull();
        let b = random.hull().transformed(&random.placement(0.7));
        let exact = brute_force_gap(&a, &b);
        let found = separating_axes(&a, &b).best().gap;
        // Apart, only the sign counts.
        n_disagree += u32::from((exact > 0.0) != (found > 0.0));
        if exact >= 0.0 {
            continue;
        }
        n += 1;
        misses += u32::from(exact - found > 1e-12);
        worst = worst.max(exact - found);
        let line = mass_properties(&b).centroid - mass_properties(&a).centroid;
        let fast = exact - fast_common_plane(&a, &b, &line.normalize()).gap;
        fast_misses += u32::from(fast > 1e-9);
        fast_worst = fast_worst.max(fast);
    }
    println!(
        "20000 overlapping pairs: verified path misses {misses} (worst {worst:.1e} m); fast common plane alone misses {:.2} % (worst {fast_worst:.3} m)",
        f64::from(fast_misses) / 200.0
    );
    assert_eq!((misses, n_disagree), (0, 0));
    // The reason for the verification; measured 5.3 %.
    assert!(fast_misses > 0 && fast_misses < 2000, "{fast_misses}");
}

/// Mass properties of random hulls turn as tensors do.
#[test]
fn moments_turn_with_the_body() {
    let mut random = Random::new(3);
    for _ in 0..50 {
        let hull = random.hull();
        let placement: Isometry = random.placement(3.0);
        let (here, there) = (
            mass_properties(&hull),
            mass_properties(&hull.transformed(&placement)),
        );
        let turn: Matrix3<f64> = *placement.rotation.to_rotation_matrix().matrix();
        let expected = turn * here.second_moment * turn.transpose();
        assert!((there.volume / here.volume - 1.0).abs() < 1e-12);
        assert!((there.second_moment - expected).abs().max() < 1e-12 * expected.trace());
    }
}
