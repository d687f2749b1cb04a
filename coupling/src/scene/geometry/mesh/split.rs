//! Convex parts of a shell that is not convex.
//!
//! Planes cut the solid, one part at a time, until the hulls of the parts have little more volume than the solid. Each cut is the
//! one of the planes of [`candidates`] that removes the most volume from the hulls. As candidates go through the notches of the
//! shell, a body with plane sides becomes exact parts: an L becomes two boxes. Hulls touch, but do not overlap, because each stays
//! in its cell of the planes. A first cut through a ring removes nothing from its hull: where no plane gains, a hollow part is
//! halved.
//!
//! Departure from approximate convex decomposition by voxels (Mamou & Ghorbel 2009): their planes are parallel to the coordinate
//! axes and half a voxel off the notches, so that parts have other volumes, and slivers between them.

mod candidates;

use riprap_dda::{Plane, Polyhedron, PolyhedronError, Surface, Vec3, clipped_polygon, volume};

use super::Soup;
use super::shells::{Shell, weld};
use crate::scene::access::fault::Fault;
use crate::scene::file::SplitFile;
use candidates::Candidates;

/// Distance of points from a plane on which they lie; × size of the shell.
const ON_PLANE: f64 = 1e-9;
/// Gain of a cut below which it is none; × volume of the shell.
const LEAST_GAIN: f64 = 1e-6;
/// Depth of the surface within a hull below which a part is not hollow; × size of the shell.
const HOLLOW: f64 = 1e-3;

/// Limits of the split of a shell into convex parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Split {
    /// Largest number of parts of a shell.
    pub most_parts: u32,
    /// Volume that the parts may have more than the shell, over its volume; –.
    pub volume_error: f64,
}

impl Default for Split {
    fn default() -> Self {
        SplitFile::default().into()
    }
}

impl From<SplitFile> for Split {
    fn from(file: SplitFile) -> Self {
        Self {
            most_parts: file.most_parts,
            volume_error: file.volume_error,
        }
    }
}

/// Convex parts of a shell with the given hull, side by side.
pub(super) fn split(
    shell: &Shell,
    hull: &Polyhedron,
    limits: Split,
) -> Result<Vec<Polyhedron>, Fault> {
    let drawn = shell.volume();
    let solid = Solid {
        surface: Surface::new(shell.points.clone(), shell.triangles.clone())?,
        candidates: Candidates::of(shell, hull.size()),
        size: hull.size(),
        on_plane: ON_PLANE * hull.size(),
        least_gain: LEAST_GAIN * drawn,
    };
    let polygons = shell.triangles.iter();
    let whole = Piece {
        polygons: polygons
            .map(|corners| corners.map(|v| shell.points[v as usize]).to_vec())
            .collect(),
        cell: hull.clone(),
        hull: hull.clone(),
    };
    let mut pieces = vec![Divided::of(whole, &solid)];
    loop {
        let excess = pieces.iter().map(|p| volume(&p.piece.hull)).sum::<f64>() - drawn;
        let is_done = pieces.len() >= limits.most_parts as usize;
        if is_done || excess <= limits.volume_error * drawn {
            break;
        }
        let gain = |k: &usize| pieces[*k].cut.as_ref().map_or(-1.0, |cut| cut.gain);
        // of equal ones the first
        let best = (0..pieces.len())
            .rev()
            .max_by(|a, b| gain(a).total_cmp(&gain(b)));
        let Some((k, cut)) = best.and_then(|k| Some((k, pieces[k].cut.take()?))) else {
            break;
        };
        let [below, above] = cut.sides;
        pieces[k] = Divided::of(below, &solid);
        pieces.push(Divided::of(above, &solid));
    }
    Ok(pieces
        .into_iter()
        .map(|divided| divided.piece.hull)
        .collect())
}

/// A shell that is being split.
struct Solid {
    surface: Surface,
    candidates: Candidates,
    /// Cube root of the volume of its hull; m.
    size: f64,
    /// m.
    on_plane: f64,
    /// m³.
    least_gain: f64,
}

/// Part of the solid within a convex cell.
#[derive(Clone)]
struct Piece {
    /// Surface of the shell within the cell, counter-clockwise from outside.
    polygons: Vec<Vec<Vec3>>,
    cell: Polyhedron,
    /// Hull of the solid within the cell.
    hull: Polyhedron,
}

/// A piece with its best cut.
struct Divided {
    piece: Piece,
    cut: Option<Cut>,
}

#[derive(Clone)]
struct Cut {
    sides: [Piece; 2],
    /// Volume by which the hulls of both sides are less than that of the piece; m³.
    gain: f64,
    /// Volume of the smaller of both hulls; m³.
    smaller: f64,
}

