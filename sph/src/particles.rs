//! The state of the fluid, one slot per particle and quantity.

use crate::{ParticleId, Vec3};
use serde::{Deserialize, Serialize};

/// Fluid particles, kept sorted by cell.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub struct Particles {
    /// Number of the particle, given at creation; sorting never changes it.
    pub id: Vec<ParticleId>,
    /// Position; written by the drift and by sorting; m.
    pub position: Vec<Vec3>,
    /// Velocity; written by kicks and by sorting; m/s.
    pub velocity: Vec<Vec3>,
    /// Mass, which never changes; sorting moves it; kg.
    #[serde(with = "crate::repeated")]
    pub mass: Vec<f64>,
    /// Density, of the mass of water per volume, that of grains between it included; written by the evaluation, or taken on in
    /// time; kg/m³.
    pub density: Vec<f64>,
    /// Pressure at the current positions, that of bulk viscosity included; written by the evaluation; Pa.
    pub pressure: Vec<f64>,
    /// Acceleration at the current positions, gravity and walls included; m/s².
    pub acceleration: Vec<Vec3>,
    /// The viscous part of `acceleration`; for the energy ledger; m/s².
    pub viscous_acceleration: Vec<[f32; 3]>,
    /// Number of its flow law, which never changes; sorting moves it.
    #[serde(with = "crate::repeated")]
    pub kind: Vec<u8>,
    /// Rate of shear `γ̇`; written by the evaluation, empty where viscosity does not vary; 1/s.
    pub shear_rate: Vec<f64>,
    /// Apparent viscosity; written by the evaluation, empty where it does not vary; Pa s.
    pub viscosity: Vec<f64>,
    /// Part of the pressure that bulk viscosity makes, from the last rates of density; moved by sorting, empty without
    /// bulk viscosity; Pa.
    pub bulk_pressure: Vec<f64>,
    /// Share of its volume that water fills, where grains fill the rest; moved by sorting, empty without such grains; –.
    pub porosity: Vec<f64>,
    /// Mass of water per volume as its own flow alone carries it, to which `density` is drawn; moved by sorting, empty without such
    /// grains; kg/m³.
    pub carried: Vec<f64>,
    /// Flux of these grains, volume per area and time; moved by sorting, empty without such grains; m/s.
    pub grain_flux: Vec<Vec3>,
    /// Numbers given so far.
    n_made: u32,
}

impl Particles {
    /// Particles at rest or in motion; densities and accelerations wait for the first evaluation.
    pub fn new(position: Vec<Vec3>, velocity: Vec<Vec3>) -> Self {
        let n = position.len();
        Self {
            id: (0..n as u32).map(ParticleId::from).collect(),
            position,
            velocity,
            mass: vec![0.0; n],
            density: vec![0.0; n],
            pressure: vec![0.0; n],
            acceleration: vec![Vec3::zeros(); n],
            viscous_acceleration: vec![[0.0; 3]; n],
            kind: vec![0; n],
            shear_rate: Vec::new(),
            viscosity: Vec::new(),
            bulk_pressure: Vec::new(),
            porosity: Vec::new(),
            carried: Vec::new(),
            grain_flux: Vec::new(),
            n_made: n as u32,
        }
    }

    /// Numbers given so far: one more than the highest id there ever was.
    pub fn n_made(&self) -> u32 {
        self.n_made
    }

    /// Makes a particle of the first flow law; pressure and acceleration wait for the next evaluation.
    pub(crate) fn push(&mut self, position: Vec3, velocity: Vec3, density: f64, mass: f64) {
        self.id.push(self.n_made.into());
        self.n_made += 1;
        self.position.push(position);
        self.velocity.push(velocity);
        self.mass.push(mass);
        self.density.push(density);
        self.pressure.push(0.0);
        self.acceleration.push(Vec3::zeros());
        self.viscous_acceleration.push([0.0; 3]);
        self.kind.push(0);
        if !self.porosity.is_empty() {
            self.porosity.push(1.0);
        }
        if !self.carried.is_empty() {
            self.carried.push(density);
        }
        if !self.grain_flux.is_empty() {
            self.grain_flux.push(Vec3::zeros());
        }
    }

