//! Friction of a contact patch: one shear spring for the pair, forces point by point.
//!
//! ```text
//! ξ(x) = ξ₀ + θ n × (x − c)                 displacement since first contact; c: center of pressure    [m]
//! F_k = −k s_k ξ(x_k) − c_t s_k u_t(x_k)     s_k = N_k/N,   k = K_t W                                   [N]
//! slips if Σ |F_k| > C + μ N:                F_k := (C + μ N) s_k F_k/|F_k|,   ξ cut back to that
//! ```
//! `C` is what a broken bond has left of its cohesion, times the wet area.
//! `W` is the weight of the patch if its faces lay flat: a base that breathes does not change it (a
//! stiffness that followed the wet part let go a little force at each breath, and an arch crept).
//! The stiffness is spread as the pressure is, so that under a straight push all points reach their limit
//! together: with springs of their own, points at the edge of the pressure slip at every tremor and the
//! block creeps. Shift and twist belong to the pair: they do not care how the clipped polygon's corners
//! come and go. While sliding, each point is held back against its own displacement, so that a block that
//! slides and spins feels Coulomb's friction of both. Carried in the moving frame after Luding (2008).

use crate::Vec3;
use crate::contact::report::{ContactState, PointState};
use crate::motion::kinematics::Kinematics;
use serde::{Deserialize, Serialize};

/// History of the shear spring of a pair.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct ShearSpring {
    /// `ξ₀`, of j against i; m.
    pub shift: Vec3,
    /// `θ`; rad.
    pub twist: f64,
    /// `c`; m.
    pub center: Vec3,
    /// `W`.
    pub weight: f64,
}

/// A patch of one normal that is sheared, and the law.
pub(crate) struct Shearing<'a> {
    /// i and j.
    pub bodies: (&'a Kinematics, &'a Kinematics),
    /// Unit, from i to j.
    pub normal: Vec3,
    /// `W`, and `K_t` of a unit of it (N/m, or Pa/m).
    pub weight: f64,
    pub stiffness: f64,
    /// `ξ`; –.
    pub damping_ratio: f64,
    /// `μ`; –.
    pub friction: f64,
    /// `C`; N.
    pub cohesion: f64,
    pub is_bonded: bool,
    /// s.
    pub dt: f64,
}

/// Result of a shear update.
pub(crate) struct Sheared {
    pub spring: ShearSpring,
    /// J.
    pub energy: f64,
    /// Of the patch as a whole; N s/m.
    pub damping: f64,
    /// Did it slip under pressure?
    pub has_slipped: bool,
}

impl Shearing<'_> {
    /// Shear forces of the points, whose normal forces are known.
    pub fn apply(&self, points: &mut [PointState], spring: &ShearSpring) -> Sheared {
        let (a, b) = self.bodies;
        let n = self.normal;
        let total: f64 = points.iter().map(|p| p.at.weight).sum();
        let normal: f64 = points.iter().map(|p| p.normal_force.max(0.0)).sum();
        // A bond may pull: its springs lie as the patch does.
        let share = |p: &PointState| {
            if self.is_bonded || normal <= 0.0 {
                p.at.weight / total
            } else {
                p.normal_force / normal
            }
        };
        let center: Vec3 = points.iter().map(|p| p.at.position * share(p)).sum();
        let (at_a, at_b) = (a.velocity_at(&center), b.velocity_at(&center));
        let rate = at_b - at_a;
        let sliding = Sliding {
            velocity: rate - n * rate.dot(&n),
            spin: (b.spin - a.spin).dot(&n),
            frame_velocity: 0.5 * (at_a + at_b),
            frame_spin: 0.5 * (a.spin + b.spin).dot(&n),
            dt: self.dt,
        };
        let mut spring = spring.moved(&n, center, self.weight, &sliding);
        let stiffness = self.stiffness * self.weight;
        let mobility = a.compliance(&center, &n) + b.compliance(&center, &n);
        let damping = if mobility > 0.0 {
            2.0 * self.damping_ratio * (stiffness / mobility).sqrt()
        } else {
            0.0
        };
        let mut asked = 0.0;
        for point in &mut *points {
            let (x, share) = (point.at.position, share(point));
            let slip = sliding.velocity + n.cross(&(x - center)) * sliding.spin;
            point.shear_viscous = -slip * (share * damping);
            point.shear_force = point.shear_viscous - spring.at(&x, &n) * (share * stiffness);
            asked += point.shear_force.norm();
        }
        let limit = self.cohesion + self.friction * normal;
        let is_slipping = asked > limit && !self.is_bonded;
        if is_slipping {
            let mut sum = Vec3::zeros();
            let mut mean = 0.0;
            for point in &mut *points {
                let size = point.shear_force.norm();
                mean += share(point) * spring.at(&point.at.position, &n).norm();
                if size > 0.0 {
                    point.shear_force *= limit * share(point) / size;
                }
                point.shear_viscous = Vec3::zeros();
                sum += point.shear_force;
            }
            if stiffness > 0.0 {
                spring.shift = -sum / stiffness;
                spring.twist *= (limit / (stiffness * mean)).min(1.0);
            }
        }
        for point in &mut *points {
            point.state = match (point.normal_force > 0.0, is_slipping) {
                (false, _) if !self.is_bonded => ContactState::Open,
                (_, true) => ContactState::Slide,
                _ => ContactState::Stick,
            };
        }
        let held: f64 = points
            .iter()
            .map(|p| share(p) * spring.at(&p.at.position, &n).norm_squared())
            .sum();
        Sheared {
            spring,
            energy: 0.5 * stiffness * held,
            damping,
            has_slipped: is_slipping && normal > 0.0,
        }
    }
}

/// Motion of j against i over a step, at the center of pressure.
struct Sliding {
    /// Across the normal; m/s.
    velocity: Vec3,
    /// About the normal; rad/s.
    spin: f64,
    /// Mean of both bodies, of the center (m/s) and about the normal (rad/s).
    frame_velocity: Vec3,
    frame_spin: f64,
    /// s.
    dt: f64,
}

impl ShearSpring {
    /// The spring at the current position of a patch of weight `weight` around `center`, after sliding.
    ///
    /// A patch that has grown keeps its force, one that has shrunk its displacement: neither makes
    /// energy.
    fn moved(&self, normal: &Vec3, center: Vec3, weight: f64, sliding: &Sliding) -> Self {
        let kept = if weight > self.weight {
            self.weight / weight
        } else {
            1.0
        };
        let dt = sliding.dt;
        let twist = self.twist * kept;
        let drift = center - (self.center + sliding.frame_velocity * dt);
        let carried = carry(&(self.shift * kept), normal, sliding.frame_spin * dt);
        Self {
            shift: carried + normal.cross(&drift) * twist + sliding.velocity * dt,
            twist: twist + sliding.spin * dt,
            center,
            weight,
        }
    }

    /// `ξ(x)`; m.
    fn at(&self, x: &Vec3, normal: &Vec3) -> Vec3 {
        self.shift + normal.cross(&(x - self.center)) * self.twist
    }
}

/// Shear displacement carried into the present plane: turned with the pair about `n`, projected,
/// and brought back to its length.
#[inline]
pub(crate) fn carry(shear: &Vec3, n: &Vec3, turn: f64) -> Vec3 {
    let square = shear.norm_squared();
    if square == 0.0 {
        return Vec3::zeros();
    }
    let turned = shear + n.cross(shear) * turn;
    let flat = turned - n * turned.dot(n);
    let flat_square = flat.norm_squared();
    if flat_square > 0.0 {
        flat * (square / flat_square).sqrt()
    } else {
        Vec3::zeros()
    }
}
