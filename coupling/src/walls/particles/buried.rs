//! Points of moving blocks inside fixed solids, which are no walls there.
//!
//! Each point stands for a cell. Where a fixed solid covers some of the cell, what is left of its volume is outside, and the
//! point moves to the center of that: a foot drawn into the bed by any fraction of a spacing leaves neither a hole in the corner,
//! into which water is drawn, nor a wall twice.
//!
//! ```text
//! C = Σ_solids Π_planes f,   f = clamp(½ − h/(2 r), 0, 1)      share of a cell that disjoint convex solids cover
//! V = V₀ (1 − C),   x = x₀ + r/(1 − C) Σ_solids Π f Σ_planes (1 − f) n
//! ```
//! `h` is the height of the point above a plane with the normal `n`, and `r` half a spacing, or the depth of the point in its own
//! block if that is less: a block that only touches keeps all of its points. That is exact for cells along the planes. Planes at
//! less than 60° count as one, that which covers least, and what contacts may press does not count: `C` begins there.

use riprap_dda::{BlockDefinition, Blocks, Shape};
use riprap_sph::Vec3;
use riprap_sph::boundary::thin_solids::Facet;

use super::Frame;
use super::points::Points;
use crate::walls::cutting::{clipped_by_symmetry, disjoint};
use crate::walls::sampler::Sampler;
use crate::walls::{Part, parts};

/// Depth of overlap that contacts may press, in spacings.
const PRESSED: f64 = 0.02;
/// Cosine between the normals of planes that count as one.
const ALIKE: f64 = 0.5;

/// The cells of moving points, except those of thin solids, and how much of each is inside a fixed solid.
#[derive(Clone, Debug)]
pub(super) struct Buried {
    /// m³.
    volumes: Vec<f64>,
    /// Half of the width of each cell; none for thin solids, which end at the bed in their own way; m.
    half_widths: Vec<Option<f64>>,
    /// m.
    pressed: f64,
    pub(super) cells: Vec<Cell>,
    /// Whether any cell is covered, or was when points were placed last.
    pub(super) is_any: bool,
    fixed: Vec<Solid>,
    /// Solids near a block.
    near: Vec<usize>,
}

/// What is left of a cell outside of fixed solids.
#[derive(Clone, Copy, Debug, serde::Serialize, serde::Deserialize)]
pub(super) struct Cell {
    /// Share of the volume.
    left: f64,
    /// From the point to the center of what is left; m.
    shift: Vec3,
}

impl Cell {
    const WHOLE: Self = Self {
        left: 1.0,
        shift: Vec3::new(0.0, 0.0, 0.0),
    };
}

/// A convex fixed solid: normals and offsets (m) of its planes, and its box (m).
#[derive(Clone, Debug)]
struct Solid {
    planes: Vec<(Vec3, f64)>,
    aabb: (Vec3, Vec3),
}

impl Buried {
    /// Whole cells, before points are placed.
    pub(super) fn new(
        points: &Points,
        (definitions, blocks): (&[BlockDefinition], &Blocks),
        (standing, sampler): (&[Part], &Sampler),
    ) -> Self {
        let spacing = sampler.lattice.particle_spacing;
        let endless = |part: &Part| sampler.endless.without_ends(part);
        let fixed = if points.blocks.is_empty() {
            Vec::new()
        } else {
            let solids = disjoint(standing.iter().map(endless).collect());
            solids.iter().map(Solid::of).collect()
        };
        let of_block = |definition: &BlockDefinition| -> Vec<Part> {
            let parts = parts(&definition.shape).into_iter();
            let parts = parts.filter_map(|part| clipped_by_symmetry(&part, &sampler.symmetry));
            parts.map(|part| endless(&part)).collect()
        };
        let own: Vec<Vec<Part>> = (definitions.iter().enumerate())
            .map(|(b, definition)| match blocks.is_fixed(b) {
                true => Vec::new(),
                false => of_block(definition),
            })
            .collect();
        let depth = |b: usize, x: &Vec3| match &definitions[b].shape {
            Shape::Sphere { center, radius } => radius - (x - center).norm(),
            _ => (own[b].iter().filter_map(|part| part.nearest_plane(x)))
                .fold(0.0, |depth, (_, height)| f64::max(depth, -height)),
        };
        let placed = points.blocks.iter().zip(&points.samples);
        let half_widths = placed.zip(&points.facets).map(|((&b, sample), &facet)| {
            let within = |depth: f64| depth.clamp(PRESSED * spacing, 0.5 * spacing);
            (facet == Facet::NONE).then(|| within(depth(b as usize, &sample.position)))
        });
        Self {
            volumes: points.samples.iter().map(|s| s.volume).collect(),
            half_widths: half_widths.collect(),
            pressed: PRESSED * spacing,
            cells: vec![Cell::WHOLE; points.blocks.len()],
            is_any: false,
            fixed,
            near: Vec::new(),
        }
    }

