//! Checks of materials and of joints between two of them.

use riprap_dda::{Interval, Property, PropertyRange};

use super::checks::Checks;
use crate::messages::Code;
use crate::scene::file::{JointFile, MaterialFile, SceneFile};

/// Range of densities without a warning; kg/m³.
pub(super) const USUAL_DENSITY: std::ops::RangeInclusive<f64> = 100.0..=10_000.0;

impl Checks {
    pub(super) fn material(&mut self, index: usize, material: &MaterialFile) {
        let path = |field: &str| format!("materials[{index}].{field}");
        let of = |what: &str| format!("material `{}`: {what}", material.name);
        self.properties(path, of, |property| material.property(property), |_| None);
    }

    /// Checks of the ranges of properties: those written, where `derived` are those that follow from elsewhere when left
    /// out; both in the units of the file.
    fn properties(
        &mut self,
        path: impl Fn(&str) -> String,
        of: impl Fn(&str) -> String,
        written: impl Fn(Property) -> Option<f64>,
        derived: impl Fn(Property) -> Option<f64>,
    ) {
        let value = |property| written(property).or_else(|| derived(property));
        let in_si = |property| match property {
            Property::FrictionAngle | Property::ResidualFrictionAngle => {
                value(property).map(f64::to_radians)
            }
            _ => value(property),
        };
        for (range, _) in PropertyRange::violations(in_si) {
            let Some(found) = written(range.property) else {
                continue;
            };
            let (field, words) = in_file(range.property);
            let allowed = match range.interval {
                Interval::Acute => "in [0, 90) degrees".to_owned(),
                Interval::UpTo(peak) => {
                    let most = value(peak).unwrap_or(f64::INFINITY);
                    // a negative peak is refused by itself
                    if most < 0.0 {
                        continue;
                    }
                    format!("in [0, {most}], the {}", in_file(peak).1)
                }
                interval => interval.to_string(),
            };
            self.refuse(
                Code::ValueOutOfRange,
                path(field),
                format!("{} must be {allowed}, found {found}", of(words)),
            );
        }
    }

    pub(super) fn joint(&mut self, index: usize, joint: &JointFile, scene: &SceneFile) {
        let path = |field: &str| format!("joints[{index}].{field}");
        let (first, second) = &joint.between;
        let of = |what: &str| format!("joint of `{first}` and `{second}`: {what}");
        for name in [first, second] {
            self.material_exists(path("between"), &of("material"), name, scene);
        }
        let is_same = |other: &JointFile| {
            let (a, b) = &other.between;
            (a, b) == (first, second) || (b, a) == (first, second)
        };
        if scene.joints[..index].iter().any(is_same) {
            self.refuse(Code::WrittenTwice, path("between"), of("is listed twice"));
        }
        for (field, ramp) in [
            ("friction_ramp", &joint.friction_ramp),
            ("cohesion_ramp", &joint.cohesion_ramp),
        ] {
            if let Some(row) = ramp.iter().find(|row| row.1 < 0.0) {
                self.refuse(
                    Code::ValueOutOfRange,
                    path(field),
                    format!("{} has a share of {}, must be >= 0", of(field), row.1),
                );
            }
            if let Some(rows) = ramp.windows(2).find(|rows| rows[1].0 <= rows[0].0) {
                self.refuse(
                    Code::ValuesOutOfOrder,
                    path(field),
                    format!(
                        "{}: times must increase, found {} s after {} s",
                        of(field),
                        rows[1].0,
                        rows[0].0
                    ),
                );
            }
        }
        // what is left out is the lesser of the two materials
        let lesser = |property| {
            let both = [first, second].map(|name| scene.materials.iter().find(|m| m.name == *name));
            let of_materials = both.into_iter().flatten();
            of_materials
                .filter_map(|material| material.property(property))
                .reduce(f64::min)
        };
        self.properties(path, of, |property| joint.property(property), lesser);
    }
}

/// Path of a property in its entry of the file, and its name in messages.
fn in_file(property: Property) -> (&'static str, &'static str) {
    match property {
        Property::Density => ("density", "density"),
        Property::FrictionAngle => ("friction_angle_deg", "friction angle"),
        Property::ResidualFrictionAngle => {
            ("residual_friction_angle_deg", "residual friction angle")
        }
        Property::JointStiffness => ("joint_stiffness", "joint stiffness"),
        Property::Cohesion => ("cohesion", "cohesion"),
        Property::ResidualCohesion => ("residual_cohesion", "residual cohesion"),
        Property::TensileStrength => ("tensile_strength", "tensile strength"),
        Property::Restitution => ("restitution", "restitution"),
        Property::ContactStiffness => ("contact_stiffness", "contact stiffness"),
        Property::ShearStiffnessRatio => ("shear_stiffness_ratio", "shear stiffness ratio"),
        Property::ShearDampingRatio => ("shear_damping_ratio", "shear damping ratio"),
        Property::RollingFriction => ("rolling_friction", "rolling friction"),
        Property::TwistingFriction => ("twisting_friction", "twisting friction"),
        Property::YoungModulus => ("elastic.young_modulus", "Young's modulus"),
        Property::Viscosity => ("elastic.viscosity", "viscosity"),
        Property::PoissonRatio => ("elastic.poisson_ratio", "Poisson's ratio"),
    }
}

impl MaterialFile {
    /// A property in the units of the file; `None` if it is left out.
    fn property(&self, property: Property) -> Option<f64> {
        match property {
            Property::Density => Some(self.density),
            Property::FrictionAngle => Some(self.friction_angle_deg),
            Property::ResidualFrictionAngle => self.residual_friction_angle_deg,
            Property::JointStiffness => self.joint_stiffness,
            Property::Cohesion => Some(self.cohesion),
            Property::ResidualCohesion => Some(self.residual_cohesion),
            Property::TensileStrength => Some(self.tensile_strength),
            Property::Restitution => Some(self.restitution),
            Property::ContactStiffness => self.contact_stiffness,
            Property::ShearStiffnessRatio => Some(self.shear_stiffness_ratio),
            Property::ShearDampingRatio => Some(self.shear_damping_ratio),
            Property::RollingFriction => Some(self.rolling_friction),
            Property::TwistingFriction => Some(self.twisting_friction),
            Property::YoungModulus => self.elastic.map(|e| e.young_modulus),
            Property::Viscosity => self.elastic.map(|e| e.viscosity),
            Property::PoissonRatio => self.elastic.map(|e| e.poisson_ratio),
        }
    }
}

impl JointFile {
    /// A property in the units of the file; `None` if it is left out.
    fn property(&self, property: Property) -> Option<f64> {
        match property {
            Property::FrictionAngle => self.friction_angle_deg,
            Property::ResidualFrictionAngle => self.residual_friction_angle_deg,
            Property::Cohesion => self.cohesion,
            Property::ResidualCohesion => self.residual_cohesion,
            Property::TensileStrength => self.tensile_strength,
            Property::Restitution => self.restitution,
            Property::ShearDampingRatio => self.shear_damping_ratio,
            Property::RollingFriction => self.rolling_friction,
            Property::TwistingFriction => self.twisting_friction,
            Property::Density
            | Property::JointStiffness
            | Property::ContactStiffness
            | Property::ShearStiffnessRatio
            | Property::YoungModulus
            | Property::Viscosity
            | Property::PoissonRatio => None,
        }
    }
}
