//! Checks of the fluid: resolution, regions, initial flow.

use super::checks::{Checks, is_inside, is_ordered};
use crate::messages::Code;
use crate::scene::file::{
    FlowFile, FluidFile, LatticeFile, RegionFile, RegionShapeFile, ResolutionFile, RheologyFile,
    SceneFile, SlipFile,
};
use crate::scene::fluid::{flow_law, mould_rows};

impl Checks {
    pub(super) fn fluid(&mut self, fluid: &FluidFile, scene: &SceneFile) {
        self.positive("fluid.density", "fluid: density", fluid.density);
        self.not_negative(
            "fluid.dynamic_viscosity",
            "fluid: dynamic viscosity",
            fluid.dynamic_viscosity,
        );
        self.rheology("fluid.rheology", fluid.rheology.as_ref());
        for (index, region) in fluid.regions.iter().enumerate() {
            let path = format!("fluid.regions[{index}].rheology");
            self.rheology(&path, region.rheology.as_ref());
        }
        if let SlipFile::Friction(angle) = scene.interface.slip
            && !(0.0..90.0).contains(&angle)
        {
            self.refuse(
                Code::ValueOutOfRange,
                "interface.slip",
                format!(
                    "interface: friction angle must be from 0 to below 90 degrees, found {angle}"
                ),
            );
        }
        if let SlipFile::Rough(roughness) = scene.interface.slip {
            self.not_negative("interface.slip", "interface: sand roughness", roughness);
        }
        match fluid.resolution {
            ResolutionFile::Spacing(spacing) => {
                self.positive("fluid.resolution", "fluid: spacing", spacing);
            }
            ResolutionFile::Count(0) => {
                self.refuse(
                    Code::ValueOutOfRange,
                    "fluid.resolution",
                    "fluid: count must be > 0, found 0".to_owned(),
                );
            }
            ResolutionFile::Count(_) => {}
        }
        if fluid.regions.is_empty() {
            self.refuse(
                Code::EmptyList,
                "fluid.regions",
                "fluid: no region; add one, or leave fluid out".to_owned(),
            );
        }
        self.staggered(fluid, scene);
        for (index, region) in fluid.regions.iter().enumerate() {
            self.region(&format!("fluid.regions[{index}].shape"), region, scene);
            self.flow(&format!("fluid.regions[{index}].flow"), region, scene);
        }
        self.unique(
            "fluid.regions",
            fluid.regions.iter().map(|r| r.name.as_str()),
        );
    }

    /// Check of a standing wave: length and depth, and no settling, which would remove it.
    fn flow(&mut self, path: &str, region: &RegionFile, scene: &SceneFile) {
        let Some(FlowFile::StandingWave {
            height,
            length,
            depth,
            crest,
        }) = region.flow
        else {
            return;
        };
        let who = format!("fluid region `{}`", region.name);
        let sizes = [("height", height), ("length", length), ("depth", depth)];
        for (name, value) in sizes {
            self.positive(
                format!("{path}.{name}"),
                &format!("{who}: {name} of the wave"),
                value,
            );
        }
        if !crest.is_finite() {
            self.refuse(
                Code::ValueOutOfRange,
                format!("{path}.crest"),
                format!("{who}: crest must be finite, found {crest}"),
            );
        }
        if 0.0 < scene.time.settle {
            self.refuse(
                Code::IncompatibleOptions,
                "time.settle",
                format!(
                    "{who}: settling would stop the flow it starts with; leave one of them out"
                ),
            );
        }
    }

    /// Check of a staggered lattice, which fits no plane wall and must be packed.
    fn staggered(&mut self, fluid: &FluidFile, scene: &SceneFile) {
        if fluid.lattice != LatticeFile::Staggered {
            return;
        }
        let is_box = |r: &&RegionFile| matches!(r.shape, RegionShapeFile::Box { .. });
        let why_not = if let Some(region) = fluid.regions.iter().find(is_box) {
            format!(
                "fluid region `{}` is a Box; let it be Below a level",
                region.name
            )
        } else if !(scene.inflows.is_empty() && scene.outflows.is_empty()) {
            "water that comes in stands in rows".to_owned()
        } else if mould_rows(scene) == 0 {
            "penalty walls hold rows; take walls of particles or integrals".to_owned()
        } else {
            return;
        };
        self.refuse(
            Code::IncompatibleOptions,
            "fluid.lattice",
            format!("a staggered lattice is packed against its walls: {why_not}, or take Cubic"),
        );
    }

    fn region(&mut self, path: &str, region: &RegionFile, scene: &SceneFile) {
        let who = format!("fluid region `{}`", region.name);
        match &region.shape {
            RegionShapeFile::Box { min, max } => {
                if !is_ordered(*min, *max) {
                    self.refuse(
                        Code::ValuesOutOfOrder,
                        format!("{path}.max"),
                        format!("{who}: max {max:?} must exceed min {min:?}"),
                    );
                } else if !(is_inside(*min, scene) && is_inside(*max, scene)) {
                    self.refuse(
                        Code::OutsideDomain,
                        path,
                        format!("{who} reaches out of the domain"),
                    );
                }
            }
            RegionShapeFile::Below { level, seed } => {
                if !is_inside(*seed, scene) {
                    self.refuse(
                        Code::SeedMisplaced,
                        format!("{path}.seed"),
                        format!("{who}: the seed {seed:?} is outside of the domain"),
                    );
                }
                if *level <= seed.2 {
                    self.refuse(
                        Code::SeedMisplaced,
                        format!("{path}.level"),
                        format!(
                            "{who}: the level {level} m must be above the seed at {} m",
                            seed.2
                        ),
                    );
                }
            }
        }
    }

    fn rheology(&mut self, path: &str, rheology: Option<&RheologyFile>) {
        if let Some(Err(error)) = rheology.map(|law| flow_law(law).check()) {
            self.refuse(Code::ValueOutOfRange, path, error.to_string());
        }
    }
}
