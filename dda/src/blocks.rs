//! The state of all blocks, struct of arrays, and how it is made; `query` is what can be asked of it.

mod pairing;
pub(crate) mod placement;
mod query;

use crate::{
    Attachment, BlockError, ContactDetection, Deformability, DeformableModel, Hold, Isometry,
    JointOverride, Load, MassProperties, Material, Motion, NormalLaw, RollingLaw, Shape,
    StaticDamping, Turning, Vec3,
    attachments::{Attachments, Surroundings},
    broad_phase::{self, Bounds},
    contact::{Pair, Workspace},
    critical_step::BlockRates,
    deformation::{Affine12, AffineBody, Dda12, Deformable, elastic_constants, tensor},
    energy::Account,
    kinematics::Kinematics,
    links::Links,
    material::Joint,
    parts::Part,
    sphere_contact::{PairRates, Rolling, SphereContact, SphereLoads, SphereMark, SpherePair},
    surface_contact::SurfacePair,
};
use nalgebra::{Matrix3, Rotation3, SymmetricEigen, UnitQuaternion};
use pairing::SpherePairBefore;

/// A block as it is given.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockDefinition {
    /// Geometry in its world placement at t = 0.
    pub shape: Shape,
    /// Position in the list of materials.
    pub material: usize,
    /// How it moves.
    pub motion: Motion,
    /// Initial velocity of the centroid, free blocks only; m/s.
    pub velocity: Vec3,
    /// Initial angular velocity, free blocks only; world; rad/s.
    pub angular_velocity: Vec3,
    /// Makes a free block of polyhedra deformable; rigid if none.
    pub deformability: Option<Deformability>,
}

/// Numbers of the solver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Acceleration of gravity; m/s².
    pub gravity: Vec3,
    /// Share `C_b` of the stability bound that a step may use, 0 < C_b ≤ 1. Default 0.8; the bound
    /// itself is about half the true limit.
    pub time_step_factor: f64,
    /// Damping ratio of the shear dashpots, ≥ 0. Default 0.2: a sliding block that stops does not
    /// ring.
    pub shear_damping_ratio: f64,
    /// Deepest overlap allowed, × size of the smaller part; never more than half the thickness of the thinner
    /// one. Default 0.2.
    pub overlap_limit: f64,
    /// How balls answer to being pressed. Default a linear spring; Hertz's needs elastic moduli.
    pub normal_law: NormalLaw,
    /// Which turning of balls is resisted. Default that of one against the other.
    pub rolling_law: RollingLaw,
    /// How common planes are found. Default verified.
    pub contact_detection: ContactDetection,
    /// Damping for a search for a state of rest. Default none: not for blocks that move.
    pub static_damping: Option<StaticDamping>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            gravity: Vec3::new(0.0, 0.0, -9.81),
            time_step_factor: 0.8,
            shear_damping_ratio: 0.2,
            overlap_limit: 0.2,
            normal_law: NormalLaw::default(),
            rolling_law: RollingLaw::default(),
            contact_detection: ContactDetection::default(),
            static_damping: None,
        }
    }
}

