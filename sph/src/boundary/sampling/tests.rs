use nalgebra::Rotation3;

use super::*;
use crate::boundary::integral::{LayerTable, integrate};
use crate::boundary::solids::{Noise, Solid};
use crate::kernel::{Dimensions, Kernel, KernelChoice, PointKernel};

const DP: f64 = 0.02;

fn volume(samples: &[WallSample]) -> f64 {
    samples.iter().map(|sample| sample.volume).sum()
}

/// Volume within `thickness` of the surface, by counting points of a fine grid.
fn shell_volume(solid: &Solid, thickness: f64) -> f64 {
    let corners = || solid.0.iter().flat_map(|(_, corners)| corners);
    let low = corners().fold(Vec3::repeat(f64::INFINITY), |low, p| low.inf(p));
    let high = corners().fold(Vec3::repeat(-f64::INFINITY), |high, p| high.sup(p));
    let n = 110;
    let cell = (high - low) / f64::from(n);
    let mut count = 0;
    for k in 0..n {
        for j in 0..n {
            for i in 0..n {
                let place = Vec3::new(f64::from(i), f64::from(j), f64::from(k)).add_scalar(0.5);
                let depth = solid.depth(&(low + place.component_mul(&cell)));
                count += i32::from(0.0 < depth && depth < thickness);
            }
        }
    }
    f64::from(count) * cell.product()
}

/// `Σ V ∇W` at a point.
fn closure(x: &Vec3, points: &[WallSample], support_radius: f64) -> Vec3 {
    let kernel = PointKernel::new(KernelChoice::WendlandC2, support_radius, Dimensions::Three);
    points
        .iter()
        .map(|point| (x - point.position, point.volume))
        .filter(|(apart, _)| apart.norm() < support_radius)
        .map(|(apart, volume)| apart * (volume * kernel.gradient_factor(apart.norm())))
        .sum()
}

/// Largest `h |f|` over points, `h = 1.5 dp`, and where.
fn largest(at: impl Iterator<Item = Vec3>, f: impl Fn(&Vec3) -> Vec3) -> (f64, Vec3) {
    at.map(|x| (1.5 * DP * f(&x).norm(), x))
        .fold((0.0, Vec3::zeros()), |p, q| if p.0 < q.0 { q } else { p })
}

/// Points `(i + ½) dp` with the given ranges of `i`, `j`, `k`.
fn cells(ranges: [std::ops::Range<i32>; 3]) -> impl Iterator<Item = Vec3> {
    let [is, js, ks] = ranges;
    is.flat_map(move |i| {
        let ks = ks.clone();
        js.clone().flat_map(move |j| {
            ks.clone().map(move |k| {
                Vec3::new(f64::from(i), f64::from(j), f64::from(k)).add_scalar(0.5) * DP
            })
        })
    })
}

fn fluid_sample(position: Vec3) -> WallSample {
    WallSample {
        position,
        volume: DP.powi(3),
    }
}

#[test]
fn box_is_a_lattice_of_its_own() {
    let mut noise = Noise(5);
    let (rotation, shift) = (noise.rotation(), noise.vector());
    let solid = Solid::cuboid([0.0; 3], [0.213, 0.16, 0.305]).moved(&rotation, &shift);
    let samples = sample_convex(&solid.faces(), DP, 3.0 * DP);
    // 0.213/0.02 = 10.65 rounds up to 11 cells, 0.305/0.02 = 15.25 down to 15; three layers
    assert_eq!(samples.len(), 11 * 8 * 15 - 5 * 2 * 9);
    let cell = 0.213 / 11.0 * 0.16 / 8.0 * 0.305 / 15.0;
    assert!((volume(&samples) - samples.len() as f64 * cell).abs() < 1e-15);
    let half_steps = [0.213 / 22.0, 0.01, 0.305 / 30.0];
    let first = (0..3)
        .map(|axis| half_steps[axis])
        .fold(f64::INFINITY, f64::min);
    let depths = || samples.iter().map(|sample| solid.depth(&sample.position));
    assert!((depths().fold(f64::INFINITY, f64::min) - first).abs() < 1e-12);
    assert!(depths().fold(0.0, f64::max) < 3.0 * 0.0204);
}

