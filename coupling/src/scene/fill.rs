//! Water at the start: particles on a lattice, in boxes and in basins.

use std::collections::VecDeque;

use riprap_dda::{Motion, Polyhedron, Shape, Vec3};

use super::error::Problem;
use super::file::{Axis, DomainFile, FluidFile, RegionShapeFile, ResolutionFile};
use super::resolve::vec3;

/// Most lattice nodes that are looked at.
const MOST_NODES: usize = 50_000_000;
/// Depth in a block, in spacings, that a box of water may have by round-off or rough drawing.
const BOX_SLACK: f64 = 0.05;
/// Share of a spacing by which a node may be nearer to a wall than half a spacing: lattices that
/// are meant to fit are off by the digits a user types.
const WALL_SLACK: f64 = 1e-3;
/// Wanted counts are met within this share.
const COUNT_TOLERANCE: f64 = 0.01;

/// Particles at the start.
#[derive(Clone, Debug, Default)]
pub struct Lattice {
    /// Along x, y, z; a periodic direction holds a whole number of spacings; m.
    pub spacing: [f64; 3],
    /// m.
    pub positions: Vec<Vec3>,
    /// m/s.
    pub velocities: Vec<Vec3>,
    /// Highest surface of any region; m.
    pub still_water_level: f64,
    /// From there to the bottom of the lowest particle; m.
    pub depth: f64,
}

impl Lattice {
    /// Volume of a particle; m³.
    pub fn particle_volume(&self) -> f64 {
        self.spacing.iter().product()
    }

    /// Cube root of the particle volume; m.
    pub fn particle_spacing(&self) -> f64 {
        self.particle_volume().cbrt()
    }
}

/// The water of the file among the given solids.
///
/// # Errors
///
/// All [`Problem`]s: overlaps, leaks, a count that cannot be met.
pub fn lattice(
    fluid: &FluidFile,
    domain: &DomainFile,
    solids: &[(String, Shape)],
) -> Result<Lattice, Vec<Problem>> {
    match fluid.resolution {
        ResolutionFile::Spacing(spacing) => at_spacing(fluid, domain, solids, spacing),
        ResolutionFile::Count(count) => with_count(fluid, domain, solids, count),
    }
}

/// Finds the spacing that gives the wanted number of particles.
fn with_count(
    fluid: &FluidFile,
    domain: &DomainFile,
    solids: &[(String, Shape)],
    count: u32,
) -> Result<Lattice, Vec<Problem>> {
    let wanted = f64::from(count);
    let extent = vec3(domain.max) - vec3(domain.min);
    let mut spacing = (extent.product() / wanted).cbrt();
    let mut best: Option<Lattice> = None;
    // the count falls with the cube of the spacing, or its square where a slab sets the third
    // direction; a secant of the logarithms would trip over the steps, so this creeps
    for attempt in 0..40 {
        let found = at_spacing(fluid, domain, solids, spacing)?;
        let n = found.positions.len() as f64;
        let miss = |lattice: &Lattice| (lattice.positions.len() as f64 / wanted - 1.0).abs();
        let share = if n > 0.0 { n / wanted } else { 0.1 };
        if best.as_ref().is_none_or(|best| miss(&found) < miss(best)) {
            best = Some(found);
        }
        if best
            .as_ref()
            .is_some_and(|best| miss(best) < 0.1 * COUNT_TOLERANCE)
        {
            break;
        }
        let damping = if attempt < 20 { 0.4 } else { 0.2 };
        spacing *= share.powf(damping);
    }
    match best {
        Some(lattice)
            if (lattice.positions.len() as f64 / wanted - 1.0).abs() <= COUNT_TOLERANCE =>
        {
            Ok(lattice)
        }
        best => Err(vec![Problem::error(
            "fluid.resolution",
            format!(
                "no spacing gives {count} particles within 1 %; the nearest is {}; give a spacing instead",
                best.map_or(0, |lattice| lattice.positions.len())
            ),
        )]),
    }
}

