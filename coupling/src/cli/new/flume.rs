//! Water channel with a paddle that makes a solitary wave.

use std::fmt::Write as _;
use std::path::Path;

use super::digits::{rounded, significant, up_to};
use super::{Draft, GRAVITY, Target};

/// Highest wave that does not break on constant depth; × depth.
const HIGHEST: f64 = 0.7;
/// Truncation of the wave, where tanh(FADE) is nearly one: a thousandth of its height.
const FADE: f64 = 4.0;
/// Rows of the paddle's record.
const RECORD: u32 = 200;

/// Write the scene of a water channel with a solitary wave, in a vertical plane.
#[derive(Debug, clap::Args)]
pub(super) struct Options {
    #[command(flatten)]
    pub target: Target,
    /// Depth of the still water; m.
    #[arg(long, value_name = "M", default_value_t = 1.0)]
    depth: f64,
    /// Height of the wave; m. 0.3 depths when left out.
    #[arg(long, value_name = "M")]
    height: Option<f64>,
    /// Length of the channel; m. 20 depths when left out.
    #[arg(long, value_name = "M")]
    length: Option<f64>,
}

/// Solitary wave in a channel.
#[derive(Clone, Copy, Debug)]
struct Wave {
    depth: f64,
    height: f64,
    length: f64,
}

pub(super) fn draft(options: &Options, path: &Path) -> Result<Draft, String> {
    let wave = Wave {
        depth: options.depth,
        height: options
            .height
            .unwrap_or_else(|| significant(0.3 * options.depth, 3)),
        length: options
            .length
            .unwrap_or_else(|| significant(20.0 * options.depth, 3)),
    };
    wave.refused()?;
    let stem = path.file_stem().unwrap_or_default().to_string_lossy();
    let record = format!("{stem}_paddle.csv");
    Ok(Draft {
        scene: wave.scene(&record),
        beside: vec![(record, wave.record())],
        notes: Vec::new(),
    })
}

impl Wave {
    fn refused(&self) -> Result<(), String> {
        let Self {
            depth,
            height,
            length,
        } = *self;
        if !(0.0 < depth && depth.is_finite()) {
            return Err(format!("--depth must be above 0, got {depth}"));
        }
        if !(0.0 < height && height <= HIGHEST * depth) {
            return Err(format!(
                "--height must be above 0 and at most {HIGHEST} depths, {} m: higher waves break; got {height}",
                significant(HIGHEST * depth, 3)
            ));
        }
        if !(8.0 * depth <= length && length.is_finite()) {
            return Err(format!(
                "--length must be at least 8 depths, {} m, for the wave to form; got {length}",
                8.0 * depth
            ));
        }
        Ok(())
    }

    /// Outskirts decay coefficient, `k = √(3 H/(4 (d + H)))`, per depth; –.
    fn decay(&self) -> f64 {
        (0.75 * self.height / (self.depth + self.height)).sqrt()
    }

    /// `c = √(g (d + H))`; m/s.
    fn celerity(&self) -> f64 {
        (GRAVITY * (self.depth + self.height)).sqrt()
    }

    /// Times and positions of the paddle, from rest at 0; s, m.
    ///
    /// ```text
    /// ξ = (H/k) tanh(k (c t − ξ)/d)           Goring (1978), Keck Lab. report KH-R-38; k of Rayleigh
    /// ```
    fn positions(&self) -> impl Iterator<Item = (f64, f64)> {
        let (k, c, depth) = (self.decay(), self.celerity(), self.depth);
        let half_stroke = self.height / k;
        // by the phase, which gives the time without iteration
        let at = move |phase: f64| {
            let place = half_stroke * phase.tanh();
            ((phase * depth / k + place) / c, place)
        };
        let (start, from) = at(-FADE);
        (0..=RECORD).map(move |row| {
            let (time, place) = at(FADE * (2.0 * f64::from(row) / f64::from(RECORD) - 1.0));
            (time - start, place - from)
        })
    }

    fn record(&self) -> String {
        let mut text = format!(
            "# solitary wave of {} m on {} m of water: Goring (1978) with Rayleigh's outskirts decay\ntime [s], x [m], y [m], z [m]\n",
            self.height, self.depth
        );
        for (time, x) in self.positions() {
            // writing to a string does not fail
            let _ = writeln!(text, "{time:.5}, {x:.6}, 0, 0");
        }
        text
    }

