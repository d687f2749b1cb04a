//! Joints that weaken with time.

use super::Blocks;
use crate::material::Joint;

impl Blocks {
    /// Reduces the friction (its tangent) and the cohesion of two materials to fractions of their initial values, including residual
    /// values. Bonds break and joints slip at the remaining strength. Materials are numbers in their list, in either order.
    ///
    /// ```text
    /// |τ| ≤ s_c c + s_φ tan φ σ                                          [Pa]
    /// ```
    pub fn weaken(&mut self, materials: (usize, usize), friction: f64, cohesion: f64) {
        let (i, j) = materials;
        let mut has_changed = false;
        for k in [
            i * self.constants.n_materials + j,
            j * self.constants.n_materials + i,
        ] {
            let Joint {
                friction: tangent,
                residual_friction,
                cohesion: bond,
                residual_cohesion,
                spheres,
                ..
            } = self.constants.initial_joints[k];
            let joint = &mut self.state.joints[k];
            let before = *joint;
            joint.friction = friction * tangent;
            joint.residual_friction = friction * residual_friction;
            joint.cohesion = cohesion * bond;
            joint.residual_cohesion = cohesion * residual_cohesion;
            joint.spheres.static_friction = friction * spheres.static_friction;
            joint.spheres.dynamic_friction = friction * spheres.dynamic_friction;
            has_changed |= *joint != before;
        }
        if has_changed {
            self.wake_all();
        }
    }
}
