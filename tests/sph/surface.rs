//! The free surface that a gauge reads.

use riprap_sph::{Fluid, Scheme, Vec3};

use crate::support::evaluate;
use crate::water::{Plane, lattice, start};

const SPACING: f64 = 0.02;

/// Rows of water over the whole width of a plane between pairs of row numbers.
fn rows(pieces: &[[i32; 2]]) -> Fluid {
    let plane = Plane {
        spacing: SPACING,
        ratio: 1.5,
        sound_speed: 20.0,
        scheme: Scheme::artificial(),
        gravity: Vec3::new(0.0, 0.0, -9.81),
        time_step_factor: 0.5,
        domain: ([0.0, -0.1], [0.8, 2.0]),
        periodic: [true, false],
    };
    let positions = (pieces.iter())
        .flat_map(|&[low, high]| lattice(SPACING, 0..40, low..high))
        .collect();
    let begin = start(positions, |_| Vec3::zeros(), |_| 0.0);
    let mut fluid = Fluid::new(begin, plane.settings()).unwrap();
    evaluate(&mut fluid);
    fluid
}

/// Rows up to the surface; a twentieth of a spacing is what half a kernel sum is off on a lattice.
fn assert_rows(pieces: &[[i32; 2]], expected: i32) {
    let surface = rows(pieces).surface_elevation(0.4, 0.5).unwrap();
    let expected = f64::from(expected) * SPACING;
    assert!(
        (surface - expected).abs() < 0.05 * SPACING,
        "{pieces:?}: {surface} {expected}"
    );
}

#[test]
fn spray_above_water_is_no_surface() {
    assert_rows(&[[0, 20]], 20);
    // three rows of spray, near and far above
    assert_rows(&[[0, 20], [30, 33]], 20);
    assert_rows(&[[0, 20], [60, 63]], 20);
    assert_rows(&[[0, 20], [40, 43], [60, 63]], 20);
}

#[test]
fn a_thick_jet_above_air_is_a_surface() {
    assert_rows(&[[0, 20], [40, 60]], 60);
}

#[test]
fn a_film_on_dry_ground_is_a_surface() {
    let film = rows(&[[0, 3]]).surface_elevation(0.4, 0.5).unwrap();
    // half of the largest kernel sum of three rows
    assert!((film - 3.0 * SPACING).abs() < 0.35 * SPACING, "{film}");
}
