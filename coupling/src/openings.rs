//! Open boundaries: inflows and outflows.
//!
//! Both are boxes that the flow crosses, with one face on the downstream side.
//!
//! - The box of an inflow contains rows of particles with the given velocity and the hydrostatic pressure; past the
//!   downstream face they are ordinary water, and a new row is added upstream when there is room for one.
//! - In the box of an outflow particles keep the horizontal velocity at which they entered (no gradient along the
//!   flow; Federico et al. 2012), at the hydrostatic pressure of a given depth, if one is given. Past
//!   its face they are removed.
//!
//! Energy and momentum of imposed velocities and pressures are booked with those of the particles that enter and leave.

mod inflow;
mod passage;

use riprap_sph::exchange::{Exchange, Imposed};
use riprap_sph::{Fluid, FluidError, Vec3};
use serde::{Deserialize, Serialize};

use crate::saved::{Read, Saved};
use crate::series::Series;
pub use inflow::{Drive, Inflow};
pub use passage::Passage;

/// Outflow boundary.
#[derive(Clone, Debug, PartialEq)]
pub struct Outflow {
    /// Its name.
    pub name: String,
    /// Its box.
    pub passage: Passage,
    /// Depth above the bottom of the box for the hydrostatic pressure; unchanged pressures without one; m.
    pub depth: Option<Series>,
}

/// Flow through an opening so far.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Passed {
    /// Name of the opening.
    pub name: String,
    /// Particles added, without those of the initial state.
    pub particles_in: u64,
    /// Their mass; kg.
    pub mass_in: f64,
    /// Particles removed.
    pub particles_out: u64,
    /// Their mass; kg.
    pub mass_out: f64,
}

/// All inflows and outflows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Openings {
    inflows: Vec<Inflow>,
    outflows: Vec<Outflow>,
    /// Flow through each inflow, then each outflow.
    passed: Vec<Passed>,
    /// Particles in the boxes, as of the last [`Self::hold`].
    held: Vec<Imposed>,
}

impl Openings {
    /// Openings of a scene.
    pub fn new(inflows: Vec<Inflow>, outflows: Vec<Outflow>) -> Self {
        let names = inflows
            .iter()
            .map(|i| &i.name)
            .chain(outflows.iter().map(|o| &o.name));
        Self {
            passed: names
                .map(|name| Passed {
                    name: name.clone(),
                    ..Passed::default()
                })
                .collect(),
            inflows,
            outflows,
            held: Vec::new(),
        }
    }

    /// Appends its state to a byte buffer.
    pub(crate) fn save(&self, out: Vec<u8>) -> Saved {
        let rows: Vec<_> = self.inflows.iter().map(|i| (i.advanced, i.speed)).collect();
        postcard::to_extend(&(rows, &self.passed, &self.held), out)
    }