impl Divided {
    fn of(piece: Piece, solid: &Solid) -> Self {
        let (mut best, mut most_even) = (None::<Cut>, None::<Cut>);
        let whole = volume(&piece.hull);
        for plane in solid.candidates.through(&piece.hull) {
            let Some(sides) = piece.cut(&plane, solid) else {
                continue;
            };
            let volumes = sides.each_ref().map(|side| volume(&side.hull));
            let cut = Cut {
                gain: whole - volumes[0] - volumes[1],
                smaller: volumes[0].min(volumes[1]),
                sides,
            };
            // more by more than round-off, which would choose between equal planes
            let exceeds = |this: f64, best: f64| best + ON_PLANE * whole < this;
            if best
                .as_ref()
                .is_none_or(|best| exceeds(cut.gain, best.gain))
            {
                best = Some(cut.clone());
            }
            if (most_even.as_ref()).is_none_or(|even| exceeds(cut.smaller, even.smaller)) {
                most_even = Some(cut);
            }
        }
        let gains = best.filter(|cut| solid.least_gain < cut.gain);
        let halves = most_even.filter(|_| piece.depth() > HOLLOW * solid.size);
        Self {
            cut: gains.or(halves),
            piece,
        }
    }
}

impl Piece {
    /// Largest depth of the middle of a polygon of the surface below the hull; m.
    fn depth(&self) -> f64 {
        let depth = |polygon: &Vec<Vec3>| {
            let middle = polygon.iter().sum::<Vec3>() / polygon.len() as f64;
            let faces = 0..self.hull.n_faces();
            faces
                .map(|face| -self.hull.plane_distance(face, &middle))
                .fold(f64::INFINITY, f64::min)
        };
        self.polygons.iter().map(depth).fold(0.0, f64::max)
    }

    /// The pieces below and above a plane; `None` if there is nothing on one side, or too little for a hull.
    fn cut(&self, plane: &Plane, solid: &Solid) -> Option<[Self; 2]> {
        let (below, above) = self.cell.cut(plane).ok()??;
        Some([
            self.side(below, |x| plane.height(x), solid).ok()?,
            self.side(above, |x| -plane.height(x), solid).ok()?,
        ])
    }

    /// The piece within a smaller cell, on the side of a plane where `height` is negative.
    fn side(
        &self,
        cell: Polyhedron,
        height: impl Fn(&Vec3) -> f64,
        solid: &Solid,
    ) -> Result<Self, PolyhedronError> {
        let height = |x: &Vec3| {
            let height = height(x);
            if height.abs() <= solid.on_plane {
                0.0
            } else {
                height
            }
        };
        let is_on = |polygon: &[Vec3]| polygon.iter().all(|x| height(x) == 0.0);
        let mut polygons = Vec::new();
        for polygon in &self.polygons {
            // one in the plane bounds the solid on the side it looks away from; of others only an edge or a corner may touch it
            let stays = if is_on(polygon) {
                let ahead = polygon[0] + normal(polygon).normalize() * (2.0 * solid.on_plane);
                if height(&ahead) > 0.0 {
                    polygon.clone()
                } else {
                    Vec::new()
                }
            } else {
                let inside = clipped_polygon(polygon, height);
                if is_on(&inside) { Vec::new() } else { inside }
            };
            if stays.len() > 2 {
                polygons.push(stays);
            }
        }
        let is_inside = |x: &&Vec3| {
            let nearest = solid.surface.surface_point_within(x, f64::INFINITY);
            nearest.is_some_and(|at| at.distance < -solid.on_plane)
        };
        let mut corners: Vec<Vec3> = polygons.iter().flatten().copied().collect();
        corners.extend(cell.vertices().iter().filter(is_inside));
        let hull = Polyhedron::convex_hull(&welded(corners))?;
        Ok(Self {
            polygons,
            cell,
            hull,
        })
    }
}

/// Normal of a plane polygon, twice its area long; m².
fn normal(polygon: &[Vec3]) -> Vec3 {
    let first = polygon[0];
    let fans = polygon.windows(2);
    fans.map(|side| (side[0] - first).cross(&(side[1] - first)))
        .sum()
}

/// Points without those within round-off of others.
fn welded(points: Vec<Vec3>) -> Vec<Vec3> {
    let numbers = 0..points.len() as u32;
    // corners of nothing: triangles of three equal corners are dropped, their points are not
    let triangles = numbers.map(|v| [v; 3]).collect();
    weld(&Soup { points, triangles }).points
}
