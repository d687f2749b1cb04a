//! What can be told of a scene from the file alone; every problem, not only the first.

use super::error::Problem;
use super::file::{
    AttachmentFile, Axis, BlockFile, DimensionsFile, FluidFile, GaugeFile, GrainRegionFile,
    GrainsFile, JointFile, MaterialFile, MotionFile, RegionShapeFile, ResolutionFile, RheologyFile,
    RockMassFile, SceneFile, ShapeFile, SlipFile, StaticDampingFile, TrajectoriesFile, Triple,
    TurningFile,
};
use super::fluid::flow_law;
use super::parse::suggestion;

/// Densities outside of this range are questioned; kg/m³.
const USUAL_DENSITY: std::ops::RangeInclusive<f64> = 100.0..=10_000.0;
/// A domain longer than this is questioned; m.
const USUAL_EXTENT: f64 = 1e5;

/// All problems of the values of a scene.
pub fn values(scene: &SceneFile) -> Vec<Problem> {
    let mut check = Checks::default();
    check.domain(scene);
    for (index, material) in scene.materials.iter().enumerate() {
        check.material(index, material);
    }
    check.unique("materials", scene.materials.iter().map(|m| m.name.as_str()));
    for (index, joint) in scene.joints.iter().enumerate() {
        check.joint(index, joint, scene);
    }
    for (index, block) in scene.blocks.iter().enumerate() {
        check.block(index, block, scene);
    }
    check.unique("blocks", scene.blocks.iter().map(|b| b.name.as_str()));
    for (index, mass) in scene.rock_masses.iter().enumerate() {
        check.rock_mass(index, mass, scene);
    }
    check.unique(
        "rock_masses",
        scene.rock_masses.iter().map(|m| m.name.as_str()),
    );
    for (index, grains) in scene.grains.iter().enumerate() {
        check.grains(index, grains, scene);
    }
    check.unique("grains", scene.grains.iter().map(|g| g.name.as_str()));
    for (index, attachment) in scene.attachments.iter().enumerate() {
        check.attachment(index, attachment, scene);
    }
    if let Some(fluid) = &scene.fluid {
        check.fluid(fluid, scene);
    }
    check.openings(scene);
    let has_blocks =
        !(scene.blocks.is_empty() && scene.rock_masses.is_empty() && scene.grains.is_empty());
    if !has_blocks && scene.fluid.is_none() {
        check.refuse(
            "",
            "the scene has neither blocks nor fluid; add one of them".to_owned(),
        );
    }
    check.numbers(scene);
    for (index, gauge) in scene.gauges.iter().enumerate() {
        check.gauge(index, gauge, scene);
    }
    check.unique("gauges", scene.gauges.iter().map(gauge_name));
    if let Some(trajectories) = &scene.trajectories {
        check.trajectories(trajectories, scene);
    }
    if let Some(camera) = &scene.camera {
        if camera.position == camera.look_at {
            check.refuse(
                "camera.look_at",
                "camera looks at itself; move position or look_at".to_owned(),
            );
        }
        let angle = camera.field_of_view_deg;
        if !(0.0 < angle && angle < 170.0) {
            check.refuse(
                "camera.field_of_view_deg",
                format!("camera: field of view must be between 0 and 170 degrees, found {angle}"),
            );
        }
    }
    check.problems
}

fn gauge_name(gauge: &GaugeFile) -> &str {
    match gauge {
        GaugeFile::SurfaceElevation { name, .. }
        | GaugeFile::Pressure { name, .. }
        | GaugeFile::Velocity { name, .. }
        | GaugeFile::BlockForce { name, .. }
        | GaugeFile::RunUp { name, .. } => name,
    }
}

fn is_zero((x, y, z): Triple) -> bool {
    x == 0.0 && y == 0.0 && z == 0.0
}

fn is_ordered(min: Triple, max: Triple) -> bool {
    min.0 < max.0 && min.1 < max.1 && min.2 < max.2
}

fn is_inside(x: Triple, scene: &SceneFile) -> bool {
    let (min, max) = (scene.domain.min, scene.domain.max);
    min.0 <= x.0 && x.0 <= max.0 && min.1 <= x.1 && x.1 <= max.1 && min.2 <= x.2 && x.2 <= max.2
}

/// Problems as they are found.
#[derive(Default)]
struct Checks {
    problems: Vec<Problem>,
}

impl Checks {
    fn refuse(&mut self, path: impl Into<String>, message: String) {
        self.problems.push(Problem::error(path, message));
    }

    fn question(&mut self, path: impl Into<String>, message: String) {
        self.problems.push(Problem::warning(path, message));
    }

    fn positive(&mut self, path: String, what: &str, value: f64) {
        if value <= 0.0 {
            self.refuse(path, format!("{what} must be > 0, found {value}"));
        }
    }

