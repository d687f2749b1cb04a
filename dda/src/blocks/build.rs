//! Construction of a system of blocks: bodies about their centroids, in principal axes, with margins and limits.

use super::body::{Body, InitialMotion};
use super::definition::check_settings;
use crate::contact::rates::BlockRates;
use crate::geometry::bounds::{grown, overlap};
use crate::geometry::parts::Part;
use crate::material::Joint;
use crate::motion::deformation::Deformable;
use crate::motion::kinematics::{Kinematics, LeverArm};
use crate::{
    BlockDefinition, BlockError, Blocks, Integrator, Isometry, JointOverride, Load, Material,
    Motion, NormalLaw, RollingLaw, Settings, Shape, Vec3,
};
use nalgebra::Matrix3;

/// Largest margin of the fat boxes, × thickness: half of it is the largest displacement of a block in a step.
const SKIN_OF_THICKNESS: f64 = 0.25;
/// Least `m R² |J⁻¹|` of a needle; it is 8 of a cube and `3/2 a²` of a box a : 1 : 1; –.
const NEEDLE: f64 = 1e3;
/// Largest share of a sliver in the volume of its body; –.
const SLIVER_SHARE: f64 = 0.05;
/// Margin of the fat boxes; × size of the part.
const SKIN: f64 = 0.05;

impl Blocks {
    /// A system of blocks at t = 0, its contacts found and its bonds made.
    ///
    /// # Errors
    ///
    /// [`BlockError`] names the first block, material or setting that is unusable.
    pub fn new(
        definitions: Vec<BlockDefinition>,
        materials: Vec<Material>,
        settings: Settings,
    ) -> Result<Self, BlockError> {
        Self::with_joints(definitions, materials, &[], settings)
    }

    /// A system of blocks with special joints between certain pairs of materials.
    ///
    /// # Errors
    ///
    /// As [`Blocks::new`], and for the first joint that is unusable.
    pub fn with_joints(
        definitions: Vec<BlockDefinition>,
        materials: Vec<Material>,
        overrides: &[JointOverride],
        settings: Settings,
    ) -> Result<Self, BlockError> {
        check_settings(&settings)?;
        let joints = Joint::table(&materials, overrides, settings.normal_law)?;
        let mut this = Self::empty(joints, materials.len(), settings);
        for (block, definition) in definitions.into_iter().enumerate() {
            this.push(block, definition, &materials)?;
        }
        this.note_neighbors();
        this.begin_rest();
        this.sort_by_update();
        this.mark_movable_parts();
        this.place_parts(true);
        this.find_candidates(0.0);
        match settings.integrator {
            Integrator::CentralDifference => {
                this.check_central_difference()?;
                this.bond_pairs();
                this.evaluate_contacts(0.0, &mut |_| {});
            }
            Integrator::ContactDynamics(_) => {
                this.check_contact_dynamics()?;
                this.bond_pairs();
                this.fix_bonds();
                this.state.outside = vec![Load::default(); this.n_blocks()];
                this.state.outside_stretch = vec![Matrix3::zeros(); this.state.deformables.len()];
            }
        }
        Ok(this)
    }

    /// Refuses what springs do not model.
    fn check_central_difference(&self) -> Result<(), BlockError> {
        let mut joints = self.constants.initial_joints.iter();
        match joints.any(|j| 0.0 < j.spheres.twisting_friction) {
            true => Err(BlockError::Setting {
                field: "integrator",
                value: f64::NAN,
                rule: "springs do not resist twisting: take contact dynamics, or leave `twisting_friction` at 0",
            }),
            false => Ok(()),
        }
    }

    /// Refuses what contact dynamics does not model.
    fn check_contact_dynamics(&self) -> Result<(), BlockError> {
        let refuse = |rule| {
            Err(BlockError::Setting {
                field: "integrator",
                value: f64::NAN,
                rule,
            })
        };
        let joints = &self.constants.initial_joints;
        for deformable in &self.state.deformables {
            if deformable.affine().is_none() {
                return refuse(
                    "contact dynamics has no classical unknowns, whose stress follows increments: take the affine model",
                );
            }
            if deformable.body().strain_mass_factor > 1.0 {
                return refuse(
                    "contact dynamics has no limit of the step by strain: leave the inertia of strain as it is",
                );
            }
        }
        if joints.iter().any(|j| j.residual_cohesion > 0.0) {
            return refuse("contact dynamics has no residual cohesion: its friction is a cone");
        }
        if self.constants.settings.rolling_law == RollingLaw::OwnSpin
            && joints.iter().any(|j| j.spheres.rolling_friction > 0.0)
        {
            return refuse(
                "contact dynamics resists rolling between bodies, not against the world",
            );
        }
        Ok(())
    }