/// A system of blocks: state, then what follows from it, then constants.
///
/// Columns are one per block unless said otherwise. Velocities are those of full steps.
#[derive(Clone, Debug)]
pub struct Blocks {
    // State.
    /// Centroid; m.
    pub(crate) centroid: Vec<Vec3>,
    /// Velocity of the centroid; m/s.
    pub(crate) velocity: Vec<Vec3>,
    /// World from principal axes.
    pub(crate) attitude: Vec<UnitQuaternion<f64>>,
    /// Angular momentum in principal axes; N m s.
    pub(crate) angular_momentum: Vec<Vec3>,
    /// Has it left?
    pub(crate) is_removed: Vec<bool>,
    /// The blocks that deform.
    pub(crate) deformables: Vec<Deformable>,
    /// Loads, supports and bolts.
    pub(crate) attachments: Attachments,
    /// Candidate pairs of parts with their contact history, sorted by parts.
    pub(crate) pairs: Vec<Pair>,
    /// The same of which a ball is one.
    pub(crate) sphere_pairs: Vec<SpherePair>,
    /// One per pair of `sphere_pairs`, as the columns that follow.
    pub(crate) sphere_marks: Vec<SphereMark>,
    pub(crate) sphere_contacts: Vec<SphereContact>,
    pub(crate) sphere_loads: Vec<SphereLoads>,
    pub(crate) sphere_rates: Vec<PairRates>,
    /// Empty if no joint resists rolling.
    pub(crate) sphere_rolling: Vec<Rolling>,
    /// The same of which a surface is one; the body first.
    pub(crate) surface_pairs: Vec<SurfacePair>,
    pub(crate) friction: Account,
    pub(crate) damping: Account,
    pub(crate) strain_damping: Account,
    pub(crate) static_damping: Account,
    pub(crate) external_work: Account,
    /// Impulse of gravity and of fixed and prescribed blocks on free ones; N s.
    pub(crate) support_impulse: Vec3,
    /// Sum of the sizes of gravity's and the supports' impulses; N s.
    pub(crate) impulse_exchanged: f64,
    /// Angular impulse that rolling resistance gave to balls without giving it back elsewhere; N m s.
    pub(crate) rolling_impulse: Vec3,
    pub(crate) n_contact_updates: u64,
    pub(crate) n_broken_bonds: u64,
    pub(crate) n_axis_searches: u64,
    pub(crate) max_overlap_over_size: f64,

    // Follows from the state.
    /// Rigid motion of every block; written by integrate.
    pub(crate) kinematics: Vec<Kinematics>,
    /// Sum of contact forces; written by contacts.
    pub(crate) contact_load: Vec<Load>,
    /// The same, one sub-step before.
    pub(crate) contact_load_before: Vec<Load>,
    /// What the contacts add to the step bound.
    pub(crate) rates: Vec<BlockRates>,
    /// Deepest overlap at the last evaluation, × what is allowed, with its parts.
    pub(crate) worst_overlap: (f64, (u32, u32)),
    /// Straining moment of the contacts; one per deformable block; N m.
    pub(crate) contact_stretch: Vec<Matrix3<f64>>,
    /// World geometry; one per part.
    pub(crate) parts: Vec<Part>,
    /// Boxes around the parts; one per part.
    pub(crate) boxes: Vec<Bounds>,
    /// Boxes that the candidate pairs were found with; one per part.
    pub(crate) fat_boxes: Vec<Bounds>,
    pub(crate) candidates: Vec<(u32, u32)>,
    pub(crate) pairs_before: Vec<Pair>,
    /// One per chunk of `pairs`, or more.
    pub(crate) workspaces: Vec<Workspace>,
    pub(crate) surface_pairs_before: Vec<SurfacePair>,
    pub(crate) sphere_pairs_before: Vec<SpherePairBefore>,
    /// The pairs of each block.
    pub(crate) links: Links,
    pub(crate) sphere_links: Links,
    pub(crate) surface_links: Links,
    /// Are the links others than when the rates were summed?
    pub(crate) has_new_links: bool,

    // Constants.
    pub(crate) motion: Vec<Motion>,
    /// Who moves it.
    pub(crate) role: Vec<Role>,
    /// The blocks of that role.
    pub(crate) special: Vec<u32>,
    /// Position among the deformable blocks, if it is one.
    pub(crate) deformable_of: Vec<Option<u32>>,
    /// What it may not do; none for any block if empty.
    pub(crate) holds: Vec<Option<Hold>>,
    pub(crate) mass: Vec<f64>,
    pub(crate) volume: Vec<f64>,
    /// Principal moments of inertia; kg m².
    pub(crate) inertia: Vec<Vec3>,
    /// Initial placement from principal axes.
    pub(crate) principal: Vec<UnitQuaternion<f64>>,
    pub(crate) initial_centroid: Vec<Vec3>,
    /// Farthest point from the centroid; m.
    pub(crate) radius: Vec<f64>,
    /// First part of each block, and at the end the number of parts; n_blocks + 1.
    pub(crate) part_start: Vec<u32>,
    /// One per part.
    pub(crate) block_of_part: Vec<u32>,
    /// One per part.
    pub(crate) material_of_part: Vec<u32>,
    /// Geometry about the initial centroid, in the initial axes; one per part.
    pub(crate) reference: Vec<Part>,
    /// Margin of the fat box, zero if the part cannot move; one per part; m.
    pub(crate) margin: Vec<f64>,
    /// Deepest overlap allowed: a share of the size, and so little of the thickness that no part can come
    /// out on the other side; one per part; m.
    pub(crate) deepest_allowed: Vec<f64>,
    /// Cube root of the volume; one per part; m.
    pub(crate) size: Vec<f64>,
    /// One per part.
    pub(crate) can_move: Vec<bool>,
    pub(crate) has_rolling: bool,
    /// Least margin of its parts; one per block; m.
    pub(crate) least_margin: Vec<f64>,
    /// Constants of every pair of materials, row by row.
    pub(crate) joints: Vec<Joint>,
    pub(crate) n_materials: usize,
    pub(crate) settings: Settings,
}

