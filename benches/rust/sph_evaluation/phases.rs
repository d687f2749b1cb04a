//! Time of the parts of an evaluation, each as long as its public call takes.
//!
//! The parts of a call are not timed but inferred: packing for the rates is assumed equal to that for the forces, and
//! listing of neighbors equal to the extra time of the first rates after a sort.

use std::time::Instant;

use riprap_sph::boundary::wall_particles::WallParticles;
use riprap_sph::{Boundary, Fluid, FluidError, Stage};

use crate::roofs::fastest;
use crate::tank::Tank;

/// Seconds of each call of an evaluation.
#[derive(Clone, Copy, Default)]
pub struct Seconds {
    pub rates: f64,
    pub pressure: f64,
    pub forces: f64,
    pub finding: f64,
    pub wall_rates: f64,
    pub extrapolation: f64,
    pub wall_forces: f64,
}

impl Seconds {
    pub fn total(&self) -> f64 {
        self.rates + self.pressure + self.forces + self.walls()
    }

    /// Of the walls alone.
    pub fn walls(&self) -> f64 {
        self.finding + self.wall_rates + self.extrapolation + self.wall_forces
    }
}

/// Seconds of what a step does beside its evaluation.
#[derive(Clone, Copy, Default)]
pub struct Beside {
    pub sorting: f64,
    pub listing: f64,
    pub advancing: f64,
    pub kick: f64,
    pub drift: f64,
}

/// Adds the time that `work` takes.
fn timed<T>(seconds: &mut f64, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let made = work();
    *seconds += start.elapsed().as_secs_f64();
    made
}

/// Walls that stand, and whether the fluid was sorted between them.
struct Held<'a> {
    walls: &'a mut WallParticles,
    has_sorted: bool,
}

impl Boundary for Held<'_> {
    type Error = FluidError;

    fn place(&mut self, fluid: &mut Fluid, _stage: Stage, _dt: f64) {
        self.has_sorted |= fluid.moved() == 0.0;
        self.walls.find_wet(fluid);
    }

    fn density_rates(&mut self, fluid: &mut Fluid) {
        self.walls.add_rates(fluid);
    }

    fn continue_pressure(&mut self, fluid: &mut Fluid) {
        self.walls.extrapolate(fluid);
    }

    fn forces(&mut self, fluid: &mut Fluid) {
        self.walls.add_forces(fluid);
    }
}

impl Tank {
    pub fn rates(&mut self, seconds: &mut Seconds) {
        let Self { fluid, walls } = self;
        fluid.open_rates();
        timed(&mut seconds.rates, || fluid.update_rates());
        timed(&mut seconds.finding, || walls.find_wet(fluid));
        timed(&mut seconds.wall_rates, || walls.add_rates(fluid));
    }

    pub fn forces(&mut self, seconds: &mut Seconds) -> Result<(), FluidError> {
        let Self { fluid, walls } = self;
        fluid.close_rates();
        timed(&mut seconds.pressure, || fluid.update_pressure())?;
        timed(&mut seconds.finding, || walls.find_wet(fluid));
        timed(&mut seconds.extrapolation, || walls.extrapolate(fluid));
        timed(&mut seconds.forces, || fluid.update_accelerations());
        timed(&mut seconds.wall_forces, || walls.add_forces(fluid));
        Ok(())
    }

    /// One step; returns whether it sorted.
    pub fn step(&mut self, dt: f64) -> Result<bool, FluidError> {
        let mut held = Held {
            walls: &mut self.walls,
            has_sorted: false,
        };
        self.fluid.step(&mut held, dt)?;
        Ok(held.has_sorted)
    }

    /// The fastest of a few evaluations at one state.
    pub fn evaluation(&mut self, rounds: usize) -> Result<Seconds, FluidError> {
        let mut best = None::<Seconds>;
        for _ in 0..rounds {
            let mut seconds = Seconds::default();
            self.rates(&mut seconds);
            self.fluid.advance_density(0.0);
            self.forces(&mut seconds)?;
            if best.is_none_or(|best| seconds.total() < best.total()) {
                best = Some(seconds);
            }
        }
        Ok(best.unwrap_or_default())
    }

    /// Other parts of a step, at the same state.
    pub fn beside(&mut self) -> Beside {
        let (mut sorting, mut first, mut next) = (f64::INFINITY, f64::INFINITY, f64::INFINITY);
        for _ in 0..3 {
            self.forget_order();
            timed_least(&mut sorting, || {
                self.fluid.refresh();
            });
            self.fluid.open_rates();
            timed_least(&mut first, || self.fluid.update_rates());
            timed_least(&mut next, || self.fluid.update_rates());
            self.fluid.close_rates();
        }
        self.fluid.open_rates();
        self.fluid.update_rates();
        let advancing = fastest(|| self.fluid.advance_density(0.0));
        self.fluid.close_rates();
        Beside {
            sorting,
            listing: first - next,
            advancing,
            kick: fastest(|| self.fluid.kick(0.0)),
            drift: fastest(|| self.fluid.drift(0.0)),
        }
    }

    /// Makes the next refresh sort: a particle that was put elsewhere may be anywhere.
    fn forget_order(&mut self) {
        let particles = self.fluid.particles();
        if let (Some(&x), Some(&v)) = (particles.position.first(), particles.velocity.first()) {
            self.fluid.relocate(0, x, v);
        }
    }
}

/// Keeps the smaller of a time and that which `work` takes.
fn timed_least(least: &mut f64, work: impl FnOnce()) {
    let mut seconds = 0.0;
    timed(&mut seconds, work);
    *least = least.min(seconds);
}
