//! Speed of spheres: a box of them that has come to rest.
//!
//! `cargo bench -p riprap-dda --bench sphere_piles` settles 10,000 spheres of 1 m, then times steps on one
//! and on all threads; `-- N` does it for about N.
#![expect(clippy::print_stdout, reason = "a benchmark reports")]

mod piles;

use piles::{Failure, Pile};
use riprap_dda::Shape;

/// Simulated time before the measurement; s.
const SETTLING: f64 = 4.0;
/// Steps of a round.
const STEPS: u32 = 200;

fn main() -> Result<(), Failure> {
    let side = piles::wanted().unwrap_or(1e4).cbrt().round() as usize;
    let pile = Pile {
        side,
        pitch: 1.1,
        // 1.4e7 N/m carries 22 layers that come down; more layers need more.
        contact_stiffness: 1.4e7 * f64::max(side as f64 / 22.0, 1.0),
        shear_stiffness_ratio: 2.0 / 7.0,
    };
    let mut blocks = pile.build(|place, random| {
        Ok(Shape::Sphere {
            center: place + piles::vector(random) * 0.04,
            radius: 0.5,
        })
    })?;
    piles::settle(&mut blocks, SETTLING)?;
    piles::report(&mut blocks, &format!("{} balls", side.pow(3)), STEPS)
}
