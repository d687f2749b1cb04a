//! Water along rough walls: the stress of the law of the wall, whatever the number of rows that bear it.

use riprap_sph::boundary::wall_law::WallLaw;
use riprap_sph::boundary::wall_particles::Slip;
use riprap_sph::scheme::Viscosity;
use riprap_sph::{Dimensions, Precision, Scheme, Settings, Start, Vec3};

use crate::water::{DENSITY, Plane, Water, lattice, start};

const VISCOSITY: f64 = 1e-6;
const SPACING: f64 = 0.01;
const COLUMNS: i32 = 12;
const LENGTH: f64 = COLUMNS as f64 * SPACING;

fn law(roughness: f64) -> WallLaw {
    WallLaw {
        height: SPACING,
        kinematic_viscosity: VISCOSITY,
        roughness,
    }
}

fn rough(roughness: f64) -> Slip {
    Slip::Rough {
        roughness,
        kinematic_viscosity: VISCOSITY,
    }
}

/// A sheet of water on a floor, without gravity, that moves at one speed (m/s); the floor at another.
fn sheet(rows: i32, (speed, of_floor): (f64, f64), (ratio, slip): (f64, Slip)) -> Water {
    let plane = Plane {
        spacing: SPACING,
        ratio,
        sound_speed: 20.0,
        scheme: Scheme {
            precision: Precision::Double,
            viscosity: Viscosity::Laminar {
                kinematic_viscosity: VISCOSITY,
            },
            ..Scheme::artificial()
        },
        gravity: Vec3::zeros(),
        time_step_factor: 0.5,
        domain: ([0.0; 2], [LENGTH, 0.3]),
        periodic: [true, false],
    };
    let water = start(
        lattice(SPACING, 0..COLUMNS, 0..rows).collect(),
        |_| Vec3::x() * speed,
        |_| 0.0,
    );
    let floor: Vec<Vec3> = lattice(SPACING, 0..COLUMNS, -5..0).collect();
    let volumes = vec![SPACING * SPACING; floor.len()];
    // the floor looks the same wherever it has gone to
    let motion = move |w: usize, _: f64| [floor[w], Vec3::x() * of_floor, Vec3::zeros()];
    Water::walled(water, plane.settings(), (volumes, slip), motion)
}

/// Force of the floor along the flow; N.
fn drag(water: &Water) -> f64 {
    water.wall_force.x
}

#[test]
fn a_wall_holds_a_film_and_deep_water_with_the_stress_of_its_law() {
    for ratio in [1.3, 2.0] {
        for roughness in [0.0, 1e-4, 3e-3] {
            for rows in [1, 2, 12] {
                let speed = 1.5;
                let water = sheet(rows, (speed, 0.0), (ratio, rough(roughness)));
                let stress = DENSITY * law(roughness).stress_over_density(speed);
                let found = -drag(&water) / LENGTH / stress;
                println!(
                    "h/dp {ratio} k_s {roughness} m, {rows} rows: {found:.4} of {stress:.2} Pa"
                );
                // measured 1e-6: rows of the lattice are where the weight is flat, on either side
                assert!((found - 1.0).abs() < 1e-4, "{rows} {found}");
            }
        }
    }
}

#[test]
fn only_the_speed_relative_to_the_wall_counts() {
    let at_rest = sheet(3, (1.0, 0.0), (2.0, rough(1e-3)));
    let drawn = sheet(3, (0.0, -1.0), (2.0, rough(1e-3)));
    assert!((drag(&drawn) / drag(&at_rest) - 1.0).abs() < 1e-9);
    let together = sheet(3, (2.0, 2.0), (2.0, rough(1e-3)));
    assert!(drag(&together).abs() < 1e-12 * drag(&at_rest).abs());
    let back = sheet(3, (-1.0, 0.0), (2.0, rough(1e-3)));
    assert!((drag(&back) / drag(&at_rest) + 1.0).abs() < 1e-9);
}

