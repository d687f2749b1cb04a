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

use riprap_sph::exchange::{Exchange, Imposed, NewParticle};
use riprap_sph::{Fluid, FluidError, Vec3};
use serde::{Deserialize, Serialize};

use crate::saved::{Read, Saved};
use crate::series::Series;

/// Box, crossed by the flow along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Lower corner; m.
    pub min: Vec3,
    /// Upper corner; m.
    pub max: Vec3,
    /// Direction of the flow: 0 for x, 1 for y.
    pub axis: usize,
    /// Whether the flow is in the positive direction.
    pub upward: bool,
}

impl Passage {
    /// Length along the flow; m.
    pub fn length(&self) -> f64 {
        self.max[self.axis] - self.min[self.axis]
    }

    /// Distance from the upstream face; m.
    fn along(&self, x: &Vec3) -> f64 {
        if self.upward {
            x[self.axis] - self.min[self.axis]
        } else {
            self.max[self.axis] - x[self.axis]
        }
    }

    /// Whether a point is in the cross-section of the box, enlarged by `slack`.
    fn is_abreast(&self, x: &Vec3, slack: f64) -> bool {
        (0..3)
            .filter(|&axis| axis != self.axis)
            .all(|axis| self.min[axis] - slack <= x[axis] && x[axis] <= self.max[axis] + slack)
    }

    /// Whether a point is in the box or less than a distance (m) from it.
    fn is_near(&self, x: &Vec3, distance: f64) -> bool {
        let s = self.along(x);
        -distance < s && s < self.length() + distance && self.is_abreast(x, distance)
    }

    /// Whether a point is in the box, with its cross-section enlarged by `slack`.
    pub fn contains(&self, x: &Vec3, slack: f64) -> bool {
        let s = self.along(x);
        0.0 <= s && s < self.length() && self.is_abreast(x, slack)
    }

    fn direction(&self) -> Vec3 {
        let mut direction = Vec3::zeros();
        direction[self.axis] = if self.upward { 1.0 } else { -1.0 };
        direction
    }
}

/// Driving condition of an inflow.
#[derive(Clone, Debug, PartialEq)]
pub enum Drive {
    /// Velocity, uniform over the depth; m/s.
    Velocity(Series),
    /// Through the whole face; m³/s.
    Discharge(Series),
}

/// Inflow boundary.
#[derive(Clone, Debug, PartialEq)]
pub struct Inflow {
    /// Its name.
    pub name: String,
    /// Its box.
    pub passage: Passage,
    /// Velocity or discharge.
    pub drive: Drive,
    /// Depth above the bottom of the box, rounded to whole rows; m.
    pub depth: Series,
    /// Distance that the rows have moved since the last one was added; m.
    advanced: f64,
    /// Velocity at the last hold; m/s.
    speed: f64,
}

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

/// Rows across the flow and upward, and their first position.
struct Rows {
    counts: [usize; 2],
    axes: [usize; 2],
    first: Vec3,
    spacing: Vec3,
}

impl Inflow {
    /// Inflow at rest until it is first held.
    pub fn new(name: String, passage: Passage, drive: Drive, depth: Series) -> Self {
        Self {
            name,
            passage,
            drive,
            depth,
            advanced: 0.0,
            speed: 0.0,
        }
    }

    fn rows(&self, fluid: &Fluid, time: f64) -> Rows {
        let spacing = Vec3::from(fluid.settings().particle_spacing);
        let Passage { min, max, axis, .. } = self.passage;
        let across = 1 - axis;
        let count = |length: f64, spacing: f64| (length / spacing).round().max(1.0) as usize;
        Rows {
            counts: [
                count(max[across] - min[across], spacing[across]),
                count(self.depth.at(time), spacing.z),
            ],
            axes: [across, 2],
            first: min + spacing * 0.5,
            spacing,
        }
    }

    /// Velocity along the flow; m/s.
    fn speed_at(&self, fluid: &Fluid, time: f64) -> f64 {
        match &self.drive {
            Drive::Velocity(velocity) => velocity.at(time),
            Drive::Discharge(discharge) => {
                let rows = self.rows(fluid, time);
                let area = (0..2)
                    .map(|k| rows.counts[k] as f64 * rows.spacing[rows.axes[k]])
                    .product::<f64>();
                discharge.at(time) / area
            }
        }
    }

    /// Row across the flow at a distance `before` upstream of the face.
    fn row(&self, fluid: &Fluid, time: f64, before: f64) -> Vec<NewParticle> {
        let rows = self.rows(fluid, time);
        let Passage {
            min,
            max,
            axis,
            upward,
        } = self.passage;
        let mut position = rows.first;
        position[axis] = if upward {
            max[axis] - before
        } else {
            min[axis] + before
        };
        let velocity = self.passage.direction() * self.speed_at(fluid, time);
        let mut made = Vec::with_capacity(rows.counts[0] * rows.counts[1]);
        for k in 0..rows.counts[1] {
            for j in 0..rows.counts[0] {
                let mut x = position;
                x[rows.axes[0]] += j as f64 * rows.spacing[rows.axes[0]];
                x.z += k as f64 * rows.spacing.z;
                made.push(NewParticle {
                    position: x,
                    velocity,
                    density: hydrostatic(fluid, min.z + self.depth.at(time) - x.z),
                });
            }
        }
        made
    }

    /// Number and spacing of the rows along the flow.
    fn n_rows(&self, fluid: &Fluid) -> (usize, f64) {
        let spacing = fluid.settings().particle_spacing[self.passage.axis];
        // round-off of the lengths in a scene
        let n = (self.passage.length() / spacing + 1e-6).floor() as usize;
        (n, spacing)
    }
}

/// Hydrostatic density at a depth; kg/m³.
fn hydrostatic(fluid: &Fluid, depth: f64) -> f64 {
    let state = fluid.state_equation();
    let pull = (-fluid.settings().gravity.z).max(0.0);
    state.density(state.hydrostatic_pressure(pull, depth.max(0.0)))
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
