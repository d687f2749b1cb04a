//! Hollows under a block that particles cannot enter.
//!
//! A block that bridges a bend or a trough closes it with its rims. Particles do not come in but for a few, and without their pressure
//! the water on top of the block would hold it down. Such a hollow is deeper than a joint, but full of water as one.

use riprap_dda::Blocks;
use riprap_sph::Fluid;

use super::{DRY, JointWater, Scratch};

/// Largest depth of a hollow, in spacings; full pressure up to one less. Deeper ones without particles hold air.
pub(super) const REACH: f64 = 4.0;

/// Space ahead of a point without a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Space {
    /// A joint, or a pore.
    Narrow,
    /// Water or air that has room for particles.
    Open,
    /// A hollow of a depth (m), with the solid at its bottom.
    Hollow(f64, u32),
    /// One that was looked at.
    Seen,
}

/// Scratch of the search.
#[derive(Clone, Debug, Default)]
pub(super) struct Hollows {
    /// One per active point.
    spaces: Vec<Space>,
    /// Connected points of one hollow: index among the active ones, depth and solid.
    connected: Vec<(usize, f64, u32)>,
}

impl JointWater {
    /// Makes hollows joints where they are closed on all sides by joints of the same face; after the water at the points.
    pub(super) fn find_hollows(&mut self, fluid: &Fluid, blocks: &Blocks) {
        let Scratch {
            near_faces,
            near_parts,
            active,
            faces,
            positions,
            normals,
            ahead,
            hollows,
            ..
        } = &mut self.scratch;
        let surroundings = |n: usize| {
            let around = (blocks, near_parts.as_slice(), fluid.settings().domain);
            near_faces[faces[n] as usize].surroundings(around, false, self.spacing)
        };
        let Hollows { spaces, connected } = hollows;
        spaces.clear();
        spaces.extend(ahead.iter().enumerate().map(|(n, ahead)| {
            if ahead.joint.is_some() || (ahead.water[0] < DRY && ahead.is_pore) {
                return Space::Narrow;
            }
            let reach = REACH * self.spacing;
            match surroundings(n).joint(&positions[n], &normals[n], reach) {
                Some((depth, solid)) => Space::Hollow(depth, solid),
                None => Space::Open,
            }
        }));
        let is_outside = |n: usize| {
            let point = &self.points[active[n] as usize];
            point.across.is_some_and(|across| {
                let around = surroundings(n);
                let across = blocks.orientation(around.block) * across;
                around.is_open(&around.beside(&positions[n], &normals[n], &across))
            })
        };
        for first in 0..spaces.len() {
            let Space::Hollow(depth, solid) = spaces[first] else {
                continue;
            };
            spaces[first] = Space::Seen;
            connected.clear();
            connected.push((first, depth, solid));
            let (mut next, mut is_closed) = (0, true);
            while let Some(&(n, ..)) = connected.get(next) {
                next += 1;
                is_closed &= !is_outside(n);
                let k = active[n] as usize;
                for &(other, _) in &self.neighbors[k] {
                    // the points of a face follow each other
                    let m = n + other as usize - k;
                    match spaces[m] {
                        Space::Hollow(depth, solid) => {
                            spaces[m] = Space::Seen;
                            connected.push((m, depth, solid));
                        }
                        Space::Open => is_closed = false,
                        Space::Narrow | Space::Seen => {}
                    }
                }
            }
            if is_closed {
                for &(n, depth, solid) in connected.iter() {
                    ahead[n].joint = Some((depth, solid));
                    ahead[n].is_hollow = true;
                }
            }
        }
    }
}