    /// Share of the volume of a particle that water fills; –.
    #[inline]
    pub fn porosity_of(&self, particle: usize) -> f64 {
        self.porosity.get(particle).copied().unwrap_or(1.0)
    }

    /// Density of the water itself: that carried by the particle over its porosity; kg/m³.
    #[inline]
    pub fn water_density(&self, particle: usize) -> f64 {
        self.density[particle] / self.porosity_of(particle)
    }

    /// Volume that a particle takes with the grains in it, as its own flow has carried it; m³.
    #[inline]
    pub fn volume_with_grains(&self, particle: usize) -> f64 {
        let carried = self.carried.get(particle);
        self.mass[particle] / carried.unwrap_or(&self.density[particle])
    }

    /// Sets the density of the water itself; kg/m³.
    pub(crate) fn set_water_density(&mut self, particle: usize, density: f64) {
        let carried = density * self.porosity_of(particle);
        self.density[particle] = carried;
        if let Some(by_flow) = self.carried.get_mut(particle) {
            *by_flow = carried;
        }
    }

    /// Flux of water and grains together: volume per area and time; m/s.
    #[inline]
    pub fn flux(&self, particle: usize) -> Vec3 {
        match self.grain_flux.get(particle) {
            None => self.velocity[particle],
            Some(of_grains) => self.velocity[particle] * self.porosity_of(particle) + of_grains,
        }
    }

    /// Number of particles.
    pub fn len(&self) -> usize {
        self.id.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.id.is_empty()
    }

    /// Whether all columns are of one length, but for those that are empty where viscosity does not vary or has no bulk part.
    pub(crate) fn is_whole(&self) -> bool {
        // no `..`: a new column cannot be forgotten
        let Self {
            id,
            position,
            velocity,
            mass,
            density,
            pressure,
            acceleration,
            viscous_acceleration,
            kind,
            shear_rate,
            viscosity,
            bulk_pressure,
            porosity,
            carried,
            grain_flux,
            n_made,
        } = self;
        let n = id.len();
        let lengths = [
            position.len(),
            velocity.len(),
            mass.len(),
            density.len(),
            pressure.len(),
            acceleration.len(),
            viscous_acceleration.len(),
            kind.len(),
        ];
        lengths.iter().all(|&length| length == n)
            && [shear_rate, viscosity, bulk_pressure, porosity, carried]
                .iter()
                .all(|column| [0, n].contains(&column.len()))
            && [0, n].contains(&grain_flux.len())
            && id.iter().all(|&id| u32::from(id) < *n_made)
    }

    /// Keeps the particles whose flag is set, in order.
    pub(crate) fn retain(&mut self, keep: &[bool]) {
        // no `..`: a new column cannot be forgotten
        let Self {
            id,
            position,
            velocity,
            mass,
            density,
            pressure,
            acceleration,
            viscous_acceleration,
            kind,
            shear_rate,
            viscosity,
            bulk_pressure,
            porosity,
            carried,
            grain_flux,
            n_made: _,
        } = self;
        filter(id, keep);
        filter(position, keep);
        filter(velocity, keep);
        filter(mass, keep);
        filter(density, keep);
        filter(pressure, keep);
        filter(acceleration, keep);
        filter(viscous_acceleration, keep);
        filter(kind, keep);
        filter(shear_rate, keep);
        filter(viscosity, keep);
        filter(bulk_pressure, keep);
        filter(porosity, keep);
        filter(carried, keep);
        filter(grain_flux, keep);
    }
}

/// Keeps the entries of a column whose flag is set, in order.
pub(crate) fn filter<T: Copy>(column: &mut Vec<T>, keep: &[bool]) {
    let mut flags = keep.iter();
    column.retain(|_| flags.next().copied().unwrap_or(true));
}