#[test]
fn c17_volumes_add_up_to_the_shell() {
    let mut noise = Noise(17);
    for size in [3.0, 6.0, 12.0, 25.0] {
        // a corner tetrahedron of edge length `size` spacings: inradius 0.21 of it
        let solid = Solid::tetrahedron(
            [Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::z()].map(|p| p * size * DP),
        )
        .moved(&noise.rotation(), &noise.vector());
        let samples = sample_convex(&solid.faces(), DP, 3.0 * DP);
        let inradius = size * DP / (3.0 + 3.0_f64.sqrt());
        let core = (1.0 - 3.0 * DP / inradius).max(0.0);
        let shell = (size * DP).powi(3) / 6.0 * (1.0 - core.powi(3));
        let error = volume(&samples) / shell - 1.0;
        let largest = samples.iter().map(|s| s.volume).fold(0.0, f64::max) / DP.powi(3);
        println!(
            "C17 tetrahedron of {size} dp: {} points, volume {error:+.2e}, largest {largest:.2} dp^3",
            samples.len()
        );
        assert!(error.abs() < 1e-2);
        assert!(samples.iter().all(|s| 0.0 < solid.depth(&s.position)));
    }
}

/// Their acute corners had up to 7 % too much while they were sampled as a union, which is made for walls of tanks.
#[test]
fn c17_prisms_that_go_on_fill_their_shells() {
    for size in [6.0, 12.0, 25.0] {
        for (name, angles) in [("60, 60, 60", [60.0, 60.0]), ("30, 60, 90", [30.0, 60.0])] {
            let [a, b] = angles.map(f64::to_radians);
            let base = size * DP;
            // corners 0, base and the third, where the sides from both meet
            let along = base * b.sin() / (a + b).sin();
            let third = Vec3::new(along * a.cos(), 0.0, along * a.sin());
            let corners = [Vec3::zeros(), Vec3::x() * base, third];
            let [near, far] = [-0.5, 0.5].map(|y| corners.map(|x| x + Vec3::y() * (y * DP)));
            let side = |k: usize| vec![far[k], far[(k + 1) % 3], near[(k + 1) % 3], near[k]];
            let ends = [near.to_vec(), far.iter().rev().copied().collect()];
            let solid = Solid::of_loops(ends.into_iter().chain((0..3).map(side)).collect());
            let samples = sample_prism(&solid.faces(), 1, DP, 2.6 * DP).unwrap_or_default();
            let area = 0.5 * base * third.z;
            let inradius = 2.0 * area / (base + along + (third - corners[1]).norm());
            let core = (1.0 - 3.0 * DP / inradius).max(0.0);
            let error = volume(&samples) / (area * DP * (1.0 - core * core)) - 1.0;
            println!(
                "C17 prism of {name} degrees, {size} dp: {} points, volume {error:+.1e}",
                samples.len()
            );
            // of the layer that ends within itself, which is summed over eight slices: 6e-4 measured
            assert!(error.abs() < 2e-3, "{error}");
            assert!(samples.iter().all(|s| s.position.y.abs() < 1e-12));
            assert!(samples.iter().all(|s| 0.0 < solid.depth(&s.position)));
        }
    }
}

