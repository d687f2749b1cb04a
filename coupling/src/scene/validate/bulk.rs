//! Checks of rock masses and grains.

use super::checks::Checks;
use crate::messages::Code;
use crate::scene::file::{
    GrainRegionFile, GrainSizeFile, GrainsFile, RockMassFile, SceneFile, ShapeFile,
};

impl Checks {
    pub(super) fn rock_mass(&mut self, index: usize, mass: &RockMassFile, scene: &SceneFile) {
        let path = |field: &str| format!("rock_masses[{index}].{field}");
        let of = |what: &str| format!("rock mass `{}`: {what}", mass.name);
        self.material_exists(path("material"), &of("material"), &mass.material, scene);
        // the shells of a mesh are blocks by themselves
        if mass.joint_sets.is_empty() && !matches!(mass.boundary, ShapeFile::Mesh { .. }) {
            self.refuse(
                Code::EmptyList,
                path("joint_sets"),
                of("no joint set; add one, or make it a block"),
            );
        }
        let at = format!("rock_masses[{index}]");
        self.joint_sets(&at, &format!("rock mass `{}`", mass.name), &mass.joint_sets);
        self.not_negative(
            path("minimum_volume"),
            &of("least volume"),
            mass.minimum_volume,
        );
        self.shape(&path("boundary"), &mass.boundary, &mass.name);
    }

    pub(super) fn grains(&mut self, index: usize, grains: &GrainsFile, scene: &SceneFile) {
        let path = |field: &str| format!("grains[{index}].{field}");
        let who = format!("grains `{}`", grains.name);
        let of = |what: &str| format!("{who}: {what}");
        self.material_exists(path("material"), &of("material"), &grains.material, scene);
        self.diameters(&path("diameter"), &who, grains.diameter);
        self.mixture(&path("mixed_with"), &who, &grains.mixed_with);
        self.not_negative(path("jitter"), &of("jitter"), grains.jitter);
        let least = grains.least_spacing();
        if let Some(spacing) = grains.spacing
            && spacing < least
        {
            self.refuse(
                Code::ValueOutOfRange,
                path("spacing"),
                format!(
                    "{} must be at least {least} m, the largest diameter times (1 + 2 jitter), found {spacing}",
                    of("spacing")
                ),
            );
        }
        if grains.count == Some(0) {
            self.refuse(
                Code::ValueOutOfRange,
                path("count"),
                of("count must be > 0"),
            );
        }
        match &grains.region {
            &GrainRegionFile::Box { min, max } => self.extent(&path("region"), &who, (min, max)),
            &GrainRegionFile::Cylinder { radius, height, .. } => {
                self.positive(path("region.radius"), &of("radius"), radius);
                self.positive(path("region.height"), &of("height"), height);
            }
            GrainRegionFile::Inside(shape) => self.shape(&path("region"), shape, &grains.name),
        }
    }

    fn diameters(&mut self, path: &str, who: &str, (smallest, largest): (f64, f64)) {
        self.positive(path.to_owned(), &format!("{who}: diameter"), smallest);
        if largest < smallest {
            self.refuse(
                Code::ValuesOutOfOrder,
                path.to_owned(),
                format!(
                    "{who}: diameter ({smallest}, {largest}): give the smallest, then the largest"
                ),
            );
        }
    }

    /// Shares of the further sizes leave one for the first.
    fn mixture(&mut self, path: &str, who: &str, sizes: &[GrainSizeFile]) {
        for (k, size) in sizes.iter().enumerate() {
            self.diameters(&format!("{path}[{k}].diameter"), who, size.diameter);
            let at = format!("{path}[{k}].volume_share");
            self.positive(at, &format!("{who}: volume share"), size.volume_share);
        }
        let all: f64 = sizes.iter().map(|size| size.volume_share).sum();
        if !sizes.is_empty() && 1.0 <= all {
            self.refuse(
                Code::ValueOutOfRange,
                path.to_owned(),
                format!(
                    "{who}: the further sizes take {all} of the volume, which leaves nothing for the first; let their shares add up to less than 1"
                ),
            );
        }
    }
}
