//! Volume of water in a terrain below a level: an integral over its triangles, for comparison with the particles.

use riprap_dda::Vec3;

use super::Terrain;

/// Space between the ground and a level.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Room {
    /// Volume; m³.
    pub volume: f64,
    /// Largest depth; m.
    pub depth: f64,
}

/// Space between the ground and a level that is connected to a seed over the grid.
///
/// ```text
/// V = Σ_triangles ∫ max(level − z, 0) dA      over the part of each in the box in plan view     [m³]
/// ```
/// Blocks in the water are not subtracted. `None` where the seed is dry.
pub fn room_below(
    terrain: &Terrain,
    level: f64,
    seed: [f64; 2],
    plan: [[f64; 2]; 2],
) -> Option<Room> {
    let wet = flooded(terrain, level, seed, plan)?;
    let surface = &terrain.surface;
    let grid = &terrain.grid;
    let is_wet = |x: &Vec3| {
        let point = [0, 1].map(|axis| {
            let along = (x[axis] - grid.corner[axis]) / grid.spacing;
            (along.round().max(0.0) as usize).min(grid.n[axis] - 1)
        });
        wet[grid.index(point)]
    };
    let mut room = Room {
        volume: 0.0,
        depth: 0.0,
    };
    for triangle in surface.triangles() {
        let corners = triangle.map(|v| surface.vertices()[v as usize]);
        let below = clipped(&corners, level, plan);
        let Some((lowest, rest)) = below
            .iter()
            .min_by(|a, b| a.z.total_cmp(&b.z))
            .zip(below.split_first())
        else {
            continue;
        };
        if !is_wet(lowest) {
            continue;
        }
        room.depth = room.depth.max(level - lowest.z);
        let (first, others) = rest;
        for pair in others.windows(2) {
            let twice_area = (pair[0] - first).xy().perp(&(pair[1] - first).xy());
            room.volume += 0.5 * twice_area * (level - (first.z + pair[0].z + pair[1].z) / 3.0);
        }
    }
    Some(room)
}

/// Grid points reached by water from a seed, including the shore.
fn flooded(
    terrain: &Terrain,
    level: f64,
    seed: [f64; 2],
    plan: [[f64; 2]; 2],
) -> Option<Vec<bool>> {
    let grid = &terrain.grid;
    let nearest = [0, 1].map(|axis| ((seed[axis] - grid.corner[axis]) / grid.spacing).round());
    let is_on = (0..2).all(|axis| 0.0 <= nearest[axis] && nearest[axis] < grid.n[axis] as f64);
    let start = nearest.map(|n| n.max(0.0) as usize);
    if !(is_on && grid.heights[grid.index(start)] < level) {
        return None;
    }
    let mut wet = vec![false; grid.heights.len()];
    wet[grid.index(start)] = true;
    let mut queue = vec![start];
    while let Some([i, j]) = queue.pop() {
        let place = grid.place([i, j]);
        let is_in_plan =
            (0..2).all(|axis| plan[0][axis] <= place[axis] && place[axis] <= plan[1][axis]);
        if !(grid.heights[grid.index([i, j])] < level && is_in_plan) {
            continue;
        }
        let beside = [
            [i.wrapping_sub(1), j],
            [i + 1, j],
            [i, j.wrapping_sub(1)],
            [i, j + 1],
        ];
        for point in beside {
            if point[0] < grid.n[0] && point[1] < grid.n[1] && !wet[grid.index(point)] {
                wet[grid.index(point)] = true;
                queue.push(point);
            }
        }
    }
    Some(wet)
}

/// Part of a triangle below a level and within a box in plan view.
fn clipped(corners: &[Vec3; 3], level: f64, [low, high]: [[f64; 2]; 2]) -> Vec<Vec3> {
    let mut polygon = corners.to_vec();
    let sides: [&dyn Fn(&Vec3) -> f64; 5] = [
        &|x| level - x.z,
        &|x| x.x - low[0],
        &|x| high[0] - x.x,
        &|x| x.y - low[1],
        &|x| high[1] - x.y,
    ];
    for inside in sides {
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (k, from) in polygon.iter().enumerate() {
            let to = &polygon[(k + 1) % polygon.len()];
            let (a, b) = (inside(from), inside(to));
            if 0.0 <= a {
                kept.push(*from);
            }
            if a * b < 0.0 {
                kept.push(from + (to - from) * (a / (a - b)));
            }
        }
        polygon = kept;
    }
    polygon
}
