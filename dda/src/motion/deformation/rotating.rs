//! Steps of an affine block in contact dynamics: rotation and strain apart, so that neither its stiffness nor its rotation limits the step.
//!
//! ```text
//! F' = [ω]× F + G,    L = J ω = 2 axial(F' S₀ Fᵀ)             G: the part without angular momentum
//! rotation    F := Q F,  G := Q G                             Q of the free rotation of the present shape, L stays
//! strain      F := F + h G                                    L stays, and G remains without angular momentum
//! kick        F' := F' + A F,   M A = Σ f ⊗ r − dt V₀ (τ + τ_v) − dt Π([ω]×² + 2 [ω]× Ḡ F⁻¹) S      [N m s]
//! ```
//! with `S = F S₀ Fᵀ`, `τ = P Fᵀ`, the projection `Π` on what carries no angular momentum, and `ω` and `Ḡ` those of the mean of the
//! velocities before and after the kick, contacts apart. The order is rotation, strain, kick, strain, rotation: symmetric in time, of second
//! order. Along straight lines `F + h F'` a rotating block would stretch by `(ω h)²/2`, which a stiff one turns into stress; here a rigid
//! rotation strains nothing but by its centrifugal force.
//!
//! Strain is semi-implicit,
//!
//! ```text
//! M A = A S + dt²/4 V₀ F C:(Fᵀ A F) Fᵀ + dt/2 (1 + s) V₀ F (2η_s e + τ_n C:e) Fᵀ,  e = sym(Fᵀ A F)      [N m s]
//! s   = (ω_el dt)²/(4 + (ω_el dt)²),    τ_n = s² dt/2
//! ```
//! which for small strains and `τ_n = 0` is the implicit midpoint rule: stable in any step, energy kept. Oscillations that a step does not resolve
//! are damped by `τ_n`, which goes with the fifth power of the step and is 1 % of critical damping at `ω_el dt = 1`: a velocity that changes its sign
//! in every step would meet contacts and rotation with energy from nowhere. For the same reason viscosity acts after the kick where a step is
//! long, instead of in its middle. What both take is booked as lost to strain. The added terms are symmetric in `A`, vanish for rotations and have
//! no torque, so that angular momentum is kept to round-off. The stiffness by stress itself remains explicit, and alone bounds
//! the step; with stiffness to infinity the block is rigid.
//!
//! Source of the semi-implicit mass: Koziara (2008), linearly implicit integration of pseudo-rigid bodies; the split is ours.

use super::{Affine12, AffineBody, axial, green_strain, symmetric};
use crate::Vec3;
use crate::motion::kinematics::flushed;
use nalgebra::{Matrix3, SMatrix, SVector, UnitQuaternion};

/// From first moments of impulses `Σ f ⊗ r`, column by column, to the change of the velocity gradient; 1/(kg m²).
pub type MomentCompliance = SMatrix<f64, 9, 9>;

/// Change of the velocity gradient by a first moment of impulses (N m s); 1/s.
pub(crate) fn product(compliance: &MomentCompliance, moment: &Matrix3<f64>) -> Matrix3<f64> {
    let moment = SVector::<f64, 9>::from_column_slice(moment.as_slice());
    Matrix3::from_column_slice((compliance * moment).as_slice())
}

/// Iterations at most, of a half step or a kick; each gains the digits of an angle of rotation.
const N_ITERATIONS: usize = 40;
/// Change that ends an iteration; –.
const ROUND_OFF: f64 = 1e-16;

/// Rate of an affine body, in rotation and strain.
struct Split<'a> {
    body: &'a mut AffineBody,
    /// `L`; N m s.
    momentum: Vec3,
    /// `G`; 1/s.
    straining: Matrix3<f64>,
}

impl<'a> Split<'a> {
    fn of(body: &'a mut AffineBody) -> Self {
        let momentum = body.angular_momentum();
        let spin = body.inverse_inertia() * momentum;
        Self {
            straining: body.rate - spin.cross_matrix() * body.gradient,
            momentum,
            body,
        }
    }

    /// Free rotation of the present shape, with its inertia half way: `θ = h Q_½ J⁻¹ Q_½ᵀ L`.
    fn rotate(&mut self, h: f64) {
        let inverse = self.body.inverse_inertia();
        let mut turn = inverse * self.momentum * h;
        for _ in 0..N_ITERATIONS {
            let half = UnitQuaternion::from_scaled_axis(turn * 0.5);
            let spin = half * (inverse * half.inverse_transform_vector(&self.momentum));
            let change = (spin * h - turn).norm();
            turn = spin * h;
            if change <= ROUND_OFF * turn.norm() {
                break;
            }
        }
        self.turn(&UnitQuaternion::from_scaled_axis(turn));
    }

    fn turn(&mut self, turn: &UnitQuaternion<f64>) {
        let turn = turn.to_rotation_matrix();
        self.body.gradient = turn * self.body.gradient;
        self.straining = turn * self.straining;
    }

    fn strain(&mut self, h: f64) {
        self.body.gradient += self.straining * h;
    }

    fn join(self) {
        let spin = self.body.inverse_inertia() * self.momentum;
        self.body.rate = spin.cross_matrix() * self.body.gradient + self.straining;
        self.body.rate.apply(|c| *c = flushed(*c));
    }
}

impl AffineBody {
    /// `Π` of a rate or an acceleration, `R − [J⁻¹ 2 axial(R S₀ Fᵀ)]× F`.
    fn without_rotation(&self, rate: &Matrix3<f64>) -> Matrix3<f64> {
        let torque = axial(&(rate * self.second_moment * self.gradient.transpose())) * 2.0;
        rate - (self.inverse_inertia() * torque).cross_matrix() * self.gradient
    }