#[test]
fn the_wall_feels_what_it_takes() {
    let mut water = sheet(4, (1.0, 0.2), (2.0, rough(1e-3)));
    let force = water.wall_force;
    let mut reaction = Vec3::zeros();
    water
        .walls
        .visit_reactions(&water.fluid, |_, _, [pressure, viscous]| {
            reaction += pressure + viscous;
        });
    // sums of the same pairs in another order
    assert!(
        (force + reaction).norm() < 1e-11 * force.norm(),
        "{force} {reaction}"
    );
}

/// Over a fully rough wall the stress goes with the square of the speed, and a film slows down as 1/U − 1/U₀ = C t/δ.
#[test]
fn a_film_slows_down_as_friction_has_it() {
    let (speed, roughness) = (2.0, 3e-3);
    let ideal = Slip::Rough {
        roughness,
        kinematic_viscosity: 0.0,
    };
    let coefficient = (0.4 / ((30.0 * SPACING / roughness).ln() - 1.0)).powi(2);
    let mut water = sheet(1, (speed, 0.0), (2.0, ideal));
    let mass = water.sum(|_, _, m| m);
    for time in [0.1, 0.2, 0.4] {
        water.advance_to(time);
        let mean = water.sum(|_, v, m| m * v.x) / mass;
        let expected = 1.0 / (1.0 / speed + coefficient * time / SPACING);
        println!("{time} s: {mean:.4} m/s of {expected:.4}");
        // the share of the stress that one row bears, as above, over a loss of a half
        assert!(
            (mean / expected - 1.0).abs() < 0.01,
            "{time} {mean} {expected}"
        );
    }
    let energies = water.fluid.energies();
    let lost = 0.5 * mass * speed * speed - energies.kinetic;
    assert!(
        (energies.viscous / lost - 1.0).abs() < 1e-3,
        "{} {lost}",
        energies.viscous
    );
}

/// In space, askew to the lattice: the force is against the flow.
#[test]
fn drag_is_against_the_flow() {
    let (n, floor_rows) = (8, 4);
    let velocity = Vec3::new(0.8, -0.6, 0.0);
    let side = f64::from(n) * SPACING;
    let settings = Settings {
        particle_spacing: [SPACING; 3],
        smoothing_length: 1.5 * SPACING,
        reference_density: DENSITY,
        sound_speed: 20.0,
        scheme: Scheme {
            viscosity: Viscosity::None,
            ..Scheme::artificial()
        },
        dimensions: Dimensions::Three,
        gravity: Vec3::zeros(),
        time_step_factor: 0.5,
        domain: (Vec3::zeros(), Vec3::new(side, side, 0.3)),
        periodic: [true, true, false],
        symmetry: [[false; 2]; 3],
    };
    let places = |rows: std::ops::Range<i32>| -> Vec<Vec3> {
        rows.flat_map(|k| (0..n * n).map(move |c| (c / n, c % n, k)))
            .map(|(i, j, k)| {
                Vec3::new(f64::from(i) + 0.5, f64::from(j) + 0.5, f64::from(k) + 0.5) * SPACING
            })
            .collect()
    };
    let positions = places(0..3);
    let water = Start {
        velocities: vec![velocity; positions.len()],
        pressures: vec![0.0; positions.len()],
        positions,
    };
    let volume = SPACING.powi(3);
    let water = Water::between(
        water,
        settings,
        (places(-floor_rows..0), volume),
        rough(1e-3),
    );
    let expected = velocity * (-side * side * DENSITY * law(1e-3).stress_over_density(1.0));
    println!("{} of {expected}", water.wall_force);
    // measured 1e-7, single precision
    assert!((water.wall_force - expected).norm() < 1e-4 * expected.norm());
}

/// Water that stands still on a floor that does is not touched by its roughness, bit for bit.
#[test]
fn a_rough_wall_leaves_still_water_alone() {
    let states = [rough(1e-3), Slip::Free].map(|slip| {
        let mut water = sheet(4, (0.0, 0.0), (2.0, slip));
        water.advance_to(0.02);
        water.fluid.particles().position.clone()
    });
    assert_eq!(states[0], states[1]);
}