    fn push(
        &mut self,
        block: usize,
        definition: BlockDefinition,
        materials: &[Material],
    ) -> Result<(), BlockError> {
        let rock = rock_of(block, &definition, materials)?;
        self.check_normal_law(&definition.shape, materials)?;
        let body = Body::of(block, &definition, rock)?;
        self.push_parts(block, &definition, &body.centroid);
        self.push_state(&InitialMotion::of(&definition), &body);
        self.push_constants(block, definition.motion, &body);
        self.push_deformable(body.deformable);
        Ok(())
    }

    fn check_normal_law(&self, shape: &Shape, materials: &[Material]) -> Result<(), BlockError> {
        if self.constants.settings.normal_law == NormalLaw::Hertz
            && matches!(shape, Shape::Sphere { .. })
            && materials.iter().any(|m| m.elastic.is_none())
        {
            return Err(BlockError::Setting {
                field: "normal_law",
                value: f64::NAN,
                rule: "Hertz needs elastic moduli of every material",
            });
        }
        Ok(())
    }

    fn push_state(&mut self, initial: &InitialMotion, body: &Body) {
        let InitialMotion {
            displacement,
            turn,
            velocity,
            spin,
        } = *initial;
        let attitude = turn * body.principal;
        let momentum = attitude
            .inverse_transform_vector(&spin)
            .component_mul(&body.moments);
        self.state.centroid.push(body.centroid + displacement);
        self.state.velocity.push(velocity);
        self.state.angular_momentum.push(momentum);
        self.state.attitude.push(attitude);
        self.state.is_removed.push(false);
        self.state.kinematics.push(Kinematics {
            centroid: body.centroid,
            velocity,
            spin,
            inverse_mass: 0.0,
            inverse_inertia: Matrix3::zeros(),
            strain_rate: None,
        });
        self.state.contact_load.push(Load::default());
        self.state.contact_load_before.push(Load::default());
        self.state.travel.push(0.0);
        self.state.rates.push(BlockRates::default());
    }

    fn push_constants(&mut self, block: usize, motion: Motion, body: &Body) {
        let lever_arm = self.lever_arm(block, body);
        self.constants.lever_arm.push(lever_arm);
        self.constants.mass.push(body.mass);
        self.constants.volume.push(body.volume);
        self.constants.inertia.push(body.moments);
        self.constants.principal.push(body.principal);
        self.constants.initial_centroid.push(body.centroid);
        self.constants.motion.push(motion);
    }

    fn push_deformable(&mut self, deformable: Option<Deformable>) {
        let number = self.state.deformables.len() as u32;
        let of_block = deformable.is_some().then_some(number);
        self.constants.deformable_of.push(of_block);
        self.state.deformables.extend(deformable);
    }

    fn push_parts(&mut self, block: usize, definition: &BlockDefinition, centroid: &Vec3) {
        let shift = Isometry::translation(-centroid.x, -centroid.y, -centroid.z);
        let first = self.constants.reference.len();
        let can_move = !matches!(definition.motion, Motion::Fixed);
        // a surface keeps its given position
        let about_centroid = match &definition.shape {
            Shape::Surface(_) => definition.shape.clone(),
            shape => shape.transformed(&shift),
        };
        match about_centroid {
            Shape::Surface(surface) => self.constants.reference.push(Part::Surface(surface)),
            Shape::Polyhedra(parts) => self.constants.reference.extend(
                parts
                    .into_iter()
                    .map(|part| Part::Polyhedron(Box::new(part))),
            ),
            Shape::Sphere { center, radius } => self
                .constants
                .reference
                .push(Part::Sphere { center, radius }),
        }
        let (least_size, least_thickness) = least_of_the_large(&self.constants.reference[first..]);
        let (mut radius, mut least_margin) = (0.0_f64, f64::INFINITY);
        for part in &self.constants.reference[first..] {
            let (size, thickness) = (
                part.size().max(least_size),
                part.thickness().max(least_thickness),
            );
            let from = if part.is_surface() {
                *centroid
            } else {
                Vec3::zeros()
            };
            radius = radius.max(part.reach_from(&from));
            let mut placed = part.clone();
            placed.set_transformed(part, &shift.inverse());
            self.derived.parts.push(placed);
            self.state.boxes.push(part.aabb());
            self.state.fat_boxes.push(part.aabb());
            self.constants.block_of_part.push(block as u32);
            self.constants
                .material_of_part
                .push(definition.material as u32);
            let margin = if can_move {
                f64::min(SKIN * size, SKIN_OF_THICKNESS * thickness)
            } else {
                0.0
            };
            least_margin = least_margin.min(margin);
            // pairs of spheres are listed by distance, not by boxes: as many as with boxes of that margin
            self.constants.margin.push(if part.is_sphere() {
                3.0_f64.sqrt() * margin
            } else {
                margin
            });
            self.constants.size.push(size);
            self.constants.thickness.push(thickness);
        }
        self.constants.radius.push(radius);
        self.constants.least_margin.push(least_margin);
        self.constants
            .part_start
            .push(self.constants.reference.len() as u32);
    }

