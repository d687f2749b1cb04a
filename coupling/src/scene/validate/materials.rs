//! Checks of materials and of joints between two of them.

use super::checks::Checks;
use crate::scene::file::{ElasticFile, JointFile, MaterialFile, SceneFile};

/// Range of densities without a warning; kg/m³.
const USUAL_DENSITY: std::ops::RangeInclusive<f64> = 100.0..=10_000.0;

impl Checks {
    pub(super) fn material(&mut self, index: usize, material: &MaterialFile) {
        let path = |field: &str| format!("materials[{index}].{field}");
        let of = |what: &str| format!("material `{}`: {what}", material.name);
        let density = material.density;
        self.positive(path("density"), &of("density"), density);
        if density > 0.0 && !USUAL_DENSITY.contains(&density) {
            self.warn(
                path("density"),
                format!("{} is {density} kg/m3; is it meant?", of("density")),
            );
        }
        let angle = material.friction_angle_deg;
        self.friction_angle(path("friction_angle_deg"), &of("friction angle"), angle);
        self.residual(
            path("residual_friction_angle_deg"),
            &of("residual friction angle"),
            material.residual_friction_angle_deg,
            (angle, "friction angle"),
        );
        self.positive(
            path("joint_stiffness"),
            &of("joint stiffness"),
            material.joint_stiffness,
        );
        self.not_negative(path("cohesion"), &of("cohesion"), material.cohesion);
        self.residual(
            path("residual_cohesion"),
            &of("residual cohesion"),
            material.residual_cohesion,
            (material.cohesion, "cohesion"),
        );
        self.not_negative(
            path("tensile_strength"),
            &of("tensile strength"),
            material.tensile_strength,
        );
        self.restitution(
            path("restitution"),
            &of("restitution"),
            material.restitution,
        );
        self.positive(
            path("contact_stiffness"),
            &of("contact stiffness"),
            material.contact_stiffness,
        );
        self.not_negative(
            path("shear_stiffness_ratio"),
            &of("shear stiffness ratio"),
            material.shear_stiffness_ratio,
        );
        self.not_negative(
            path("rolling_friction"),
            &of("rolling friction"),
            material.rolling_friction,
        );
        if let Some(elastic) = material.elastic {
            self.elastic(path, of, &elastic);
        }
    }

    fn elastic(
        &mut self,
        path: impl Fn(&str) -> String,
        of: impl Fn(&str) -> String,
        elastic: &ElasticFile,
    ) {
        self.positive(
            path("elastic.young_modulus"),
            &of("Young's modulus"),
            elastic.young_modulus,
        );
        self.not_negative(
            path("elastic.viscosity"),
            &of("viscosity"),
            elastic.viscosity,
        );
        let ratio = elastic.poisson_ratio;
        if !(-1.0 < ratio && ratio < 0.5) {
            self.refuse(
                path("elastic.poisson_ratio"),
                format!(
                    "{} must be above -1 and below 0.5, found {ratio}",
                    of("Poisson's ratio")
                ),
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
            self.refuse(path("between"), of("is listed twice"));
        }
        for (field, ramp) in [
            ("friction_ramp", &joint.friction_ramp),
            ("cohesion_ramp", &joint.cohesion_ramp),
        ] {
            if let Some(row) = ramp.iter().find(|row| row.1 < 0.0) {
                self.refuse(
                    path(field),
                    format!("{} has a share of {}, must be >= 0", of(field), row.1),
                );
            }
            if let Some(rows) = ramp.windows(2).find(|rows| rows[1].0 <= rows[0].0) {
                self.refuse(
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
        let lesser = |limit: f64, of_material: fn(&MaterialFile) -> f64| {
            let both = [first, second].map(|name| scene.materials.iter().find(|m| m.name == *name));
            both.into_iter()
                .flatten()
                .map(of_material)
                .fold(limit, f64::min)
        };
        self.friction_angle(
            path("friction_angle_deg"),
            &of("friction angle"),
            joint.friction_angle_deg,
        );
        let angle = joint.friction_angle_deg;
        let angle = angle.unwrap_or_else(|| lesser(90.0, |m| m.friction_angle_deg));
        self.residual(
            path("residual_friction_angle_deg"),
            &of("residual friction angle"),
            joint.residual_friction_angle_deg,
            (angle, "friction angle"),
        );
        let cohesion = joint.cohesion;
        let cohesion = cohesion.unwrap_or_else(|| lesser(f64::INFINITY, |m| m.cohesion));
        self.residual(
            path("residual_cohesion"),
            &of("residual cohesion"),
            joint.residual_cohesion,
            (cohesion, "cohesion"),
        );
        self.not_negative(path("cohesion"), &of("cohesion"), joint.cohesion);
        self.not_negative(
            path("tensile_strength"),
            &of("tensile strength"),
            joint.tensile_strength,
        );
        self.not_negative(
            path("rolling_friction"),
            &of("rolling friction"),
            joint.rolling_friction,
        );
        self.restitution(path("restitution"), &of("restitution"), joint.restitution);
    }
}