/// Behind a plane in two parts as behind the whole; behind an arch what is between it and the arch as deep as the support.
#[test]
fn c17_layers_behind_a_side_of_several_faces() {
    let support = 2.6 * DP;
    let strip = |[from, to]: [[f64; 2]; 2]| {
        let at = |[x, z]: [f64; 2], y: f64| Vec3::new(x, y, z) * DP;
        vec![at(from, -0.5), at(to, -0.5), at(to, 0.5), at(from, 0.5)]
    };
    let normal = |x: &[Vec3]| (x[1] - x[0]).cross(&(x[2] - x[1])).normalize();
    let row = Rows {
        axis: 1,
        from: -0.5 * DP,
        width: DP,
        count: 1,
    };
    let behind = |strips: &[Vec<Vec3>]| {
        let faces: Vec<Face> = strips
            .iter()
            .map(|vertices| Face {
                normal: normal(vertices),
                vertices,
            })
            .collect();
        sample_behind_side(&faces, Some(row), DP, support)
    };
    let whole = behind(&[strip([[0.0, 0.0], [12.0, 0.0]])]);
    let parts = behind(&[
        strip([[0.0, 0.0], [5.0, 0.0]]),
        strip([[5.0, 0.0], [12.0, 0.0]]),
    ]);
    assert_eq!(half_cells(places(&whole)), half_cells(places(&parts)));
    assert!((volume(&whole) / volume(&parts) - 1.0).abs() < 1e-12);
    // a circle of 20 dp, twelve faces over 60 degrees
    let (radius, angle) = (20.0, 5.0_f64.to_radians());
    let at = |k: i32| {
        let (sin, cos) = (angle * f64::from(k)).sin_cos();
        [radius * sin, radius * cos]
    };
    let arch: Vec<Vec<Vec3>> = (-6..6).map(|k| strip([at(k), at(k + 1)])).collect();
    let samples = behind(&arch);
    let inside = samples.iter().filter(|sample| {
        let x = sample.position / DP;
        (x.x / x.z).atan().abs() < 6.0 * angle
    });
    let found: f64 = inside.map(|sample| sample.volume).sum();
    // triangles of the inscribed polygon from its apothem to three layers below, and what is beside the radii at both
    // ends, where layers end straight below the edge
    let (apothem, half) = (radius * (0.5 * angle).cos(), (0.5 * angle).tan());
    let sector = 12.0 * half * (apothem.powi(2) - (apothem - 3.0).powi(2)) + 9.0 * half;
    let error = found / (sector * DP.powi(3)) - 1.0;
    println!(
        "C17 arch of 20 dp: {} points, volume {error:+.1e}",
        samples.len()
    );
    // the slices that a layer is summed over are exact where it narrows evenly
    assert!(error.abs() < 1e-9, "{error}");
    let mut by_place: Vec<Vec3> = samples.iter().map(|sample| sample.position).collect();
    by_place.sort_by(|a, b| a.x.total_cmp(&b.x));
    let near = |pair: &[Vec3]| (pair[0] - pair[1]).norm() < 0.3 * DP;
    assert!(!by_place.windows(2).any(near), "no place twice");
}

/// Of points.
fn places(samples: &[WallSample]) -> impl Iterator<Item = Vec3> {
    samples.iter().map(|sample| sample.position)
}

#[test]
fn c17_random_hulls_fill_their_shells() {
    let mut noise = Noise(170);
    for size in [2.0, 5.0, 10.0, 20.0] {
        let points: Vec<Vec3> = (0..14)
            .map(|_| noise.vector().normalize() * (size * DP))
            .collect();
        let solid = Solid::hull(&points);
        let samples = sample_convex(&solid.faces(), DP, 3.0 * DP);
        let shell = shell_volume(&solid, 3.0 * DP);
        let error = volume(&samples) / shell - 1.0;
        println!(
            "C17 hull of radius {size} dp: {} faces, {} points, volume {error:+.2e}",
            solid.0.len(),
            samples.len()
        );
        // the count over 110³ cells is good to 2e-3
        assert!(error.abs() < 1e-2);
        assert!(samples.iter().all(|s| 0.0 < solid.depth(&s.position)));
    }
}

#[test]
fn parts_of_one_plane_share_a_face() {
    let solid = Solid::cuboid([0.0; 3], [0.2, 0.16, 0.3]);
    let mut split = solid.0.clone();
    let (normal, top) = split.remove(5);
    split.push((normal, vec![top[0], top[1], top[2]]));
    split.push((normal, vec![top[0], top[2], top[3]]));
    let split = Solid(split);
    let whole = volume(&sample_convex(&solid.faces(), DP, 3.0 * DP));
    let parts = volume(&sample_convex(&split.faces(), DP, 3.0 * DP));
    assert!((parts / whole - 1.0).abs() < 1e-2, "{parts} {whole}");
}