fn at_spacing(
    fluid: &FluidFile,
    domain: &DomainFile,
    solids: &[(String, Shape)],
    wanted: f64,
) -> Result<Lattice, Vec<Problem>> {
    let (min, max) = (vec3(domain.min), vec3(domain.max));
    let mut spacing = [wanted; 3];
    for axis in &domain.periodic {
        let period = max[axis.index()] - min[axis.index()];
        spacing[axis.index()] = period / (period / wanted).round().max(1.0);
    }
    let mut lattice = Lattice {
        spacing,
        still_water_level: f64::NEG_INFINITY,
        ..Lattice::default()
    };
    let mut lowest = f64::INFINITY;
    let mut problems = Vec::new();
    for (index, region) in fluid.regions.iter().enumerate() {
        let path = format!("fluid.regions[{index}].shape");
        let filled = match &region.shape {
            RegionShapeFile::Box { min, max } => {
                lattice.still_water_level = lattice.still_water_level.max(max.2);
                fill_box((vec3(*min), vec3(*max)), spacing, solids, &region.name)
            }
            RegionShapeFile::Below { level, seed } => {
                lattice.still_water_level = lattice.still_water_level.max(*level);
                Basin::new(domain, spacing, *level).flood(&vec3(*seed), solids, &region.name)
            }
        };
        match filled {
            Ok(positions) => {
                lowest = positions
                    .iter()
                    .fold(lowest, |low, x| low.min(x.z - 0.5 * spacing[2]));
                let n = positions.len();
                lattice.positions.extend(positions);
                lattice
                    .velocities
                    .extend(std::iter::repeat_n(vec3(region.velocity), n));
            }
            Err(message) => problems.push(Problem::error(path, message)),
        }
    }
    if lattice.positions.is_empty() && problems.is_empty() {
        problems.push(Problem::error(
            "fluid.regions",
            "no particle fits in any region; refine `fluid.resolution` or enlarge the regions",
        ));
    }
    lattice.depth = lattice.still_water_level - lowest;
    if problems.is_empty() {
        Ok(lattice)
    } else {
        Err(problems)
    }
}

/// Cell centres of a box, which must be clear of blocks.
fn fill_box(
    (min, max): (Vec3, Vec3),
    spacing: [f64; 3],
    solids: &[(String, Shape)],
    name: &str,
) -> Result<Vec<Vec3>, String> {
    // a hair more than the extent, so that a box of whole spacings is not cut by round-off
    let counts =
        [0, 1, 2].map(|axis| ((max[axis] - min[axis]) / spacing[axis] + 1e-6).max(0.0) as usize);
    if counts.iter().product::<usize>() > MOST_NODES {
        return Err(too_many(name));
    }
    let mut positions = Vec::with_capacity(counts.iter().product());
    for k in 0..counts[2] {
        for j in 0..counts[1] {
            for i in 0..counts[0] {
                let steps = [i, j, k];
                positions.push(
                    min + Vec3::from_fn(|axis, _| (steps[axis] as f64 + 0.5) * spacing[axis]),
                );
            }
        }
    }
    for (block, solid) in solids {
        let near = Reach::of(solid, 0.0);
        let depth = positions
            .iter()
            .filter(|x| near.holds(x))
            .map(|x| -solid.signed_distance(x).distance)
            .fold(0.0, f64::max);
        if depth > BOX_SLACK * spacing[2] {
            return Err(format!(
                "fluid region `{name}` overlaps block `{block}` by {depth:.3} m; shrink the box or \
                 use Below(level, seed), which fills round blocks"
            ));
        }
    }
    Ok(positions)
}

fn too_many(name: &str) -> String {
    format!(
        "fluid region `{name}` needs more than {MOST_NODES} lattice nodes; coarsen `fluid.resolution` \
         or shrink the domain"
    )
}

/// The box in which a solid can be within a distance.
struct Reach {
    min: Vec3,
    max: Vec3,
}

impl Reach {
    fn of(solid: &Shape, distance: f64) -> Self {
        let (min, max) = solid.aabb();
        Self {
            min: min.add_scalar(-distance),
            max: max.add_scalar(distance),
        }
    }

    fn holds(&self, x: &Vec3) -> bool {
        (0..3).all(|axis| self.min[axis] <= x[axis] && x[axis] <= self.max[axis])
    }
}

/// Lattice nodes of the domain below a level.
struct Basin {
    spacing: [f64; 3],
    counts: [usize; 3],
    first: Vec3,
    periodic: [bool; 3],
}

