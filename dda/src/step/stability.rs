//! The stability limit of the sub-step, where the bound of `critical_step` is safe and cheap.

use crate::contact::spring::Spring;
use crate::motion::kinematics::Kinematics;
use crate::{Blocks, Vec3};
use nalgebra::Matrix3;

/// Rounds of the power iteration; the largest eigenvalue is then good to 1 %, mostly to much less.
const N_ROUNDS: usize = 300;
/// Iterations for the stable step of the stiffest motion.
const N_TRIALS: usize = 4;

/// A motion of a block, and the impulses that make it: of the centroid, about it, and of all first moments where the
/// block deforms.
#[derive(Clone, Copy, Default)]
struct Motion {
    velocity: Vec3,
    spin: Vec3,
    strain_rate: Matrix3<f64>,
    momentum: Vec3,
    angular_momentum: Vec3,
    moment: Matrix3<f64>,
}

impl Blocks {
    /// Largest stable sub-step of the current contacts and of the strains of the blocks; s. Infinite without
    /// stiffness.
    ///
    /// ```text
    /// (dt/2)² v·Kv + dt/2 v·Cv ≤ v·Mv    for the motion v that asks for the least                    [s]
    /// ```
    /// found by power iteration over all contacts, thousands of times the work of [`Blocks::critical_time_step`], which
    /// is a bound from the sums of each block and governs the steps: 2 to 3 times less, with room for the contacts that
    /// form next. Spheres on surfaces of triangles, attachments and strains add their bounds.
    pub fn stability_limit(&self) -> f64 {
        let springs = self.springs();
        let (mut k_bound, mut c_bound) = (0.0_f64, 0.0_f64);
        let mut attached = vec![0.0; self.n_blocks()];
        self.state.attachments.add_stiffness_rates(
            &self.state.kinematics,
            |b| self.is_free(b),
            &mut attached,
        );
        for pair in &self.contacts.surface_pairs {
            // a polyhedron is among the springs
            if pair.is_touching && pair.is_of_sphere() {
                attached[pair.blocks.0 as usize] += pair.rates.stiffness;
                c_bound = c_bound.max(pair.rates.damping);
            }
        }
        for b in (0..self.n_blocks()).filter(|&b| self.is_free(b)) {
            let mut k = attached[b];
            if let Some(of) = self.constants.deformable_of[b] {
                let (square, xi) = self.state.deformables[of as usize].stiffness_rate();
                k += square;
                c_bound = c_bound.max(2.0 * xi * square.sqrt());
            }
            k_bound = k_bound.max(k);
        }
        let longest = |k: f64, c: f64| ((c * c + 4.0 * k).sqrt() - c) / k;
        let mut dt = if k_bound > 0.0 {
            longest(k_bound, c_bound)
        } else {
            f64::INFINITY
        };
        let mut motion = self.stirred();
        for _ in 0..N_TRIALS {
            let share = if dt.is_finite() { 0.5 * dt } else { 1.0 };
            let (k, c) = self.stiffest(&springs, share, &mut motion);
            if k > 0.0 {
                dt = longest(k + k_bound, c + c_bound);
            }
        }
        dt
    }

    /// Some motion of the free blocks, the same each time.
    fn stirred(&self) -> Vec<Motion> {
        let some = |k: usize| Vec3::from_fn(|i, _| ((3 * k + i) as f64 * 2.399).sin());
        let stir = |(b, body): (usize, &Kinematics)| {
            let mut motion = Motion::default();
            for k in 0..3 {
                let x = body.centroid + some(2 * (3 * b + k)) * self.constants.radius[b];
                motion.push(&some(2 * (3 * b + k) + 1), &x, body);
            }
            motion
        };
        self.state.kinematics.iter().enumerate().map(stir).collect()
    }

    /// Rayleigh's quotients of stiffness (1/s²) and damping (1/s) of the motion for which `s² K + s C` is largest;
    /// `motion` continues from its last value.
    fn stiffest(&self, springs: &[Spring], s: f64, motion: &mut Vec<Motion>) -> (f64, f64) {
        let mut answer = vec![Motion::default(); motion.len()];
        let mut found = (0.0, 0.0);
        for _ in 0..N_ROUNDS {
            answer.fill(Motion::default());
            let (mut k, mut c) = (0.0, 0.0);
            for spring in springs {
                let [i, j] = spring.blocks;
                let (a, b) = (&self.state.kinematics[i], &self.state.kinematics[j]);
                let rate = motion[j].at(&spring.point, b) - motion[i].at(&spring.point, a);
                let along = spring.normal * spring.normal.dot(&rate);
                let across = rate - along;
                let squares = [along.norm_squared(), across.norm_squared()];
                let sum = |of: &[f64; 2]| of[0] * squares[0] + of[1] * squares[1];
                k += sum(&spring.stiffness);
                c += sum(&spring.dashpot);
                let weight =
                    |axis: usize| s * s * spring.stiffness[axis] + s * spring.dashpot[axis];
                let force = along * weight(0) + across * weight(1);
                answer[i].push(&-force, &spring.point, a);
                answer[j].push(&force, &spring.point, b);
            }
            let twice_energy = |motion: &[Motion]| -> f64 {
                motion.iter().map(Motion::twice_kinetic_energy).sum()
            };
            let mass = twice_energy(motion);
            if mass <= 0.0 {
                return (0.0, 0.0);
            }
            found = (k / mass, c / mass);
            let scale = twice_energy(&answer).sqrt();
            if scale <= 0.0 {
                break;
            }
            for motion in &mut answer {
                motion.scale(1.0 / scale);
            }
            std::mem::swap(motion, &mut answer);
        }
        found
    }
}

impl Motion {
    /// Velocity of a point; m/s.
    fn at(&self, x: &Vec3, body: &Kinematics) -> Vec3 {
        if body.inverse_mass == 0.0 {
            return Vec3::zeros();
        }
        let r = x - body.centroid;
        self.velocity + self.spin.cross(&r) + self.strain_rate * r
    }

    /// Adds the effect of an impulse at a point.
    fn push(&mut self, impulse: &Vec3, x: &Vec3, body: &Kinematics) {
        if body.inverse_mass == 0.0 {
            return;
        }
        let r = x - body.centroid;
        self.momentum += impulse;
        self.velocity += impulse * body.inverse_mass;
        if body.strain_rate.is_some() {
            let moment = impulse * r.transpose();
            self.moment += moment;
            // its inverse inertia is that of all first moments
            self.strain_rate += moment * body.inverse_inertia;
        } else {
            let angular = r.cross(impulse);
            self.angular_momentum += angular;
            self.spin += body.inverse_inertia * angular;
        }
    }

    /// `v·Mv`; J.
    fn twice_kinetic_energy(&self) -> f64 {
        self.velocity.dot(&self.momentum)
            + self.spin.dot(&self.angular_momentum)
            + self.strain_rate.dot(&self.moment)
    }

    fn scale(&mut self, factor: f64) {
        self.velocity *= factor;
        self.spin *= factor;
        self.strain_rate *= factor;
        self.momentum *= factor;
        self.angular_momentum *= factor;
        self.moment *= factor;
    }
}
