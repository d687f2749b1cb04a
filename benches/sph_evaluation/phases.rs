//! Time of the parts of an evaluation, each as long as its public call takes.
//!
//! What a call is made of is not timed but inferred. Looking up the rows of candidates is done again from outside.
//! The filter's share is the slope of the time over the candidates: a fluid that takes its particles to have moved
//! farther looks at more of them and finds the same pairs. Packing for the rates is taken to be that for the forces.

use std::time::Instant;

use rayon::prelude::*;
use riprap_sph::FluidError;
use riprap_sph::cells::{MAX_RUNS, Run};

use crate::counts::{CHUNK, Counts, seen};
use crate::roofs::fastest;
use crate::tank::Tank;

/// Share of the support radius by which particles are taken to have moved, for the slope of the filter.
const MOVED: f64 = 0.25;

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
    pub advancing: f64,
    pub kick: f64,
    pub drift: f64,
}

/// Seconds within the calls, inferred.
#[derive(Clone, Copy, Default)]
pub struct Inferred {
    /// Of one sum over the fluid.
    pub rows: f64,
    pub filter: f64,
}

/// Adds the time that `work` takes.
fn timed<T>(seconds: &mut f64, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let made = work();
    *seconds += start.elapsed().as_secs_f64();
    made
}

impl Tank {
    pub fn rates(&mut self, seconds: &mut Seconds) {
        let Self { fluid, walls } = self;
        timed(&mut seconds.rates, || fluid.update_rates());
        timed(&mut seconds.finding, || walls.find_wet(fluid));
        timed(&mut seconds.wall_rates, || walls.add_rates(fluid));
    }

    pub fn forces(&mut self, seconds: &mut Seconds) -> Result<(), FluidError> {
        let Self { fluid, walls } = self;
        timed(&mut seconds.pressure, || fluid.update_pressure())?;
        timed(&mut seconds.finding, || walls.find_wet(fluid));
        timed(&mut seconds.extrapolation, || walls.extrapolate(fluid));
        timed(&mut seconds.forces, || fluid.update_accelerations());
        timed(&mut seconds.wall_forces, || walls.add_forces(fluid));
        Ok(())
    }

    /// One kick-drift-kick; returns whether it sorted.
    pub fn step(&mut self, dt: f64) -> Result<bool, FluidError> {
        let seconds = &mut Seconds::default();
        let mut has_sorted = false;
        self.fluid.kick(0.5 * dt);
        self.fluid.drift(0.5 * dt);
        self.fluid.refresh();
        has_sorted |= self.fluid.moved() == 0.0;
        self.rates(seconds);
        self.fluid.advance_density(dt);
        self.fluid.drift(0.5 * dt);
        self.fluid.refresh();
        has_sorted |= self.fluid.moved() == 0.0;
        self.forces(seconds)?;
        self.fluid.kick(0.5 * dt);
        Ok(has_sorted)
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

    /// What else a step does, at the same state.
    pub fn beside(&mut self) -> Beside {
        let mut sorting = f64::INFINITY;
        for _ in 0..3 {
            self.forget_order();
            timed_least(&mut sorting, || {
                self.fluid.refresh();
            });
        }
        Beside {
            sorting,
            advancing: fastest(|| self.fluid.advance_density(0.0)),
            kick: fastest(|| self.fluid.kick(0.0)),
            drift: fastest(|| self.fluid.drift(0.0)),
        }
    }

    /// Makes the next refresh sort: a particle that was put elsewhere may be anywhere.
    fn forget_order(&mut self) {
        let particles = self.fluid.particles();
        if let (Some(&x), Some(&v)) = (particles.position.first(), particles.velocity.first()) {
            self.fluid.replace(0, x, v);
        }
    }

    /// What the sums over the fluid are made of; wants particles that move.
    pub fn inferred(&mut self, counts: &Counts, rounds: usize) -> Inferred {
        let fluid = &self.fluid;
        let reach = fluid.settings().support_radius() + 2.0 * fluid.moved();
        let rows = fastest(|| {
            let positions = fluid.particles().position.par_chunks(CHUNK);
            let n: usize = positions
                .map(|positions| {
                    let mut runs = [Run::default(); MAX_RUNS];
                    let found = |x| fluid.grid().runs_within(x, reach, &mut runs);
                    positions.iter().map(found).sum::<usize>()
                })
                .sum();
            std::hint::black_box(n);
        });
        // the largest speed by which moves are bounded is that of the last kick
        self.fluid.kick(0.0);
        let support_radius = self.fluid.settings().support_radius();
        let away = 0.5 * MOVED * support_radius / self.fluid.max_speed();
        let mut least = [f64::INFINITY; 2];
        for _ in 0..rounds {
            self.forget_order();
            self.fluid.refresh();
            timed_least(&mut least[0], || self.fluid.update_rates());
            // there and back: what has moved so far may be twice as far from where it was sorted
            self.fluid.drift(away);
            self.fluid.drift(-away);
            timed_least(&mut least[1], || self.fluid.update_rates());
        }
        let particles = &self.fluid.particles().position;
        let reach = (support_radius, self.fluid.moved());
        let wide = seen((self.fluid.grid(), particles), particles, reach);
        self.forget_order();
        self.fluid.refresh();
        let slope = (least[1] - least[0]) / (wide.registers - counts.fluid.registers);
        Inferred {
            rows,
            filter: slope * counts.fluid.registers,
        }
    }
}

/// Keeps the smaller of a time and that which `work` takes.
fn timed_least(least: &mut f64, work: impl FnOnce()) {
    let mut seconds = 0.0;
    timed(&mut seconds, work);
    *least = least.min(seconds);
}