    fn not_negative(&mut self, path: String, what: &str, value: f64) {
        if value < 0.0 {
            self.refuse(path, format!("{what} must be >= 0, found {value}"));
        }
    }

    fn share(&mut self, path: &str, what: &str, value: Option<f64>) {
        if let Some(value) = value
            && !(0.0 < value && value <= 1.0)
        {
            self.refuse(
                path,
                format!("{what} must be above 0 and at most 1, found {value}"),
            );
        }
    }

    fn unique<'a>(&mut self, list: &str, names: impl Iterator<Item = &'a str>) {
        let mut seen: Vec<&str> = Vec::new();
        for (index, name) in names.enumerate() {
            let path = format!("{list}[{index}]");
            if name.is_empty() {
                self.refuse(&path, "the name is empty".to_owned());
            }
            if name.contains([',', '"', '\n', '\r']) {
                self.refuse(
                    &path,
                    format!("the name `{name}` has a comma, quote or line break"),
                );
            }
            if seen.contains(&name) {
                self.refuse(
                    &path,
                    format!("the name `{name}` is taken; names in {list} must differ"),
                );
            }
            seen.push(name);
        }
    }

    fn domain(&mut self, scene: &SceneFile) {
        let domain = &scene.domain;
        if !is_ordered(domain.min, domain.max) {
            self.refuse(
                "domain.max",
                format!(
                    "domain: max {:?} must exceed min {:?} in every direction",
                    domain.max, domain.min
                ),
            );
        }
        let longest = (domain.max.0 - domain.min.0).max(domain.max.1 - domain.min.1);
        if longest > USUAL_EXTENT {
            self.question(
                "domain",
                format!("domain is {longest} m long; is it in millimetres?"),
            );
        }
        for (index, axis) in domain.periodic.iter().enumerate() {
            let along = match axis {
                Axis::X => scene.gravity.0,
                Axis::Y => scene.gravity.1,
                Axis::Z => scene.gravity.2,
            };
            let path = format!("domain.periodic[{index}]");
            if along != 0.0 {
                self.refuse(&path, format!("periodic along {axis:?}, but gravity acts along it; water would fall for ever"));
            }
            if domain.periodic[..index].contains(axis) {
                self.refuse(&path, format!("{axis:?} is listed twice"));
            }
        }
        self.symmetry(scene);
    }

    fn symmetry(&mut self, scene: &SceneFile) {
        let domain = &scene.domain;
        for (index, side) in domain.symmetry.iter().enumerate() {
            let path = format!("domain.symmetry[{index}]");
            let (number, _) = side.axis();
            let (axis, along) = [
                (Axis::X, scene.gravity.0),
                (Axis::Y, scene.gravity.1),
                (Axis::Z, scene.gravity.2),
            ][number];
            if domain.symmetry[..index].contains(side) {
                self.refuse(&path, format!("{side:?} is listed twice"));
            }
            if domain.periodic.contains(&axis) {
                self.refuse(&path, format!("{side:?} cannot be a plane of symmetry, for the domain repeats itself along {axis:?}; take {axis:?} out of periodic, or leave {side:?} out"));
            }
            if along != 0.0 {
                self.refuse(&path, format!("{side:?} cannot be a plane of symmetry, for gravity acts across it; choose a side along gravity"));
            }
            if axis == Axis::Y && domain.dimensions == DimensionsFile::Two {
                self.refuse(&path, format!("{side:?} cannot be a plane of symmetry, for nothing depends on y in a flow in two dimensions; leave it out"));
            }
            if scene.fluid.is_none() {
                self.refuse(
                    &path,
                    "a plane of symmetry mirrors water; add `fluid` or leave it out".to_owned(),
                );
            }
        }
    }

    fn material(&mut self, index: usize, material: &MaterialFile) {
        let path = |field: &str| format!("materials[{index}].{field}");
        let of = |what: &str| format!("material `{}`: {what}", material.name);
        self.positive(path("density"), &of("density"), material.density);
        if material.density > 0.0 && !USUAL_DENSITY.contains(&material.density) {
            self.question(
                path("density"),
                format!(
                    "{} is {} kg/m3; is it meant?",
                    of("density"),
                    material.density
                ),
            );
        }
        let angle = material.friction_angle_deg;
        if !(0.0..90.0).contains(&angle) {
            self.refuse(
                path("friction_angle_deg"),
                format!(
                    "{} must be in [0, 90) degrees, found {angle}",
                    of("friction angle")
                ),
            );
        }
        if let Some(residual) = material.residual_friction_angle_deg
            && !(0.0..=angle).contains(&residual)
        {
            self.refuse(
                path("residual_friction_angle_deg"),
                format!(
                    "{} must be in [0, {angle}], the friction angle, found {residual}",
                    of("residual friction angle")
                ),
            );
        }
        if let Some(stiffness) = material.joint_stiffness {
            self.positive(path("joint_stiffness"), &of("joint stiffness"), stiffness);
        }
        self.not_negative(path("cohesion"), &of("cohesion"), material.cohesion);
        if !(0.0..=material.cohesion).contains(&material.residual_cohesion) {
            self.refuse(
                path("residual_cohesion"),
                format!(
                    "{} must be in [0, {}], the cohesion, found {}",
                    of("residual cohesion"),
                    material.cohesion,
                    material.residual_cohesion
                ),
            );
        }
        self.not_negative(
            path("tensile_strength"),
            &of("tensile strength"),
            material.tensile_strength,
        );
        if !(0.0..=1.0).contains(&material.restitution) {
            self.refuse(
                path("restitution"),
                format!(
                    "{} must be in [0, 1], found {}",
                    of("restitution"),
                    material.restitution
                ),
            );
        }
        if let Some(stiffness) = material.contact_stiffness {
            self.positive(
                path("contact_stiffness"),
                &of("contact stiffness"),
                stiffness,
            );
        }
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
    }

    fn block(&mut self, index: usize, block: &BlockFile, scene: &SceneFile) {
        let path = |field: &str| format!("blocks[{index}].{field}");
        let of = |what: &str| format!("block `{}`: {what}", block.name);
        if !scene.materials.iter().any(|m| m.name == block.material) {
            let names: Vec<&str> = scene.materials.iter().map(|m| m.name.as_str()).collect();
            self.refuse(
                path("material"),
                format!(
                    "{} `{}` is not in materials{}",
                    of("material"),
                    block.material,
                    suggestion(&block.material, &names)
                ),
            );
        }
        let is_surface = matches!(
            block.shape,
            ShapeFile::Surface { .. } | ShapeFile::Raster { .. }
        );
        if is_surface && !matches!(block.motion, MotionFile::Fixed) {
            self.refuse(
                path("motion"),
                format!("{} must be Fixed: a surface has no mass", of("motion")),
            );
        }
        self.shape(&path("shape"), &block.shape, &block.name);
        if let Some(turn) = &block.placement.rotate
            && is_zero(turn.axis)
        {
            self.refuse(
                path("placement.rotate.axis"),
                format!("{} has no direction", of("axis of rotation")),
            );
        }
        if let MotionFile::Shaking { direction, .. } = &block.motion
            && is_zero(*direction)
        {
            self.refuse(
                path("motion.direction"),
                format!("{} has no direction", of("motion")),
            );
        }
        let is_free = matches!(block.motion, MotionFile::Free);
        if let Some(deformable) = &block.deformable {
            let material = scene.materials.iter().find(|m| m.name == block.material);
            if material.is_some_and(|m| m.elastic.is_none()) {
                self.refuse(
                    path("deformable"),
                    format!(
                        "{} needs a material with elastic moduli; give `{}` its `elastic`",
                        of("deformable"),
                        block.material
                    ),
                );
            }
            if !is_free || matches!(block.shape, ShapeFile::Sphere { .. }) {
                self.refuse(
                    path("deformable"),
                    format!(
                        "{} must be a free block of polyhedra; leave deformable out",
                        of("it")
                    ),
                );
            }
            if deformable.strain_mass_factor < 1.0 {
                self.refuse(
                    path("deformable.strain_mass_factor"),
                    format!(
                        "{} must be at least 1, found {}",
                        of("strain mass factor"),
                        deformable.strain_mass_factor
                    ),
                );
            }
        }
        if let Some(hold) = &block.hold {
            if !is_free {
                self.refuse(
                    path("hold"),
                    of("only a free block can be held; leave hold out"),
                );
            }
            if block.deformable.is_some() && hold.turning != TurningFile::Free {
                self.refuse(
                    path("hold.turning"),
                    of("the turning of a deformable block cannot be held"),
                );
            }
            for (k, axis) in hold.directions.iter().enumerate() {
                if hold.directions[..k].contains(axis) {
                    self.refuse(
                        path(&format!("hold.directions[{k}]")),
                        format!("{} {axis:?} is listed twice", of("hold")),
                    );
                }
            }
        }
        if let MotionFile::Sinusoid {
            direction,
            amplitude,
            period,
            ramp,
            ..
        } = &block.motion
        {
            if is_zero(*direction) {
                self.refuse(
                    path("motion.direction"),
                    format!("{} has no direction", of("motion")),
                );
            }
            self.not_negative(path("motion.amplitude"), &of("amplitude"), *amplitude);
            self.positive(path("motion.period"), &of("period"), *period);
            self.not_negative(path("motion.ramp"), &of("ramp"), *ramp);
        }
        let starts_at_rest = is_zero(block.velocity) && is_zero(block.angular_velocity);
        if !starts_at_rest && !matches!(block.motion, MotionFile::Free) {
            self.question(
                path("velocity"),
                of("an initial velocity has no effect on a block that is not free"),
            );
        }
    }

    fn rock_mass(&mut self, index: usize, mass: &RockMassFile, scene: &SceneFile) {
        let path = |field: &str| format!("rock_masses[{index}].{field}");
        let names: Vec<&str> = scene.materials.iter().map(|m| m.name.as_str()).collect();
        if !names.contains(&mass.material.as_str()) {
            self.refuse(
                path("material"),
                format!(
                    "rock mass `{}`: material `{}` is not in materials{}",
                    mass.name,
                    mass.material,
                    suggestion(&mass.material, &names)
                ),
            );
        }
        if mass.joint_sets.is_empty() {
            self.refuse(
                path("joint_sets"),
                format!(
                    "rock mass `{}`: no joint set; add one, or make it a block",
                    mass.name
                ),
            );
        }
        self.not_negative(
            path("minimum_volume"),
            &format!("rock mass `{}`: least volume", mass.name),
            mass.minimum_volume,
        );
        self.shape(&path("boundary"), &mass.boundary, &mass.name);
    }

    fn joint(&mut self, index: usize, joint: &JointFile, scene: &SceneFile) {
        let path = |field: &str| format!("joints[{index}].{field}");
        let (first, second) = &joint.between;
        let of = |what: &str| format!("joint of `{first}` and `{second}`: {what}");
        let names: Vec<&str> = scene.materials.iter().map(|m| m.name.as_str()).collect();
        let mut of_materials = Vec::new();
        for name in [first, second] {
            match scene.materials.iter().find(|m| m.name == *name) {
                Some(material) => of_materials.push(material),
                None => self.refuse(
                    path("between"),
                    format!(
                        "{} `{name}` is not in materials{}",
                        of("material"),
                        suggestion(name, &names)
                    ),
                ),
            }
        }
        let is_same = |other: &JointFile| {
            let (a, b) = &other.between;
            (a, b) == (first, second) || (b, a) == (first, second)
        };
        if scene.joints[..index].iter().any(is_same) {
            self.refuse(path("between"), of("is listed twice"));
        }
        // left out, it is the lesser of the two materials
        let angle = joint.friction_angle_deg.unwrap_or_else(|| {
            let angles = of_materials.iter().map(|m| m.friction_angle_deg);
            angles.fold(90.0, f64::min)
        });
        if joint.friction_angle_deg.is_some() && !(0.0..90.0).contains(&angle) {
            self.refuse(
                path("friction_angle_deg"),
                format!(
                    "{} must be in [0, 90) degrees, found {angle}",
                    of("friction angle")
                ),
            );
        }
        if let Some(residual) = joint.residual_friction_angle_deg
            && !(0.0..=angle).contains(&residual)
        {
            self.refuse(
                path("residual_friction_angle_deg"),
                format!(
                    "{} must be in [0, {angle}], the friction angle, found {residual}",
                    of("residual friction angle")
                ),
            );
        }
        let cohesion = joint.cohesion.unwrap_or_else(|| {
            let cohesions = of_materials.iter().map(|m| m.cohesion);
            cohesions.fold(f64::INFINITY, f64::min)
        });
        if let Some(residual) = joint.residual_cohesion
            && !(0.0..=cohesion).contains(&residual)
        {
            self.refuse(
                path("residual_cohesion"),
                format!(
                    "{} must be in [0, {cohesion}], the cohesion, found {residual}",
                    of("residual cohesion")
                ),
            );
        }
        for (field, what, value) in [
            ("cohesion", "cohesion", joint.cohesion),
            (
                "tensile_strength",
                "tensile strength",
                joint.tensile_strength,
            ),
            (
                "rolling_friction",
                "rolling friction",
                joint.rolling_friction,
            ),
        ] {
            if let Some(value) = value {
                self.not_negative(path(field), &of(what), value);
            }
        }
        if let Some(restitution) = joint.restitution
            && !(0.0..=1.0).contains(&restitution)
        {
            self.refuse(
                path("restitution"),
                format!(
                    "{} must be in [0, 1], found {restitution}",
                    of("restitution")
                ),
            );
        }
    }

    fn grains(&mut self, index: usize, grains: &GrainsFile, scene: &SceneFile) {
        let path = |field: &str| format!("grains[{index}].{field}");
        let of = |what: &str| format!("grains `{}`: {what}", grains.name);
        let names: Vec<&str> = scene.materials.iter().map(|m| m.name.as_str()).collect();
        if !names.contains(&grains.material.as_str()) {
            self.refuse(
                path("material"),
                format!(
                    "{} `{}` is not in materials{}",
                    of("material"),
                    grains.material,
                    suggestion(&grains.material, &names)
                ),
            );
        }
        let (smallest, largest) = grains.diameter;
        self.positive(path("diameter"), &of("diameter"), smallest);
        if largest < smallest {
            self.refuse(
                path("diameter"),
                format!(
                    "{} ({smallest}, {largest}): give the smallest, then the largest",
                    of("diameter")
                ),
            );
        }
        self.not_negative(path("jitter"), &of("jitter"), grains.jitter);
        let least = grains.least_spacing();
        if let Some(spacing) = grains.spacing
            && spacing < least
        {
            self.refuse(
                path("spacing"),
                format!(
                    "{} must be at least {least} m, the largest diameter times (1 + 2 jitter), found {spacing}",
                    of("spacing")
                ),
            );
        }
        if grains.count == Some(0) {
            self.refuse(path("count"), format!("{} must be > 0", of("count")));
        }
        match grains.region {
            GrainRegionFile::Box { min, max } => {
                if !is_ordered(min, max) {
                    self.refuse(
                        path("region.max"),
                        format!(
                            "{} {max:?} must exceed min {min:?} in every direction",
                            of("max")
                        ),
                    );
                }
            }
            GrainRegionFile::Cylinder { radius, height, .. } => {
                self.positive(path("region.radius"), &of("radius"), radius);
                self.positive(path("region.height"), &of("height"), height);
            }
        }
    }

    fn attachment(&mut self, index: usize, attachment: &AttachmentFile, scene: &SceneFile) {
        let at = format!("attachments[{index}]");
        let names: Vec<&str> = scene.blocks.iter().map(|b| b.name.as_str()).collect();
        let mut known = |field: &str, block: &String| {
            if !names.contains(&block.as_str()) {
                self.refuse(
                    format!("{at}.{field}"),
                    format!(
                        "attachment: there is no block `{block}`{}",
                        suggestion(block, &names)
                    ),
                );
            }
        };
        match attachment {
            AttachmentFile::PointLoad { block, .. } | AttachmentFile::BodyLoad { block, .. } => {
                known("block", block);
            }
            AttachmentFile::Pressure { block, face, .. } => {
                known("block", block);
                if is_zero(*face) {
                    self.refuse(
                        format!("{at}.face"),
                        "attachment: the face has no direction".to_owned(),
                    );
                }
            }
            AttachmentFile::FixedPoint {
                block, stiffness, ..
            } => {
                known("block", block);
                self.positive(
                    format!("{at}.stiffness"),
                    "attachment: stiffness",
                    *stiffness,
                );
            }
            AttachmentFile::RockBolt {
                from,
                to,
                from_point,
                to_point,
                stiffness,
                pretension,
                yield_force,
            } => {
                known("from", from);
                known("to", to);
                if from == to {
                    self.refuse(
                        format!("{at}.to"),
                        format!("rock bolt: both ends are in `{to}`; it needs two blocks"),
                    );
                }
                if from_point == to_point {
                    self.refuse(
                        format!("{at}.to_point"),
                        "rock bolt: its ends must be apart".to_owned(),
                    );
                }
                self.positive(
                    format!("{at}.stiffness"),
                    "rock bolt: stiffness",
                    *stiffness,
                );
                self.positive(
                    format!("{at}.yield_force"),
                    "rock bolt: yield force",
                    *yield_force,
                );
                if pretension.abs() > *yield_force {
                    self.refuse(
                        format!("{at}.pretension"),
                        format!(
                            "rock bolt: pretension {pretension} N exceeds its yield force {yield_force} N"
                        ),
                    );
                }
            }
        }
    }

    fn shape(&mut self, path: &str, shape: &ShapeFile, name: &str) {
        let of = |what: &str| format!("block `{name}`: {what}");
        match shape {
            ShapeFile::Box { min, max } => {
                if !is_ordered(*min, *max) {
                    self.refuse(
                        format!("{path}.max"),
                        format!(
                            "{} {max:?} must exceed min {min:?} in every direction",
                            of("max")
                        ),
                    );
                }
            }
            ShapeFile::Wedge {
                length,
                height,
                width,
            } => {
                self.positive(format!("{path}.length"), &of("length"), *length);
                self.positive(format!("{path}.height"), &of("height"), *height);
                self.positive(format!("{path}.width"), &of("width"), *width);
            }
            ShapeFile::Hull { points } => {
                if points.len() < 4 {
                    self.refuse(
                        format!("{path}.points"),
                        format!(
                            "{} needs at least four points, found {}",
                            of("hull"),
                            points.len()
                        ),
                    );
                }
            }
            ShapeFile::Polyhedron { vertices, faces } => {
                self.faces(path, vertices.len(), faces, name);
            }
            ShapeFile::Polyhedra { parts } => {
                if parts.is_empty() {
                    self.refuse(
                        format!("{path}.parts"),
                        of("no part; give at least one polyhedron"),
                    );
                }
                for (k, part) in parts.iter().enumerate() {
                    let path = format!("{path}.parts[{k}]");
                    self.faces(&path, part.vertices.len(), &part.faces, name);
                }
            }
            ShapeFile::Extrusion {
                polygon, from, to, ..
            } => {
                if polygon.len() < 3 {
                    self.refuse(
                        format!("{path}.polygon"),
                        format!(
                            "{} needs at least three corners, found {}",
                            of("polygon"),
                            polygon.len()
                        ),
                    );
                }
                if from >= to {
                    self.refuse(
                        format!("{path}.to"),
                        format!("{} {to} must exceed from {from}", of("to")),
                    );
                }
            }
            ShapeFile::Sphere { radius, .. } => {
                self.positive(format!("{path}.radius"), &of("radius"), *radius);
            }
            ShapeFile::Mesh { scale, .. } | ShapeFile::Surface { scale, .. } => {
                self.positive(format!("{path}.scale"), &of("scale"), *scale);
            }
            ShapeFile::Raster { origin, .. } => {
                if !(origin.0.is_finite() && origin.1.is_finite()) {
                    self.refuse(
                        format!("{path}.origin"),
                        format!("{} must be finite", of("origin")),
                    );
                }
            }
        }
    }

    fn faces(&mut self, path: &str, n_vertices: usize, faces: &[Vec<u32>], name: &str) {
        for (k, face) in faces.iter().enumerate() {
            if let Some(v) = face.iter().find(|&&v| v as usize >= n_vertices) {
                self.refuse(
                    format!("{path}.faces[{k}]"),
                    format!(
                        "block `{name}`: face {k} names vertex {v}, but there are {n_vertices}"
                    ),
                );
            }
        }
    }

    fn fluid(&mut self, fluid: &FluidFile, scene: &SceneFile) {
        self.positive("fluid.density".into(), "fluid: density", fluid.density);
        self.not_negative(
            "fluid.dynamic_viscosity".into(),
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
                "interface.slip",
                format!(
                    "interface: friction angle must be from 0 to below 90 degrees, found {angle}"
                ),
            );
        }
        match fluid.resolution {
            ResolutionFile::Spacing(spacing) => {
                self.positive("fluid.resolution".into(), "fluid: spacing", spacing);
            }
            ResolutionFile::Count(0) => {
                self.refuse(
                    "fluid.resolution",
                    "fluid: count must be > 0, found 0".to_owned(),
                );
            }
            ResolutionFile::Count(_) => {}
        }
        if fluid.regions.is_empty() {
            self.refuse(
                "fluid.regions",
                "fluid: no region; add one, or leave fluid out".to_owned(),
            );
        }
        for (index, region) in fluid.regions.iter().enumerate() {
            let path = format!("fluid.regions[{index}].shape");
            match &region.shape {
                RegionShapeFile::Box { min, max } => {
                    if !is_ordered(*min, *max) {
                        self.refuse(
                            format!("{path}.max"),
                            format!(
                                "fluid region `{}`: max {max:?} must exceed min {min:?}",
                                region.name
                            ),
                        );
                    } else if !(is_inside(*min, scene) && is_inside(*max, scene)) {
                        self.refuse(
                            path,
                            format!("fluid region `{}` reaches out of the domain", region.name),
                        );
                    }
                }
                RegionShapeFile::Below { level, seed } => {
                    if !is_inside(*seed, scene) {
                        self.refuse(
                            format!("{path}.seed"),
                            format!(
                                "fluid region `{}`: the seed {seed:?} is outside of the domain",
                                region.name
                            ),
                        );
                    }
                    if *level <= seed.2 {
                        self.refuse(
                            format!("{path}.level"),
                            format!("fluid region `{}`: the level {level} m must be above the seed at {} m", region.name, seed.2),
                        );
                    }
                }
            }
        }
        self.unique(
            "fluid.regions",
            fluid.regions.iter().map(|r| r.name.as_str()),
        );
    }

    fn rheology(&mut self, path: &str, rheology: Option<&RheologyFile>) {
        let Some(Err(error)) = rheology.map(|law| flow_law(law).check()) else {
            return;
        };
        self.refuse(path.to_owned(), error.to_string());
    }

    fn openings(&mut self, scene: &SceneFile) {
        let absorbers = scene.absorbers.iter().enumerate().map(|(index, a)| {
            let path = format!("absorbers[{index}]");
            (
                path,
                format!("absorber `{}`", a.name),
                (a.min, a.max),
                a.towards,
            )
        });
        let inflows = scene.inflows.iter().enumerate().map(|(index, i)| {
            let path = format!("inflows[{index}]");
            (
                path,
                format!("inflow `{}`", i.name),
                (i.min, i.max),
                i.towards,
            )
        });
        let outflows = scene.outflows.iter().enumerate().map(|(index, o)| {
            let path = format!("outflows[{index}]");
            (
                path,
                format!("outflow `{}`", o.name),
                (o.min, o.max),
                o.towards,
            )
        });
        let is_plane = scene.domain.dimensions == DimensionsFile::Two;
        for (path, what, (min, max), towards) in absorbers.chain(inflows).chain(outflows) {
            if !is_ordered(min, max) {
                self.refuse(
                    format!("{path}.max"),
                    format!("{what}: max {max:?} must exceed min {min:?} in every direction"),
                );
            }
            if scene.fluid.is_none() {
                self.refuse(
                    &path,
                    format!("{what} needs water; add `fluid` or leave it out"),
                );
            }
            let (axis, _) = towards.axis();
            if axis == 2 && !path.starts_with('a') || axis == 1 && is_plane {
                self.refuse(
                    format!("{path}.towards"),
                    format!("{what}: water cannot go to {towards:?} here; choose XMin or XMax, or in space YMin or YMax"),
                );
            }
        }
        for (index, absorber) in scene.absorbers.iter().enumerate() {
            if let Some(rate) = absorber.rate {
                let what = format!("absorber `{}`: rate", absorber.name);
                self.positive(format!("absorbers[{index}].rate"), &what, rate);
            }
        }
        for (index, inflow) in scene.inflows.iter().enumerate() {
            let path = format!("inflows[{index}]");
            let what = format!("inflow `{}`", inflow.name);
            if inflow.velocity.is_empty() == inflow.discharge.is_empty() {
                self.refuse(
                    &path,
                    format!("{what}: give either velocity or discharge, as [(time, value), ...]"),
                );
            }
            let height = inflow.max.2 - inflow.min.2;
            self.series(
                &format!("{path}.velocity"),
                &what,
                &inflow.velocity,
                f64::INFINITY,
            );
            self.series(
                &format!("{path}.discharge"),
                &what,
                &inflow.discharge,
                f64::INFINITY,
            );
            self.series(&format!("{path}.depth"), &what, &inflow.depth, height);
        }
        for (index, outflow) in scene.outflows.iter().enumerate() {
            let what = format!("outflow `{}`", outflow.name);
            let height = outflow.max.2 - outflow.min.2;
            self.series(
                &format!("outflows[{index}].depth"),
                &what,
                &outflow.depth,
                height,
            );
        }
        self.unique("absorbers", scene.absorbers.iter().map(|a| a.name.as_str()));
        self.unique("inflows", scene.inflows.iter().map(|i| i.name.as_str()));
        self.unique("outflows", scene.outflows.iter().map(|o| o.name.as_str()));
        if 0.0 < scene.time.settle && !(scene.inflows.is_empty() && scene.outflows.is_empty()) {
            self.refuse(
                "time.settle",
                "time: water that flows in or out does not settle; leave settle out".to_owned(),
            );
        }
    }

    /// Rows of time and value: times increase, values are from 0 to `most`.
    fn series(&mut self, path: &str, what: &str, rows: &[(f64, f64)], most: f64) {
        for (k, &(time, value)) in rows.iter().enumerate() {
            if k > 0 && !(rows[k - 1].0 < time) {
                self.refuse(
                    format!("{path}[{k}]"),
                    format!(
                        "{what}: times must increase, found {time} s after {} s",
                        rows[k - 1].0
                    ),
                );
            }
            if !(0.0..=most).contains(&value) {
                self.refuse(
                    format!("{path}[{k}]"),
                    format!("{what}: must be in [0, {most}], found {value}"),
                );
            }
        }
    }

    fn trajectories(&mut self, trajectories: &TrajectoriesFile, scene: &SceneFile) {
        if let Some(interval) = trajectories.interval {
            self.positive(
                "trajectories.interval".into(),
                "trajectories: interval",
                interval,
            );
        }
        let is_free = |block: &&BlockFile| matches!(block.motion, MotionFile::Free);
        let free = scene.blocks.iter().filter(is_free);
        let names: Vec<&str> = free.map(|block| block.name.as_str()).collect();
        for (index, name) in trajectories.blocks.iter().enumerate() {
            let path = format!("trajectories.blocks[{index}]");
            if !names.contains(&name.as_str()) {
                self.refuse(
                    &path,
                    format!(
                        "trajectories: `{name}` is no free block of `blocks`{}",
                        suggestion(name, &names)
                    ),
                );
            }
            if trajectories.blocks[..index].contains(name) {
                self.refuse(&path, format!("trajectories: `{name}` is listed twice"));
            }
        }
        if names.is_empty() && scene.rock_masses.is_empty() {
            self.refuse(
                "trajectories",
                "trajectories: no block is free to move; leave trajectories out".to_owned(),
            );
        }
        if scene.blocks.iter().all(|block| is_free(&block)) {
            self.question(
                "trajectories",
                "trajectories: no block is fixed, so there is no ground to measure heights from"
                    .to_owned(),
            );
        }
    }

    fn numbers(&mut self, scene: &SceneFile) {
        let (numerics, time, output) = (&scene.numerics, &scene.time, &scene.output);
        let positives = [
            (
                "interface.penalty_stiffness",
                "penalty stiffness",
                scene.interface.penalty_stiffness,
            ),
            ("numerics.sound_speed", "sound speed", numerics.sound_speed),
            (
                "numerics.expected_speed",
                "expected speed",
                numerics.expected_speed,
            ),
            (
                "output.frame_interval",
                "frame interval",
                output.frame_interval,
            ),
            (
                "output.gauge_interval",
                "gauge interval",
                output.gauge_interval,
            ),
            (
                "output.ledger_interval",
                "ledger interval",
                output.ledger_interval,
            ),
            ("time.duration", "duration", Some(time.duration)),
        ];
        for (path, what, value) in positives {
            if let Some(value) = value {
                self.positive(path.to_owned(), what, value);
            }
        }
        if let Some(damping) = scene.interface.penalty_damping {
            self.not_negative(
                "interface.penalty_damping".into(),
                "penalty damping",
                damping,
            );
        }
        self.not_negative("time.settle".into(), "settling time", time.settle);
        self.share(
            "numerics.time_step_factor",
            "time-step factor",
            numerics.time_step_factor,
        );
        self.share(
            "numerics.block_time_step_factor",
            "block time-step factor",
            numerics.block_time_step_factor,
        );
        let damping = "numerics.static_damping";
        match numerics.static_damping {
            Some(StaticDampingFile::MassProportional(value)) => {
                self.not_negative(damping.into(), "mass-proportional damping", value);
            }
            Some(StaticDampingFile::Local(value)) if !(0.0..1.0).contains(&value) => {
                self.refuse(
                    damping,
                    format!("local damping must be in [0, 1), found {value}"),
                );
            }
            Some(StaticDampingFile::Kinetic(value)) => {
                self.share(damping, "kinetic damping", Some(value));
            }
            _ => {}
        }
        if numerics.static_damping.is_some() {
            self.question(
                damping,
                "blocks are damped for a search for rest: their motion means nothing".to_owned(),
            );
        }
        if let Some(ratio) = numerics.smoothing_length_ratio
            && !(1.0..=3.0).contains(&ratio)
        {
            self.refuse(
                "numerics.smoothing_length_ratio",
                format!("smoothing length over spacing must be in [1, 3], found {ratio}: fewer neighbours than 30 or more than 900"),
            );
        }
    }

    fn gauge(&mut self, index: usize, gauge: &GaugeFile, scene: &SceneFile) {
        let name = gauge_name(gauge);
        let level = scene.domain.min.2;
        let mut inside = |field: &str, x: Triple| {
            if !is_inside(x, scene) {
                self.refuse(
                    format!("gauges[{index}].{field}"),
                    format!("gauge `{name}` at {x:?} is outside of the domain"),
                );
            }
        };
        match gauge {
            GaugeFile::SurfaceElevation { x, y, .. } => inside("x", (*x, *y, level)),
            GaugeFile::Pressure { position, .. } | GaugeFile::Velocity { position, .. } => {
                inside("position", *position);
            }
            GaugeFile::RunUp { from, to, .. } => {
                inside("from", (from.0, from.1, level));
                inside("to", (to.0, to.1, level));
            }
            GaugeFile::BlockForce { block, .. } => {
                let names: Vec<&str> = scene.blocks.iter().map(|b| b.name.as_str()).collect();
                if !names.contains(&block.as_str()) {
                    self.refuse(
                        format!("gauges[{index}].block"),
                        format!(
                            "gauge `{name}`: there is no block `{block}`{}",
                            suggestion(block, &names)
                        ),
                    );
                }
            }
        }
        if scene.fluid.is_none() && !matches!(gauge, GaugeFile::BlockForce { .. }) {
            self.question(
                format!("gauges[{index}]"),
                format!("gauge `{name}` measures water, but the scene has none"),
            );
        }
    }
}
