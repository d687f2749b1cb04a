//! Surfaces in theory beside the records of gauges, in scenes with one wave maker.

use std::path::Path;

use crate::output::run_folder;
use crate::scene;
use crate::scene::resolve::Scene;
use crate::scene::resolved::recording::Quantity;
use crate::scene::wave_maker::WaveMaker;

/// Gauge of a surface, before a wave maker.
#[derive(Clone, Debug)]
pub(in crate::picture) struct Theory {
    maker: WaveMaker,
    place: [f64; 2],
}

/// Theories for the gauges of a run folder.
#[derive(Clone, Debug, Default)]
pub(in crate::picture) struct Theories(Option<Scene>);

impl Theories {
    /// Those of the scene in the folder; none where it has no wave maker, or cannot be read by itself.
    pub fn of_folder(folder: &Path) -> Self {
        let case = folder.join(run_folder::CASE);
        // checking a large scene takes long
        let has_maker = std::fs::read_to_string(&case).is_ok_and(|text| text.contains("Waves("));
        let scene = has_maker.then(|| scene::load(&case, &[]).ok()).flatten();
        Self(scene.map(|(scene, _)| scene))
    }

    /// Theory for a gauge by its name.
    pub fn of(&self, gauge: &str) -> Option<Theory> {
        self.0.as_ref().and_then(|scene| Theory::of(scene, gauge))
    }
}

impl Theory {
    /// Theory for a gauge by its name; none where waves of several makers meet, or without one.
    pub fn of(scene: &Scene, gauge: &str) -> Option<Self> {
        let mut makers = (scene.wave_makers.iter()).filter(|maker| maker.makes_waves());
        let (Some(maker), None) = (makers.next(), makers.next()) else {
            return None;
        };
        let gauge = scene.gauges.iter().find(|one| one.name == gauge)?;
        let Quantity::SurfaceElevation { x, y } = gauge.quantity else {
            return None;
        };
        // behind the piston there is none
        maker.elevation([x, y], 0.0)?;
        Some(Self {
            maker: maker.clone(),
            place: [x, y],
        })
    }

    /// Elevations at some times (s); m.
    pub fn at(&self, times: &[f64]) -> Vec<f64> {
        let elevation = |&time: &f64| self.maker.elevation(self.place, time);
        (times.iter())
            .map(|time| elevation(time).unwrap_or(f64::NAN))
            .collect()
    }
}
