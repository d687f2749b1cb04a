//! The state of all blocks, struct of arrays; `build` is how it is made, `query` what can be asked of it.

mod build;
mod checkpoint;
mod definition;
pub(crate) mod links;
mod pairing;
pub(crate) mod placement;
mod query;
mod strength;

use crate::blocks::links::Links;
use crate::contact::detection::broad_phase::Bounds;
use crate::contact::penalty::polyhedra::{Pair, Workspace};
use crate::contact::penalty::spheres::{
    PairRates, Rolling, SphereContact, SphereLoads, SphereMark, SpherePair,
};
use crate::contact::penalty::step_bound::BlockRates;
use crate::contact::penalty::terrain::SurfacePair;
use crate::geometry::parts::Part;
use crate::material::Joint;
use crate::motion::deformation::Deformable;
use crate::motion::kinematics::Kinematics;
use crate::step::accounts::Accounts;
use crate::step::attachments::{Attachments, Surroundings};
use crate::step::energy::Account;
use crate::step::sleep::Rest;
use crate::{Attachment, BlockError, Hold, Load, Motion, StaticDamping, Turning, Vec3};
pub use definition::{BlockDefinition, Settings};
use nalgebra::{Matrix3, UnitQuaternion};
use pairing::SpherePairBefore;

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
    /// What was left of the motion of blocks that fell asleep.
    pub(crate) laid_to_rest: Account,
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
    pub(crate) rest: Rest,

    // Follows from the state.
    /// Rigid motion of every block; written by integrate.
    pub(crate) kinematics: Vec<Kinematics>,
    /// Sum of contact forces; written by contacts.
    pub(crate) contact_load: Vec<Load>,
    /// The same, one sub-step before.
    pub(crate) contact_load_before: Vec<Load>,
    pub(crate) accounts: Accounts,
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
    /// Did pairs meet or part in this step?
    pub(crate) has_excess: bool,

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
    /// Lever by which no contact turns the block more easily than by its worst corner: the radius, less where
    /// the block is a needle; m.
    pub(crate) lever: Vec<f64>,
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
    /// As they were before the first was weakened; empty until then.
    joints_at_start: Vec<Joint>,
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
    /// Forces would, but it lies still.
    Asleep,
    /// Forces: deformable, held, or damped by its load.
    Special,
}

/// Blocks, or pairs of balls, that one thread takes at a time.
pub(crate) const CHUNK: usize = 512;
impl Blocks {
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
            laid_to_rest: Account::default(),
            rest: Rest::default(),
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
            accounts: Accounts::default(),
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
            has_excess: false,
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
            lever: Vec::new(),
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
            joints_at_start: Vec::new(),
            n_materials,
            settings,
        }
    }

    /// Sorts the blocks by who moves them.
    pub(crate) fn note_roles(&mut self) {
        let is_damped = matches!(self.settings.static_damping, Some(StaticDamping::Local(_)));
        self.role = (0..self.n_blocks())
            .map(|b| {
                if !self.is_free(b) {
                    Role::Still
                } else if is_damped || self.deformable_of[b].is_some() || self.hold_of(b).is_some()
                {
                    Role::Special
                } else if self.rest.has(b) {
                    Role::Asleep
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
        self.rest.leave(b);
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