    /// Worst point of contact: among the corners, or anywhere on the bounding sphere of a block that is no polyhedron.
    ///
    /// Its lever is the radius `R`, or for a needle that with the rotational compliance of its worst corner: a force across the axis
    /// of a needle acts about this axis with a lever of at most half a thickness, never half its length.
    ///
    /// ```text
    /// R² |J⁻¹| = max_r Σ_k (r² − r_k²)/J_k                                                   [1/kg]
    /// ```
    fn lever_arm(&self, block: usize, body: &Body) -> LeverArm {
        let radius = self.constants.radius[block];
        let inverse = body.moments.map(|moment| 1.0 / moment);
        let softness = inverse.norm();
        let is_needle = radius * radius * softness * body.mass > NEEDLE;
        let (mut trace, mut largest) = (0.0, 0.0);
        for part in &self.constants.reference[self.parts_of(block)] {
            let Part::Polyhedron(part) = part else {
                return LeverArm {
                    length: radius,
                    compliance: radius * radius * inverse.max(),
                };
            };
            for corner in part.vertices() {
                let arms = body
                    .principal
                    .inverse_transform_vector(corner)
                    .cross_matrix();
                let compliance = arms.transpose() * Matrix3::from_diagonal(&inverse) * arms;
                trace = f64::max(trace, compliance.trace());
                largest = f64::max(largest, compliance.symmetric_eigenvalues().max());
            }
        }
        LeverArm {
            length: if is_needle {
                radius.min((trace / softness).sqrt())
            } else {
                radius
            },
            compliance: largest,
        }
    }

    /// Hidden faces, and corners where surfaces join, between parts of one body and between fixed bodies.
    fn note_neighbors(&mut self) {
        let is_fixed = |block: u32| matches!(self.constants.motion[block as usize], Motion::Fixed);
        // fixed parts can be compared in their initial placement
        let placed = self.derived.parts.clone();
        let fixed: Vec<usize> = (0..placed.len())
            .filter(|&part| is_fixed(self.constants.block_of_part[part]))
            .collect();
        for part in 0..self.derived.parts.len() {
            let block = self.constants.block_of_part[part];
            let own: Vec<usize> = self.parts_of(block as usize).collect();
            let company = if is_fixed(block) { &fixed } else { &own };
            if company.len() < 2 || !matches!(placed[part], Part::Polyhedron(_)) {
                continue;
            }
            let others: Vec<&crate::Polyhedron> = company
                .iter()
                .filter_map(|&other| match &placed[other] {
                    Part::Polyhedron(body) => {
                        let is_near = overlap(
                            &grown(&placed[part].aabb(), 1e-2 * body.size()),
                            &body.aabb(),
                        );
                        (other != part && is_near).then_some(&**body)
                    }
                    Part::Sphere { .. } | Part::Surface(_) => None,
                })
                .collect();
            let turn_back = self.state.attitude[block as usize]
                * self.constants.principal[block as usize].inverse();
            if let (Part::Polyhedron(body), Part::Polyhedron(reference)) = (
                &mut self.derived.parts[part],
                &mut self.constants.reference[part],
            ) {
                crate::geometry::parts::note_neighbors(body, &others);
                reference.copy_neighbors(body, &turn_back.inverse());
            }
        }
    }
}

/// Material of a block.
fn rock_of<'a>(
    block: usize,
    definition: &BlockDefinition,
    materials: &'a [Material],
) -> Result<&'a Material, BlockError> {
    let material = definition.material;
    materials.get(material).ok_or(BlockError::NoSuchMaterial {
        block,
        material,
        n_materials: materials.len(),
    })
}

/// Smallest size and thickness of the parts of a body except its slivers; m. A sliver that is part of a body moves with the
/// others and is restrained by them: alone it would require steps and overlaps as small as itself.
fn least_of_the_large(parts: &[Part]) -> (f64, f64) {
    let volume = |part: &Part| part.size().powi(3);
    let whole: f64 = parts.iter().map(volume).sum();
    let is_large = |part: &&Part| SLIVER_SHARE * whole <= volume(part);
    let least = |of: fn(&Part) -> f64| {
        let large = parts.iter().filter(is_large);
        large.map(of).fold(f64::INFINITY, f64::min)
    };
    (least(Part::size), least(Part::thickness))
}
