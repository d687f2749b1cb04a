//! Time integration of the fluid: each stepping is a file, and each file begins with its list of phases.
//!
//! A stepping moves the fluid by the pieces of [`Fluid`] and asks its [`Boundary`] at fixed places. A new one is a
//! file here, a variant of [`Stepping`] and two lines below.

mod kick_drift_kick;
mod limits;
mod predictor_corrector;
mod symplectic_euler;

use crate::Fluid;
use crate::boundary::{Boundary, Phase, Stage};
use crate::fluid::porosity::Flow;
use crate::scheme::{Scheme, Stepping, ViscousStep};
use crate::stability::share_left_by_bulk;

/// Largest step with density from continuity, over `h/c₀`.
fn sound_limit(scheme: &Scheme) -> f64 {
    match scheme.stepping {
        Stepping::KickDriftKick | Stepping::SymplecticEuler => {
            share_left_by_bulk(scheme.bulk_viscosity)
        }
        Stepping::PredictorCorrector => predictor_corrector::sound_limit(scheme.diffusion),
    }
}

impl Fluid {
    /// Advances the fluid by `dt` (s) with the stepping of its scheme, within its boundary.
    ///
    /// # Errors
    ///
    /// Errors of the boundary, and [`crate::FluidError`] of the fluid; the state is then that of the failed step.
    pub fn step<B: Boundary>(&mut self, boundary: &mut B, dt: f64) -> Result<(), B::Error> {
        match self.settings.scheme.stepping {
            Stepping::KickDriftKick => kick_drift_kick::step(self, boundary, dt),
            Stepping::PredictorCorrector => predictor_corrector::step(self, boundary, dt),
            Stepping::SymplecticEuler => symplectic_euler::step(self, boundary, dt),
        }
    }

    /// Everything that follows from positions, velocities and densities at the end of a step of `dt` (s), 0 before the first:
    ///
    /// ```text
    /// 1 particles enter and leave       4 shifting, where the scheme shifts
    /// 2 sort by cell                    5 flow held in openings
    /// 3 boundaries at their places      6 pressures, viscosities, accelerations
    ///                                   7 implicit viscous step, where the scheme has it
    /// ```
    ///
    /// # Errors
    ///
    /// As [`Self::step`].
    pub fn evaluate<B: Boundary>(&mut self, boundary: &mut B, dt: f64) -> Result<(), B::Error> {
        self.forget_viscous_change();
        boundary.exchange(self, dt)?;
        boundary.ended(Phase::Integration);
        self.sorted(boundary)?;
        boundary.place(self, Stage::End, dt);
        if self.shifts() && 0.0 < dt {
            self.update_concentration();
            boundary.concentration(self);
            self.shift(dt);
            self.refresh();
            boundary.ended(Phase::Density);
            boundary.find(self);
        }
        boundary.hold(self, Stage::End, dt);
        boundary.ended(Phase::Density);
        self.evaluate_forces(boundary)?;
        if self.settings.scheme.viscous_step == ViscousStep::Implicit {
            self.begin_viscous_step();
            boundary.resistance(self);
            self.solve_viscous_step(dt)?;
            boundary.drag(self);
            boundary.ended(Phase::Forces);
        }
        boundary.share(self);
        Ok(())
    }

    /// Pressures, viscosities and accelerations with all neighbors found; rates of density where the stepping takes both
    /// from one state.
    fn evaluate_forces<B: Boundary>(&mut self, boundary: &mut B) -> Result<(), B::Error> {
        if self.settings.scheme.stepping.rates_with_forces() && self.advances_density() {
            self.update_rates();
            boundary.density_rates(self);
            self.update_bulk_pressure();
        }
        self.update_pressure()?;
        boundary.ended(Phase::Density);
        boundary.continue_pressure(self);
        if self.varies_viscosity() {
            self.update_strain();
            boundary.strain_rates(self);
            self.update_viscosity();
        }
        boundary.ended(Phase::Forces);
        boundary.solve_motion(self);
        self.update_accelerations();
        boundary.ended(Phase::Forces);
        boundary.forces(self);
        Ok(())
    }

    /// Sorts if due, and reports particles that left the domain.
    fn sorted<B: Boundary>(&mut self, boundary: &mut B) -> Result<(), B::Error> {
        let n_escaped = self.refresh();
        boundary.ended(Phase::Neighbors);
        match n_escaped {
            0 => Ok(()),
            _ => boundary.escaped(n_escaped),
        }
    }

    /// A kick of the fluid by `kick` over `dt` (s), the boundary's equal and opposite with it.
    fn kicked<B: Boundary>(&mut self, boundary: &mut B, dt: f64, kick: fn(&mut Self, f64)) {
        boundary.begin_kick(self, dt);
        kick(self, dt);
        boundary.end_kick(self, dt);
        boundary.ended(Phase::Integration);
    }

    /// Drifts by `dt` (s), with the density advanced half way at the boundaries' position there; with summation there is
    /// no density to advance.
    fn drift_with_density<B: Boundary>(
        &mut self,
        boundary: &mut B,
        dt: f64,
    ) -> Result<(), B::Error> {
        if !self.advances_density() {
            self.drift(dt);
            boundary.ended(Phase::Integration);
            return Ok(());
        }
        self.drift(0.5 * dt);
        boundary.ended(Phase::Integration);
        self.sorted(boundary)?;
        boundary.place(self, Stage::Midpoint, dt);
        self.open_rates();
        if self.is_shared() {
            self.update_rates_of(Flow::Water);
            boundary.density_rates(self);
            self.keep_compression_of_water();
        }
        self.update_rates();
        boundary.ended(Phase::Density);
        boundary.density_rates(self);
        // the force at the start works in the kick before, that at the end in the kick after
        self.book_bulk(0.5 * dt);
        self.update_bulk_pressure();
        self.book_bulk(0.5 * dt);
        self.advance_density(dt);
        self.close_rates();
        boundary.ended(Phase::Density);
        self.drift(0.5 * dt);
        boundary.ended(Phase::Integration);
        Ok(())
    }
}