#[test]
fn body_below_a_spacing_is_one_point() {
    let points = [Vec3::zeros(), Vec3::x(), Vec3::y(), Vec3::z()].map(|p| p * DP);
    let samples = sample_convex(&Solid::tetrahedron(points).faces(), DP, 3.0 * DP);
    assert_eq!(samples.len(), 1);
    assert!((samples[0].volume - DP.powi(3) / 6.0).abs() < 1e-18);
    assert!((samples[0].position - Vec3::repeat(0.25 * DP)).amax() < 1e-15);
}

/// Positions in units of half cells, sorted.
fn half_cells(positions: impl Iterator<Item = Vec3>) -> Vec<[i64; 3]> {
    let mut places: Vec<[i64; 3]> = positions
        .map(|x| {
            let place = x / (0.5 * DP);
            assert!((place - place.map(f64::round)).amax() < 1e-9, "{x:?}");
            place.map(|p| p.round() as i64).into()
        })
        .collect();
    places.sort_unstable();
    places
}

fn lattice(region: Region) -> UnionLattice {
    UnionLattice {
        anchor: Vec3::zeros(),
        particle_spacing: DP,
        support_radius: 3.0 * DP,
        region,
    }
}

#[test]
fn tank_of_five_slabs_continues_the_lattice() {
    let (n, t) = ([10, 6, 8], 0.1);
    let [x, y, z] = n.map(|n| f64::from(n) * DP);
    let slabs = [
        Solid::cuboid([-t, -t, -t], [x + t, y + t, 0.0]),
        Solid::cuboid([-t, -t, 0.0], [0.0, y + t, z]),
        Solid::cuboid([x, -t, 0.0], [x + t, y + t, z]),
        // the last two overlap the corners of the others and reach below the floor
        Solid::cuboid([-t, -t, -t], [x + t, 0.0, z]),
        Solid::cuboid([-t, y, -t], [x + t, y + t, z]),
    ];
    let faces = slabs.each_ref().map(Solid::faces);
    let parts = faces.each_ref().map(Vec::as_slice);
    let region = Region {
        min: Vec3::zeros(),
        max: Vec3::new(x, y, z),
    };
    let samples = sample_union(&parts, &lattice(region));
    let is_inside = |x: &Vec3| region.contains(x);
    let [nx, ny, nz] = n;
    let expected = cells([-3..nx + 3, -3..ny + 3, -3..nz]).filter(|x| !is_inside(x));
    let found = samples.iter().map(|sample| sample.sample.position);
    assert_eq!(half_cells(found), half_cells(expected));
    assert!(
        samples
            .iter()
            .all(|s| (s.sample.volume - DP.powi(3)).abs() < 1e-18)
    );
    // each belongs to the first slab it is in
    for s in &samples {
        let first = slabs
            .iter()
            .position(|slab| -1e-9 < slab.depth(&s.sample.position));
        assert_eq!(first, Some(s.part));
    }
}

#[test]
fn floors_side_by_side_are_one_floor() {
    let region = Region {
        min: Vec3::new(0.0, 0.0, 0.0),
        max: Vec3::new(0.4, 0.2, 0.2),
    };
    let whole = [Solid::cuboid([-0.1, -0.1, -0.1], [0.5, 0.3, 0.0])];
    let halves = [
        Solid::cuboid([-0.1, -0.1, -0.1], [0.213, 0.3, 0.0]),
        Solid::cuboid([0.213, -0.1, -0.1], [0.5, 0.3, 0.0]),
    ];
    let positions = |solids: &[Solid]| {
        let faces: Vec<Vec<Face>> = solids.iter().map(Solid::faces).collect();
        let parts: Vec<&[Face]> = faces.iter().map(Vec::as_slice).collect();
        let samples = sample_union(&parts, &lattice(region));
        half_cells(samples.iter().map(|s| s.sample.position))
    };
    assert_eq!(positions(&whole), positions(&halves));
    // 20 by 10 cells and three more on all sides, three layers
    assert_eq!(positions(&whole).len(), 26 * 16 * 3);
}

