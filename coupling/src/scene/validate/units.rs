//! Checks for quantities in another unit than the file's: angles in radians or as tangents, densities in tons per cubic
//! meter, weights for densities, gravity in centimeters, moduli in gigapascals.

use std::f64::consts::{FRAC_PI_2, PI};

use super::checks::Checks;
use crate::messages::Code;
use crate::scene::file::{JointSetFile, MotionFile, SceneFile, SlipFile};

/// Acceleration of gravity of the Earth; m/s².
const EARTH: f64 = 9.81;
/// Gravity of a scene in meters and seconds on the Earth; dimensionless scenes and centrifuges are outside; m/s².
const EARTHLY: std::ops::RangeInclusive<f64> = 5.0..=15.0;
/// Densities of rock and concrete in tons per cubic meter.
const IN_TONS: std::ops::RangeInclusive<f64> = 0.5..=10.0;
/// Densities of water and mud in tons per cubic meter.
const WATER_IN_TONS: std::ops::RangeInclusive<f64> = 0.5..=3.0;
/// Unit weights of rock and concrete; kN/m³.
const UNIT_WEIGHT: std::ops::RangeInclusive<f64> = 15.0..=32.0;
/// Softest solid; Pa.
const SOFTEST: f64 = 1e4;
/// Unit weights of water and mud; N/m³.
const WATER_WEIGHT: std::ops::RangeInclusive<f64> = 9_000.0..=15_000.0;
/// Speed of sound in air, which neither rock nor water reaches in a slide; m/s.
const FASTEST: f64 = 340.0;
/// Steps of angles that are set out by hand; degrees.
const ROUND_ANGLE: f64 = 5.0;
/// Tolerance of such an angle in radians with four digits; rad.
const FOUR_DIGITS: f64 = 1e-4;

impl Checks {
    pub(super) fn units(&mut self, scene: &SceneFile) {
        self.gravity(scene);
        self.densities(scene);
        for (index, material) in scene.materials.iter().enumerate() {
            let path = |field: &str| format!("materials[{index}].{field}");
            let of = |what: &str| format!("material `{}`: {what}", material.name);
            for (field, what, angle) in [
                (
                    "friction_angle_deg",
                    "friction angle",
                    Some(material.friction_angle_deg),
                ),
                (
                    "residual_friction_angle_deg",
                    "residual friction angle",
                    material.residual_friction_angle_deg,
                ),
            ] {
                self.friction(path(field), &of(what), angle);
            }
            if let Some(elastic) = material.elastic
                && 0.0 < elastic.young_modulus
                && elastic.young_modulus < SOFTEST
            {
                let modulus = elastic.young_modulus;
                self.warn(
                    Code::SuspiciousUnits,
                    path("elastic.young_modulus"),
                    format!(
                        "{} is {modulus} Pa, softer than foam; {modulus} GPa are {modulus}e9 Pa",
                        of("Young's modulus")
                    ),
                );
            }
        }
        for (index, joint) in scene.joints.iter().enumerate() {
            let path = |field: &str| format!("joints[{index}].{field}");
            let of = |what: &str| {
                format!(
                    "joint of `{}` and `{}`: {what}",
                    joint.between.0, joint.between.1
                )
            };
            let field = "friction_angle_deg";
            self.friction(path(field), &of("friction angle"), joint.friction_angle_deg);
            let (field, what) = ("residual_friction_angle_deg", "residual friction angle");
            self.friction(path(field), &of(what), joint.residual_friction_angle_deg);
        }
        if let SlipFile::Friction(angle) = scene.interface.slip {
            self.friction(
                "interface.slip".to_owned(),
                "interface: friction angle",
                Some(angle),
            );
        }
        self.turns(scene);
        self.speeds(scene);
    }

    /// Upward gravity, gravity along another axis than z, in centimeters or multiples of the Earth's.
    fn gravity(&mut self, scene: &SceneFile) {
        let (x, y, z) = scene.gravity;
        let size = x.hypot(y).hypot(z);
        if z > 0.0 {
            self.refuse(
                Code::UnexpectedGravity,
                "gravity",
                format!(
                    "gravity acts upward, found {z} along z; z is up: write {}",
                    -z
                ),
            );
        } else if z == 0.0 && EARTHLY.contains(&size) {
            self.warn(
                Code::UnexpectedGravity,
                "gravity",
                format!("gravity acts along the horizon, found ({x}, {y}, {z}); z is up: write (0, 0, -{size})"),
            );
        }
        for (factor, unit) in [(100.0, "cm/s2"), (1000.0, "mm/s2")] {
            if (size / factor / EARTH - 1.0).abs() < 0.01 {
                self.warn(
                    Code::UnexpectedGravity,
                    "gravity",
                    format!("gravity is {size} m/s2, as if in {unit}; the Earth's is {EARTH} m/s2"),
                );
            }
        }
    }

