//! Numbers that say whether a flow is ready for a solver of columns, and which kind suits it.

use serde::Serialize;

use super::columns::{Columns, Water};
use super::spectrum::Spectrum;

/// Share of kinetic energy in columns above which shallow-water solvers do; tanh(kd)/(kd) at kd = 0.57.
const SHALLOW: f64 = 0.9;
/// Largest kd of dispersive solvers.
const DISPERSIVE: f64 = 3.0;
/// Range of the quality in which a flow is that of waves.
const QUALITY: std::ops::RangeInclusive<f64> = 0.9..=1.1;
/// Depth from which the pressure at the bed is looked at; × particle spacing.
const DEEP: f64 = 3.0;
/// Stretch of a column above which its crest breaks.
const BREAKING: f64 = 1.5;

/// Fitness of a flow for hand-off.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fitness {
    /// Kinetic energy of columns that move as one over that of the particles, r_h; 1 in shallow water; –.
    pub column_share: f64,
    /// Wave number times depth, the mean over the spectrum of the surface weighted by its power; –.
    pub kd: f64,
    /// q = r_h kd/tanh(kd), 1 for linear waves of that length; –.
    pub quality: f64,
    /// Departure of the pressure at the bed from the weight of the water above it, p/(ρ g h) − 1, as the root mean square over wet cells of
    /// three spacings and more; 0 in shallow water; –.
    pub pressure_deviation: f64,
    /// Cells whose crest breaks: particles over more than 1.5 depths.
    pub breaking_cells: usize,
    /// Wet cells.
    pub wet_cells: usize,
    /// Volume of the surface above and below the level of rest; m³.
    pub volume_above_and_below: [f64; 2],
    /// Kinetic energy of the particles; J.
    pub kinetic_energy: f64,
    /// Potential energy of the surface against the level of rest; J.
    pub potential_energy: f64,
    /// Kind of solver that suits, or that none does yet.
    pub advice: Advice,
}

/// Advice on hand-off.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Advice {
    /// Nothing moves.
    Still,
    /// Not yet: jets and splashes carry more energy than waves of that length do.
    NotYet,
    /// Long waves: shallow-water solvers do.
    ShallowWater,
    /// Dispersive solvers: Boussinesq, or layers with their own pressure.
    Dispersive,
    /// Waves too short for Boussinesq solvers: solvers of the full water depth.
    Short,
}

impl std::fmt::Display for Advice {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Still => "the water is at rest: there is nothing to hand over",
            Self::NotYet => "not yet: jets, splashes or breaking crests carry more than waves of that length do; run further",
            Self::ShallowWater => "ready: a shallow-water solver will do",
            Self::Dispersive => "ready for a dispersive solver (Boussinesq or non-hydrostatic)",
            Self::Short => "waves, but too short for Boussinesq solvers: take one that resolves the depth",
        })
    }
}

/// Fitness of columns over a level of rest (m) under gravity (m/s²).
pub fn fitness(columns: &Columns, water: Water, level: f64, gravity: f64) -> Fitness {
    let kinetic = |mass: f64, squares: f64| 0.5 * mass * squares;
    let particles = water.velocity.iter().zip(water.mass);
    let kinetic_energy: f64 = particles.map(|(v, &m)| kinetic(m, v.norm_squared())).sum();
    let cells = columns.momentum.iter().zip(&columns.mass);
    let of_columns: f64 = cells
        .filter(|(_, mass)| 0.0 < **mass)
        .map(|(p, mass)| 0.5 * (p[0] * p[0] + p[1] * p[1]) / mass)
        .sum();
    let area = columns.raster.area();
    let is_wet = |cell: &usize| 0.0 < columns.depth[*cell];
    let wet: Vec<usize> = (0..columns.raster.n_cells()).filter(is_wet).collect();
    let raised = elevation(columns, level);
    let density = water.mass.first().map_or(0.0, |mass| mass / water.volume);
    let potential_energy = raised
        .iter()
        .map(|eta| 0.5 * density * gravity * eta * eta * area)
        .sum();
    // where water is at rest, the depth under the level
    let depths = wet
        .iter()
        .map(|&cell| level - columns.ground[cell])
        .filter(|d| 0.0 < *d);
    let (n, sum) = depths.fold((0, 0.0), |(n, sum), d| (n + 1, sum + d));
    let kd = mean_wave_number(columns, &raised) * sum / f64::from(n.max(1));
    let column_share = of_columns / kinetic_energy;
    let quality = column_share * kd / kd.tanh();
    let hydrostatic = density * gravity;
    let (n_deep, squares) = wet
        .iter()
        .filter(|&&cell| DEEP * water.spacing <= columns.depth[cell])
        .map(|&cell| columns.bed_pressure[cell] / (hydrostatic * columns.depth[cell]) - 1.0)
        .filter(|deviation| deviation.is_finite())
        .fold((0, 0.0), |(n, sum), d| (n + 1, sum + d * d));
    let breaking = wet.iter().filter(|&&cell| BREAKING < columns.stretch[cell]);
    let above = |sign: f64| raised.iter().map(|eta| (sign * eta).max(0.0) * area).sum();
    Fitness {
        column_share,
        kd,
        quality,
        pressure_deviation: (squares / f64::from(n_deep)).sqrt(),
        breaking_cells: breaking.count(),
        wet_cells: wet.len(),
        volume_above_and_below: [above(1.0), above(-1.0)],
        kinetic_energy,
        potential_energy,
        advice: advice(column_share, kd, quality),
    }
}

fn advice(share: f64, kd: f64, quality: f64) -> Advice {
    match () {
        () if !(share.is_finite() && quality.is_finite()) => Advice::Still,
        () if SHALLOW < share => Advice::ShallowWater,
        () if !QUALITY.contains(&quality) => Advice::NotYet,
        () if kd < DISPERSIVE => Advice::Dispersive,
        () => Advice::Short,
    }
}

/// Surface over the level of rest; 0 where dry, and where the ground is above the level; m.
pub fn elevation(columns: &Columns, level: f64) -> Vec<f64> {
    let cells = 0..columns.raster.n_cells();
    cells
        .map(|cell| {
            let is_water = 0.0 < columns.depth[cell] && columns.ground[cell] < level;
            if is_water {
                columns.surface[cell] - level
            } else {
                0.0
            }
        })
        .collect()
}

/// Mean wave number of a surface, weighted by the power of its spectrum without its mean; 1/m.
fn mean_wave_number(columns: &Columns, raised: &[f64]) -> f64 {
    let spectrum = Spectrum::of(raised, columns.raster.n, columns.raster.side);
    let (mut power, mut sum) = (0.0, 0.0);
    for (index, value) in spectrum.values.iter().enumerate().skip(1) {
        let [kx, ky] = spectrum.wave_vector(index);
        power += value.norm_sqr();
        sum += value.norm_sqr() * kx.hypot(ky);
    }
    sum / power
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn advice_follows_share_and_quality() {
        assert_eq!(advice(0.95, 0.4, 1.0), Advice::ShallowWater);
        assert_eq!(advice(0.76, 1.0, 1.0), Advice::Dispersive);
        assert_eq!(advice(0.2, 5.0, 1.0), Advice::Short);
        assert_eq!(advice(0.4, 1.0, 0.5), Advice::NotYet);
        assert_eq!(advice(f64::NAN, 1.0, f64::NAN), Advice::Still);
    }
}