    fn scene(&self, record: &str) -> String {
        let Self {
            depth,
            height,
            length,
        } = *self;
        let neat = |value: f64| significant(value, 3);
        let (wall, top) = (neat(0.4 * depth), neat(depth + 2.5 * height));
        let (end, seen) = (rounded(length + wall, 4), rounded(length - 0.05 * depth, 4));
        let travel = (length + FADE * depth / self.decay()) / self.celerity();
        let gauges = [0.3, 0.5, 0.7].map(|share| neat(share * length));
        format!(
            r#"// A solitary wave travels along a water channel and runs up its end wall; written by `riprap new flume`.
//
// In a vertical plane, x along the channel, z up from its floor; lengths in meters. Masses and forces are those of a slice 1 m wide.
(
    title: "Solitary wave in a channel",
    // two dimensions: the domain's extent along y is the width of the slice
    domain: (min: (-{back}, 0, -{below}), max: ({far}, 1, {sky}), dimensions: Two),
    materials: [(name: "concrete", density: 2400, friction_angle_deg: 35)],
    blocks: [
        // moves as the water in the wave does, averaged over the depth (Goring 1978): {height} m high
        (name: "paddle", material: "concrete", shape: Box(min: (-{wall}, -0.5, 0), max: (0, 1.5, {top})),
         motion: Table(file: {record:?})),
        (name: "floor", material: "concrete", motion: Fixed, shape: Box(min: (-{depth}, -0.5, -{wall}), max: ({end}, 1.5, 0))),
        (name: "end", material: "concrete", motion: Fixed, shape: Box(min: ({length}, -0.5, 0), max: ({end}, 1.5, {top}))),
    ],
    fluid: (
        // 20 rows in the depth; half the spacing takes eight times as long
        resolution: Spacing({spacing}),
        regions: [(name: "channel", shape: Box(min: (0, 0, 0), max: ({length}, 1, {depth})))],
    ),
    // the wave leaves the paddle, travels at sqrt(g (d + H)) = {celerity} m/s, and runs up the wall
    time: (duration: {duration}),
    gauges: [
        SurfaceElevation(name: "g1", x: {g1}, y: 0.5),
        SurfaceElevation(name: "g2", x: {g2}, y: 0.5),
        SurfaceElevation(name: "g3", x: {g3}, y: 0.5),
        // run-up on the wall: by theory 2 e + e^2/2 = {run_up} m above the still water for e = H/d (Byatt-Smith 1971)
        SurfaceElevation(name: "wall", x: {seen}, y: 0.5),
        Pressure(name: "wall_pressure", position: ({length}, 0.5, {low})),
        BlockForce(name: "paddle", block: "paddle"),
    ],
)
"#,
            back = neat(0.6 * depth),
            below = neat(0.5 * depth),
            far = rounded(length + 0.5 * depth, 4),
            sky = neat(depth + 4.0 * height),
            spacing = significant(depth / 20.0, 3),
            celerity = significant(self.celerity(), 4),
            duration = significant(
                up_to(travel + 4.0 * (depth / GRAVITY).sqrt(), 0.05 * travel),
                3
            ),
            run_up = significant(
                depth * (2.0 * height / depth + 0.5 * (height / depth).powi(2)),
                3
            ),
            low = significant(0.1 * depth, 3),
            g1 = gauges[0],
            g2 = gauges[1],
            g3 = gauges[2],
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The stroke is `2 H/k`, `k = √(3 H/(4 d² (d + H)))`, over the depth of 1 m.
    #[test]
    fn the_stroke_is_that_of_the_wave() {
        let wave = Wave {
            depth: 1.0,
            height: 0.3,
            length: 20.0,
        };
        let positions: Vec<_> = wave.positions().collect();
        assert_eq!(positions[0], (0.0, 0.0));
        let stroke = 2.0 * 0.3 / (0.225f64 / 1.3).sqrt();
        let last = positions[positions.len() - 1];
        // truncated at tanh 4 = 0.9993
        assert!((last.1 / (stroke * 4f64.tanh()) - 1.0).abs() < 1e-12);
        assert!(positions.windows(2).all(|pair| pair[0].0 < pair[1].0));
    }
}
