//! Particles that penetrate walls: those moving into a solid stop at its surface, those inside are
//! pushed back.
//!
//! Walls of particles hold the water by a pressure as smooth as the kernel. If that is much wider than the
//! spacing, the force on a single particle hardly depends on its distance from the wall. A particle that passes the surface,
//! for instance into the corner under a slope, acts on its neighbors like outflow: their density and pressure drop,
//! and more particles follow.
//!
//! ```text
//! J = −min(0, (v_a − v_wall)·n)/(1/m_a + w)     along n on the particle, against it on the body at the foot point
//! ```
//! `w` is the compliance of the body there: particle and body meet without rebound, one after the other.

use riprap_dda::Load;
use riprap_sph::{Fluid, Vec3};

use crate::walls::penalty::Penetration;
use crate::walls::penalty::swept::Motion;
use crate::world::coupler::Coupler;

impl Coupler<'_> {
    /// Stops the particles that the step of `dt` (s) took through a solid, or into an opening too narrow for them, where they
    /// entered; the water must be sorted and its touches found, and is again after that. Rows that openings make have no path.
    pub(super) fn stop_on_the_way(&mut self, fluid: &mut Fluid, dt: f64) {
        let motion = Motion {
            dt,
            are_held: self.rock.are_held(),
        };
        let mut stops = (self.interface).stops_on_the_way(fluid, self.rock.blocks, motion);
        let positions = &fluid.particles().position;
        stops.retain(|stop| !(self.openings).has_near(&positions[stop.particle as usize], 0.0));
        self.put_back(fluid, &stops);
    }

    /// Stops the particles at surfaces and puts back those inside; the water must be sorted and its touches found,
    /// and is again after that.
    pub(super) fn stop_penetrations(&mut self, fluid: &mut Fluid) {
        let penetrations = self.interface.penetrations(fluid, self.rock.blocks);
        self.put_back(fluid, &penetrations);
    }

    fn put_back(&mut self, fluid: &mut Fluid, penetrations: &[Penetration]) {
        let mut n_moved = 0;
        for penetration in penetrations {
            n_moved += u64::from(penetration.is_deep);
            self.stop(fluid, penetration);
        }
        if 0 < n_moved {
            self.rock.progress.extremes.particles_pushed_back += n_moved;
            fluid.refresh();
            self.interface.find(fluid, self.rock.blocks);
        }
    }

    fn stop(&mut self, fluid: &mut Fluid, penetration: &Penetration) {
        let are_held = self.rock.are_held();
        let (blocks, bodies) = (&mut *self.rock.blocks, &mut *self.rock.bodies);
        let ledger = &mut self.rock.progress.ledger;
        let (a, block) = (penetration.particle as usize, penetration.block as usize);
        let (mass, from, before) = {
            let particles = fluid.particles();
            (
                particles.mass[a],
                particles.position[a],
                particles.velocity[a],
            )
        };
        let normal = penetration.normal;
        let is_free = !are_held && blocks.is_free(block);
        let wall = if are_held {
            Vec3::zeros()
        } else {
            blocks.velocity_at(block, &penetration.point)
        };
        let compliance = if is_free {
            blocks.compliance(block, &penetration.point, &normal)
        } else {
            0.0
        };
        let approach = (before - wall).dot(&normal).min(0.0);
        let impulse = normal * (-approach / (1.0 / mass + compliance));
        let after = before + impulse / mass;
        let to = penetration.clear;
        ledger.pushed_back += if penetration.is_deep {
            fluid.relocate(a, to, after)
        } else {
            fluid.set_velocity(a, after)
        };
        ledger.impulse += impulse;
        if !is_free {
            let work = impulse.dot(&wall);
            ledger.pushed_back += work;
            ledger.push(work);
            return;
        }
        let centroid = blocks.centroid(block);
        let moment = |x: &Vec3, v: &Vec3| (x - centroid).cross(&(v * mass));
        let torque = if penetration.is_deep {
            // the change of angular momentum by the shift goes to the block, too
            moment(&from, &before) - moment(&to, &after)
        } else {
            -(penetration.point - centroid).cross(&impulse)
        };
        let felt = self.interface.in_plane(Load {
            force: -impulse,
            torque,
        });
        ledger.impulse += felt.force;
        let energy = blocks.kinetic_energy(block);
        blocks.apply_impulse_to(block, &felt);
        ledger.pushed_back += energy - blocks.kinetic_energy(block);
        if let Some((_, kept)) = bodies.accounts.iter_mut().find(|(b, _)| *b == block) {
            kept.pushed_back += felt;
        }
    }
}
