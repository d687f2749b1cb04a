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

/// Distance from a surface within which water may be crushed, in spacings.
const ROOM: f64 = 0.5;
/// Density beyond which it is, over that at rest: an impact at Mach 0.2, where waves of pressure begin to be wrong, compresses by a
/// fifth, `p = ρ c u`.
const CRUSHED: f64 = 1.2;

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

    /// Relieves the particles at surfaces that are compressed beyond what any flow that the sound speed allows does to them:
    /// water that bodies close in leaks through joints which are too narrow for particles, and takes the load off with it.
    pub(super) fn relieve_crushed(&mut self, fluid: &mut Fluid) {
        let room = ROOM * self.interface.settings().particle_spacing;
        let limit = CRUSHED * fluid.settings().reference_density;
        let (mut n_relieved, mut lost) = (0, 0.0);
        let touches = self.interface.touches().iter();
        for touch in touches.filter(|touch| touch.distance < room) {
            if let Some(energy) = fluid.relieve(touch.particle as usize, limit) {
                n_relieved += 1;
                lost += energy;
            }
        }
        let progress = &mut *self.rock.progress;
        progress.ledger.pushed_back += lost;
        progress.extremes.reliefs += n_relieved;
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
        let (a, block) = (penetration.particle as usize, penetration.block as usize);
        let (point, normal) = (penetration.point, penetration.normal);
        let (mass, velocity) = (fluid.particles().mass[a], fluid.particles().velocity[a]);
        let approach = (velocity - self.wall_velocity(block, &point))
            .dot(&normal)
            .min(0.0);
        let compliance = self.compliance(block, &point, &normal);
        let push = Push {
            particle: a,
            block,
            point,
            impulse: normal * (-approach / (1.0 / mass + compliance)),
            to: penetration.is_deep.then_some(penetration.clear),
        };
        self.give(fluid, &push);
    }

    /// Velocity of a block at a point (m), zero while blocks are held; m/s.
    fn wall_velocity(&self, block: usize, point: &Vec3) -> Vec3 {
        match self.rock.are_held() {
            true => Vec3::zeros(),
            false => self.rock.blocks.velocity_at(block, point),
        }
    }

    /// Compliance of a block at a point (m) along a unit vector, zero where it does not give way; 1/kg.
    fn compliance(&self, block: usize, point: &Vec3, along: &Vec3) -> f64 {
        match !self.rock.are_held() && self.rock.blocks.is_free(block) {
            true => self.rock.blocks.compliance(block, point, along),
            false => 0.0,
        }
    }

    /// Gives a particle an impulse and the opposite one to the block, and books both.
    fn give(&mut self, fluid: &mut Fluid, push: &Push) {
        let are_held = self.rock.are_held();
        let wall = self.wall_velocity(push.block, &push.point);
        let (blocks, bodies) = (&mut *self.rock.blocks, &mut *self.rock.bodies);
        let ledger = &mut self.rock.progress.ledger;
        let (a, block, impulse) = (push.particle, push.block, push.impulse);
        let (mass, from, before) = {
            let particles = fluid.particles();
            (
                particles.mass[a],
                particles.position[a],
                particles.velocity[a],
            )
        };
        let is_free = !are_held && blocks.is_free(block);
        let after = before + impulse / mass;
        ledger.pushed_back += match push.to {
            Some(to) => fluid.relocate(a, to, after),
            None => fluid.set_velocity(a, after),
        };
        ledger.impulse += impulse;
        let centroid = blocks.centroid(block);
        let moment = |x: &Vec3, v: &Vec3| (x - centroid).cross(&(v * mass));
        let torque = match push.to {
            // the change of angular momentum by the shift goes to the block, too
            Some(to) => moment(&from, &before) - moment(&to, &after),
            None => -(push.point - centroid).cross(&impulse),
        };
        let felt = self.interface.in_plane(Load {
            force: -impulse,
            torque,
        });
        if !are_held {
            bodies.book_push(block, felt);
        }
        if !is_free {
            let work = impulse.dot(&wall);
            ledger.pushed_back += work;
            ledger.push(work);
            return;
        }
        ledger.impulse += felt.force;
        ledger.pushed_back -= blocks.apply_impulse_to(block, &felt);
    }
}

/// An impulse that a wall gives to a particle.
struct Push {
    particle: usize,
    block: usize,
    /// Where the block feels it; m.
    point: Vec3,
    /// On the particle; N s.
    impulse: Vec3,
    /// Place to which the particle is moved at the same time; m.
    to: Option<Vec3>,
}

#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    reason = "a test stops at the first thing that is wrong"
)]
mod tests {
    use super::*;
    use crate::run::world_of;
    use crate::world::World;
    use crate::world::time_step::BlockSteps;

    const DP: f64 = 0.1;
    const SOUND: f64 = 20.0;

