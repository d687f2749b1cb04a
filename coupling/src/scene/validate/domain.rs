//! Checks of the modeled box: corners, periodic directions, planes of symmetry.

use super::checks::Checks;
use crate::messages::Code;
use crate::scene::file::{Axis, DimensionsFile, SceneFile};

/// Length of a domain above which a warning is due; m.
const USUAL_EXTENT: f64 = 1e5;

impl Checks {
    pub(super) fn domain(&mut self, scene: &SceneFile) {
        let domain = &scene.domain;
        self.extent("domain", "domain", (domain.min, domain.max));
        let longest = (domain.max.0 - domain.min.0).max(domain.max.1 - domain.min.1);
        if longest > USUAL_EXTENT {
            self.warn(
                Code::SuspiciousUnits,
                "domain",
                format!("domain is {longest} m long; is it in millimeters?"),
            );
        }
        for (index, axis) in domain.periodic.iter().enumerate() {
            let path = format!("domain.periodic[{index}]");
            if gravity_along(scene, *axis) != 0.0 {
                self.refuse(Code::UnusablePeriod, &path, format!("periodic along {axis:?}, but gravity acts along it; water would fall for ever"));
            }
            self.listed_once(&path, format!("{axis:?}"), (&domain.periodic, index));
        }
        self.symmetry(scene);
    }

    fn symmetry(&mut self, scene: &SceneFile) {
        let domain = &scene.domain;
        for (index, side) in domain.symmetry.iter().enumerate() {
            let path = format!("domain.symmetry[{index}]");
            let axis = [Axis::X, Axis::Y, Axis::Z][side.axis().0];
            self.listed_once(&path, format!("{side:?}"), (&domain.symmetry, index));
            if domain.periodic.contains(&axis) {
                self.refuse(Code::UnusableSymmetryPlane, &path, format!("{side:?} cannot be a plane of symmetry, for the domain is periodic along {axis:?}; take {axis:?} out of periodic, or leave {side:?} out"));
            }
            if gravity_along(scene, axis) != 0.0 {
                self.refuse(Code::UnusableSymmetryPlane, &path, format!("{side:?} cannot be a plane of symmetry, for gravity acts across it; choose a side along gravity"));
            }
            if axis == Axis::Y && domain.dimensions == DimensionsFile::Two {
                self.refuse(Code::UnusableSymmetryPlane, &path, format!("{side:?} cannot be a plane of symmetry, for nothing depends on y in a flow in two dimensions; leave it out"));
            }
            if scene.fluid.is_none() {
                self.refuse(
                    Code::NeedsWater,
                    &path,
                    "a plane of symmetry mirrors water; add `fluid` or leave it out".to_owned(),
                );
            }
        }
    }
}

fn gravity_along(scene: &SceneFile, axis: Axis) -> f64 {
    match axis {
        Axis::X => scene.gravity.0,
        Axis::Y => scene.gravity.1,
        Axis::Z => scene.gravity.2,
    }
}
