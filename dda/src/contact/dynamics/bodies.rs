//! Bodies that impulses at contacts move: rigid ones, and ones that strain.
//!
//! ```text
//! v(r) = v + ω × r + D r                                  velocity of a point at r from the centroid      [m/s]
//! ω, D : axial vector and symmetric part of  A = M⁻¹ Σ f ⊗ r                                              [1/s]
//! ```
//! Most scenes have rigid bodies alone: what strain needs lies beside their columns, and is empty there.

use crate::Vec3;
use crate::motion::deformation::{MomentCompliance, axial, product, symmetric};
use nalgebra::Matrix3;

/// A rigid body that impulses move; what does not move is no body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// 1/kg.
    pub inverse_mass: f64,
    /// Projection on the directions in which it may move, where it is held in others.
    pub freedom: Option<Matrix3<f64>>,
    /// `J⁻¹` in world axes, of the rotation it is allowed; 1/(kg m²).
    pub inverse_inertia: Matrix3<f64>,
}

impl Body {
    /// Velocity and spin by an impulse (N s) and its moment (N m s); m/s, rad/s.
    #[inline]
    pub fn kicked(&self, impulse: &Vec3, moment: &Vec3) -> [Vec3; 2] {
        let free = self.freedom.map_or(*impulse, |freedom| freedom * impulse);
        [free * self.inverse_mass, self.inverse_inertia * moment]
    }

    /// Velocity of the centroid by an impulse, `1/m P`; 1/kg.
    pub fn of_centroid(&self) -> Matrix3<f64> {
        self.freedom.unwrap_or_else(Matrix3::identity) * self.inverse_mass
    }

    /// Velocity of a point at `arm` (m) by an impulse there, `1/m P − [r]× J⁻¹ [r]×`; 1/kg.
    fn compliance(&self, arm: &Vec3) -> Matrix3<f64> {
        let cross = arm.cross_matrix();
        self.of_centroid() - cross * self.inverse_inertia * cross
    }
}

/// Body on one side of a contact, and the point from its centroid (m).
pub type Arm = Option<(u32, Vec3)>;

/// A contact point of two bodies, or a pair of torques between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Columns n, t1, t2 in world axes; n from A to B. Of a pair of torques in m: their length.
    pub frame: Matrix3<f64>,
    /// Bodies A and B; none where it does not move.
    pub arms: [Arm; 2],
    /// Whether its impulses are torques over a length, and its velocities spins times it.
    pub is_torque: bool,
}

impl Point {
    /// A point of normal `n`, from A to B; the tangents follow from `n` alone.
    pub fn new(normal: Vec3, arms: [Arm; 2]) -> Self {
        let axis = normal.iamin();
        let first = Vec3::ith(axis, 1.0).cross(&normal).normalize();
        let second = normal.cross(&first);
        Self {
            frame: Matrix3::from_columns(&[normal, first, second]),
            arms,
            is_torque: false,
        }
    }

    /// Torques about all axes between the bodies of a contact, as impulses at the end of a length (m).
    pub fn turning(contact: &Self, length: f64) -> Self {
        Self {
            frame: contact.frame * length,
            is_torque: true,
            ..*contact
        }
    }

    /// Torques across the normal of a contact, as impulses at the end of a length (m).
    pub fn rolling(contact: &Self, length: f64) -> Self {
        let mut torques = Self::turning(contact, length);
        torques.frame.set_column(0, &Vec3::zeros());
        torques
    }

    /// Torque along the normal of a contact, as an impulse at the end of a length (m).
    pub fn twisting(contact: &Self, length: f64) -> Self {
        let mut torque = Self::turning(contact, length);
        torque.frame.columns_mut(1, 2).fill(0.0);
        torque
    }

    /// Velocity of B seen from A, of velocity and spin of each body (m/s, rad/s); m/s.
    #[inline]
    pub(super) fn relative(&self, of_bodies: &[[Vec3; 2]]) -> Vec3 {
        let side = |arm: &Arm| {
            arm.map_or(Vec3::zeros(), |(body, arm)| {
                let [velocity, spin] = of_bodies[body as usize];
                match self.is_torque {
                    true => spin,
                    false => velocity + spin.cross(&arm),
                }
            })
        };
        let [a, b] = &self.arms;
        self.frame.tr_mul(&(side(b) - side(a)))
    }
}

/// A body of which the velocity is linear in position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrainingBody {
    /// Its number among the bodies, which has mass and freedom of the centroid.
    pub body: u32,
    /// `M⁻¹`, symmetric; 1/(kg m²).
    pub compliance: MomentCompliance,
}

impl StrainingBody {
    /// Velocity gradient by a first moment of impulses `Σ f ⊗ r` (N m s); 1/s.
    pub fn gradient(&self, moment: &Matrix3<f64>) -> Matrix3<f64> {
        product(&self.compliance, moment)
    }

    /// Velocity of a point at `arm` (m) by an impulse there, `r·M⁻¹·r`; of the spin by a torque (1/(kg m²)); 1/kg.
    fn compliance(&self, arm: &Vec3, is_torque: bool) -> Matrix3<f64> {
        let columns = [0, 1, 2].map(|axis| {
            let moment = first_moment(&Vec3::ith(axis, 1.0), arm, is_torque);
            let gradient = self.gradient(&moment);
            match is_torque {
                true => axial(&gradient),
                false => gradient * arm,
            }
        });
        Matrix3::from_columns(&columns)
    }
}

