//! Side view of a world.

use riprap_dda::Vec3;

use crate::picture::overview::{Outline, Snapshot};
use crate::scene::resolve::Scene;
use crate::scene::terrain::Rock;
use crate::world::World;

/// Half the width of the strip of water along a slide's line; × particle spacing.
const STRIP: f64 = 2.0;
/// Slides whose bed is more level than this have no direction; sine of the slope.
const LEVEL: f64 = 1e-3;
/// Sine of the angle from the vertical within which a face is a wall.
const UPRIGHT: f64 = 1e-9;
/// Distance within which points of a section are above each other; × its length.
const ABOVE: f32 = 1e-5;

/// Vertical plane of the side views.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Section {
    /// A point in plan view; m.
    through: [f64; 2],
    /// Direction in plan view, to the right of the picture.
    along: [f64; 2],
    /// Largest distance of the water that is shown; m.
    reach: f64,
}

impl Section {
    /// Along the motion of the largest slide, through its center; without slides the x-z plane in the middle of the domain, which
    /// shows all of the water.
    pub fn of(scene: &Scene) -> Self {
        let (low, high) = (scene.domain.min, scene.domain.max);
        let rocks = scene.terrain.iter().flat_map(|terrain| &terrain.rock);
        let largest = rocks.max_by(|a, b| a.volume.total_cmp(&b.volume));
        largest
            .and_then(|rock| Self::down(rock, scene))
            .unwrap_or(Self {
                through: [0.0, 0.5 * (low.y + high.y)],
                along: [1.0, 0.0],
                reach: f64::INFINITY,
            })
    }

    fn down(rock: &Rock, scene: &Scene) -> Option<Self> {
        let along = rock.downhill(LEVEL)?;
        let center = rock.center();
        let spacing = (scene.fluid.as_ref()).map_or(0.0, |fluid| fluid.walls.particle_spacing);
        Some(Self {
            through: [center.x, center.y],
            along: [along.x, along.y],
            reach: STRIP * spacing,
        })
    }

    /// Distance along it from the origin of the scene, distance behind it, and height; m.
    fn seen(&self, x: &Vec3) -> Vec3 {
        let [ux, uy] = self.along;
        let behind = ux * (x.y - self.through[1]) - uy * (x.x - self.through[0]);
        Vec3::new(ux * x.x + uy * x.y, behind, x.z)
    }

    /// Label of the horizontal axis.
    pub fn label(&self) -> String {
        if self.along == [1.0, 0.0] {
            return "x [m]".to_owned();
        }
        let toward = self.along[0]
            .atan2(self.along[1])
            .to_degrees()
            .rem_euclid(360.0);
        format!("along the slide, toward {toward:.0}° [m]")
    }

    /// Ends in a rectangle in plan view; m.
    pub fn ends(&self, (low, high): (Vec3, Vec3)) -> [[f64; 2]; 2] {
        // distances from the point on it at which it passes the sides
        let (mut from, mut to) = (f64::NEG_INFINITY, f64::INFINITY);
        for axis in 0..2 {
            if self.along[axis] != 0.0 {
                let at = [low[axis], high[axis]]
                    .map(|side| (side - self.through[axis]) / self.along[axis]);
                from = from.max(at[0].min(at[1]));
                to = to.min(at[0].max(at[1]));
            }
        }
        [from, to].map(|s| [0, 1].map(|axis| self.through[axis] + s * self.along[axis]))
    }

    /// Lower left and upper right corner of the picture; m.
    pub fn view(&self, domain: (Vec3, Vec3)) -> ([f64; 2], [f64; 2]) {
        let [from, to] = self
            .ends(domain)
            .map(|[x, y]| self.seen(&Vec3::new(x, y, 0.0)).x);
        ([from, domain.0.z], [to, domain.1.z])
    }

    /// Whether it follows a slide.
    pub fn follows_slide(&self) -> bool {
        self.reach.is_finite()
    }
}

/// Water and silhouettes of the blocks in the side view.
pub(super) fn snapshot(world: &World, section: &Section) -> Snapshot {
    let mut shown = Snapshot {
        time: world.time(),
        outlines: outlines(world, section),
        ..Snapshot::default()
    };
    if let Some(water) = &world.water {
        let particles = water.fluid.particles();
        for (x, v) in particles.position.iter().zip(&particles.velocity) {
            let x = section.seen(x);
            if x.y.abs() <= section.reach {
                shown.positions.push([x.x as f32, x.y as f32, x.z as f32]);
                shown.speeds.push(v.norm() as f32);
            }
        }
    }
    shown
}

