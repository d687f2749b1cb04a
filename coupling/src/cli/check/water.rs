//! Amount of water, as drawn and as its particles have it, and the waves of wave makers.

use crate::scene::fill::Amount;
use crate::scene::resolved::Scene;

/// Heading and text of a line.
type Line = (&'static str, String);

/// Volume and mass of each region, and the compression by the water's own weight, which adds to the mass of its particles.
pub(super) fn amounts(scene: &Scene) -> Vec<Line> {
    let Some(fluid) = &scene.fluid else {
        return Vec::new();
    };
    let density = fluid.settings.reference_density;
    let amounts = fluid.regions.iter().zip(&fluid.lattice.amounts);
    let mut lines: Vec<Line> = amounts
        .map(|(region, &Amount { drawn, filled })| {
            let text = format!(
                "`{}`: drawn {drawn:.6} m3, {:.4} kg; filled {filled:.6} m3, {:.4} kg, {:+.3} %",
                region.name,
                density * drawn,
                density * filled,
                // no minus before a zero
                100.0 * (filled / drawn - 1.0) + 0.0,
            );
            ("water", text)
        })
        .collect();
    let of_pressure = |pressure: &f64| pressure / (density * fluid.settings.sound_speed.powi(2));
    let compression: f64 = fluid.pressures.iter().map(of_pressure).sum();
    let compression = compression / fluid.pressures.len().max(1) as f64;
    if 0.0 < compression {
        lines.push((
            "compression",
            format!(
                "{:.2} % more mass by the water's own weight at this sound speed",
                100.0 * compression
            ),
        ));
    }
    lines
}

/// Waves and strokes of the wave makers.
pub(super) fn wave_makers(scene: &Scene) -> Vec<Line> {
    let spacing = (scene.fluid.as_ref()).map(|fluid| fluid.settings.mean_spacing());
    let makers = scene.wave_makers.iter();
    makers
        .map(|maker| {
            let name = &scene.block_names[maker.block];
            let text = format!("`{name}`: {}", maker.description(spacing));
            ("wave maker", text)
        })
        .collect()
}
