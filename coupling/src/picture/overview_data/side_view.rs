//! Side view of a world.

use riprap_dda::Vec3;

use crate::picture::overview::{Outline, Snapshot};
use crate::world::World;

/// Water and silhouettes of the blocks in the side view.
pub(super) fn snapshot(world: &World) -> Snapshot {
    let (mut positions, mut speeds) = (Vec::new(), Vec::new());
    if let Some(water) = &world.water {
        let particles = water.fluid.particles();
        positions = particles
            .position
            .iter()
            .map(|x| [x.x as f32, x.y as f32, x.z as f32])
            .collect();
        speeds = particles.velocity.iter().map(|v| v.norm() as f32).collect();
    }
    Snapshot {
        time: world.time(),
        positions,
        speeds,
        outlines: outlines(world),
    }
}

/// Silhouettes of the blocks cut by the middle plane of the domain, without side walls that would hide the water. On
/// terrain, which appears as a section only, all moving blocks.
fn outlines(world: &World) -> Vec<Outline> {
    let blocks = &world.blocks;
    let middle = 0.5 * (world.domain().0.y + world.domain().1.y);
    let is_present = |&b: &usize| !blocks.is_removed(b);
    // only surfaces have no volume
    let (surfaces, solids): (Vec<usize>, Vec<usize>) = (0..blocks.n_blocks())
        .filter(is_present)
        .partition(|&b| blocks.volume(b) == 0.0);
    let shows_all = !surfaces.is_empty();
    let sections = surfaces.iter().flat_map(|&b| {
        let (vertices, faces) = blocks.world_polygons(b);
        section(&vertices, &faces, middle, world.domain().0.z)
    });
    let solids = solids
        .into_iter()
        .flat_map(|block| blocks.parts_of(block).map(move |part| (block, part)))
        .filter(|&(block, part)| {
            let (low, high) = blocks.part_aabb(part);
            low.y <= middle && middle <= high.y || shows_all && !world.is_fixed(block)
        })
        .map(|(block, part)| {
            let points = blocks.part_points(part);
            Outline {
                points: convex_outline(points.iter().map(in_view).collect()),
                is_fixed: world.is_fixed(block),
            }
        });
    sections.chain(solids).collect()
}

fn in_view(x: &Vec3) -> [f32; 2] {
    [x.x as f32, x.z as f32]
}

/// Section of a triangulated surface at `y` = middle: the ground below a terrain, down to `bottom` (m); individual cuts
/// where it overhangs.
fn section(vertices: &[Vec3], faces: &[Vec<u32>], middle: f64, bottom: f64) -> Vec<Outline> {
    let corner = |v: u32| vertices[v as usize];
    let cut = |face: &Vec<u32>| -> Vec<[f32; 2]> {
        (0..face.len())
            .map(|k| (corner(face[k]), corner(face[(k + 1) % face.len()])))
            .filter(|(p, q)| (p.y <= middle) != (q.y <= middle))
            .map(|(p, q)| in_view(&p.lerp(&q, (middle - p.y) / (q.y - p.y))))
            .collect()
    };
    let cuts = faces.iter().map(cut).filter(|cut| !cut.is_empty());
    let looks_up = |face: &Vec<u32>| {
        let [a, b, c] = [0, 1, 2].map(|k| corner(face[k]));
        (b - a).xy().perp(&(c - a).xy()) > 0.0
    };
    let outline = |points| Outline {
        points,
        is_fixed: true,
    };
    if !faces.iter().all(looks_up) {
        return cuts.map(outline).collect();
    }
    let mut points: Vec<[f32; 2]> = cuts.flatten().collect();
    points.sort_by(|p, q| p[0].total_cmp(&q[0]));
    points.dedup();
    let Some((&first, &last)) = points.first().zip(points.last()) else {
        return Vec::new();
    };
    let bottom = bottom as f32;
    points.extend([[last[0], bottom], [first[0], bottom]]);
    vec![outline(points)]
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
        let at = |x: f64, y: f64| Vec3::new(x, y, x * x + y);
        let vertices = [
            at(0.0, 0.0),
            at(2.0, 0.0),
            at(4.0, 0.0),
            at(0.0, 2.0),
            at(2.0, 2.0),
            at(4.0, 2.0),
        ];
        let faces = [[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]].map(|face| face.to_vec());
        let found = section(&vertices, &faces, 1.0, -3.0);
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
        assert_eq!(section(&vertices, &turned, 1.0, -3.0).len(), 4);
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
