//! Checks of wave makers.

use super::checks::Checks;
use crate::messages::Code;
use crate::scene::file::{BlockFile, MotionFile, SceneFile, SpectrumFile, WavesFile};

/// Range of the peak enhancement of JONSWAP that is observed; –.
const ENHANCEMENT: (f64, f64) = (1.0, 10.0);

impl Checks {
    /// Check of a piston that makes waves.
    pub(super) fn wave_maker(&mut self, index: usize, block: &BlockFile, scene: &SceneFile) {
        let MotionFile::Waves {
            direction,
            waves,
            depth,
            ramp,
            absorb,
        } = &block.motion
        else {
            return;
        };
        let path = format!("blocks[{index}].motion");
        let of = |what: &str| format!("block `{}`: {what}", block.name);
        self.direction(format!("{path}.direction"), &of("motion"), *direction);
        if direction.2 != 0.0 {
            self.refuse(
                Code::UnusableDirection,
                format!("{path}.direction"),
                format!(
                    "{} must be horizontal, found {direction:?}; let its z be 0",
                    of("a wave maker's direction")
                ),
            );
        }
        if scene.fluid.is_none() {
            self.refuse(
                Code::NeedsWater,
                path.clone(),
                of("there is no water to make waves in; add `fluid`, or let the motion be Sinusoid"),
            );
        }
        let (x, y, z) = scene.gravity;
        if !(x == 0.0 && y == 0.0 && z < 0.0) {
            self.refuse(
                Code::UnexpectedGravity,
                "gravity",
                format!(
                    "{} needs gravity along -z, found {:?}",
                    of("a wave maker"),
                    scene.gravity
                ),
            );
        }
        self.positive(format!("{path}.depth"), &of("depth"), *depth);
        self.not_negative(format!("{path}.ramp"), &of("ramp"), *ramp);
        if matches!(waves, WavesFile::Still { .. }) && !absorb {
            self.refuse(
                Code::IncompatibleOptions,
                format!("{path}.absorb"),
                of("a piston without waves stands still; let `absorb` be true, or the motion be Fixed"),
            );
        }
        self.waves(&format!("{path}.waves"), &block.name, waves);
    }

    fn waves(&mut self, path: &str, block: &str, waves: &WavesFile) {
        let of = |what: &str| format!("block `{block}`: {what}");
        let (scales, spectrum): (&[_], _) = match waves {
            WavesFile::Regular { height, period } => {
                (&[("height", *height), ("period", *period)], None)
            }
            WavesFile::Solitary { height } => (&[("height", *height)], None),
            WavesFile::Still { period } => (&[("period", *period)], None),
            WavesFile::Irregular {
                spectrum,
                height,
                period,
                seed: _,
            } => (&[("height", *height), ("period", *period)], Some(spectrum)),
            WavesFile::Focused {
                spectrum,
                amplitude,
                period,
                distance,
                time,
            } => (
                &[
                    ("amplitude", *amplitude),
                    ("period", *period),
                    ("distance", *distance),
                    ("time", *time),
                ],
                Some(spectrum),
            ),
        };
        for (field, value) in scales {
            let who = of(&format!("{field} of the waves"));
            self.positive(format!("{path}.{field}"), &who, *value);
        }
        let (least, most) = ENHANCEMENT;
        if let Some(SpectrumFile::Jonswap(enhancement)) = spectrum
            && !(least..=most).contains(enhancement)
        {
            self.refuse(
                Code::ValueOutOfRange,
                format!("{path}.spectrum"),
                format!(
                    "{} must be from {least} to {most}, found {enhancement}",
                    of("peak enhancement of Jonswap")
                ),
            );
        }
    }
}