/// Silhouettes of the blocks cut by the plane, without side walls that would hide the water. On terrain, which appears as a section
/// only, all moving blocks.
fn outlines(world: &World, plane: &Section) -> Vec<Outline> {
    let blocks = &world.blocks;
    let is_present = |&b: &usize| !blocks.is_removed(b);
    // only surfaces have no volume
    let (surfaces, solids): (Vec<usize>, Vec<usize>) = (0..blocks.n_blocks())
        .filter(is_present)
        .partition(|&b| blocks.volume(b) == 0.0);
    let shows_all = !surfaces.is_empty();
    let sections = surfaces.iter().flat_map(|&b| {
        let (vertices, faces) = blocks.world_polygons(b);
        let vertices: Vec<Vec3> = vertices.iter().map(|x| plane.seen(x)).collect();
        cut_ground(&vertices, &faces, world.domain().0.z)
    });
    let parts = solids
        .into_iter()
        .flat_map(|block| blocks.parts_of(block).map(move |part| (block, part)));
    let solids = parts.filter_map(|(block, part)| {
        let points: Vec<Vec3> = (blocks.part_points(part).iter().map(|x| plane.seen(x))).collect();
        let is_cut = points.iter().any(|x| x.y <= 0.0) && points.iter().any(|x| 0.0 <= x.y);
        (is_cut || shows_all && !world.is_fixed(block)).then(|| Outline {
            points: convex_outline(points.iter().map(in_view).collect()),
            is_fixed: world.is_fixed(block),
        })
    });
    sections.chain(solids).collect()
}

fn in_view(x: &Vec3) -> [f32; 2] {
    [x.x as f32, x.z as f32]
}

/// Section of a triangulated surface at y = 0: the ground below a terrain, down to `bottom` (m); individual cuts where it overhangs.
fn cut_ground(vertices: &[Vec3], faces: &[Vec<u32>], bottom: f64) -> Vec<Outline> {
    let corner = |v: u32| vertices[v as usize];
    let cut = |face: &Vec<u32>| -> Vec<[f32; 2]> {
        (0..face.len())
            .map(|k| (corner(face[k]), corner(face[(k + 1) % face.len()])))
            .filter(|(p, q)| (p.y <= 0.0) != (q.y <= 0.0))
            .map(|(p, q)| in_view(&p.lerp(&q, -p.y / (q.y - p.y))))
            .collect()
    };
    let cuts = faces.iter().map(cut).filter(|cut| !cut.is_empty());
    // the walls of a scar are upright
    let overhangs = |face: &Vec<u32>| {
        let [a, b, c] = [0, 1, 2].map(|k| corner(face[k]));
        let (u, v) = ((b - a).xy(), (c - a).xy());
        u.perp(&v) < -UPRIGHT * (b - a).norm() * (c - a).norm()
    };
    let outline = |points| Outline {
        points,
        is_fixed: true,
    };
    if faces.iter().any(overhangs) {
        return cuts.map(outline).collect();
    }
    let mut points = in_line(cuts.flatten().collect());
    let Some((&first, &last)) = points.first().zip(points.last()) else {
        return Vec::new();
    };
    let bottom = bottom as f32;
    points.extend([[last[0], bottom], [first[0], bottom]]);
    vec![outline(points)]
}

/// Points of a profile from left to right; those above each other, in a wall, begin with the one closest to the point before.
fn in_line(mut points: Vec<[f32; 2]>) -> Vec<[f32; 2]> {
    points.sort_by(|p, q| p[0].total_cmp(&q[0]));
    points.dedup();
    let length = points
        .first()
        .zip(points.last())
        .map_or(0.0, |(first, last)| last[0] - first[0]);
    let mut line: Vec<[f32; 2]> = Vec::with_capacity(points.len());
    for group in points.chunk_by_mut(|p, q| q[0] - p[0] <= ABOVE * length) {
        group.sort_by(|p, q| p[1].total_cmp(&q[1]));
        let before = line.last().map_or(group[0][1], |point| point[1]);
        let (low, high) = (group[0][1], group[group.len() - 1][1]);
        if (high - before).abs() < (low - before).abs() {
            group.reverse();
        }
        line.extend_from_slice(group);
    }
    line.dedup();
    line
}

