//! Presets: a scheme with its parameters, under one name.
//!
//! | | `Mueller2003` | `Standard` | `Reference` |
//! |---|---|---|---|
//! | kernel | Mueller's | Wendland C2 | Wendland C2 |
//! | `h`/spacing | 1.5 | 1.3, in a plane 2.0 | 2.0 |
//! | density | summation | continuity | continuity |
//! | density diffusion | none | Fourtakas 0.1 | Fourtakas 0.1 |
//! | viscosity | published, dynamic viscosity of the fluid | laminar, viscosity of the fluid | as `Standard` |
//! | shifting | none | none | none |
//! | negative pressure | clamped | kept | kept |
//! | stepping | symplectic Euler | kick-drift-kick | kick-drift-kick |
//! | step factor | 0.5 of the limit | 1.0 `h/(c₀ + v)` | 1.0 `h/(c₀ + v)` |
//! | sound speed | 10 times the fastest | 7 times | 14 times |
//! | pair sums | double | single | single |
//!
//! `Preview` is `Standard` with 5 times the fastest speed. Cost and error of each are measured in `benches/trade`.
//!
//! Sources: Mueller, Charypar & Gross (2003) with Geraili Mikola & Sitar (2014); Colagrossi et al. (2013) for the wide
//! support of waves that travel far; those of the schemes in [`crate::scheme`].

use crate::kernel::Dimensions;
use crate::scheme::Scheme;

/// Ratio of the speed of sound to the fastest expected flow at which density varies by about 1 %.
pub const SOUND_SPEED_RATIO: f64 = 10.0;

/// A scheme with its parameters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preset {
    /// The published scheme, misprints corrected.
    Mueller2003,
    /// A first look: `Standard` with a lower speed of sound.
    Preview,
    /// The least work for errors of some percent.
    #[default]
    Standard,
    /// Accuracy first.
    Reference,
}

/// Parameters of a preset.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PresetParameters {
    /// Ratio of smoothing length to particle spacing; –.
    pub smoothing_length_ratio: f64,
    /// Time step over the stability limit; –.
    pub time_step_factor: f64,
    /// Speed of sound over the fastest expected flow; –.
    pub sound_speed_ratio: f64,
    /// Scheme.
    pub scheme: Scheme,
}

impl Preset {
    /// Parameters for a fluid of some density (kg/m³) and dynamic viscosity (Pa s).
    pub fn parameters(
        self,
        dimensions: Dimensions,
        density: f64,
        dynamic_viscosity: f64,
    ) -> PresetParameters {
        let standard = PresetParameters {
            // in space a support of 2.6 spacings, 80 neighbors; in a plane one of 4, 50 neighbors: with the
            // 21 of 2.6 still water stirs itself
            smoothing_length_ratio: match dimensions {
                Dimensions::Three => 1.3,
                Dimensions::Two { .. } => 2.0,
            },
            // shorter steps have the same errors; a lattice allows 1.54 with the usual diffusion
            time_step_factor: 1.0,
            sound_speed_ratio: 7.0,
            // the artificial one takes a fifth of a standing wave in six periods, water's own next to nothing
            scheme: Scheme::laminar(dynamic_viscosity / density),
        };
        match self {
            Self::Standard => standard,
            Self::Preview => PresetParameters {
                sound_speed_ratio: 5.0,
                ..standard
            },
            Self::Mueller2003 => PresetParameters {
                // support of three spacings: the lattice sum of poly6 within 0.3 % of one
                smoothing_length_ratio: 1.5,
                // half the lattice limit leaves room for disorder
                time_step_factor: 0.5,
                sound_speed_ratio: SOUND_SPEED_RATIO,
                scheme: Scheme::mueller2003(dynamic_viscosity),
            },
            Self::Reference => PresetParameters {
                // support of four spacings: waves that travel far (Colagrossi et al. 2013)
                smoothing_length_ratio: 2.0,
                sound_speed_ratio: 14.0,
                ..standard
            },
        }
    }
}
