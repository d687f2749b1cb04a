//! Water channel with a paddle that makes regular waves.

use std::f64::consts::TAU;

use super::digits::{rounded, significant, up_to};
use super::{Draft, GRAVITY, Target};

/// Steepest regular wave, `H/L` over `tanh kd`, with a margin to Miche's 0.142, and highest by the depth.
const STEEPEST: f64 = 0.1;
const HIGHEST: f64 = 0.5;
/// Particle spacings in the depth and in the wave height.
const ROWS: (f64, f64) = (15.0, 4.0);
/// Periods recorded once the waves have reached the last gauge.
const PERIODS: f64 = 6.0;

/// Write the scene of a water channel with regular waves, in a vertical plane.
#[derive(Debug, clap::Args)]
pub(super) struct Options {
    #[command(flatten)]
    pub target: Target,
    /// Depth of the still water; m.
    #[arg(long, value_name = "M", default_value_t = 1.0)]
    depth: f64,
    /// Wave height from trough to crest; m. 0.15 depths when left out.
    #[arg(long, value_name = "M")]
    height: Option<f64>,
    /// Wave period; s. That of waves about six depths long when left out.
    #[arg(long, value_name = "S")]
    period: Option<f64>,
    /// Length of the channel to the absorbing layer; m. Two wave lengths when left out.
    #[arg(long, value_name = "M")]
    length: Option<f64>,
}

/// Regular waves of linear theory.
#[derive(Clone, Copy, Debug)]
struct Waves {
    depth: f64,
    height: f64,
    period: f64,
    /// Wave number; 1/m.
    number: f64,
}

pub(super) fn draft(options: &Options) -> Result<Draft, String> {
    let depth = options.depth;
    let given = [
        ("--depth", Some(depth)),
        ("--height", options.height),
        ("--period", options.period),
        ("--length", options.length),
    ];
    for (name, value) in given {
        if let Some(value) = value.filter(|value| !(0.0 < *value && value.is_finite())) {
            return Err(format!("{name} must be above 0, got {value}"));
        }
    }
    // kd = 1
    let period = options
        .period
        .unwrap_or_else(|| significant(TAU / (GRAVITY / depth * 1f64.tanh()).sqrt(), 3));
    let waves = Waves {
        depth,
        height: options
            .height
            .unwrap_or_else(|| significant(0.15 * depth, 3)),
        period,
        number: wave_number(depth, period),
    };
    waves.refused()?;
    let length = options
        .length
        .unwrap_or_else(|| significant(2.0 * waves.length(), 3));
    Ok(Draft {
        scene: waves.scene(length),
        beside: Vec::new(),
        notes: Vec::new(),
    })
}

/// Wave number of the dispersion relation `ω² = g k tanh kd`, by Newton's iteration; 1/m.
fn wave_number(depth: f64, period: f64) -> f64 {
    let deep = (TAU / period).powi(2) * depth / GRAVITY;
    // kd of deep and of shallow water, whichever is larger
    let mut kd = deep.max(deep.sqrt());
    for _ in 0..30 {
        let tanh = kd.tanh();
        kd -= (kd * tanh - deep) / (tanh + kd * (1.0 - tanh * tanh));
    }
    kd / depth
}

impl Waves {
    fn length(&self) -> f64 {
        TAU / self.number
    }

    fn refused(&self) -> Result<(), String> {
        let steepest = STEEPEST * self.length() * (self.number * self.depth).tanh();
        let highest = steepest.min(HIGHEST * self.depth);
        if self.height <= highest {
            return Ok(());
        }
        Err(format!(
            "waves of {} m would break at {} s on {} m of water; --height at most {} m, or a longer --period",
            self.height,
            self.period,
            self.depth,
            significant(0.99 * highest, 2)
        ))
    }

    /// Full stroke of a piston, `S = H (sinh 2kd + 2kd)/(2 (cosh 2kd − 1))`: Dean & Dalrymple (1991), eq. 6.26; m.
    fn stroke(&self) -> f64 {
        let twice = 2.0 * self.number * self.depth;
        self.height * (twice.sinh() + twice) / (2.0 * (twice.cosh() - 1.0))
    }