impl Basin {
    /// The top row stands half a spacing under the level, the others below it; in the plan the
    /// first row stands half a spacing inside the domain.
    fn new(domain: &DomainFile, spacing: [f64; 3], level: f64) -> Self {
        let (min, max) = (vec3(domain.min), vec3(domain.max));
        let top = level.min(max.z);
        let counts = [
            ((max.x - min.x) / spacing[0] + 1e-6) as usize,
            ((max.y - min.y) / spacing[1] + 1e-6) as usize,
            ((top - min.z) / spacing[2] + 1e-6).max(0.0) as usize,
        ];
        let first = Vec3::new(
            min.x + 0.5 * spacing[0],
            min.y + 0.5 * spacing[1],
            top - (counts[2] as f64 - 0.5) * spacing[2],
        );
        Self {
            spacing,
            counts,
            first,
            periodic: [Axis::X, Axis::Y, Axis::Z].map(|axis| domain.periodic.contains(&axis)),
        }
    }

    fn position(&self, node: [usize; 3]) -> Vec3 {
        self.first + Vec3::from_fn(|axis, _| node[axis] as f64 * self.spacing[axis])
    }

    fn index(&self, node: [usize; 3]) -> usize {
        (node[2] * self.counts[1] + node[1]) * self.counts[0] + node[0]
    }

    /// The node one step along an axis, round the periodic directions; `None` past an edge.
    fn step(&self, node: [usize; 3], axis: usize, forward: bool) -> Option<[usize; 3]> {
        let n = self.counts[axis];
        let mut next = node;
        next[axis] = match (forward, node[axis]) {
            (true, at) if at + 1 < n => at + 1,
            (false, at) if at > 0 => at - 1,
            (true, _) if self.periodic[axis] => 0,
            (false, _) if self.periodic[axis] => n - 1,
            _ => return None,
        };
        Some(next)
    }

    /// All nodes that water from `seed` reaches.
    fn flood(
        &self,
        seed: &Vec3,
        solids: &[(String, Shape)],
        name: &str,
    ) -> Result<Vec<Vec3>, String> {
        if self.counts.contains(&0) {
            return Err(format!(
                "fluid region `{name}`: no lattice row fits between the bottom of the domain and the level"
            ));
        }
        if self.counts.iter().product::<usize>() > MOST_NODES {
            return Err(too_many(name));
        }
        let dp = self.spacing.iter().product::<f64>().cbrt();
        let near: Vec<(Reach, &Shape)> = solids
            .iter()
            .map(|(_, solid)| (Reach::of(solid, dp), solid))
            .collect();
        let clearance = (0.5 - WALL_SLACK) * dp;
        let is_free = |x: &Vec3| {
            !near
                .iter()
                .any(|(reach, solid)| reach.holds(x) && is_within(solid, x, clearance))
        };
        let start = [0, 1, 2].map(|axis| {
            let place = (seed[axis] - self.first[axis]) / self.spacing[axis];
            (place.round().max(0.0) as usize).min(self.counts[axis] - 1)
        });
        if seed.z > self.first.z + (self.counts[2] as f64 - 0.5) * self.spacing[2] {
            return Err(format!(
                "fluid region `{name}`: the seed at z = {} m is above the level",
                seed.z
            ));
        }
        if !is_free(&self.position(start)) {
            return Err(format!(
                "fluid region `{name}`: the seed ({}, {}, {}) m is inside or within half a spacing of a block",
                seed.x, seed.y, seed.z
            ));
        }
        let mut wet = vec![false; self.counts.iter().product()];
        let mut queue = VecDeque::from([start]);
        wet[self.index(start)] = true;
        while let Some(node) = queue.pop_front() {
            for (axis, forward) in (0..3).flat_map(|axis| [(axis, false), (axis, true)]) {
                let Some(next) = self.step(node, axis, forward) else {
                    let x = self.position(node);
                    let mut outside = x;
                    outside[axis] += if forward {
                        self.spacing[axis]
                    } else {
                        -self.spacing[axis]
                    };
                    // upward there is air, not an edge; a wall may stand at the edge itself
                    if (axis == 2 && forward) || !is_free(&outside) {
                        continue;
                    }
                    return Err(format!(
                        "fluid region `{name}` leaks out of the domain at ({:.3}, {:.3}, {:.3}) m; \
                         blocks must close the basin below its level",
                        x.x, x.y, x.z
                    ));
                };
                let index = self.index(next);
                let (from, to) = (self.position(node), self.position(next));
                // half way the water must find room too, or it would pass plates thinner than a
                // spacing; a node beside such a plate is clear of it by half a spacing only
                let middle = 0.5 * (from + to);
                let wraps = (to - from).norm() > 1.5 * self.spacing[axis];
                let is_open = |x: &Vec3| {
                    !near
                        .iter()
                        .any(|(reach, solid)| reach.holds(x) && is_within(solid, x, 0.0))
                };
                if !wet[index] && is_free(&to) && (wraps || is_open(&middle)) {
                    wet[index] = true;
                    queue.push_back(next);
                }
            }
        }
        let mut positions = Vec::new();
        for k in 0..self.counts[2] {
            for j in 0..self.counts[1] {
                for i in 0..self.counts[0] {
                    if wet[self.index([i, j, k])] {
                        positions.push(self.position([i, j, k]));
                    }
                }
            }
        }
        Ok(positions)
    }
}

