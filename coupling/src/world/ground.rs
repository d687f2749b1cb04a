//! Ground: upward faces of fixed blocks or of a survey, and their elevation below a point.

use riprap_dda::{Blocks, Vec3};

/// Faces with a smaller vertical component of the normal are walls; –.
const LEAST_UPWARD: f64 = 1e-6;
/// Tolerance of a point outside a triangle that counts as above it, so that none falls between two; × its double area.
const ROUND_OFF: f64 = 1e-9;

/// Upward triangles, in a grid of squares in plan view. Those of fixed blocks do not move, so it is built once.
#[derive(Clone, Debug)]
pub struct Ground {
    triangles: Vec<[Vec3; 3]>,
    /// Lower corner of the grid, x and y; m.
    corner: [f64; 2],
    /// Side of a square; m.
    side: f64,
    /// Squares along x and y.
    n: [usize; 2],
    /// First of the triangles of each square in `listed`, and at the end their number.
    start: Vec<u32>,
    /// Triangles over each square.
    listed: Vec<u32>,
}

impl Ground {
    /// The ground of a system of blocks.
    pub fn of(blocks: &Blocks) -> Self {
        let mut triangles = Vec::new();
        for block in (0..blocks.n_blocks()).filter(|&b| blocks.is_fixed(b) && !blocks.is_removed(b))
        {
            let (vertices, faces) = blocks.world_polygons(block);
            for face in faces {
                let corners: Vec<Vec3> = face.iter().map(|&v| vertices[v as usize]).collect();
                triangles.extend(fan(&corners));
            }
        }
        Self::over(triangles)
    }

    /// Ground from the upward ones of some triangles (m).
    pub fn over(mut triangles: Vec<[Vec3; 3]>) -> Self {
        triangles.retain(looks_up);
        Self::sorted(triangles)
    }

    /// Whether it is empty.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// Elevation of the highest ground at a point in plan view (m), `None` without ground; m.
    pub fn height_under_the_sky(&self, [x, y]: [f64; 2]) -> Option<f64> {
        self.height_below(&Vec3::new(x, y, f64::INFINITY))
    }

    /// Elevation of the highest ground at or below a point (m), `None` without ground; m.
    pub fn height_below(&self, x: &Vec3) -> Option<f64> {
        let [i, j] = [0, 1].map(|axis| ((x[axis] - self.corner[axis]) / self.side).floor());
        if !(0.0 <= i && i < self.n[0] as f64 && 0.0 <= j && j < self.n[1] as f64) {
            return None;
        }
        let square = j as usize * self.n[0] + i as usize;
        let here = self.start[square] as usize..self.start[square + 1] as usize;
        self.listed[here]
            .iter()
            .filter_map(|&t| height_at(&self.triangles[t as usize], x))
            .filter(|&height| height <= x.z)
            .max_by(f64::total_cmp)
    }

    /// About one triangle per square.
    fn sorted(triangles: Vec<[Vec3; 3]>) -> Self {
        let corners = triangles.iter().flatten();
        let (low, high) = corners.fold(
            (Vec3::repeat(f64::INFINITY), Vec3::repeat(f64::NEG_INFINITY)),
            |(low, high), x| (low.inf(x), high.sup(x)),
        );
        if triangles.is_empty() {
            return Self {
                triangles,
                corner: [0.0; 2],
                side: 1.0,
                n: [0; 2],
                start: vec![0],
                listed: Vec::new(),
            };
        }
        let extent = high - low;
        // a strip is cut along its length only
        let side = (extent.x * extent.y / triangles.len() as f64)
            .sqrt()
            .max(extent.x.max(extent.y) / triangles.len() as f64);
        let n = [extent.x, extent.y].map(|length| (length / side) as usize + 1);
        let squares = |triangle: &[Vec3; 3]| {
            let range = |axis: usize| {
                let place = |v: &Vec3| ((v[axis] - low[axis]) / side) as usize;
                let first = triangle.iter().map(place).min().unwrap_or(0);
                let last = triangle.iter().map(place).max().unwrap_or(0);
                first..(last + 1).min(n[axis])
            };
            let (columns, rows) = (range(0), range(1));
            rows.flat_map(move |j| columns.clone().map(move |i| j * n[0] + i))
        };
        let mut start = vec![0; n[0] * n[1] + 1];
        for square in triangles.iter().flat_map(squares) {
            start[square + 1] += 1;
        }
        for square in 1..start.len() {
            start[square] += start[square - 1];
        }
        let mut next = start.clone();
        let mut listed = vec![0; start[n[0] * n[1]] as usize];
        for (number, triangle) in (0..).zip(&triangles) {
            for square in squares(triangle) {
                listed[next[square] as usize] = number;
                next[square] += 1;
            }
        }
        Self {
            triangles,
            corner: [low.x, low.y],
            side,
            n,
            start,
            listed,
        }
    }
}