    fn scene(&self, length: f64) -> String {
        let Self {
            depth,
            height,
            period,
            ..
        } = *self;
        let neat = |value: f64| significant(value, 3);
        let (wall, top) = (neat(0.4 * depth), neat(depth + 2.0 * height + 0.2 * depth));
        let amplitude = significant(0.5 * self.stroke(), 4);
        let layer = significant(self.length(), 3);
        let end = rounded(length + layer, 4);
        let spacing = significant((depth / ROWS.0).min(height / ROWS.1), 2);
        let group = 0.5 * self.length() / period;
        let gauges = [0.25, 0.5, 0.75].map(|share| neat(share * length));
        format!(
            r#"// A piston makes regular waves in a water channel; a layer at its end absorbs them. Written by `riprap new wavemaker`.
//
// In a vertical plane, x along the channel, z up from its floor; lengths in meters. Masses and forces are those of a slice 1 m wide.
// Linear theory: waves of {period} s on {depth} m of water are {wave_length} m long and travel at {celerity} m/s.
(
    title: "Regular waves in a channel",
    // two dimensions: the domain's extent along y is the width of the slice
    domain: (min: (-{back}, 0, -{below}), max: ({far}, 1, {sky}), dimensions: Two),
    materials: [(name: "concrete", density: 2400, friction_angle_deg: 35)],
    blocks: [
        // a stroke of {stroke} m makes waves {height} m high (Dean & Dalrymple 1991, eq. 6.26); one period of ramp avoids a shock
        (name: "paddle", material: "concrete", shape: Box(min: (-{wall}, -0.5, 0), max: (0, 1.5, {top})),
         motion: Sinusoid(direction: (1, 0, 0), amplitude: {amplitude}, period: {period}, ramp: {period})),
        (name: "floor", material: "concrete", motion: Fixed, shape: Box(min: (-{depth}, -0.5, -{wall}), max: ({behind}, 1.5, 0))),
        (name: "end", material: "concrete", motion: Fixed, shape: Box(min: ({end}, -0.5, 0), max: ({behind}, 1.5, {top}))),
    ],
    fluid: (
        // {rows:.0} rows in the depth, {in_wave:.0} in the wave height; half the spacing takes eight times as long
        resolution: Spacing({spacing}),
        regions: [(name: "channel", shape: Box(min: (0, 0, 0), max: ({end}, 1, {depth})))],
    ),
    // as long as a wave: shorter layers reflect
    absorbers: [(name: "beach", min: ({length}, 0, 0), max: ({end}, 1, {top}), towards: XMax)],
    // {PERIODS} periods after the waves have passed the last gauge, at the speed of their group
    time: (duration: {duration}),
    gauges: [
        SurfaceElevation(name: "g1", x: {g1}, y: 0.5),
        SurfaceElevation(name: "g2", x: {g2}, y: 0.5),
        SurfaceElevation(name: "g3", x: {g3}, y: 0.5),
        BlockForce(name: "paddle", block: "paddle"),
    ],
)
"#,
            wave_length = layer,
            celerity = neat(self.length() / period),
            back = neat(wall + 0.2 * depth + amplitude),
            below = neat(0.5 * depth),
            far = rounded(end + 0.5 * depth, 4),
            sky = neat(depth + 3.0 * height + 0.4 * depth),
            stroke = neat(self.stroke()),
            behind = rounded(end + wall, 4),
            rows = depth / spacing,
            in_wave = height / spacing,
            duration = significant(up_to(0.75 * length / group + PERIODS * period, period), 3),
            g1 = gauges[0],
            g2 = gauges[1],
            g3 = gauges[2],
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// kd = 1: the wave of `cases/piston.ron`.
    #[test]
    fn waves_follow_linear_theory() {
        let number = wave_number(1.0, 2.29872);
        assert!((number - 1.0).abs() < 1e-5, "{number}");
        for (depth, period) in [(0.1, 20.0), (1.0, 0.5), (30.0, 9.0)] {
            let k = wave_number(depth, period);
            let left = (TAU / period).powi(2);
            assert!((GRAVITY * k * (k * depth).tanh() / left - 1.0).abs() < 1e-12);
        }
        let waves = Waves {
            depth: 1.0,
            height: 0.0589,
            period: 2.29872,
            number,
        };
        // to the digits printed in that case
        assert!((waves.stroke() - 0.06).abs() < 5e-5);
    }
}