/// A wall that ends where the domain does is exposed on both sides: at 2.9 spacings its middle layer was near neither, and water
/// leaked through.
#[test]
fn a_slab_exposed_on_both_sides_is_filled_to_its_volume() {
    for thickness in [0.4, 1.0, 1.3, 2.0, 2.5, 2.9, 3.0, 3.005, 3.2, 4.5, 5.9, 6.0] {
        let t = thickness * DP;
        let slab = Solid::cuboid([-0.1, -0.1, 0.0], [0.5, 0.3, t]);
        let faces = slab.faces();
        let region = Region {
            min: Vec3::zeros(),
            max: Vec3::new(0.4, 0.2, 0.4),
        };
        let samples = sample_union(&[faces.as_slice()], &lattice(region));
        let is_of_a_cell =
            |x: &Vec3| (x.x - 10.5 * DP).abs() < 1e-9 && (x.y - 4.5 * DP).abs() < 1e-9;
        let column = samples.iter().filter(|s| is_of_a_cell(&s.sample.position));
        let (mut volume, mut moment) = (0.0, 0.0);
        for UnionSample { sample, .. } in column {
            volume += sample.volume;
            moment += sample.volume * (sample.position.z - 0.5 * t);
        }
        let exact = DP * DP * t;
        assert!(
            (volume / exact - 1.0).abs() < 1e-9,
            "{thickness}: {volume} {exact}"
        );
        assert!(moment.abs() < 1e-9 * exact * t, "{thickness}: {moment}");
    }
}

/// A beach of slope 1:25 on a floor, beside a wall at y = 0.1 m.
struct Beach {
    parts: [Solid; 3],
}

impl Beach {
    const TOE: f64 = 0.5;
    const END: f64 = 1.5;
    const SLOPE: f64 = 0.04;

    fn new() -> Self {
        let rise = Self::SLOPE * (Self::END - Self::TOE);
        let corner = |x: f64, y: f64, z: f64| Vec3::new(x, y, z);
        let at = |y: f64| {
            let ends = [(Self::TOE, 0.0), (Self::END, 0.0), (Self::END, rise)];
            ends.map(|(x, z)| corner(x, y, z))
        };
        let ([a, b, c], [d, e, f]) = (at(-0.3), at(0.1));
        let prism = vec![
            vec![a, b, c],
            vec![d, f, e],
            vec![a, c, f, d],
            vec![a, d, e, b],
            vec![b, e, f, c],
        ];
        Self {
            parts: [
                Solid::cuboid([-0.2, -0.3, -0.1], [1.7, 0.1, 0.0]),
                Solid::of_loops(prism),
                Solid::cuboid([-0.2, 0.1, -0.1], [1.7, 0.3, 0.4]),
            ],
        }
    }

    fn bed(x: f64) -> f64 {
        Self::SLOPE * (x.min(Self::END) - Self::TOE).max(0.0)
    }

    fn samples(&self) -> Vec<WallSample> {
        let region = Region {
            min: Vec3::new(0.0, -0.1, 0.0),
            max: Vec3::new(1.4, 0.1, 0.3),
        };
        union_samples(&self.parts, region)
    }
}

fn union_samples(solids: &[Solid], region: Region) -> Vec<WallSample> {
    let faces: Vec<Vec<Face>> = solids.iter().map(Solid::faces).collect();
    let parts: Vec<&[Face]> = faces.iter().map(Vec::as_slice).collect();
    let samples = sample_union(&parts, &lattice(region));
    samples.iter().map(|s| s.sample).collect()
}

/// `∇λ` of rows of wall along the faces of solids that touch but do not overlap.
fn gradient(solids: &[Solid], x: &Vec3, support_radius: f64) -> Vec3 {
    let space = Dimensions::Three;
    let layers = LayerTable::new(DP, support_radius, space);
    let gradient =
        |solid: &Solid| integrate(&solid.faces(), x, support_radius, space, Some(&layers)).gradient;
    solids.iter().map(gradient).sum()
}