/// Whether a point is nearer to a solid than a distance.
fn is_within(solid: &Shape, x: &Vec3, distance: f64) -> bool {
    match solid {
        Shape::Polyhedra(parts) => parts.iter().any(|part: &Polyhedron| {
            part.surface_point_within(x, distance)
                .is_some_and(|surface| surface.distance < distance)
        }),
        Shape::Sphere { center, radius } => (x - center).norm() - radius < distance,
    }
}

/// Free blocks that overlap others at the start by more than a thousandth of their size.
///
/// Vertices and centroids of one body inside the other are looked at: what contact would throw
/// apart. Touching blocks do not overlap.
pub fn overlaps(solids: &[(String, Shape)], motions: &[Motion]) -> Vec<Problem> {
    let mut problems = Vec::new();
    for (i, (name, solid)) in solids.iter().enumerate() {
        if !matches!(motions[i], Motion::Free) {
            continue;
        }
        for (j, (other_name, other)) in solids.iter().enumerate() {
            if i == j || (j < i && matches!(motions[j], Motion::Free)) {
                continue;
            }
            let size = solid.volume().min(other.volume()).cbrt();
            let depth = depth_of(solid, other).max(depth_of(other, solid));
            let message = format!(
                "block `{name}` overlaps block `{other_name}` by {depth:.3e} m, {:.2} % of the smaller size",
                100.0 * depth / size
            );
            let path = format!("blocks[{i}].placement");
            if depth > 1e-2 * size {
                problems.push(Problem::error(path, message + "; move them apart"));
            } else if depth > 1e-6 * size {
                problems.push(Problem::warning(
                    path,
                    message + ": they will push each other apart",
                ));
            }
        }
    }
    problems
}

/// Depth of the deepest vertex, or centre, of `body` in `other`.
fn depth_of(body: &Shape, other: &Shape) -> f64 {
    let depth = |x: &Vec3| -other.signed_distance(x).distance;
    match body {
        Shape::Polyhedra(parts) => parts
            .iter()
            .flat_map(|part| part.vertices())
            .map(depth)
            .fold(0.0, f64::max),
        Shape::Sphere { center, radius } => (depth(center) + radius).max(0.0),
    }
}

#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    reason = "a test may stop where a library may not"
)]
mod tests {
    use super::*;
    use crate::scene::file::{Leaving, RegionFile};

    fn domain(periodic: Vec<Axis>) -> DomainFile {
        DomainFile {
            min: (0.0, 0.0, -0.5),
            max: (4.0, 0.4, 2.0),
            periodic,
            leaving: Leaving::Removed,
        }
    }

    fn fluid(shape: RegionShapeFile, resolution: ResolutionFile) -> FluidFile {
        FluidFile {
            density: 1000.0,
            dynamic_viscosity: 1.0,
            resolution,
            regions: vec![RegionFile {
                name: "lake".into(),
                shape,
                velocity: (0.0, 0.0, 0.0),
            }],
        }
    }

    fn cuboid(name: &str, min: [f64; 3], max: [f64; 3]) -> (String, Shape) {
        let solid = Polyhedron::cuboid(Vec3::from(min), Vec3::from(max)).unwrap();
        (name.into(), Shape::Polyhedra(vec![solid]))
    }