/// First moment `f ⊗ r` of an impulse (N s) at `arm` (m), or of a torque (N m s), `[t]×/2`; N m s.
pub(super) fn first_moment(impulse: &Vec3, arm: &Vec3, is_torque: bool) -> Matrix3<f64> {
    match is_torque {
        true => impulse.cross_matrix() * 0.5,
        false => impulse * arm.transpose(),
    }
}

/// All bodies.
#[derive(Clone, Debug, Default)]
pub struct Bodies {
    /// Of all bodies, those that strain included.
    pub(super) rigid: Vec<Body>,
    pub(super) straining: Vec<StrainingBody>,
    /// Position among those that strain; empty if none does.
    straining_of: Vec<Option<u32>>,
}

impl From<Vec<Body>> for Bodies {
    fn from(rigid: Vec<Body>) -> Self {
        Self::new(rigid, Vec::new())
    }
}

/// Velocities of bodies.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BodyVelocities {
    /// Velocity and spin; one per body; m/s, rad/s.
    pub rigid: Vec<[Vec3; 2]>,
    /// `D`; one per body that strains; 1/s.
    pub strain_rate: Vec<Matrix3<f64>>,
}

impl BodyVelocities {
    /// Adds velocity (m/s) and velocity gradient (1/s) of a body, the `k`-th that strains.
    pub fn add(&mut self, (body, k): (usize, usize), (more, gradient): (&Vec3, &Matrix3<f64>)) {
        let [velocity, spin] = &mut self.rigid[body];
        *velocity += more;
        *spin += axial(gradient);
        self.strain_rate[k] += symmetric(gradient);
    }

    /// Velocity gradient `[ω]× + D` of the `k`-th body that strains; 1/s.
    pub fn gradient(&self, body: usize, k: usize) -> Matrix3<f64> {
        self.rigid[body][1].cross_matrix() + self.strain_rate[k]
    }
}

impl Bodies {
    /// Bodies, and what those that strain have beside mass and freedom.
    pub fn new(rigid: Vec<Body>, straining: Vec<StrainingBody>) -> Self {
        let mut straining_of = Vec::new();
        if !straining.is_empty() {
            straining_of.resize(rigid.len(), None);
        }
        for (k, body) in (0..).zip(&straining) {
            straining_of[body.body as usize] = Some(k);
        }
        Self {
            rigid,
            straining,
            straining_of,
        }
    }

    /// Mass, freedom and inertia of all bodies.
    pub fn rigid(&self) -> &[Body] {
        &self.rigid
    }

    /// Those that strain.
    pub fn straining(&self) -> &[StrainingBody] {
        &self.straining
    }

    /// Velocities of bodies at rest.
    pub fn at_rest(&self) -> BodyVelocities {
        BodyVelocities {
            rigid: vec![[Vec3::zeros(); 2]; self.rigid.len()],
            strain_rate: vec![Matrix3::zeros(); self.straining.len()],
        }
    }

    /// Position of a body among those that strain.
    #[inline]
    pub(super) fn straining_number(&self, body: u32) -> Option<usize> {
        let number = self.straining_of.get(body as usize).copied().flatten();
        number.map(|k| k as usize)
    }

    /// Velocity of B seen from A at a point; m/s.
    #[inline]
    pub fn relative(&self, point: &Point, velocities: &BodyVelocities) -> Vec3 {
        let rigid = point.relative(&velocities.rigid);
        match self.straining.is_empty() || point.is_torque {
            true => rigid,
            false => rigid + self.relative_by_strain(point, velocities),
        }
    }

    // apart, so that the sums of rigid bodies stay short
    #[cold]
    #[inline(never)]
    fn relative_by_strain(&self, point: &Point, velocities: &BodyVelocities) -> Vec3 {
        let side = |arm: &Arm| {
            let strains = arm.and_then(|(body, arm)| Some((self.straining_number(body)?, arm)));
            strains.map_or(Vec3::zeros(), |(k, arm)| velocities.strain_rate[k] * arm)
        };
        let [a, b] = &point.arms;
        point.frame.tr_mul(&(side(b) - side(a)))
    }

    /// Velocity of a point by an impulse there, or spin by a torque; 1/kg, 1/(kg m²).
    pub(super) fn compliance(&self, body: u32, arm: &Vec3, is_torque: bool) -> Matrix3<f64> {
        let rigid = &self.rigid[body as usize];
        match (self.straining_number(body), is_torque) {
            (None, true) => rigid.inverse_inertia,
            (None, false) => rigid.compliance(arm),
            (Some(k), true) => self.straining[k].compliance(arm, true),
            (Some(k), false) => rigid.of_centroid() + self.straining[k].compliance(arm, false),
        }
    }

    /// Adds an impulse (N s) at `arm` (m), or a torque (N m s), on the `k`-th body that strains.
    #[cold]
    #[inline(never)]
    pub(super) fn push_straining(
        &self,
        (body, k): (u32, usize),
        velocities: &mut BodyVelocities,
        (impulse, arm, is_torque): (&Vec3, &Vec3, bool),
    ) {
        let velocity = match is_torque {
            true => Vec3::zeros(),
            false => self.rigid[body as usize].of_centroid() * impulse,
        };
        let gradient = self.straining[k].gradient(&first_moment(impulse, arm, is_torque));
        velocities.add((body as usize, k), (&velocity, &gradient));
    }

    /// Parts the velocity gradients of bodies that strain, where there are strain rates, into spin and strain rate.
    pub(super) fn part_gradients(&self, velocities: &mut BodyVelocities) {
        for (body, gradient) in self.straining.iter().zip(&mut velocities.strain_rate) {
            velocities.rigid[body.body as usize][1] = axial(gradient);
            *gradient = symmetric(gradient);
        }
    }
}
