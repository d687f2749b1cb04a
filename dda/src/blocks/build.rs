//! Construction of a system of blocks: bodies about their centroids, in principal axes, with margins and limits.

use super::definition::check_settings;
use crate::contact::rates::BlockRates;
use crate::geometry::bounds::{grown, overlap};
use crate::geometry::parts::Part;
use crate::material::Joint;
use crate::motion::deformation::{
    Affine12, AffineBody, Dda12, Deformable, elastic_constants, tensor,
};
use crate::motion::kinematics::Kinematics;
use crate::{
    BlockDefinition, BlockError, Blocks, Deformability, DeformableModel, Isometry, JointOverride,
    Load, MassProperties, Material, Motion, NormalLaw, Settings, Shape, Vec3,
};
use nalgebra::{Matrix3, Rotation3, SymmetricEigen, UnitQuaternion};

/// Overlap allowed, × thickness: two plates of equal thickness have passed each other's middle, and
/// would be pushed out on the wrong side, at 1.
const THICKNESS_SHARE: f64 = 0.5;
/// Largest margin of the fat boxes, × thickness: half of it is the largest displacement of a block in a step.
const SKIN_OF_THICKNESS: f64 = 0.25;
/// A block is a needle from this `m R² |J⁻¹|` on, which is 8 of a cube and `3/2 a²` of a box a : 1 : 1; –.
const NEEDLE: f64 = 1e3;
/// Below this share of the volume of its body a part is a sliver of it; –.
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

    /// Creates blocks with joints between certain materials.
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
        this.find_candidates();
        this.bond_pairs();
        this.evaluate_contacts(0.0, &mut |_| {});
        Ok(this)
    }

    fn push(
        &mut self,
        block: usize,
        definition: BlockDefinition,
        materials: &[Material],
    ) -> Result<(), BlockError> {
        let BlockDefinition {
            shape,
            material,
            motion,
            velocity,
            angular_velocity,
            deformability,
        } = definition;
        let Some(rock) = materials.get(material) else {
            return Err(BlockError::NoSuchMaterial {
                block,
                material,
                n_materials: materials.len(),
            });
        };
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
        let properties = shape.mass_properties();
        let is_surface = matches!(shape, Shape::Surface(_));
        if is_surface && !matches!(motion, Motion::Fixed) {
            return Err(BlockError::Surface { block });
        }
        let has_volume = properties.volume > 0.0 && properties.volume.is_finite();
        if !has_volume && !is_surface {
            return Err(BlockError::Empty { block });
        }
        if !velocity
            .iter()
            .chain(angular_velocity.iter())
            .all(|c| c.is_finite())
        {
            return Err(BlockError::NotFinite { block });
        }
        let mut displacement = Vec3::zeros();
        let mut turn = UnitQuaternion::identity();
        if let Motion::Prescribed(path) = &motion {
            path.check(block)?;
            displacement = path.displacement(0.0);
            turn = path.turn(0.0);
        }
        let deformable = match &deformability {
            None => None,
            Some(wanted) => Some(make_deformable(
                block,
                wanted,
                (&shape, &motion),
                rock,
                (&properties, &angular_velocity),
            )?),
        };
        let (moments, principal) = if is_surface {
            // it has no mass and never moves: nonzero moments give zero spin instead of 0/0
            (Vec3::repeat(1.0), UnitQuaternion::identity())
        } else {
            principal_axes(&properties, rock.density)
        };
        let start = properties.centroid;
        self.push_parts(
            block,
            material,
            &shape,
            &start,
            !matches!(motion, Motion::Fixed),
        );
        self.state.centroid.push(start + displacement);
        self.state.velocity.push(match &motion {
            Motion::Free => velocity,
            Motion::Fixed => Vec3::zeros(),
            Motion::Prescribed(path) => path.velocity(0.0),
        });
        let spin = match &motion {
            Motion::Free => angular_velocity,
            Motion::Fixed => Vec3::zeros(),
            Motion::Prescribed(path) => path.spin(0.0),
        };
        let attitude = turn * principal;
        let momentum = attitude
            .inverse_transform_vector(&spin)
            .component_mul(&moments);
        self.state.angular_momentum.push(momentum);
        self.state.attitude.push(attitude);
        self.state.is_removed.push(false);
        self.state.kinematics.push(Kinematics {
            centroid: start,
            velocity,
            spin,
            inverse_mass: 0.0,
            inverse_inertia: Matrix3::zeros(),
            strain_rate: None,
        });
        self.constants.deformable_of.push(
            deformable
                .is_some()
                .then_some(self.state.deformables.len() as u32),
        );
        self.state.deformables.extend(deformable);
        self.state.contact_load.push(Load::default());
        self.state.contact_load_before.push(Load::default());
        self.state.rates.push(BlockRates::default());
        let mass = rock.density * properties.volume;
        let lever = self.worst_lever(block, &moments, &principal, mass);
        self.constants.lever.push(lever);
        self.constants.mass.push(mass);
        self.constants.volume.push(properties.volume);
        self.constants.inertia.push(moments);
        self.constants.principal.push(principal);
        self.constants.initial_centroid.push(start);
        self.constants.motion.push(motion);
        Ok(())
    }

    fn push_parts(
        &mut self,
        block: usize,
        material: usize,
        shape: &Shape,
        centroid: &Vec3,
        can_move: bool,
    ) {
        let shift = Isometry::translation(-centroid.x, -centroid.y, -centroid.z);
        let first = self.constants.reference.len();
        // A surface stays where it is given.
        let about_centroid = match shape {
            Shape::Surface(_) => shape.clone(),
            _ => shape.transformed(&shift),
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
        let mut radius = 0.0_f64;
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
            self.constants.material_of_part.push(material as u32);
            self.constants.margin.push(if can_move {
                f64::min(SKIN * size, SKIN_OF_THICKNESS * thickness)
            } else {
                0.0
            });
            self.constants.size.push(size);
            self.constants.deepest_allowed.push(f64::min(
                self.constants.settings.overlap_limit * size,
                THICKNESS_SHARE * thickness,
            ));
        }
        self.constants.radius.push(radius);
        let margins = self.constants.margin[first..].iter().copied();
        self.constants
            .least_margin
            .push(margins.fold(f64::INFINITY, f64::min));
        self.constants
            .part_start
            .push(self.constants.reference.len() as u32);
    }

    /// The radius `R`; for a needle the lever with the rotational compliance of its worst corner. A force across a needle's axis
    /// acts about the axis with a lever of at most half a thickness, never half its length.
    ///
    /// ```text
    /// R² |J⁻¹| = max_r Σ_k (r² − r_k²)/J_k                                                   [1/kg]
    /// ```
    fn worst_lever(
        &self,
        block: usize,
        moments: &Vec3,
        principal: &UnitQuaternion<f64>,
        mass: f64,
    ) -> f64 {
        let radius = self.constants.radius[block];
        let inverse = moments.map(|moment| 1.0 / moment);
        let softness = inverse.norm();
        if !(radius * radius * softness * mass > NEEDLE) {
            return radius;
        }
        let compliance = |corner: &Vec3| {
            let r = principal.inverse_transform_vector(corner);
            let square = r.norm_squared();
            r.map(|component| square - component * component)
                .dot(&inverse)
        };
        let worst = self.constants.reference[self.parts_of(block)]
            .iter()
            .map(|part| match part {
                Part::Polyhedron(body) => {
                    body.vertices().iter().map(compliance).fold(0.0, f64::max)
                }
                Part::Sphere { .. } | Part::Surface(_) => f64::INFINITY,
            })
            .fold(0.0, f64::max);
        radius.min((worst / softness).sqrt())
    }

    /// Finds the faces that nothing can touch and the corners where surfaces join, between parts of one
    /// body and between fixed bodies.
    fn note_neighbors(&mut self) {
        let is_fixed = |block: u32| matches!(self.constants.motion[block as usize], Motion::Fixed);
        // In the initial placement, where the fixed parts can be compared.
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

/// The deformable body of a block, at t = 0.
fn make_deformable(
    block: usize,
    wanted: &Deformability,
    (shape, motion): (&Shape, &Motion),
    rock: &Material,
    (properties, spin): (&MassProperties, &Vec3),
) -> Result<Deformable, BlockError> {
    let refuse = |reason| Err(BlockError::Deformability { block, reason });
    if !matches!(motion, Motion::Free) {
        return refuse("only a free block can be deformable");
    }
    if !matches!(shape, Shape::Polyhedra(_)) {
        return refuse("only a block of polyhedra can be deformable");
    }
    let Some(elastic) = &rock.elastic else {
        return refuse("its material has no elastic moduli");
    };
    if !(wanted.strain_mass_factor >= 1.0 && wanted.strain_mass_factor.is_finite()) {
        return refuse("the factor on the inertia of strain must be at least 1");
    }
    if wanted.initial_stress.iter().any(|c| !c.is_finite()) {
        return refuse("the initial stress must be finite");
    }
    let second_moment = properties.second_moment * rock.density;
    let Some(body) = AffineBody::new(
        second_moment,
        properties.volume,
        spin,
        wanted.strain_mass_factor,
    ) else {
        return refuse("it is flat");
    };
    let constants = elastic_constants(elastic, &second_moment, properties.volume);
    let stress = tensor(&wanted.initial_stress);
    Ok(match wanted.model {
        DeformableModel::Affine12(law) => {
            Deformable::Affine12(Affine12::new(body, law, constants, stress))
        }
        DeformableModel::Dda12 => Deformable::Dda12(Dda12::new(body, constants, stress)),
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

/// Moments of inertia and the rotation from principal axes to the given placement.
fn principal_axes(properties: &MassProperties, density: f64) -> (Vec3, UnitQuaternion<f64>) {
    let inertia = properties.inertia() * density;
    let largest = inertia.abs().max();
    let off_diagonal = inertia[(0, 1)]
        .abs()
        .max(inertia[(0, 2)].abs())
        .max(inertia[(1, 2)].abs());
    // Already principal: keep the axes, and the digits.
    if off_diagonal <= 1e-14 * largest {
        return (inertia.diagonal(), UnitQuaternion::identity());
    }
    let eigen = SymmetricEigen::new(inertia);
    let mut axes = eigen.eigenvectors;
    if axes.determinant() < 0.0 {
        axes.set_column(0, &-axes.column(0));
    }
    let turn = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
    (eigen.eigenvalues, turn)
}