    fn plate_text(walls: &str, plate: &str) -> String {
        format!(
            "(title: \"plate\", gravity: (0, 0, 0), domain: (min: (-2, -2, -2), max: (2, 2, 2)),
             materials: [(name: \"m\", density: 2000, friction_angle_deg: 30)],
             blocks: [(name: \"plate\", material: \"m\", {plate}
                       shape: Box(min: (-1, -1, -0.02), max: (1, 1, 0)))],
             fluid: (resolution: Spacing({DP}), regions: [(name: \"drop\",
                     shape: Box(min: (-0.05, -0.05, 0.5), max: (0.05, 0.05, 0.6)))]),
             interface: (walls: {walls}),
             numerics: (sound_speed: {SOUND}, time_step_factor: 1.0), time: (duration: 1))"
        )
    }

    /// One particle above a plate of a fifth of a spacing, its top at z = 0.
    fn plate(walls: &str, plate: &str) -> World {
        let world = world_of(&plate_text(walls, plate));
        assert_eq!(world.water.as_ref().unwrap().fluid.particles().len(), 1);
        world
    }

    /// Ends a step of `dt` (s) that took the particle from a place (m) with a velocity (m/s), and opens the ledger before it.
    fn shoot(world: &mut World, from: Vec3, velocity: Vec3, dt: f64) {
        let fluid = &mut world.water.as_mut().unwrap().fluid;
        fluid.relocate(0, from + velocity * dt, velocity);
        fluid.set_velocity(0, velocity);
        world.open_ledger();
        world
            .coupled(BlockSteps::NONE, |fluid, coupler| {
                fluid.refresh();
                coupler.interface.find(fluid, coupler.rock.blocks);
                coupler.stop_on_the_way(fluid, dt);
                Ok(())
            })
            .unwrap();
    }

    /// Shots at 100 angles and 20 speeds up to half of the speed of sound, each over a step of 1.3 dp/(c₀ + v) that ends past
    /// the plate, in it, or short of it.
    fn shots() -> impl Iterator<Item = (Vec3, Vec3, f64)> {
        (0..2000).map(|k| {
            let (angle, step) = (k % 100, f64::from(k / 100) + 1.0);
            let speed = 0.5 * SOUND * step / 20.0;
            let dt = 1.3 * DP / (SOUND + speed);
            // from the normal, and round it
            let (tilt, turn) = (
                0.85 * f64::from(angle) / 100.0 * std::f64::consts::FRAC_PI_2,
                f64::from(angle) * 2.4,
            );
            let down = Vec3::new(
                tilt.sin() * turn.cos(),
                tilt.sin() * turn.sin(),
                -tilt.cos(),
            );
            // the share of the step after which it meets the plate, anything from 0 to 1.2
            let share = 1.2 * f64::from(k).mul_add(0.618_033_988_75, 0.01).fract();
            let from = -down * (share * speed * dt);
            (from, down * speed, dt)
        })
    }

    fn state(world: &World) -> (Vec3, Vec3, f64) {
        let particles = world.water.as_ref().unwrap().fluid.particles();
        let mass = particles.mass[0];
        (particles.position[0], particles.velocity[0], mass)
    }

    #[test]
    fn a_particle_shot_at_a_thin_plate_stops_at_it() {
        for walls in ["Penalty", "Particles", "Integral"] {
            let mut world = plate(walls, "motion: Fixed,");
            let mut n_stopped = 0;
            for (from, velocity, dt) in shots() {
                let reaches = (from + velocity * dt).z < 0.0;
                n_stopped += u32::from(reaches);
                shoot(&mut world, from, velocity, dt);
                let (x, v, mass) = state(&world);
                if !reaches {
                    assert_eq!((x, v), (from + velocity * dt, velocity));
                    continue;
                }
                let along = Vec3::new(velocity.x, velocity.y, 0.0);
                let (size, speed) = (mass * velocity.norm(), velocity.norm());
                // round-off: of the position in meters, and of one product and sum in the rest
                assert!((x.z - 1e-3 * DP).abs() < 1e-15, "{x:?}");
                assert!(v.z.abs() < 1e-15 * speed, "{v:?}");
                assert!((v - along - Vec3::z() * v.z).norm() < 1e-15 * speed);
                let given = world.progress.ledger.impulse;
                assert!(((v - velocity) * mass - given).norm() < 1e-14 * size);
                let lost = 0.5 * mass * (velocity.norm_squared() - v.norm_squared());
                let booked = world.progress.ledger.pushed_back;
                assert!((lost - booked).abs() < 1e-14 * size * speed);
            }
            // 1/1.2 of them
            assert!(1600 < n_stopped, "{n_stopped}");
        }
    }

    /// A free plate takes the impulse, and the loss is that of a plastic impact.
    #[test]
    fn a_free_plate_takes_what_a_particle_loses() {
        for walls in ["Penalty", "Particles", "Integral"] {
            for (from, velocity, dt) in shots().step_by(37) {
                let mut world = plate(walls, "");
                shoot(&mut world, from, velocity, dt);
                let (x, v, mass) = state(&world);
                if (from + velocity * dt).z >= 0.0 {
                    continue;
                }
                let speed = velocity.norm();
                let momentum = world.momentum() - velocity * mass;
                assert!(momentum.norm() < 1e-14 * mass * speed, "{momentum:?}");
                let energy = world.energy();
                let lost = 0.5 * mass * velocity.norm_squared() - energy.kinetic;
                assert!((lost - energy.pushed_back).abs() < 1e-14 * mass * speed * speed);
                // they go on together; the plate, 160 times as heavy, also takes the angular momentum of the shift by
                // a thousandth of a spacing, of which its velocity is 1e-7 of the particle's
                let wall = world.blocks.velocity_at(0, &Vec3::new(x.x, x.y, 0.0));
                assert!((v - wall).z.abs() < 1e-6 * speed, "{v:?} {wall:?}");
            }
        }
    }
}
