//! Choices of the schema as choices of the solvers, and back for the scene as it ran.

use riprap_sph::scheme::{DensityDiffusion, DensityMethod, Shifting, Stepping};
use riprap_sph::{KernelChoice, NegativePressure as Clamping, Precision, StateEquation};

use super::{
    DensityDiffusionFile, DensityFile, KernelFile, NegativePressure, PrecisionFile, Preset,
    ShiftingFile, StateEquationFile, SteppingFile, WallMethodFile,
};
use crate::walls::WallMethod;

/// Conversions between two enumerations of the same variants.
macro_rules! same_variants {
    ($($file:ident, $solver:path: $($variant:ident),+;)+) => {$(
        impl From<$file> for $solver {
            fn from(choice: $file) -> Self {
                match choice {
                    $($file::$variant => Self::$variant,)+
                }
            }
        }

        impl From<$solver> for $file {
            fn from(choice: $solver) -> Self {
                type Solver = $solver;
                match choice {
                    $(Solver::$variant => Self::$variant,)+
                }
            }
        }
    )+};
}

same_variants! {
    Preset, riprap_sph::Preset: Mueller2003, Preview, Standard, Reference;
    KernelFile, KernelChoice: Mueller, WendlandC2, CubicSpline;
    DensityFile, DensityMethod: Summation, Continuity;
    StateEquationFile, StateEquation: Linear, Tait;
    SteppingFile, Stepping: KickDriftKick, PredictorCorrector, SymplecticEuler;
    PrecisionFile, Precision: Single, Double;
    NegativePressure, Clamping: Clamped, Kept;
    WallMethodFile, WallMethod: Penalty, Particles, Integral;
}

impl From<DensityDiffusionFile> for DensityDiffusion {
    fn from(choice: DensityDiffusionFile) -> Self {
        match choice {
            DensityDiffusionFile::Off => Self::None,
            DensityDiffusionFile::MolteniColagrossi(delta) => Self::MolteniColagrossi(delta),
            DensityDiffusionFile::Fourtakas(delta) => Self::Fourtakas(delta),
            DensityDiffusionFile::Antuono(delta) => Self::Antuono(delta),
        }
    }
}

impl From<DensityDiffusion> for DensityDiffusionFile {
    fn from(choice: DensityDiffusion) -> Self {
        match choice {
            DensityDiffusion::None => Self::Off,
            DensityDiffusion::MolteniColagrossi(delta) => Self::MolteniColagrossi(delta),
            DensityDiffusion::Fourtakas(delta) => Self::Fourtakas(delta),
            DensityDiffusion::Antuono(delta) => Self::Antuono(delta),
        }
    }
}

impl From<ShiftingFile> for Shifting {
    fn from(choice: ShiftingFile) -> Self {
        match choice {
            ShiftingFile::Off => Self::None,
            ShiftingFile::Fickian(coefficient) => Self::Fickian { coefficient },
        }
    }
}

impl From<Shifting> for ShiftingFile {
    fn from(choice: Shifting) -> Self {
        match choice {
            Shifting::None => Self::Off,
            Shifting::Fickian { coefficient } => Self::Fickian(coefficient),
        }
    }
}