#[test]
fn beach_on_a_floor_beside_a_wall_is_seen_as_a_solid() {
    let (beach, support) = (Beach::new(), 3.0 * DP);
    let wall = beach.samples();
    let is_wet = |x: &Vec3| 0.5 * DP - 1e-9 <= x.z - Beach::bed(x.x);
    let mut all = wall.clone();
    all.extend(
        cells([-3..73, -8..5, 0..9])
            .filter(is_wet)
            .map(fluid_sample),
    );
    // fluid on a lattice leaves gaps of up to a spacing above a slope; a plane that far below
    // leaves this: it is the fluid's start, not the wall, that does not close
    let stepped = stepped_floor_closure();
    // The second bound is for the wall alone against rows along its faces. Measured 1.05e-3 on a
    // plane, as in C03; 5.9e-3 at the toe, where 2.3 degrees between rows are left open; 1.35e-2
    // beside the wall, where the lattice of the level floor, which closes to round-off, has 1.32e-2
    // too: there the correction by faces errs, not the points.
    for (name, x, y, bound) in [
        ("floor", 3..22, -1..0, 1.2e-3),
        ("toe", 22..30, -1..0, 7e-3),
        ("slope", 30..67, -1..0, 1.2e-3),
        ("floor and wall", 3..22, 2..5, 1.5e-2),
        ("toe and wall", 22..30, 2..5, 1.5e-2),
        ("slope and wall", 30..67, 2..5, 1.5e-2),
    ] {
        let places = || cells([x.clone(), y.clone(), 0..5]).filter(is_wet);
        let (with_fluid, _) = largest(places(), |x| closure(x, &all, support));
        let (of_wall, place) = largest(places(), |x| {
            closure(x, &wall, support) - gradient(&beach.parts, x, support)
        });
        println!("beach, {name}: closure {with_fluid:.2e}, wall alone {of_wall:.2e} at {place:?}");
        let allowed = if name.starts_with("floor") {
            1e-13
        } else {
            stepped
        };
        assert!(with_fluid <= allowed, "{name} {with_fluid}");
        assert!(of_wall < bound, "{name} {of_wall}");
    }
}

/// Residual above a floor whose rows are a spacing below those that continue the fluid.
fn stepped_floor_closure() -> f64 {
    let mut points: Vec<WallSample> = cells([-4..4, -4..4, 0..8]).map(fluid_sample).collect();
    points.extend(cells([-4..4, -4..4, -5..-1]).map(fluid_sample));
    largest(cells([0..1, 0..1, 0..4]), |x| closure(x, &points, 3.0 * DP)).0
}

#[test]
fn tank_of_no_whole_number_of_spacings_is_seen_as_a_solid() {
    let (x, y) = (10.4 * DP, 9.7 * DP);
    let slabs = [
        Solid::cuboid([-0.1, -0.1, -0.1], [x + 0.1, y + 0.1, 0.0]),
        Solid::cuboid([x, -0.1, 0.0], [x + 0.1, y + 0.1, 0.2]),
        Solid::cuboid([-0.1, y, 0.0], [x, y + 0.1, 0.2]),
    ];
    let region = Region {
        min: Vec3::zeros(),
        max: Vec3::new(x, y, 0.2),
    };
    let wall = union_samples(&slabs, region);
    // half a spacing from all three walls, and further away
    let places = cells([5..10, 5..9, 0..4]);
    let (error, place) = largest(places, |x| {
        closure(x, &wall, 3.0 * DP) - gradient(&slabs, x, 3.0 * DP)
    });
    println!(
        "odd tank: {} points, wall alone {error:.2e} at {place:?}",
        wall.len()
    );
    // measured 2.0e-2 in the corner of three faces; 1.3e-2 at an edge where the lattice closes exactly
    assert!(error < 2.2e-2);
}