/// Who moves a block in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Role {
    /// Forces do not.
    Still,
    /// Forces: rigid and free of holds.
    Plain,
    /// Forces: deformable, held, or damped by its load.
    Special,
}

/// Blocks, or pairs of balls, that one thread takes at a time.
pub(crate) const CHUNK: usize = 512;
/// Overlap allowed, × thickness: two plates of equal thickness have passed each other's middle, and
/// would be pushed out on the wrong side, at 1.
const THICKNESS_SHARE: f64 = 0.5;
/// Margin of the fat boxes, × thickness at most: half of it is the way that a block may go in a step.
const SKIN_OF_THICKNESS: f64 = 0.25;
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

    /// The same with joints between certain materials.
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
        let resists_rolling = joints.iter().any(|j| j.spheres.rolling_friction > 0.0);
        let mut this = Self::empty(joints, materials.len(), settings);
        this.has_rolling = resists_rolling;
        for (block, definition) in definitions.into_iter().enumerate() {
            this.push(block, definition, &materials)?;
        }
        this.note_neighbors();
        this.note_roles();
        this.place_parts(true);
        this.find_candidates();
        this.bond_pairs();
        this.evaluate_contacts(0.0, &mut |_| {});
        Ok(this)
    }

    fn empty(joints: Vec<Joint>, n_materials: usize, settings: Settings) -> Self {
        Self {
            centroid: Vec::new(),
            velocity: Vec::new(),
            attitude: Vec::new(),
            angular_momentum: Vec::new(),
            is_removed: Vec::new(),
            deformables: Vec::new(),
            attachments: Attachments::default(),
            pairs: Vec::new(),
            sphere_pairs: Vec::new(),
            sphere_marks: Vec::new(),
            sphere_contacts: Vec::new(),
            sphere_loads: Vec::new(),
            sphere_rates: Vec::new(),
            sphere_rolling: Vec::new(),
            surface_pairs: Vec::new(),
            friction: Account::default(),
            damping: Account::default(),
            strain_damping: Account::default(),
            static_damping: Account::default(),
            external_work: Account::default(),
            support_impulse: Vec3::zeros(),
            impulse_exchanged: 0.0,
            rolling_impulse: Vec3::zeros(),
            n_contact_updates: 0,
            n_broken_bonds: 0,
            n_axis_searches: 0,
            max_overlap_over_size: 0.0,
            kinematics: Vec::new(),
            contact_load: Vec::new(),
            contact_load_before: Vec::new(),
            rates: Vec::new(),
            worst_overlap: (0.0, (0, 0)),
            contact_stretch: Vec::new(),
            parts: Vec::new(),
            boxes: Vec::new(),
            fat_boxes: Vec::new(),
            candidates: Vec::new(),
            pairs_before: Vec::new(),
            workspaces: Vec::new(),
            surface_pairs_before: Vec::new(),
            sphere_pairs_before: Vec::new(),
            links: Links::default(),
            sphere_links: Links::default(),
            surface_links: Links::default(),
            has_new_links: true,
            motion: Vec::new(),
            role: Vec::new(),
            special: Vec::new(),
            deformable_of: Vec::new(),
            holds: Vec::new(),
            mass: Vec::new(),
            volume: Vec::new(),
            inertia: Vec::new(),
            principal: Vec::new(),
            initial_centroid: Vec::new(),
            radius: Vec::new(),
            part_start: vec![0],
            block_of_part: Vec::new(),
            material_of_part: Vec::new(),
            reference: Vec::new(),
            margin: Vec::new(),
            deepest_allowed: Vec::new(),
            size: Vec::new(),
            can_move: Vec::new(),
            has_rolling: false,
            least_margin: Vec::new(),
            joints,
            n_materials,
            settings,
        }
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
        if self.settings.normal_law == NormalLaw::Hertz
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
        if let Motion::Prescribed(path) = &motion {
            path.check(block)?;
            displacement = path.displacement(0.0);
        }
        let is_free = matches!(motion, Motion::Free);
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
        let (moments, principal) = principal_axes(&properties, rock.density);
        let start = properties.centroid;
        self.push_parts(
            block,
            material,
            &shape,
            &start,
            !matches!(motion, Motion::Fixed),
        );
        self.centroid.push(start + displacement);
        self.velocity.push(match &motion {
            Motion::Free => velocity,
            Motion::Fixed => Vec3::zeros(),
            Motion::Prescribed(path) => path.velocity(0.0),
        });
        let spin = if is_free {
            angular_velocity
        } else {
            Vec3::zeros()
        };
        let momentum = principal
            .inverse_transform_vector(&spin)
            .component_mul(&moments);
        self.angular_momentum.push(momentum);
        self.attitude.push(principal);
        self.is_removed.push(false);
        self.kinematics.push(Kinematics {
            centroid: start,
            velocity,
            spin,
            inverse_mass: 0.0,
            inverse_inertia: Matrix3::zeros(),
            strain_rate: None,
        });
        self.deformable_of.push(
            deformable
                .is_some()
                .then_some(self.deformables.len() as u32),
        );
        self.deformables.extend(deformable);
        self.contact_load.push(Load::default());
        self.contact_load_before.push(Load::default());
        self.rates.push(BlockRates::default());
        self.mass.push(rock.density * properties.volume);
        self.volume.push(properties.volume);
        self.inertia.push(moments);
        self.principal.push(principal);
        self.initial_centroid.push(start);
        self.motion.push(motion);
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
        let first = self.reference.len();
        // A surface stays where it is given.
        let about_centroid = match shape {
            Shape::Surface(_) => shape.clone(),
            _ => shape.transformed(&shift),
        };
        match about_centroid {
            Shape::Surface(surface) => self.reference.push(Part::Surface(surface)),
            Shape::Polyhedra(parts) => self.reference.extend(
                parts
                    .into_iter()
                    .map(|part| Part::Polyhedron(Box::new(part))),
            ),
            Shape::Sphere { center, radius } => {
                self.reference.push(Part::Sphere { center, radius })
            }
        }
        let mut radius = 0.0_f64;
        for part in &self.reference[first..] {
            let from = if part.is_surface() {
                *centroid
            } else {
                Vec3::zeros()
            };
            radius = radius.max(part.reach_from(&from));
            let mut placed = part.clone();
            placed.set_transformed(part, &shift.inverse());
            self.parts.push(placed);
            self.boxes.push(part.aabb());
            self.fat_boxes.push(part.aabb());
            self.block_of_part.push(block as u32);
            self.material_of_part.push(material as u32);
            self.margin.push(if can_move {
                f64::min(SKIN * part.size(), SKIN_OF_THICKNESS * part.thickness())
            } else {
                0.0
            });
            self.can_move.push(can_move);
            self.size.push(part.size());
            self.deepest_allowed.push(f64::min(
                self.settings.overlap_limit * part.size(),
                THICKNESS_SHARE * part.thickness(),
            ));
        }
        self.radius.push(radius);
        let margins = self.margin[first..].iter().copied();
        self.least_margin
            .push(margins.fold(f64::INFINITY, f64::min));
        self.part_start.push(self.reference.len() as u32);
    }

    /// Finds the faces that nothing can touch and the corners where surfaces join, between parts of one
    /// body and between fixed bodies.
    fn note_neighbors(&mut self) {
        let is_fixed = |block: u32| matches!(self.motion[block as usize], Motion::Fixed);
        // In the initial placement, where the fixed parts can be compared.
        let placed = self.parts.clone();
        let fixed: Vec<usize> = (0..placed.len())
            .filter(|&part| is_fixed(self.block_of_part[part]))
            .collect();
        for part in 0..self.parts.len() {
            let block = self.block_of_part[part];
            let own: Vec<usize> = self.parts_of(block as usize).collect();
            let company = if is_fixed(block) { &fixed } else { &own };
            if company.len() < 2 || !matches!(placed[part], Part::Polyhedron(_)) {
                continue;
            }
            let others: Vec<&crate::Polyhedron> = company
                .iter()
                .filter_map(|&other| match &placed[other] {
                    Part::Polyhedron(body) => {
                        let is_near = broad_phase::overlap(
                            &broad_phase::grown(&placed[part].aabb(), 1e-2 * body.size()),
                            &body.aabb(),
                        );
                        (other != part && is_near).then_some(&**body)
                    }
                    Part::Sphere { .. } | Part::Surface(_) => None,
                })
                .collect();
            let turn_back =
                self.attitude[block as usize] * self.principal[block as usize].inverse();
            if let (Part::Polyhedron(body), Part::Polyhedron(reference)) =
                (&mut self.parts[part], &mut self.reference[part])
            {
                crate::parts::note_neighbors(body, &others);
                reference.copy_neighbors(body, &turn_back.inverse());
            }
        }
    }

    /// Sorts the blocks by who moves them.
    fn note_roles(&mut self) {
        let is_damped = matches!(self.settings.static_damping, Some(StaticDamping::Local(_)));
        self.role = (0..self.n_blocks())
            .map(|b| {
                if !self.is_free(b) {
                    Role::Still
                } else if is_damped || self.deformable_of[b].is_some() || self.hold_of(b).is_some()
                {
                    Role::Special
                } else {
                    Role::Plain
                }
            })
            .collect();
        self.special = (0..self.n_blocks())
            .filter(|&b| self.role[b] == Role::Special)
            .map(|b| b as u32)
            .collect();
    }

    pub(crate) fn hold_of(&self, block: usize) -> Option<&Hold> {
        self.holds.get(block).and_then(Option::as_ref)
    }

    /// Holds a free, rigid block in some directions, or its turning, from now on.
    ///
    /// # Errors
    ///
    /// [`BlockError::Hold`] if the block does not exist, is not free and rigid, or the hold is unusable.
    pub fn hold(&mut self, block: usize, hold: Hold) -> Result<(), BlockError> {
        if block >= self.n_blocks() || !self.is_free(block) {
            return Err(BlockError::Hold {
                block,
                reason: "it is not a free block",
            });
        }
        if self.deformable_of[block].is_some() && hold.turning != Turning::Free {
            return Err(BlockError::Hold {
                block,
                reason: "the turning of a deformable block cannot be held",
            });
        }
        hold.check(block)?;
        let n = self.n_blocks();
        self.holds.resize(n, None);
        let held = hold.held_part(&self.velocity[block]);
        self.velocity[block] -= held;
        let (attitude, inertia) = (self.attitude[block], self.inertia[block]);
        hold.hold_turning(&attitude, &inertia, &mut self.angular_momentum[block]);
        self.holds[block] = Some(hold);
        self.note_roles();
        self.set_kinematics(block);
        Ok(())
    }

    /// Attaches loads, supports and bolts, at t = 0.
    ///
    /// # Errors
    ///
    /// [`BlockError::Attachment`] names the first that is unusable.
    pub fn attach(&mut self, attachments: &[Attachment]) -> Result<(), BlockError> {
        for (number, attachment) in attachments.iter().enumerate() {
            self.attachments.push(
                attachment,
                number,
                &self.centroid,
                &self.mass,
                &self.part_start,
                &self.parts,
            )?;
        }
        self.evaluate_attachments(true);
        Ok(())
    }

    pub(crate) fn evaluate_attachments(&mut self, is_first: bool) {
        if self.attachments.is_empty() {
            return;
        }
        let mut attachments = std::mem::take(&mut self.attachments);
        attachments.evaluate(
            &Surroundings {
                kinematics: &self.kinematics,
                gradient: &|b| self.placement_gradient(b),
                is_free: &|b| self.is_free(b),
                deformable_of: &self.deformable_of,
                parts: &self.parts,
            },
            is_first,
        );
        self.attachments = attachments;
    }

    /// World from the axes of the start: rotation, with strain where there is any.
    fn placement_gradient(&self, block: usize) -> Matrix3<f64> {
        match self.deformable_of[block] {
            None => *self.orientation(block).to_rotation_matrix().matrix(),
            Some(k) => self.deformables[k as usize].body().gradient,
        }
    }

    /// Takes a block out: it no longer moves, collides or counts in sums.
    pub fn remove(&mut self, b: usize) {
        if self.is_removed[b] {
            return;
        }
        self.is_removed[b] = true;
        for part in self.parts_of(b) {
            self.boxes[part] = NOWHERE;
            self.fat_boxes[part] = NOWHERE;
            self.can_move[part] = false;
        }
        self.note_roles();
        let stays = |blocks: (u32, u32)| blocks.0 as usize != b && blocks.1 as usize != b;
        self.pairs.retain(|pair| stays(pair.blocks));
        self.surface_pairs.retain(|pair| stays(pair.blocks));
        fn keep<T>(column: &mut Vec<T>, stays: &[bool]) {
            let mut stays = stays.iter();
            column.retain(|_| stays.next().is_none_or(|&stays| stays));
        }
        let left: Vec<bool> = self.sphere_pairs.iter().map(|p| stays(p.blocks)).collect();
        keep(&mut self.sphere_pairs, &left);
        keep(&mut self.sphere_marks, &left);
        keep(&mut self.sphere_contacts, &left);
        keep(&mut self.sphere_loads, &left);
        keep(&mut self.sphere_rates, &left);
        keep(&mut self.sphere_rolling, &left);
        self.link_pairs();
        self.contact_load[b] = Load::default();
        self.velocity[b] = Vec3::zeros();
        self.angular_momentum[b] = Vec3::zeros();
        self.set_kinematics(b);
        self.sum_loads();
    }
}

