//! The accounts of a run: energy with every sink named, and momentum.

use serde::{Deserialize, Serialize};

use crate::grains::AveragedGrains;
use crate::joints::JointWater;
use crate::walls::Walls;
use crate::walls::penalty::Interface;
use crate::world::World;
use riprap_dda::{Blocks, Load};
use riprap_sph::{Exchange, Fluid, Vec3};

/// Declares every term once: the field, its column of `energy.csv` and its position in the row.
macro_rules! energy_terms {
    ($($(#[$doc:meta])* $term:ident,)*) => {
        /// Energy terms; J. Losses and works count from the start of the ledger.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
        pub struct Energy {
            $($(#[$doc])* pub $term: f64,)*
        }

        impl Energy {
            /// Names of the terms.
            pub const TERMS: &'static [&'static str] = &[$(stringify!($term)),*];

            /// The terms in the order of [`Energy::TERMS`]; J.
            pub fn terms(&self) -> [f64; Self::TERMS.len()] {
                [$(self.$term),*]
            }
        }
    };
}

energy_terms! {
    /// Of motion, fluid and free blocks.
    kinetic,
    /// In the field of gravity.
    potential,
    /// In contact springs, bolts, supports and penalty walls.
    elastic,
    /// In deformable blocks.
    strain,
    /// Of compression of the fluid.
    internal,
    /// Taken by friction between blocks.
    friction,
    /// Taken by viscosity.
    viscous,
    /// Taken by bulk viscosity.
    bulk,
    /// Taken by drag between water and grains whose forces are averages.
    drag,
    /// Of compression, taken by density diffusion.
    diffusive,
    /// Taken by the dashpots of contacts and walls.
    damping,
    /// Taken by the viscosity of deformable blocks.
    strain_damping,
    /// Taken by the damping of a search for rest.
    static_damping,
    /// Taken by bolts that yield.
    plastic,
    /// Dissipated where particles stopped at a solid, or were pushed back out of it.
    pushed_back,
    /// Energy of water and blocks that left the domain.
    removed,
    /// Taken by absorbing layers.
    absorbed,
    /// Kinetic energy removed when water was put to sleep.
    sleep_loss,
    /// Brought in by prescribed blocks and given loads.
    external_work,
    /// Brought in by the removal of overlap that contact dynamics leaves.
    overlap_removal,
    /// Brought in by exact joints as they restore the places of their points; of either sign.
    joint_correction,
    /// Brought in by water in joints too narrow for particles, which pushes blocks apart.
    joint_water,
    /// Energy through inflows and outflows, including the work of imposing the flow there.
    through_openings,
    /// Energy introduced at walls of particles or integrals: the work of their pressure on the water minus that of the
    /// blocks, `Σ p_w V_w V_a (v_w − v_a)·∇W`. That pressure is extrapolated from the water and its work is not stored: an
    /// error of the walls, which decreases with the spacing. Cercos-Pita, Antuono, Colagrossi & Souto-Iglesias (2017).
    at_walls,
    /// Energy introduced at grains by their averages: by the room that they take and the water that they carry along at once as they get wet,
    /// and by averages that reach walls before the grains do.
    at_grains,
    /// Energy unexplained by the terms above since the start: the error of the scheme.
    residual,
}

impl Energy {
    /// Kinetic, potential, elastic, strain and internal energy; J.
    pub fn stored(&self) -> f64 {
        self.kinetic + self.potential + self.elastic + self.strain + self.internal
    }

    /// All losses; J.
    pub fn lost(&self) -> f64 {
        self.friction
            + self.viscous
            + self.bulk
            + self.drag
            + self.diffusive
            + self.damping
            + self.strain_damping
            + self.static_damping
            + self.plastic
            + self.pushed_back
            + self.removed
            + self.absorbed
            + self.sleep_loss
    }
}

/// Work and impulse of the interface forces, booked with each half kick.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct Ledger {
    /// Stored energy at the start; J.
    stored_at_start: f64,
    /// Fluid and block momentum at the start; kg m/s.
    momentum_at_start: Vec3,
    /// Taken by wall dashpots; J.
    wall_damping: f64,
    /// Taken by stopping particles at solids and putting them back; J.
    pub(crate) pushed_back: f64,
    /// Given by prescribed blocks to the fluid; J.
    wall_work: f64,
    /// Given by blocks that are not free, by planes of symmetry and by gravity to the fluid; kg m/s.
    pub(crate) impulse: Vec3,
    /// Sum of the sizes of these impulses; kg m/s.
    exchanged: f64,
    /// Momentum of blocks that left; kg m/s.
    pub(crate) removed_momentum: Vec3,
    /// Energy of blocks that left; J.
    pub(crate) removed_energy: f64,
    /// Taken by absorbing layers; J.
    absorbed: f64,
    /// Taken from water that was put to sleep; J.
    sleep_loss: f64,
    /// Brought in through openings; J.
    through_openings: f64,
    /// Brought in by water in joints; J.
    joint_water: f64,
    /// Given to the fluid through the pressure of walls by blocks that move; J.
    pressed: f64,
    /// The same through their shear; J.
    dragged: f64,
    /// Taken by drag of grains; J.
    drag: f64,
    /// Taken from grains by the viscosity of the water that they share their volume with; J.
    viscous_at_grains: f64,
    /// Brought in by grains as they get wet, and given by water that is accelerated with them, its own energy not counted; J.
    at_grains: f64,
    /// Kinetic energy of water that was accelerated with grains at the start; J.
    added_at_start: f64,
}

impl Ledger {
    /// Books work (J) that a prescribed block did on the fluid at once.
    pub(crate) fn push(&mut self, work: f64) {
        self.wall_work += work;
    }

    /// Books the (negative) contribution of absorbing layers.
    pub(crate) fn absorb(&mut self, absorbed: &Exchange) {
        self.absorbed -= absorbed.energy;
        self.impulse += absorbed.momentum;
        self.exchanged += absorbed.momentum.norm();
    }

    /// Books the (negative) contribution of putting water to sleep.
    pub(crate) fn put_to_sleep(&mut self, lost: &Exchange) {
        self.sleep_loss -= lost.energy;
        self.impulse += lost.momentum;
        self.exchanged += lost.momentum.norm();
    }

    /// Books the work of water in joints on moving blocks over `dt`, as [`Self::book_walls`]: blocks at rest on each other are pushed
    /// apart in one kick and return by the next, which the velocities before each kick alone would book as work.
    pub(crate) fn book_joints(&mut self, joints: &JointWater, blocks: &Blocks, dt: f64) {
        self.joint_water += joints.power_on_free_blocks(blocks) * dt;
    }

    /// Books the energy of compression (J) that grains brought into the water as they got wet.
    pub(crate) fn compress(&mut self, brought: f64) {
        self.at_grains += brought;
    }

    /// Books the exchange of averaged forces with grains over `dt`, as [`Self::book_walls`].
    pub(crate) fn book_grains(
        &mut self,
        grains: &AveragedGrains,
        fluid: &Fluid,
        blocks: &Blocks,
        dt: f64,
    ) {
        let power = grains.power(fluid, blocks);
        self.drag += power.drag * dt;
        self.at_grains += power.added * dt;
        self.viscous_at_grains += power.viscous * dt;
        self.wall_work += power.by_prescribed * dt;
        self.impulse += power.held * dt;
        self.exchanged += power.held.norm() * dt;
    }

    /// Books the contribution of openings.
    pub(crate) fn exchange(&mut self, brought: &Exchange) {
        self.through_openings += brought.energy;
        self.impulse += brought.momentum;
        self.exchanged += brought.momentum.norm();
    }

    /// Books the work of moving blocks on the fluid through its walls over `dt`, at their current velocities: half of a
    /// kick before it, half after it, so that the work equals that lost by the blocks.
    pub(crate) fn book_walls(&mut self, walls: &Walls, blocks: &Blocks, dt: f64) {
        for (b, load) in walls.loads().iter().enumerate() {
            let (linear, angular) = (blocks.velocity(b), blocks.angular_velocity(b));
            let power = |load: &Load| load.force.dot(&linear) + load.torque.dot(&angular);
            let strained = match blocks.is_deformable(b) {
                true => load.stretch.dot(&blocks.velocity_gradient(b)),
                false => 0.0,
            };
            self.pressed -= (power(&load.pressure) + strained) * dt;
            self.dragged -= power(&load.shear) * dt;
        }
    }

    /// Books the interface forces and gravity over `dt`: half of a step, with each half kick.
    pub(crate) fn book(&mut self, fluid: &Fluid, holding: &Holding, dt: f64) {
        let Holding {
            interface,
            walls,
            joints,
            blocks,
        } = *holding;
        let mut power = 0.0;
        let mut work = 0.0;
        let mut impulse = Vec3::zeros();
        for on in interface.forces() {
            power += on.dissipated_power;
            if !blocks.is_free(on.block as usize) {
                work += on.force.dot(&on.wall_velocity);
                impulse += on.force;
            } else {
                // the transverse load taken by a slab
                let felt = Load {
                    force: on.force,
                    ..Load::default()
                };
                impulse += on.force - interface.in_plane(felt).force;
            }
        }
        if let Some(walls) = walls {
            work += walls.power();
            impulse += walls.force_on_fluid();
            for (block, load) in walls.loads().iter().enumerate() {
                if blocks.is_free(block) {
                    impulse += interface.in_plane(load.total()).force;
                }
            }
        }
        let by_joints = Load {
            force: joints.force_on_free_blocks(blocks),
            ..Load::default()
        };
        impulse += interface.in_plane(by_joints).force;
        // sleeping water is supported from below
        let weight = fluid.settings().gravity * fluid.awake_mass();
        let mirrored = fluid.plane_force();
        self.wall_damping += power * dt;
        self.wall_work += work * dt;
        self.impulse += (impulse + weight + mirrored) * dt;
        self.exchanged += (impulse.norm() + weight.norm() + mirrored.norm()) * dt;
    }
}

/// Whatever holds the fluid and the blocks that it is made of, at the time of a kick.
#[derive(Debug)]
pub(crate) struct Holding<'a> {
    pub interface: &'a Interface,
    pub walls: Option<&'a Walls>,
    pub joints: &'a JointWater,
    pub blocks: &'a Blocks,
}

impl World {
    /// Opens the ledger: energy and momentum count from here.
    pub(crate) fn open_ledger(&mut self) {
        if let Some(water) = &mut self.water {
            water.fluid.open_ledger();
        }
        self.progress.ledger = Ledger::default();
        let grains = self.water.as_ref().and_then(|water| water.grains.as_ref());
        let added = grains.map_or(0.0, AveragedGrains::added_energy);
        self.progress.ledger.added_at_start = added;
        self.progress.ledger.stored_at_start = self.energy().stored();
        self.progress.ledger.momentum_at_start = self.momentum() - self.blocks.support_impulse();
    }

    /// Energy of blocks and fluid, with all that was lost and brought in since the start; J.
    pub fn energy(&self) -> Energy {
        let blocks = self.blocks.energies();
        let mut energy = Energy {
            kinetic: blocks.kinetic,
            potential: blocks.potential,
            elastic: blocks.elastic,
            strain: blocks.strain,
            strain_damping: blocks.strain_damping,
            static_damping: blocks.static_damping,
            plastic: blocks.plastic,
            friction: blocks.friction,
            damping: blocks.damping + self.progress.ledger.wall_damping,
            pushed_back: self.progress.ledger.pushed_back,
            removed: self.progress.ledger.removed_energy,
            absorbed: self.progress.ledger.absorbed,
            sleep_loss: self.progress.ledger.sleep_loss + blocks.sleep_loss,
            overlap_removal: blocks.overlap_removal,
            joint_correction: blocks.joint_correction,
            joint_water: self.progress.ledger.joint_water,
            through_openings: self.progress.ledger.through_openings,
            external_work: blocks.external_work + self.progress.ledger.wall_work,
            ..Energy::default()
        };
        if let Some(water) = &self.water {
            let fluid = water.fluid.energies();
            energy.kinetic += fluid.kinetic;
            energy.potential += fluid.potential;
            energy.internal = fluid.internal;
            energy.viscous = fluid.viscous
                + self.progress.ledger.dragged
                + self.progress.ledger.viscous_at_grains;
            if water.walls.is_some() && water.fluid.advances_density() {
                energy.at_walls = water.fluid.energy_from_walls() - self.progress.ledger.pressed;
            }
            energy.bulk = fluid.bulk;
            energy.drag = self.progress.ledger.drag;
            if let Some(grains) = &water.grains {
                let (added, ledger) = (grains.added_energy(), &self.progress.ledger);
                energy.kinetic += added;
                energy.at_grains = ledger.at_grains
                    + water.fluid.energy_from_walls_by_grains()
                    + (added - ledger.added_at_start);
            }
            energy.diffusive = fluid.diffusive;
            energy.pushed_back += water.fluid.withheld_loss();
            energy.removed += fluid.removed;
            energy.elastic += water.interface.elastic_energy();
        }
        energy.residual = energy.stored() + energy.lost()
            - energy.external_work
            - energy.overlap_removal
            - energy.joint_correction
            - energy.joint_water
            - energy.through_openings
            - energy.at_walls
            - energy.at_grains
            - self.progress.ledger.stored_at_start;
        energy
    }

    /// Work of blocks that move on the water, through walls of particles or integrals; J.
    pub fn work_on_water(&self) -> f64 {
        self.progress.ledger.pressed + self.progress.ledger.dragged
    }

    /// Momentum of fluid and free blocks; kg m/s.
    pub fn momentum(&self) -> Vec3 {
        let fluid = self
            .water
            .as_ref()
            .map_or(Vec3::zeros(), |water| water.fluid.momentum());
        fluid + self.blocks.momentum()
    }

    /// Momentum that nothing explains, over the momentum exchanged with walls and gravity.
    ///
    /// ```text
    /// |P(t) + P_removed − P(0) − J_walls − J_symmetry − J_gravity| / Σ |J|
    /// ```
    pub fn momentum_residual(&self) -> f64 {
        let mut given = self.progress.ledger.impulse + self.blocks.support_impulse();
        if let Some(water) = &self.water {
            given += water.fluid.reflected();
        }
        let removed = self.progress.ledger.removed_momentum
            + self
                .water
                .as_ref()
                .map_or(Vec3::zeros(), |water| water.fluid.removed().momentum);
        let unexplained =
            self.momentum() + removed - self.progress.ledger.momentum_at_start - given;
        let exchanged = self.progress.ledger.exchanged
            + self.blocks.impulse_exchanged()
            + self.progress.ledger.momentum_at_start.norm();
        if exchanged == 0.0 {
            0.0
        } else {
            unexplained.norm() / exchanged
        }
    }
}