    /// Restores a saved state.
    pub(crate) fn read<'a>(&mut self, bytes: &'a [u8]) -> Read<'a> {
        let (rows, rest);
        let of_each = self.passed.len();
        ((rows, self.passed, self.held), rest) = postcard::take_from_bytes(bytes)?;
        let rows: Vec<(f64, f64)> = rows;
        if (rows.len(), self.passed.len()) != (self.inflows.len(), of_each) {
            return Err(postcard::Error::DeserializeBadEncoding);
        }
        for (inflow, row) in self.inflows.iter_mut().zip(rows) {
            (inflow.advanced, inflow.speed) = row;
        }
        Ok(rest)
    }

    /// Flow through each opening so far.
    pub fn passed(&self) -> &[Passed] {
        &self.passed
    }

    /// Whether a point is less than a distance (m) from an opening.
    pub fn has_near(&self, x: &Vec3, distance: f64) -> bool {
        let inflows = self.inflows.iter().map(|inflow| &inflow.passage);
        let outflows = self.outflows.iter().map(|outflow| &outflow.passage);
        inflows
            .chain(outflows)
            .any(|passage| passage.is_near(x, distance))
    }

    /// Whether there are no openings.
    pub fn is_empty(&self) -> bool {
        self.passed.is_empty()
    }

    /// Fills the boxes of the inflows with rows: the state at t = 0.
    ///
    /// # Errors
    ///
    /// [`FluidError::TooManyParticles`].
    pub fn fill(&self, fluid: &mut Fluid) -> Result<(), FluidError> {
        for inflow in &self.inflows {
            let (n, spacing) = inflow.n_rows(fluid);
            for row in 0..n {
                let made = inflow.row(fluid, 0.0, (row as f64 + 0.5) * spacing);
                fluid.add(&made)?;
            }
        }
        Ok(())
    }

    /// Adds rows where the last `dt` made room and removes particles past the outflows; returns the mass, momentum and
    /// energy that this brought in.
    ///
    /// # Errors
    ///
    /// [`FluidError::TooManyParticles`].
    pub fn exchange(
        &mut self,
        fluid: &mut Fluid,
        time: f64,
        dt: f64,
    ) -> Result<Exchange, FluidError> {
        let mut total = Exchange::default();
        if self.is_empty() {
            return Ok(total);
        }
        for (inflow, passed) in self.inflows.iter_mut().zip(&mut self.passed) {
            let (n, spacing) = inflow.n_rows(fluid);
            inflow.advanced += inflow.speed * dt;
            while spacing <= inflow.advanced {
                inflow.advanced -= spacing;
                let before = (n as f64 - 0.5) * spacing - inflow.advanced;
                let made = fluid.add(&inflow.row(fluid, time, before))?;
                passed.particles_in += made.count.unsigned_abs();
                passed.mass_in += made.mass;
                total += made;
            }
        }
        let slack = slack(fluid);
        let mut taken = vec![Exchange::default(); self.outflows.len()];
        fluid.take_out(
            |x| {
                self.outflows.iter().position(|outflow| {
                    let passage = &outflow.passage;
                    passage.length() <= passage.along(x) && passage.is_abreast(x, slack)
                })
            },
            &mut taken,
        );
        for (passed, taken) in self.passed[self.inflows.len()..].iter_mut().zip(&taken) {
            passed.particles_out += taken.count.unsigned_abs();
            passed.mass_out -= taken.mass;
            total += *taken;
        }
        Ok(total)
    }

    /// Imposes velocities and densities on the particles in the boxes; returns the energy and momentum that this brought
    /// in. The order of the particles must not change before [`Self::hold_velocities`].
    pub fn hold(&mut self, fluid: &mut Fluid, time: f64) -> Exchange {
        if self.is_empty() {
            return Exchange::default();
        }
        for inflow in &mut self.inflows {
            inflow.speed = inflow.speed_at(fluid, time);
        }
        self.held.clear();
        let slack = slack(fluid);
        let particles = fluid.particles();
        for (a, x) in particles.position.iter().enumerate() {
            let inflow = self.inflows.iter().find(|i| i.passage.contains(x, slack));
            let (velocity, surface) = if let Some(inflow) = inflow {
                let passage = &inflow.passage;
                let surface = passage.min.z + inflow.depth.at(time);
                (passage.direction() * inflow.speed, Some(surface))
            } else if let Some(outflow) =
                self.outflows.iter().find(|o| o.passage.contains(x, slack))
            {
                let mut velocity = particles.velocity[a];
                velocity.z = 0.0;
                let depth = outflow.depth.as_ref().map(|depth| depth.at(time));
                (velocity, depth.map(|depth| outflow.passage.min.z + depth))
            } else {
                continue;
            };
            self.held.push(Imposed {
                particle: a as u32,
                velocity,
                density: surface.map(|surface| hydrostatic(fluid, surface - x.z)),
            });
        }
        fluid.impose(&self.held)
    }

    /// Particles whose velocities are imposed.
    pub fn held(&self) -> impl Iterator<Item = u32> + '_ {
        self.held.iter().map(|one| one.particle)
    }

    /// Restores the velocities of the particles in the boxes after a kick; returns the energy and momentum that this
    /// brought in.
    pub fn hold_velocities(&mut self, fluid: &mut Fluid) -> Exchange {
        for one in &mut self.held {
            one.density = None;
        }
        fluid.impose(&self.held)
    }
}

/// Tolerance of half a spacing: particles are not exactly in their rows.
fn slack(fluid: &Fluid) -> f64 {
    0.5 * fluid.settings().particle_spacing[2]
}

/// Hydrostatic density at a depth; kg/m³.
fn hydrostatic(fluid: &Fluid, depth: f64) -> f64 {
    let state = fluid.state_equation();
    let pull = (-fluid.settings().gravity.z).max(0.0);
    state.density(state.hydrostatic_pressure(pull, depth.max(0.0)))
}
