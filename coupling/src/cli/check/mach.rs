//! Compressibility of the water at the speeds that it may reach.

use super::facts::Water;
use crate::messages::{Code, Message};
use crate::scene::resolved::Scene;

/// Mach number above which `check` warns: density changes by half of its square.
const LARGEST_MACH: f64 = 0.2;
/// Round-off in a speed of sound that is a multiple of the speed.
const ROUND_OFF: f64 = 1e-9;

/// Warning of water that may become so fast that its sound is felt.
pub(super) fn warning(scene: &Scene) -> Option<Message> {
    let water = Water::of(scene.fluid.as_ref()?, scene);
    let (speed, sound) = (water.fastest_flow_m_per_s, water.sound_speed_m_per_s);
    let mach = water.mach;
    (LARGEST_MACH * (1.0 + ROUND_OFF) < mach).then(|| {
        let words = format!(
            "the water may reach {speed:.2} m/s, Mach {mach:.2} of the speed of sound of {sound:.2} m/s (at most {LARGEST_MACH} \
             is advised): its density rises by {:.0} % where it is stopped, and impacts are those of sound, rho c u; where they matter let \
             numerics.expected_speed be {speed:.2}",
            50.0 * mach * mach
        );
        Message::new(Code::WaterNearSoundSpeed, words)
    })
}