    /// A trough from x = 0.5 to 3.5 with its floor at z = 0, open to y.
    fn trough() -> Vec<(String, Shape)> {
        vec![
            cuboid("floor", [-1.0, -1.0, -1.0], [5.0, 1.4, 0.0]),
            cuboid("left", [-1.0, -1.0, -1.0], [0.5, 1.4, 3.0]),
            cuboid("right", [3.5, -1.0, -1.0], [5.0, 1.4, 3.0]),
        ]
    }

    fn below(level: f64) -> RegionShapeFile {
        RegionShapeFile::Below {
            level,
            seed: (2.0, 0.2, 0.5),
        }
    }

    #[test]
    fn a_periodic_trough_fills_to_its_volume() {
        let fluid = fluid(below(1.0), ResolutionFile::Spacing(0.1));
        let lattice = lattice(&fluid, &domain(vec![Axis::Y]), &trough()).unwrap();
        // 3 m x 0.4 m x 1 m in cubes of 0.1 m, which fit exactly
        assert_eq!(lattice.positions.len(), 30 * 4 * 10);
        assert!((lattice.depth - 1.0).abs() < 1e-12);
    }

    #[test]
    fn an_open_basin_names_its_leak() {
        let fluid = fluid(below(1.0), ResolutionFile::Spacing(0.1));
        let problems = lattice(&fluid, &domain(vec![]), &trough()).unwrap_err();
        assert!(
            problems[0].message.contains("leaks out of the domain at ("),
            "{problems:?}"
        );
    }

    #[test]
    fn a_plate_thinner_than_a_spacing_keeps_water_out() {
        let mut solids = trough();
        solids.push(cuboid("plate", [2.49, -1.0, -1.0], [2.51, 1.4, 3.0]));
        let fluid = fluid(below(1.0), ResolutionFile::Spacing(0.1));
        let lattice = lattice(&fluid, &domain(vec![Axis::Y]), &solids).unwrap();
        assert!(lattice.positions.iter().all(|x| x.x < 2.5));
    }

    #[test]
    fn a_wanted_count_is_met_within_a_percent() {
        for count in [1000, 5000, 24_000] {
            let fluid = fluid(below(1.03), ResolutionFile::Count(count));
            let lattice = lattice(&fluid, &domain(vec![Axis::Y]), &trough()).unwrap();
            let share = lattice.positions.len() as f64 / f64::from(count);
            assert!((share - 1.0).abs() <= 0.01, "{count}: {share}");
        }
    }

    #[test]
    fn a_box_that_overlaps_a_block_says_by_how_much() {
        let shape = RegionShapeFile::Box {
            min: (0.0, 0.0, 0.0),
            max: (2.0, 0.4, 1.0),
        };
        let fluid = fluid(shape, ResolutionFile::Spacing(0.1));
        let problems = lattice(&fluid, &domain(vec![Axis::Y]), &trough()).unwrap_err();
        // the deepest node stands 0.45 m inside the left wall
        let expected = "fluid region `lake` overlaps block `left` by 0.450 m";
        assert!(problems[0].message.contains(expected), "{problems:?}");
    }

    #[test]
    fn no_particle_is_nearer_to_a_slope_than_half_a_spacing() {
        let mut solids = trough();
        let beach =
            Polyhedron::extrusion(&[[1.0, 0.0], [3.5, 1.5], [3.5, 0.0]], 1, -1.0, 1.4).unwrap();
        solids.push(("beach".into(), Shape::Polyhedra(beach)));
        let fluid = fluid(below(1.0), ResolutionFile::Spacing(0.04));
        let lattice = lattice(&fluid, &domain(vec![Axis::Y]), &solids).unwrap();
        let nearest = lattice
            .positions
            .iter()
            .flat_map(|x| solids.iter().map(|(_, s)| s.signed_distance(x).distance))
            .fold(f64::INFINITY, f64::min);
        assert!(nearest >= 0.02 * (1.0 - 2.0 * WALL_SLACK), "{nearest}");
        // trough 3 m x 1 m less the beach's wedge under the level; a row is lost at most on the
        // 1.94 m of wetted slope
        let exact = (3.0 - 0.5 * (1.0 / 0.6) - (2.5 - 1.0 / 0.6)) * 0.4;
        let volume = lattice.positions.len() as f64 * lattice.particle_volume();
        assert!(
            volume <= exact && exact - volume < 1.94 * 0.04 * 0.4,
            "{volume} of {exact}"
        );
    }
}