/// Convex hull in the plane by Andrew's monotone chain, counter-clockwise.
pub(super) fn convex_outline(mut points: Vec<[f32; 2]>) -> Vec<[f32; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let turns_left = |o: [f32; 2], a: [f32; 2], b: [f32; 2]| {
        (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]) > 0.0
    };
    let chain = |points: &mut dyn Iterator<Item = [f32; 2]>| {
        let mut chain: Vec<[f32; 2]> = Vec::new();
        for p in points {
            while let [.., o, a] = chain.as_slice()
                && !turns_left(*o, *a, p)
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut hull = chain(&mut points.iter().copied());
    hull.extend(chain(&mut points.iter().rev().copied()));
    hull
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_section_of_a_terrain_is_what_lies_below_it() {
        let at = |x: f64, y: f64| Vec3::new(x, y - 1.0, x * x + y);
        let vertices = [
            at(0.0, 0.0),
            at(2.0, 0.0),
            at(4.0, 0.0),
            at(0.0, 2.0),
            at(2.0, 2.0),
            at(4.0, 2.0),
        ];
        let faces = [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]].map(|face| face.to_vec());
        let found = cut_ground(&vertices, &faces, -3.0);
        let expected = [
            [0.0, 1.0],
            [1.0, 3.0],
            [2.0, 5.0],
            [3.0, 11.0],
            [4.0, 17.0],
            [4.0, -3.0],
            [0.0, -3.0],
        ];
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].points, expected);
        // a surface facing down is not a terrain
        let turned = faces.map(|face| face.into_iter().rev().collect());
        assert_eq!(cut_ground(&vertices, &turned, -3.0).len(), 4);
    }

    #[test]
    fn the_wall_of_a_scar_is_part_of_the_profile() {
        // down a wall at 1, along a floor, and up a wall at 2, of which a point was found twice
        let points = vec![
            [0.0, 5.0],
            [2.0, 6.0],
            [1.0, 3.0],
            [1.0, 5.0],
            [2.0, 3.0],
            [3.0, 6.0],
            [1.0, 3.0],
            [1.0, 4.0],
        ];
        let expected = [
            [0.0, 5.0],
            [1.0, 5.0],
            [1.0, 4.0],
            [1.0, 3.0],
            [2.0, 3.0],
            [2.0, 6.0],
            [3.0, 6.0],
        ];
        assert_eq!(in_line(points), expected);
    }

    #[test]
    fn a_section_runs_down_its_slide() {
        // toward the south-east, through (10, 20)
        let half = 0.5f64.sqrt();
        let section = Section {
            through: [10.0, 20.0],
            along: [half, -half],
            reach: 1.0,
        };
        let seen = section.seen(&Vec3::new(11.0, 19.0, 7.0));
        assert!(
            (seen - Vec3::new(-8.0 * half, 0.0, 7.0)).norm() < 1e-12,
            "{seen}"
        );
        // the north-east is behind
        assert!(section.seen(&Vec3::new(11.0, 21.0, 0.0)).y > 0.0);
        assert_eq!(section.label(), "along the slide, toward 135° [m]");
        let [from, to] = section.ends((Vec3::new(0.0, 0.0, 0.0), Vec3::new(100.0, 25.0, 9.0)));
        let is = |found: [f64; 2], x: f64, y: f64| (found[0] - x).hypot(found[1] - y) < 1e-12;
        assert!(is(from, 5.0, 25.0) && is(to, 30.0, 0.0), "{from:?} {to:?}");
    }

    #[test]
    fn the_outline_of_a_box_with_points_inside_is_its_corners() {
        let points = vec![
            [0.0, 0.0],
            [1.0, 0.0],
            [0.5, 0.5],
            [1.0, 2.0],
            [0.0, 2.0],
            [0.0, 1.0],
        ];
        assert_eq!(
            convex_outline(points),
            [[0.0, 0.0], [1.0, 0.0], [1.0, 2.0], [0.0, 2.0]]
        );
    }
}