    /// Half a step of `h` (s) towards its middle.
    pub fn drift_to_middle(&mut self, h: f64) {
        let mut split = Split::of(self);
        split.rotate(h);
        split.strain(h);
        split.join();
    }

    /// Half a step of `h` (s) from its middle on.
    pub fn drift_from_middle(&mut self, h: f64) {
        let mut split = Split::of(self);
        split.strain(h);
        split.rotate(h);
        split.join();
    }

    /// Turns the block where it is; its angular momentum stays.
    pub fn turn(&mut self, turn: &UnitQuaternion<f64>) {
        let mut split = Split::of(self);
        split.turn(turn);
        split.join();
    }
}

impl Affine12 {
    /// `M⁻¹` of a kick over `dt` (s); zero if the block has collapsed, which the check of the step reports.
    pub fn moment_compliance(&self, dt: f64) -> MomentCompliance {
        let gradient = &self.body.gradient;
        let second = self.body.present_second_moment();
        let stiff = 0.25 * dt * dt;
        let late = 0.5 * dt * (1.0 + self.lateness(dt));
        let mut mass = MomentCompliance::zeros();
        for k in 0..9 {
            let mut rate = Matrix3::zeros();
            rate[k] = 1.0;
            let strain = symmetric(&(gradient.transpose() * rate * gradient));
            let stress =
                self.elastic.linear(&strain) * stiff + self.viscous_stress(&strain, dt) * late;
            let image = rate * second + gradient * stress * gradient.transpose() * self.body.volume;
            mass.column_mut(k).copy_from_slice(image.as_slice());
        }
        let mass = (mass + mass.transpose()) * 0.5;
        let factors = mass.cholesky();
        factors.map_or_else(MomentCompliance::zeros, |factors| factors.inverse())
    }

    /// `s`: share of viscosity that acts after a kick over `dt` (s) instead of in its middle; –.
    fn lateness(&self, dt: f64) -> f64 {
        let square = self.elastic.largest_square * dt * dt;
        square / (4.0 + square)
    }

    /// Second Piola stress by viscosity, with that of oscillations that a step of `dt` (s) does not resolve, at a rate of Green's strain
    /// (1/s); Pa.
    fn viscous_stress(&self, rate: &Matrix3<f64>, dt: f64) -> Matrix3<f64> {
        let unresolved = self.lateness(dt).powi(2) * 0.5 * dt;
        rate * (2.0 * self.elastic.viscosity) + self.elastic.linear(rate) * unresolved
    }

    /// `A` of a kick over `dt` (s) by outer forces, of some `torque` and first moment (N m s), by stress and rotation; 1/s.
    pub fn free_change(
        &self,
        compliance: &MomentCompliance,
        (torque, outer): (&Vec3, &Matrix3<f64>),
        dt: f64,
    ) -> Matrix3<f64> {
        let body = &self.body;
        let rate = symmetric(&(body.gradient.transpose() * body.rate));
        let viscous = body.gradient * self.viscous_stress(&rate, dt);
        let stress = (self.first_piola() + viscous) * body.gradient.transpose();
        let momentum = body.angular_momentum() + torque * 0.5;
        let spin = (body.inverse_inertia() * momentum).cross_matrix();
        let given = outer - symmetric(&stress) * (body.volume * dt);
        let centrifugal = spin * spin * body.gradient;
        let mut mean = body.rate;
        let mut change = Matrix3::zeros();
        for _ in 0..N_ITERATIONS {
            let coriolis = spin * body.without_rotation(&mean) * 2.0;
            let inertial = body.without_rotation(&(centrifugal + coriolis));
            // no torque but by round-off
            let moment = inertial * body.second_moment * body.gradient.transpose();
            let next = product(compliance, &(given - symmetric(&moment) * dt));
            let difference = (next - change).norm();
            change = next;
            mean = body.rate + change * body.gradient * 0.5;
            if difference <= ROUND_OFF * change.norm() {
                break;
            }
        }
        change
    }

    /// Kick over `dt` (s) by a change of the velocity gradient (1/s); returns what viscosity takes; J.
    pub fn kick_by(&mut self, change: &Matrix3<f64>, dt: f64) -> f64 {
        let late = 0.5 * self.lateness(dt);
        let gradient = self.body.gradient;
        let gained = change * gradient;
        let mean = self.body.rate + gained * 0.5;
        self.body.rate += gained;
        self.body.rate.apply(|c| *c = flushed(*c));
        let strain_rate = |rate: Matrix3<f64>| symmetric(&(gradient.transpose() * rate));
        let stress = self.viscous_stress(&strain_rate(mean + gained * late), dt);
        dt * self.body.volume * stress.dot(&strain_rate(mean))
    }

    /// Squared frequency of the stiffness by stress, which stays explicit; 1/s². Twice its bound: Saint Venant-Kirchhoff's law and the
    /// corotational one differ from the semi-implicit stiffness by as much.
    ///
    /// ```text
    /// ω² ≤ 2 V₀ |C:E + S_i| |S₀⁻¹|
    /// ```
    pub fn stress_rate(&self) -> f64 {
        let body = &self.body;
        let stress = self.elastic.linear(&green_strain(&body.gradient)) + self.initial_stress;
        2.0 * body.volume * stress.norm() * body.inverse_second_moment.norm()
    }
}
