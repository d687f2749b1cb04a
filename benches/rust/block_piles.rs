//! Speed of blocks: random hulls and cubes that have fallen into a bin.
//!
//! `cargo bench -p riprap-dda` settles 125 and 1000 of each, then times steps on one and on all threads.
//! `cargo bench -p riprap-dda -- N` does it for about N bodies, `-- N hulls` and `-- N cubes` for one kind of them, `-- eigenvalues`
//! with that bound of the step, `-- dynamics` with contact dynamics and steps of 5 ms.
#![expect(clippy::print_stdout, reason = "a benchmark reports")]

mod piles;

use piles::{Failure, Pile};
use riprap_dda::{Isometry, Polyhedron, Random, Shape, Vec3};

/// Simulated time before the measurement; s.
const SETTLING: f64 = 1.5;
/// Steps of a round.
const STEPS: u32 = 40;

fn body(is_hull: bool, random: &mut Random) -> Result<Polyhedron, Failure> {
    if !is_hull {
        return Ok(Polyhedron::cuboid(Vec3::repeat(-0.5), Vec3::repeat(0.5))?);
    }
    // 14 points on a sphere of 0.6 m
    let points: Vec<Vec3> = (0..14)
        .map(|_| {
            let mut v = piles::vector(random);
            while v.norm() > 1.0 || v.norm() < 0.1 {
                v = piles::vector(random);
            }
            v.normalize() * 0.6
        })
        .collect();
    Ok(Polyhedron::convex_hull(&points)?)
}

fn main() -> Result<(), Failure> {
    let sides = piles::wanted().map_or(vec![5, 10], |n| vec![n.cbrt().round() as usize]);
    let is_named = |kind: &str| std::env::args().any(|argument| argument == kind);
    let kinds = match (is_named("cubes"), is_named("hulls")) {
        (true, false) => vec![false],
        (false, true) => vec![true],
        _ => vec![false, true],
    };
    for side in sides {
        for &is_hull in &kinds {
            let pile = Pile {
                side,
                pitch: 1.45,
                // 1e8 N/m stops ten layers that come down; n times as many bring n times the mass from n times
                // the height
                contact_stiffness: 1e8 * f64::max(side as f64 / 10.0, 1.0).powi(2),
                shear_stiffness_ratio: 0.8,
            };
            let mut blocks = pile.build(|place, random| {
                let center = place + Vec3::new(0.0, 0.0, 0.2);
                let turn = Isometry::new(center, piles::vector(random) * 0.3);
                let body = body(is_hull, random)?.transformed(&turn);
                Ok(Shape::Polyhedra(vec![body]))
            })?;
            piles::settle(&mut blocks, SETTLING)?;
            let kind = if is_hull { "hulls" } else { "cubes" };
            piles::report(&mut blocks, &format!("{} {kind}", side.pow(3)), STEPS)?;
        }
    }
    Ok(())
}