    /// Finds what is left of the cells of points of blocks in order, where these are.
    pub(super) fn find(
        &mut self,
        block: &[u32],
        local: &[Vec3],
        (frames, blocks): (&[Frame], &Blocks),
    ) {
        let had_any = std::mem::take(&mut self.is_any);
        let mut first = 0;
        for of_block in block.chunk_by(|a, b| a == b) {
            let points = first..first + of_block.len();
            first = points.end;
            let b = of_block[0] as usize;
            let is_near = |&solid: &usize| {
                let (low, high) = &self.fixed[solid].aabb;
                let depth = self.pressed;
                blocks.parts_of(b).any(|own| {
                    let (min, max) = blocks.part_aabb(own);
                    (0..3).all(|k| low[k] + depth < max[k] && min[k] + depth < high[k])
                })
            };
            self.near.clear();
            self.near.extend((0..self.fixed.len()).filter(is_near));
            for w in points {
                self.cells[w] = match self.half_widths[w] {
                    Some(half_width) if !self.near.is_empty() => {
                        self.outside(&frames[b].place(&local[w]), half_width)
                    }
                    _ => Cell::WHOLE,
                };
                self.is_any |= self.cells[w].left < 1.0;
            }
        }
        self.is_any |= had_any;
    }

    /// What is left of the cell at a point (m).
    fn outside(&self, x: &Vec3, half_width: f64) -> Cell {
        let (mut covered, mut moment) = (0.0, Vec3::zeros());
        for &solid in &self.near {
            let (share, of_rest) = self.fixed[solid].cover(x, half_width);
            covered += share;
            moment += of_rest;
        }
        let pressed = self.pressed / (2.0 * half_width);
        if covered <= pressed {
            return Cell::WHOLE;
        }
        let counted = (covered - pressed) / (1.0 - pressed);
        moment *= counted / covered;
        let left = 1.0 - counted;
        match left {
            // round-off
            left if left < 1e-9 => Cell {
                left: 0.0,
                ..Cell::WHOLE
            },
            left => Cell {
                left,
                shift: moment / left,
            },
        }
    }

    /// Volume of a point, in m³.
    pub(super) fn volume(&self, w: usize) -> f64 {
        self.volumes[w] * self.cells[w].left
    }

    /// From the middle of the cell of a point to where it is; m.
    pub(super) fn shift(&self, w: usize) -> Vec3 {
        self.cells[w].shift
    }
}

impl Solid {
    fn of(part: &Part) -> Self {
        let faces = part.faces.iter();
        let planes = faces.filter_map(|(normal, corners)| {
            let offset = normal.dot(corners.first()?);
            Some((*normal, offset))
        });
        Self {
            planes: planes.collect(),
            aabb: part.aabb(),
        }
    }

    /// Share of a cell that is inside, and the first moment (m) of the rest, in cells, about the point.
    fn cover(&self, x: &Vec3, half_width: f64) -> (f64, Vec3) {
        let nothing = (0.0, Vec3::zeros());
        let height = |(normal, offset): &(Vec3, f64)| normal.dot(x) - offset;
        if self.planes.iter().any(|plane| half_width <= height(plane)) {
            return nothing;
        }
        let inside = |height: f64| (0.5 - height / (2.0 * half_width)).min(1.0);
        let (mut share, mut toward) = (1.0, Vec3::zeros());
        // square of the distance to an edge
        let mut beside = 0.0;
        for (k, plane) in self.planes.iter().enumerate() {
            let own = height(plane);
            let f = inside(own);
            let counts_more = |(other, next): (usize, &(Vec3, f64))| {
                let height = height(next);
                other != k
                    && ALIKE < next.0.dot(&plane.0)
                    && (own < height || (own == height && other < k))
            };
            if f < 1.0 && !self.planes.iter().enumerate().any(counts_more) {
                share *= f;
                toward += plane.0 * (1.0 - f);
                beside += own.max(0.0).powi(2);
            }
        }
        match beside.sqrt() < half_width {
            true => (share, toward * (share * half_width)),
            false => nothing,
        }
    }
}

#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    reason = "a test stops at the first thing that is wrong"
)]
mod tests {
    use super::*;
    use crate::run::world_of;
    use crate::walls::Walls;
    use crate::world::World;