#[test]
fn turned_block_on_a_floor_is_seen_as_a_solid() {
    let turn = Rotation3::from_axis_angle(&Vec3::z_axis(), 0.5);
    let block = Solid::cuboid([-0.1, -0.08, 0.0], [0.1, 0.08, 0.12]);
    let solids = [
        Solid::cuboid([-0.5, -0.5, -0.1], [0.5, 0.5, 0.0]),
        block.moved(&turn, &Vec3::zeros()),
    ];
    let region = Region {
        min: Vec3::new(-0.3, -0.3, 0.0),
        max: Vec3::new(0.3, 0.3, 0.3),
    };
    let wall = union_samples(&solids, region);
    let above = wall.iter().filter(|s| 0.0 < s.position.z);
    let filled: f64 = above.map(|sample| sample.volume).sum();
    // the shell of the block: less the core 3 dp inside its sides and top
    let shell = 0.2 * 0.16 * 0.12 - 0.08 * 0.04 * 0.06;
    println!(
        "turned block: {} points, volume {:+.2e}",
        wall.len(),
        filled / shell - 1.0
    );
    // cells on the bisecting planes are counted in 64 parts, copies left out; measured 6e-3
    assert!((filled / shell - 1.0).abs() < 1e-2);
    let places = cells([-12..12, -12..12, 0..9]).filter(|x| solids[1].depth(x) < -0.5 * DP);
    let (error, place) = largest(places, |x| {
        closure(x, &wall, 3.0 * DP) - gradient(&solids, x, 3.0 * DP)
    });
    println!("turned block: wall alone {error:.2e} at {place:?}");
    // measured 5.4e-2 above the upper edges, where rows of top and sides meet at half cells; the
    // same block as a lattice of its own has 1.6e-2
    assert!(error < 6e-2);
}

/// Points of a sphere fill its shell, and a point of its surface sees of them what it would of the solid: less than the
/// half of a plane, as the sphere curves away.
#[test]
fn a_ball_is_filled_to_the_depth_of_the_support() {
    let (radius, spacing, support): (f64, f64, f64) = (1.0, 0.1, 0.26);
    let center = Vec3::new(0.3, -0.2, 0.5);
    let samples = sample_sphere(center, radius, spacing, support);
    let volume: f64 = samples.iter().map(|sample| sample.volume).sum();
    let ball = |r: f64| 4.0 / 3.0 * std::f64::consts::PI * r.powi(3);
    let shell = ball(radius) - ball(radius - 0.3);
    assert!((volume / shell - 1.0).abs() < 1e-12);
    let kernel = PointKernel::new(KernelChoice::WendlandC2, support, Dimensions::Three);
    // share of the support of a surface point inside the sphere, by slices of spheres round the point
    let n = 2000;
    let exact: f64 = (0..n)
        .map(|k| {
            let r = (f64::from(k) + 0.5) * support / f64::from(n);
            let cap = 2.0 * std::f64::consts::PI * r * r * (1.0 - r / (2.0 * radius));
            cap * kernel.value(r) * support / f64::from(n)
        })
        .sum();
    let (mut worst, mut mean): (f64, f64) = (0.0, 0.0);
    let looks = 500;
    for i in 0..looks {
        let height = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(looks);
        let across = (1.0 - height * height).sqrt();
        let (sin, cos) = (2.4 * f64::from(i)).sin_cos();
        let x = center + Vec3::new(across * cos, across * sin, height) * radius;
        let seen: f64 = samples
            .iter()
            .map(|s| s.volume * kernel.value((s.position - x).norm()))
            .sum();
        worst = worst.max((seen / exact - 1.0).abs());
        mean += seen / exact / f64::from(looks);
    }
    println!(
        "share of the support: mean {:+.2} %, worst {:.1} %",
        100.0 * (mean - 1.0),
        100.0 * worst
    );
    // a lattice's rows at half a spacing lose as much to the second order of the spacing
    assert!((mean - 1.0).abs() < 0.02, "{mean}");
    assert!(worst < 0.1, "{worst}");
}
