//! Friction of a contact patch: one shear spring for the pair, forces point by point.
//!
//! ```text
//! ξ(x) = ξ₀ + θ n × (x − c)                 displacement since first contact; c: centre of pressure    [m]
//! F_k = −k s_k ξ(x_k) − c_t s_k u_t(x_k)     s_k = N_k/N,   k = K_t W                                   [N]
//! slips if Σ |F_k| > μ N:                    F_k := μ N_k F_k/|F_k|,   ξ cut back to that
//! ```
//! `W` is the weight of the patch if its faces lay flat: a base that breathes does not change it (a
//! stiffness that followed the wet part let go a little force at each breath, and an arch crept).
//! The stiffness is spread as the pressure is, so that under a straight push all points reach their limit
//! together: with springs of their own, points at the edge of the pressure slip at every tremor and the
//! block creeps. Shift and twist belong to the pair: they do not care how the clipped polygon's corners
//! come and go. While sliding, each point is held back against its own displacement, so that a block that
//! slides and spins feels Coulomb's friction of both. Carried in the moving frame after Luding (2008).

use crate::Vec3;

/// What the shear spring of a pair remembers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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

/// Motion of j against i over a step, at the centre of pressure.
pub(crate) struct Sliding {
    /// Across the normal; m/s.
    pub velocity: Vec3,
    /// About the normal; rad/s.
    pub spin: f64,
    /// Mean of both bodies, of the centre (m/s) and about the normal (rad/s).
    pub frame_velocity: Vec3,
    pub frame_spin: f64,
    /// s.
    pub dt: f64,
}

impl ShearSpring {
    /// The spring in the present place of a patch of weight `weight` around `center`, after sliding.
    ///
    /// A patch that has grown keeps its force, one that has shrunk its displacement: neither makes
    /// energy.
    pub fn moved(&self, normal: &Vec3, center: Vec3, weight: f64, sliding: &Sliding) -> Self {
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
    pub fn at(&self, x: &Vec3, normal: &Vec3) -> Vec3 {
        self.shift + normal.cross(&(x - self.center)) * self.twist
    }
}

/// Shear displacement carried into the present plane: turned with the pair about `n`, projected,
/// and brought back to its length.
pub(crate) fn carry(shear: &Vec3, n: &Vec3, turn: f64) -> Vec3 {
    let length = shear.norm();
    if length == 0.0 {
        return Vec3::zeros();
    }
    let turned = shear + n.cross(shear) * turn;
    let flat = turned - n * turned.dot(n);
    let flat_length = flat.norm();
    if flat_length > 0.0 {
        flat * (length / flat_length)
    } else {
        Vec3::zeros()
    }
}
