//! Surfaces in theory beside the records of gauges, in scenes with one wave maker.

use crate::scene::resolve::Scene;
use crate::scene::resolved::recording::Quantity;
use crate::scene::wave_maker::WaveMaker;

/// Gauge of a surface, before a wave maker.
#[derive(Clone, Debug)]
pub(super) struct Theory {
    maker: WaveMaker,
    place: [f64; 2],
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