    /// Densities of moving rock and of water without their thousand, or unit weights in their place.
    fn densities(&mut self, scene: &SceneFile) {
        let (x, y, z) = scene.gravity;
        let is_si = EARTHLY.contains(&x.hypot(y).hypot(z));
        let moving: Vec<&str> = (scene.blocks.iter())
            .filter(|block| matches!(block.motion, MotionFile::Free))
            .map(|block| block.material.as_str())
            .chain(scene.rock_masses.iter().map(|mass| mass.material.as_str()))
            .chain(scene.slides.iter().map(|slide| slide.material.as_str()))
            .chain(scene.grains.iter().map(|grains| grains.material.as_str()))
            .collect();
        for (index, material) in scene.materials.iter().enumerate() {
            let (path, density) = (format!("materials[{index}].density"), material.density);
            let who = format!("material `{}`: density", material.name);
            if is_si && IN_TONS.contains(&density) && moving.contains(&material.name.as_str()) {
                self.refuse(Code::SuspiciousUnits, path, in_tons(&who, density));
            } else if is_si
                && (UNIT_WEIGHT.contains(&density) || UNIT_WEIGHT.contains(&(density / 1000.0)))
            {
                let in_kn = if density > 1000.0 {
                    density / 1000.0
                } else {
                    density
                };
                self.warn(
                    Code::SuspiciousUnits,
                    path,
                    format!(
                        "{who} is {density} kg/m3; a unit weight of {in_kn} kN/m3 is {:.0} kg/m3",
                        1000.0 * in_kn / EARTH
                    ),
                );
            } else if density > 0.0 && !super::materials::USUAL_DENSITY.contains(&density) {
                self.warn(
                    Code::SuspiciousUnits,
                    path,
                    format!("{who} is {density} kg/m3; rock has 2000 to 3000"),
                );
            }
        }
        if let Some(fluid) = &scene.fluid
            && is_si
            && WATER_IN_TONS.contains(&fluid.density)
        {
            self.refuse(
                Code::SuspiciousUnits,
                "fluid.density",
                in_tons("fluid: density", fluid.density),
            );
        }
        if let Some(fluid) = &scene.fluid
            && is_si
            && WATER_WEIGHT.contains(&fluid.density)
        {
            let density = fluid.density;
            self.warn(
                Code::SuspiciousUnits,
                "fluid.density",
                format!(
                    "fluid: density is {density} kg/m3; a unit weight of {density} N/m3 is {:.0} kg/m3",
                    density / EARTH
                ),
            );
        }
    }

    /// A friction angle so small that it is one in radians or its tangent; whole degrees pass.
    fn friction(&mut self, path: String, what: &str, angle: Option<f64>) {
        if let Some(angle) = angle
            && looks_like_radians(angle, 1.0)
        {
            self.warn(
                Code::SuspiciousUnits,
                path,
                format!(
                    "{what} is {angle} degrees, hardly any; {angle} rad are {:.1} degrees, a tangent of {angle} is {:.1}",
                    angle.to_degrees(),
                    angle.atan().to_degrees()
                ),
            );
        }
    }

    /// A dip so small that it is one in radians; half degrees pass.
    pub(super) fn dip(&mut self, path: &str, what: &str, (dip, direction): (f64, f64)) {
        if looks_like_radians(dip, 0.5) {
            self.warn(
                Code::SuspiciousUnits,
                format!("{path}.dip_deg"),
                format!(
                    "{what}: dip is {dip} degrees, nearly level; {dip} rad are {:.1} degrees",
                    dip.to_degrees()
                ),
            );
        }
        if !(-360.0..=360.0).contains(&direction) {
            self.warn(
                Code::SuspiciousUnits,
                format!("{path}.dip_direction_deg"),
                format!(
                    "{what}: dip direction is {direction} degrees, more than a full turn; 400 gon are 360 degrees"
                ),
            );
        }
    }