/// Triangles of a convex polygon, all of them at its first corner.
pub fn fan(corners: &[Vec3]) -> impl Iterator<Item = [Vec3; 3]> + '_ {
    let others = corners.windows(2).skip(1);
    others.map(|side| [corners[0], side[0], side[1]])
}

fn looks_up([a, b, c]: &[Vec3; 3]) -> bool {
    let area = (b - a).cross(&(c - a));
    LEAST_UPWARD * area.norm() < area.z
}

/// Elevation of a triangle at a point in plan view; m.
fn height_at([a, b, c]: &[Vec3; 3], x: &Vec3) -> Option<f64> {
    let double_area = |p: &Vec3, q: &Vec3, r: &Vec3| (q - p).xy().perp(&(r - p).xy());
    let whole = double_area(a, b, c);
    let weights = [(b, c), (c, a), (a, b)].map(|(p, q)| double_area(x, p, q) / whole);
    let is_over = weights.iter().all(|&weight| -ROUND_OFF <= weight);
    is_over.then(|| weights[0] * a.z + weights[1] * b.z + weights[2] * c.z)
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    /// A tilted plane of 12 by 3 squares, cut in triangles, and a small table over it.
    fn plane() -> Ground {
        let at = |x: f64, y: f64| Vec3::new(x, y, 0.5 * x - 0.25 * y);
        let mut triangles = Vec::new();
        for i in 0..12 {
            for j in 0..3 {
                let (x, y) = (f64::from(i), f64::from(j));
                let square = [
                    at(x, y),
                    at(x + 1.0, y),
                    at(x + 1.0, y + 1.0),
                    at(x, y + 1.0),
                ];
                triangles.push([square[0], square[1], square[2]]);
                triangles.push([square[0], square[2], square[3]]);
            }
        }
        let table = |x: f64, y: f64| Vec3::new(x, y, 9.0);
        triangles.push([table(2.0, 1.0), table(4.0, 1.0), table(3.0, 2.0)]);
        Ground::sorted(triangles)
    }

    #[test]
    fn heights_follow_the_plane_up_to_its_edges() {
        let ground = plane();
        for i in 0..=48 {
            for j in 0..=12 {
                let (x, y) = (0.25 * f64::from(i), 0.25 * f64::from(j));
                let found = ground.height_below(&Vec3::new(x, y, 8.0)).unwrap();
                assert!((found - (0.5 * x - 0.25 * y)).abs() < 1e-12, "{x} {y}");
            }
        }
        for [x, y] in [[-0.1, 1.0], [12.1, 1.0], [6.0, -0.1], [6.0, 3.1]] {
            assert_eq!(ground.height_below(&Vec3::new(x, y, 8.0)), None);
        }
    }

    #[test]
    fn ground_above_a_point_is_not_below_it() {
        let ground = plane();
        let height = |z: f64| ground.height_below(&Vec3::new(3.0, 1.5, z));
        assert_eq!(height(10.0), Some(9.0));
        assert_eq!(height(8.0), Some(1.125));
        assert_eq!(height(1.0), None);
    }

    #[test]
    fn without_fixed_blocks_there_is_no_ground() {
        assert_eq!(
            Ground::sorted(Vec::new()).height_below(&Vec3::zeros()),
            None
        );
    }
}