/// A box that overlaps nothing.
const NOWHERE: Bounds = (
    Vec3::new(f64::INFINITY, f64::INFINITY, f64::INFINITY),
    Vec3::new(f64::NEG_INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY),
);

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

/// Moments of inertia and the turn that takes principal axes to the given placement.
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

fn check_settings(settings: &Settings) -> Result<(), BlockError> {
    let refuse = |field, value, rule| Err(BlockError::Setting { field, value, rule });
    let Settings {
        gravity,
        time_step_factor,
        shear_damping_ratio,
        overlap_limit,
        contact_detection: _,
        normal_law: _,
        rolling_law: _,
        static_damping,
    } = *settings;
    if let Some(&value) = gravity.iter().find(|c| !c.is_finite()) {
        return refuse("gravity", value, "must be finite");
    }
    if !(time_step_factor > 0.0 && time_step_factor <= 1.0) {
        return refuse(
            "time_step_factor",
            time_step_factor,
            "must be above 0 and at most 1",
        );
    }
    if !(shear_damping_ratio >= 0.0 && shear_damping_ratio.is_finite()) {
        return refuse("shear_damping_ratio", shear_damping_ratio, "must be >= 0");
    }
    if !(overlap_limit > 0.0 && overlap_limit <= 1.0) {
        return refuse(
            "overlap_limit",
            overlap_limit,
            "must be above 0 and at most 1",
        );
    }
    match static_damping {
        Some(StaticDamping::MassProportional(value)) if !(value >= 0.0 && value.is_finite()) => {
            refuse("static_damping", value, "must be >= 0 1/s")
        }
        Some(StaticDamping::Local(value)) if !(0.0..1.0).contains(&value) => {
            refuse("static_damping", value, "must be in [0, 1)")
        }
        Some(StaticDamping::Kinetic(value)) if !(value > 0.0 && value <= 1.0) => {
            refuse("static_damping", value, "must be above 0 and at most 1")
        }
        _ => Ok(()),
    }
}