    const DP: f64 = 0.1;
    const WIDTH: f64 = 0.6;

    /// A moving box of four spacings by four, its foot at a height, on a bed of some boxes.
    fn on_bed(foot: f64, dimensions: &str, bed: &[&str]) -> World {
        let bed: String = (bed.iter().enumerate())
            .map(|(k, shape)| {
                format!("(name: \"bed{k}\", material: \"m\", motion: Fixed, shape: {shape}),")
            })
            .collect();
        let text = format!(
            "(title: \"foot\", domain: (min: (-2, 0, -1), max: (2, {WIDTH}, 2), {dimensions}),
             materials: [(name: \"m\", density: 2000, friction_angle_deg: 30)],
             blocks: [(name: \"paddle\", material: \"m\", motion: Sinusoid(direction: (1, 0, 0), amplitude: 0.1, period: 4),
                       shape: Box(min: (-0.4, -1, {foot}), max: (0, 2, {}))), {bed}],
             fluid: (resolution: Spacing({DP}), regions: [
                 (name: \"water\", shape: Box(min: (0, 0, 0), max: (1, {WIDTH}, 0.5)))]),
             numerics: (sound_speed: 20), time: (duration: 1))",
            foot + 0.4,
        );
        world_of(&text)
    }

    /// Volume and first moment of the points of moving blocks; m³, m⁴.
    fn volume_and_moment(world: &World) -> (f64, Vec3) {
        let Some(Walls::Particles(walls)) = &world.water.as_ref().unwrap().walls else {
            unreachable!("walls of particles are the default");
        };
        let points = walls.moving.positions().iter().zip(walls.moving.volumes());
        points.fold((0.0, Vec3::zeros()), |(volume, moment), (x, v)| {
            (volume + v, moment + x * *v)
        })
    }

    /// In a bed of one box, of two side by side, and of two that overlap: wherever its foot is, a block has the volume, and the
    /// center, of what is outside.
    #[test]
    fn of_a_block_in_its_bed_what_is_outside_counts() {
        let whole = "Box(min: (-3, -1, -1), max: (3, 2, 0))";
        let halves = [
            "Box(min: (-3, -1, -1), max: (-0.23, 2, 0))",
            "Box(min: (-0.23, -1, -1), max: (3, 2, 0))",
        ];
        let overlapping = ["Box(min: (-3, -1, -1), max: (-0.1, 2, 0))", halves[1]];
        for dimensions in ["dimensions: Two", "periodic: [Y]"] {
            for bed in [&[whole][..], &halves, &overlapping] {
                for k in 0..=20 {
                    let depth = 0.15 * DP * f64::from(k);
                    let height = 0.4 - depth;
                    let (volume, moment) = volume_and_moment(&on_bed(-depth, dimensions, bed));
                    let (expected, middle) = (
                        0.4 * WIDTH * height,
                        Vec3::new(-0.2, 0.5 * WIDTH, 0.5 * height),
                    );
                    // what contacts press is not cut off
                    let pressed = 1.01 * PRESSED * DP;
                    let off = (volume - expected).abs();
                    assert!(
                        off <= 0.4 * WIDTH * pressed,
                        "{dimensions} {bed:?} {depth} {off}"
                    );
                    let off = (moment / volume - middle).norm();
                    assert!(off <= pressed, "{dimensions} {bed:?} {depth} {off}");
                }
            }
        }
    }

    /// A block that touches its bed, and one that hangs over the edge of a step beside it, have all of their points, as they were.
    #[test]
    fn of_a_block_that_touches_all_counts() {
        let alone = on_bed(
            0.0,
            "periodic: [Y]",
            &["Box(min: (1, -1, -1), max: (3, 2, 0))"],
        );
        let slope = "Extrusion(polygon: [(-3, 0.9), (-0.2, 0), (-0.2, -1), (-3, -1)], axis: Y, from: -1, to: 2)";
        let lower = "Box(min: (-3, -1, -1), max: (3, 2, -0.03))";
        for bed in [
            &["Box(min: (-3, -1, -1), max: (3, 2, 0))"][..],
            &["Box(min: (-3, -1, -1), max: (-0.27, 2, 0))", lower],
            &["Box(min: (-3, -1, -1), max: (-0.4, 2, 1))"],
        ] {
            let on = on_bed(0.0, "periodic: [Y]", bed);
            assert_eq!(volume_and_moment(&on), volume_and_moment(&alone), "{bed:?}");
        }
        let (volume, _) = volume_and_moment(&on_bed(0.0, "periodic: [Y]", &[slope]));
        assert!(volume < volume_and_moment(&alone).0);
    }
}
