//! Resolution required for a slide into water, and a check that the water fills its basin.

use crate::scene::impulse_wave::SlideImpact;
use crate::scene::resolve::{FluidScene, Scene};
use crate::scene::terrain::Terrain;
use crate::scene::terrain::basin::{Room, room_below};

/// Smallest number of particle spacings across the thickness of a slide: with fewer, most of the water is within the support of its far side, too.
const IN_SLIDE: f64 = 3.0;
/// Smallest number of particle spacings in the height of the first crest: the surface is known to half a spacing.
const IN_CREST: f64 = 3.0;

/// Tolerance of the filled volume of a basin, and of the distance between the last row and the bottom; –.
const WELL_FILLED: f64 = 0.005;

/// Lines of the report: heading and text.
pub(super) fn lines(scene: &Scene) -> Vec<(&'static str, String)> {
    let (Some(terrain), Some(fluid)) = (&scene.terrain, &scene.fluid) else {
        return Vec::new();
    };
    let mut lines = basins(scene, terrain, fluid);
    let spacing = fluid.walls.particle_spacing;
    for rock in &terrain.rock {
        let Some(slide) = SlideImpact::of(rock, scene) else {
            continue;
        };
        let crest = slide.first_crest();
        lines.push((
            "slide wave",
            format!(
                "`{}`, {:.3e} m3, {:.1} m thick and {:.0} m wide, meets the water at about {:.0} m/s; by formulas fitted to \
                 experiments (P = {:.2}) the first crest is {crest:.1} m, within a third",
                rock.name,
                slide.volume,
                slide.thickness,
                slide.width,
                slide.speed,
                slide.impulse_product()
            ),
        ));
        let (of_slide, of_crest) = (slide.thickness / IN_SLIDE, crest / IN_CREST);
        let coarsest = of_slide.min(of_crest);
        let verdict = if spacing <= coarsest {
            "resolves both"
        } else {
            "is too coarse for quantitative results, sufficient for a first look"
        };
        lines.push((
            "resolution",
            format!(
                "{IN_SLIDE} spacings of {of_slide:.2} m in the thickness of the slide, {IN_CREST} of {of_crest:.2} m in the crest: \
                 {coarsest:.2} m or finer; {spacing:.2} m {verdict}"
            ),
        ));
    }
    lines
}

/// Volume of the water in basins of the terrain, compared with the volume below its level.
fn basins(scene: &Scene, terrain: &Terrain, fluid: &FluidScene) -> Vec<(&'static str, String)> {
    let (min, max) = (scene.domain.min, scene.domain.max);
    let plan = [[min.x, min.y], [max.x, max.y]];
    let regions = fluid.regions.iter();
    let basins = regions.enumerate().filter_map(|(k, region)| {
        let seed = region.seed?;
        let room = room_below(terrain, region.level, [seed.x, seed.y], plan)?;
        let of_region = fluid.lattice.region.iter().filter(|&&r| r as usize == k);
        let volume = of_region.count() as f64 * fluid.lattice.particle_volume();
        let off = volume / room.volume - 1.0;
        let advice = if off.abs() < WELL_FILLED {
            String::new()
        } else {
            filling(&room, fluid)
        };
        let words = format!(
            "`{}`: {volume:.4e} m3 in particles, {:+.2} % of the integral between ground and level{advice}",
            region.name,
            100.0 * off
        );
        Some(("water", words))
    });
    basins.collect()
}

/// The spacing closest to that of the scene with whole rows between level and bottom; empty if the scene has them.
fn filling(room: &Room, fluid: &FluidScene) -> String {
    let row_height = fluid.lattice.spacing[2];
    let rows = (room.depth / row_height).round().max(1.0);
    let stretch = room.depth / (rows * row_height);
    if (stretch - 1.0).abs() < WELL_FILLED {
        return String::new();
    }
    format!(
        ": rows end above a flat bottom, at a spacing of {:.3} m {rows} of them fill the depth",
        stretch * fluid.walls.particle_spacing
    )
}
