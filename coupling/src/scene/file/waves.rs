//! Waves of a wave maker.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Waves that a piston makes.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub enum WavesFile {
    /// Regular waves, to second order: Madsen (1971).
    Regular {
        /// From trough to crest; m.
        #[schemars(extend("x-unit" = "m", "exclusiveMinimum" = 0))]
        height: f64,
        /// Period; s.
        #[schemars(extend("x-unit" = "s", "exclusiveMinimum" = 0))]
        period: f64,
    },
    /// A solitary wave: Goring (1978), with Rayleigh's decay of its outskirts.
    Solitary {
        /// Height above the still water; m.
        #[schemars(extend("x-unit" = "m", "exclusiveMinimum" = 0))]
        height: f64,
    },
    /// Irregular waves of random phases.
    Irregular {
        /// Shape of the spectrum.
        #[serde(default)]
        spectrum: SpectrumFile,
        /// Significant height, four times the root of the variance; m.
        #[schemars(extend("x-unit" = "m", "exclusiveMinimum" = 0))]
        height: f64,
        /// Peak period; s.
        #[schemars(extend("x-unit" = "s", "exclusiveMinimum" = 0))]
        period: f64,
        /// Seed of phases and frequencies: the same one gives the same waves.
        #[serde(default)]
        seed: u64,
    },
    /// A group of waves whose crests meet at a place and a time.
    Focused {
        /// Shape of the spectrum.
        #[serde(default)]
        spectrum: SpectrumFile,
        /// Height of the crest there in linear theory, the sum of all amplitudes; m.
        #[schemars(extend("x-unit" = "m", "exclusiveMinimum" = 0))]
        amplitude: f64,
        /// Peak period; s.
        #[schemars(extend("x-unit" = "s", "exclusiveMinimum" = 0))]
        period: f64,
        /// Distance of the place from the piston; m.
        #[schemars(extend("x-unit" = "m", "exclusiveMinimum" = 0))]
        distance: f64,
        /// Time at which they meet; s.
        #[schemars(extend("x-unit" = "s", "exclusiveMinimum" = 0))]
        time: f64,
    },
    /// None: the piston only absorbs the waves that come to it.
    Still {
        /// Period of those that it absorbs best; s.
        #[schemars(extend("x-unit" = "s", "exclusiveMinimum" = 0))]
        period: f64,
    },
}

/// Shape of a spectrum of waves.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub enum SpectrumFile {
    /// Growing sea, Hasselmann et al. (1973); the peak enhancement, 3.3 on average.
    #[schemars(extend("x-unit" = "-"))]
    Jonswap(f64),
    /// Fully grown sea, Pierson & Moskowitz (1964).
    PiersonMoskowitz,
}

impl Default for SpectrumFile {
    fn default() -> Self {
        Self::Jonswap(3.3)
    }
}
