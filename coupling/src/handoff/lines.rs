//! Flow through lines: surface, depth, discharge, and velocities over the depth.

use riprap_dda::Vec3;

use super::columns::Water;
use crate::scene::resolved::recording::PlanLine;
use crate::world::ground::Ground;

/// Levels of velocities, equal shares of the depth from the bed up.
pub const LEVELS: usize = 10;
/// Half of the width of the strip that stands for a line, and the length of its pieces; × particle spacing.
const STRIP: f64 = 2.0;

/// A line with the ground under it.
#[derive(Clone, Debug)]
pub struct Line {
    from: [f64; 2],
    along: [f64; 2],
    /// To the right of the line; –.
    normal: [f64; 2],
    /// Half of the width of the strip; m.
    half_width: f64,
    /// Elevation of the ground in the middle of each piece; NaN without ground; m.
    ground: Vec<f64>,
    /// m.
    piece: f64,
    /// m.
    spacing: f64,
}

/// Flow through a line at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Flow {
    /// Mean elevation of the surface over its wet pieces; NaN where all is dry; m.
    pub surface: f64,
    /// Mean depth over its wet pieces; m.
    pub depth: f64,
    /// Discharge to the right; m³/s.
    pub discharge: f64,
    /// Velocity to the right, means over tenths of the depth from the bed up; NaN where no water is; m/s.
    pub velocity: [f64; LEVELS],
}

impl Line {
    /// A line over the ground, for water with a particle spacing (m).
    pub fn new(PlanLine { from, to }: PlanLine, ground: &Ground, spacing: f64) -> Self {
        let way = [to[0] - from[0], to[1] - from[1]];
        let length = way[0].hypot(way[1]);
        let along = way.map(|w| w / length);
        let n = ((length / (STRIP * spacing)).round() as usize).max(1);
        let piece = length / n as f64;
        let middle = |k: usize| {
            let s = (k as f64 + 0.5) * piece;
            [0, 1].map(|axis| from[axis] + s * along[axis])
        };
        let height = |k| ground.height_under_the_sky(middle(k)).unwrap_or(f64::NAN);
        Self {
            from,
            along,
            normal: [along[1], -along[0]],
            half_width: STRIP * spacing,
            ground: (0..n).map(height).collect(),
            piece,
            spacing,
        }
    }

    /// Piece and weight of a place, and `None` outside of the strip; 1/m.
    ///
    /// ```text
    /// w(n) = (1 − |n|/b)/b      over the distance n from the line, so that ∫ w dn = 1
    /// ```
    fn weight(&self, x: &Vec3) -> Option<(usize, f64)> {
        let way = [x.x - self.from[0], x.y - self.from[1]];
        let across = (way[0] * self.normal[0] + way[1] * self.normal[1]).abs();
        let place = (way[0] * self.along[0] + way[1] * self.along[1]) / self.piece;
        let is_beside = across < self.half_width && 0.0 <= place;
        let piece = place as usize;
        (is_beside && piece < self.ground.len())
            .then(|| (piece, (1.0 - across / self.half_width) / self.half_width))
    }

    /// Flow of the water through the line.
    ///
    /// ```text
    /// q = Σ V_a w(n_a) v_a·n,     h = Σ V_a w(n_a)/L  of each piece of length L,     η = ground + h
    /// ```
    pub fn flow(&self, water: Water) -> Flow {
        let mut volume = vec![0.0; self.ground.len()];
        let mut discharge = 0.0;
        let mut inside = Vec::new();
        for (x, v) in water.position.iter().zip(water.velocity) {
            let Some((piece, weight)) = self.weight(x) else {
                continue;
            };
            let weight = weight * water.volume;
            let speed = v.x * self.normal[0] + v.y * self.normal[1];
            volume[piece] += weight;
            discharge += weight * speed;
            inside.push((piece, weight, x.z, speed));
        }
        let depth: Vec<f64> = volume.iter().map(|volume| volume / self.piece).collect();
        let is_wet = |&k: &usize| 0.5 * self.spacing <= depth[k] && self.ground[k].is_finite();
        let wet: Vec<usize> = (0..depth.len()).filter(is_wet).collect();
        let mean = |value: &dyn Fn(usize) -> f64| {
            wet.iter().map(|&k| value(k)).sum::<f64>() / wet.len() as f64
        };
        let mut sums = [[0.0; 2]; LEVELS];
        for (piece, weight, z, speed) in inside.into_iter().filter(|(k, ..)| is_wet(k)) {
            // a particle reaches over its own height
            let share = (z - self.ground[piece]) / depth[piece];
            let reach = (self.spacing / depth[piece]).max(1.0 / LEVELS as f64);
            for (level, [weights, speeds]) in sums.iter_mut().enumerate() {
                let off = ((level as f64 + 0.5) / LEVELS as f64 - share).abs() / reach;
                let near = weight * (1.0 - off).max(0.0);
                *weights += near;
                *speeds += near * speed;
            }
        }
        Flow {
            surface: mean(&|k| self.ground[k] + depth[k]),
            depth: mean(&|k| depth[k]),
            discharge,
            velocity: sums.map(|[weight, speed]| speed / weight),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A stream over a flat bed with a speed that grows with the height, through a line across it at an angle.
    #[test]
    fn a_sheared_stream_has_its_discharge_and_velocities() {
        let (spacing, depth) = (0.1, 1.0);
        let mut position = Vec::new();
        for i in 0..60 {
            for j in 0..40 {
                for k in 0..10 {
                    let at = |n: i32| (f64::from(n) + 0.5) * spacing;
                    position.push(Vec3::new(at(i), at(j), at(k)));
                }
            }
        }
        let velocity: Vec<Vec3> = position
            .iter()
            .map(|x| Vec3::new(1.0 + x.z, 0.0, 0.0))
            .collect();
        let mass = vec![1.0; position.len()];
        let [a, b, c, d] =
            [(-9., -9.), (9., -9.), (9., 9.), (-9., 9.)].map(|(x, y)| Vec3::new(x, y, 0.0));
        let ground = Ground::over(vec![[a, b, c], [a, c, d]]);
        let water = Water {
            position: &position,
            velocity: &velocity,
            pressure: &mass,
            mass: &mass,
            volume: spacing.powi(3),
            spacing,
        };
        // to the north, so that east is to its right; the second one leans by 3 in 4
        for (to, share) in [([3.0, 3.0], 1.0), ([4.5, 3.0], 0.8)] {
            let line = PlanLine {
                from: [3.0, 1.0],
                to,
            };
            let flow = Line::new(line, &ground, spacing).flow(water);
            // pieces sample a turned lattice
            let tolerance = if share == 1.0 { 1e-12 } else { 0.03 };
            assert!((flow.depth / depth - 1.0).abs() < tolerance, "{flow:?}");
            assert!((flow.surface / depth - 1.0).abs() < tolerance);
            // 1.5 m/s, 1 m of depth, 2 m of width across the stream
            assert!((flow.discharge / 3.0 - 1.0).abs() < tolerance);
            for level in 1..LEVELS - 1 {
                let exact = share * (1.0 + (level as f64 + 0.5) / LEVELS as f64);
                assert!((flow.velocity[level] / exact - 1.0).abs() < tolerance);
            }
        }
    }
}