    /// Checks of the joint sets of a rock mass or slide, in the units of the file.
    pub(super) fn joint_sets(&mut self, path: &str, who: &str, sets: &[JointSetFile]) {
        for (index, set) in sets.iter().enumerate() {
            let path = format!("{path}.joint_sets[{index}]");
            let who = format!("{who}: joint set {index}");
            let at = |field: &str| format!("{path}.{field}");
            let of = |what: &str| format!("{who}: {what}");
            let (dip, direction) = (set.dip_deg, set.dip_direction_deg);
            if let Some(name) = &set.name {
                self.label(at("name"), name);
            }
            if !(0.0..=90.0).contains(&dip) {
                let right = the_same_plane(dip, direction);
                self.refuse(
                    Code::ValueOutOfRange,
                    at("dip_deg"),
                    format!(
                        "{} must be in [0, 90] degrees, found {dip}{right}",
                        of("dip")
                    ),
                );
            }
            self.dip(&path, &who, (dip, direction));
            self.positive(at("spacing"), &of("spacing"), set.spacing);
            self.not_negative(at("scatter_deg"), &of("scatter"), set.scatter_deg);
            for (field, value, most) in [
                ("persistence", set.persistence, 1.0),
                ("spacing_scatter", set.spacing_scatter, 0.5),
            ] {
                if !(0.0..=most).contains(&value) {
                    let what = of(&field.replace('_', " "));
                    self.refuse(
                        Code::ValueOutOfRange,
                        at(field),
                        format!("{what} must be in [0, {most}], found {value}"),
                    );
                }
            }
        }
    }

    /// Rotations by a round angle in radians.
    fn turns(&mut self, scene: &SceneFile) {
        for (index, block) in scene.blocks.iter().enumerate() {
            let Some(turn) = &block.placement.rotate else {
                continue;
            };
            let angle = turn.angle_deg;
            let degrees = (angle.to_degrees() / ROUND_ANGLE).round() * ROUND_ANGLE;
            let is_round = (degrees.to_radians() - angle).abs() < FOUR_DIGITS;
            if degrees != 0.0 && is_round && angle.abs() < 2.1 * PI && (2.0 * angle).fract() != 0.0
            {
                self.warn(
                    Code::SuspiciousUnits,
                    format!("blocks[{index}].placement.rotate.angle_deg"),
                    format!(
                        "block `{}`: it is turned by {angle} degrees; {angle} rad are {degrees} degrees",
                        block.name
                    ),
                );
            }
        }
    }
}

impl Checks {
    /// Initial speeds in millimeters per second.
    fn speeds(&mut self, scene: &SceneFile) {
        let blocks = (scene.blocks.iter().enumerate()).map(|(k, b)| {
            (
                format!("blocks[{k}]"),
                format!("block `{}`", b.name),
                b.velocity,
            )
        });
        let grains = (scene.grains.iter().enumerate()).map(|(k, g)| {
            (
                format!("grains[{k}]"),
                format!("grains `{}`", g.name),
                g.velocity,
            )
        });
        let regions = scene
            .fluid
            .iter()
            .flat_map(|fluid| fluid.regions.iter().enumerate());
        let water = regions.map(|(k, r)| {
            let who = format!("fluid region `{}`", r.name);
            (format!("fluid.regions[{k}]"), who, r.velocity)
        });
        for (path, who, (x, y, z)) in blocks.chain(grains).chain(water) {
            let speed = x.hypot(y).hypot(z);
            if FASTEST < speed {
                self.warn(
                    Code::SuspiciousUnits,
                    format!("{path}.velocity"),
                    format!("{who}: it starts at {speed} m/s, faster than sound in air; velocities are in m/s"),
                );
            }
        }
    }
}

fn in_tons(who: &str, density: f64) -> String {
    format!(
        "{who} is {density} kg/m3, as if in t/m3; write {}",
        1000.0 * density
    )
}

/// True for an angle (degrees) above 0 and below a right angle in radians that is no multiple of `step`.
fn looks_like_radians(angle: f64, step: f64) -> bool {
    0.0 < angle && angle <= FRAC_PI_2 && (angle / step).fract() != 0.0
}

/// The same plane with a dip from 0 to 90 degrees, as advice.
pub(super) fn the_same_plane(dip: f64, direction: f64) -> String {
    let turned = (direction + 180.0).rem_euclid(360.0);
    if (-90.0..0.0).contains(&dip) {
        format!("; write {} with dip_direction_deg: {turned}", -dip)
    } else if 90.0 < dip && dip <= 180.0 {
        format!("; write {} with dip_direction_deg: {turned}", 180.0 - dip)
    } else {
        String::new()
    }
}
