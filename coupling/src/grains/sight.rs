//! Walls around a grain: the water that they hide from it, and its images in them.
//!
//! A kernel that a wall cuts is completed by the image of the grain in the wall, in a corner by the images of the image. Water in front of the
//! wall then sees as much of a bed of grains as far from it, and a grain beside the wall is seen with all of its volume: porosity has no
//! gradient at walls, which would be a pressure.

use riprap_dda::{Blocks, Vec3};

use super::Grain;

/// Cosine between the normals of two walls above which they are one wall.
const PARALLEL: f64 = 0.95;
/// Most walls that are near a grain; the nearest count.
const MOST: usize = 8;
/// Most walls in which a grain has images: those of a corner.
const MOST_MIRRORS: usize = 3;
/// Most images, the grain itself among them.
const MOST_IMAGES: usize = 1 << MOST_MIRRORS;

/// Parts of all blocks that are not grains.
#[derive(Clone, Debug)]
pub(super) struct Sight {
    parts: Vec<usize>,
}

/// A wall near a grain.
#[derive(Clone, Copy, Debug, Default)]
struct Near {
    part: usize,
    /// m.
    distance: f64,
    /// Toward the grain.
    normal: Vec3,
    point: Vec3,
}

/// Walls near a grain.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct View {
    near: [Near; MOST],
    n: usize,
    images: [Vec3; MOST_IMAGES],
    n_images: usize,
}

impl Sight {
    pub(super) fn new(grains: &[usize], blocks: &Blocks) -> Self {
        let is_grain = |part: &usize| grains.binary_search(&blocks.block_of_part(*part)).is_ok();
        Self {
            parts: (0..blocks.n_parts())
                .filter(|part| !is_grain(part))
                .collect(),
        }
    }

    /// Walls within the kernel of a grain.
    pub(super) fn of(&self, blocks: &Blocks, grain: &Grain) -> View {
        let (x, reach) = (blocks.centroid(grain.block), grain.reach);
        let mut view = View::default();
        for &part in &self.parts {
            let (min, max) = blocks.part_aabb(part);
            let outside = (min - x).sup(&(x - max)).sup(&Vec3::zeros());
            if reach * reach <= outside.norm_squared() {
                continue;
            }
            let Some(at) = blocks.surface_point_within(part, &x, reach) else {
                continue;
            };
            view.add(Near {
                part,
                distance: at.distance.max(0.0),
                normal: at.normal,
                point: at.point,
            });
        }
        view.reflect(x);
        view
    }
}

impl View {
    fn add(&mut self, wall: Near) {
        if self.n < MOST {
            self.near[self.n] = wall;
            self.n += 1;
            return;
        }
        let farthest = self
            .near
            .iter_mut()
            .max_by(|a, b| a.distance.total_cmp(&b.distance));
        if let Some(farthest) = farthest.filter(|farthest| wall.distance < farthest.distance) {
            *farthest = wall;
        }
    }

    /// Images of a grain at `x` (m) in the nearest walls of different directions.
    fn reflect(&mut self, x: Vec3) {
        let near = &mut self.near[..self.n];
        near.sort_unstable_by(|a, b| a.distance.total_cmp(&b.distance).then(a.part.cmp(&b.part)));
        self.images[0] = x;
        self.n_images = 1;
        for (k, wall) in near.iter().enumerate() {
            let is_known = near[..k]
                .iter()
                .any(|one| PARALLEL < one.normal.dot(&wall.normal));
            if is_known || self.n_images == MOST_IMAGES {
                continue;
            }
            for image in 0..self.n_images {
                let of = self.images[image];
                let height = (of - wall.point).dot(&wall.normal);
                self.images[self.n_images + image] = of - wall.normal * (2.0 * height);
            }
            self.n_images *= 2;
        }
    }

    /// The grain and its images; m.
    pub(super) fn images(&self) -> &[Vec3] {
        &self.images[..self.n_images]
    }

    /// Whether any wall may hide any of some places from a grain at `x` (m): those behind a plane in front of it. The places are from
    /// the grain, an axis a column, to within an error; m.
    pub(super) fn may_hide(&self, x: &Vec3, offsets: [&[f32]; 3], error: f64) -> bool {
        let [dx, dy, dz] = offsets;
        self.near[..self.n].iter().any(|wall| {
            let normal: [f32; 3] = std::array::from_fn(|axis| wall.normal[axis] as f32);
            let least = (error - (x - wall.point).dot(&wall.normal)) as f32;
            let heights = dx.iter().zip(dy).zip(dz);
            let heights =
                heights.map(|((dx, dy), dz)| dx * normal[0] + dy * normal[1] + dz * normal[2]);
            // without leaving early, which would keep it from being done several at a time
            heights.fold(false, |is_behind, height| is_behind | (height < least))
        })
    }

    /// Whether a grain at `x` sees the place `y`; m.
    pub(super) fn sees(&self, blocks: &Blocks, x: &Vec3, y: &Vec3) -> bool {
        self.near[..self.n].iter().all(|wall| {
            // what is in front of the plane between the grain and a convex wall is in sight
            let is_in_front = 0.0 <= (y - wall.point).dot(&wall.normal);
            is_in_front || blocks.passage(wall.part, x, y).is_none()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn wall(part: usize, normal: Vec3, distance: f64) -> Near {
        Near {
            part,
            distance,
            normal,
            point: -normal * distance,
        }
    }

    #[test]
    fn a_corner_has_the_images_of_images() {
        let mut view = View::default();
        // a floor of two blocks, and a wall
        view.add(wall(0, Vec3::z(), 0.1));
        view.add(wall(1, Vec3::z(), 0.1));
        view.add(wall(2, Vec3::x(), 0.2));
        view.reflect(Vec3::zeros());
        let expected = [
            Vec3::zeros(),
            Vec3::new(0.0, 0.0, -0.2),
            Vec3::new(-0.4, 0.0, 0.0),
            Vec3::new(-0.4, 0.0, -0.2),
        ];
        assert_eq!(view.images(), expected);
    }

    #[test]
    fn only_what_is_behind_a_plane_may_be_hidden() {
        let mut view = View::default();
        view.add(wall(0, Vec3::z(), 0.1));
        let may_hide =
            |z: [f32; 3]| view.may_hide(&Vec3::zeros(), [&[0.3, -0.2, 0.0], &[0.1; 3], &z], 1e-6);
        assert!(!may_hide([0.2, -0.05, -0.0999]));
        assert!(may_hide([0.2, -0.11, 0.05]));
        // within the error of a place
        assert!(may_hide([0.2, 0.0, -0.099_999_5]));
        assert!(!View::default().may_hide(&Vec3::zeros(), [&[-1.0]; 3], 1e-6));
    }
}
