//! Removal of the overlap that a step leaves, as a displacement:
//!
//! ```text
//! z ≥ 0,   W_n z ≥ 0.2 max(0, −gap − tol),  at right angles;   q += M⁻¹ H_nᵀ z                          tol = 1e-4 L
//! ```
//! Joints stay as they are in it; blocks that deform keep their strain. It gives no velocity. What it gives in height, and in energy of rotation, has a place of its own in the account.

use super::touches::Touch;
use crate::Blocks;
use crate::Vec3;
use crate::blocks::Update;
use crate::contact::dynamics::accuracy::Scaling;
use crate::contact::dynamics::bilateral::Bilateral;
use crate::contact::dynamics::delassus::{BodyContacts, Delassus};
use crate::contact::dynamics::gauss_seidel::{GaussSeidel, Order, Until};
use crate::contact::dynamics::{ContactProblem, Rolling};
use nalgebra::UnitQuaternion;

/// Share of the overlap that a step removes.
const SHARE: f64 = 0.2;
/// Overlap that stays, × size of the smaller part.
const LEFT: f64 = 1e-4;
const UNTIL: Until = Until {
    tolerance: 1e-2,
    scaling: Scaling::ContactMass,
    n_iterations: 10,
};

impl Blocks {
    /// After the kick of `problem` at these points.
    pub(super) fn remove_overlap(
        &mut self,
        problem: &ContactProblem<BodyContacts>,
        touches: &[Touch],
    ) {
        let limits = self.constants.overlap_limits();
        let room = |touch: &Touch| touch.gap + LEFT * limits.size_of(touch.parts);
        if touches.iter().all(|touch| 0.0 <= room(touch)) {
            return;
        }
        let way = |touch: &Touch| Vec3::x() * (SHARE * room(touch)).min(touch.gap.max(0.0));
        // rolling resistance takes no part; bonds and joints move their blocks together
        let slack = |rolling: &Rolling| Rolling {
            coefficient: 0.0,
            ..*rolling
        };
        let mut ways: Vec<Vec3> = touches.iter().map(way).collect();
        ways.resize(problem.len(), Vec3::zeros());
        let displacements = ContactProblem {
            operator: problem.operator.clone(),
            free_velocity: ways,
            friction: vec![0.0; touches.len()],
            rolling: problem.rolling.iter().map(slack).collect(),
            joints: (problem.joints.iter())
                .map(Bilateral::of_displacements)
                .collect(),
        };
        let mut pushes = vec![Vec3::zeros(); problem.len()];
        GaussSeidel::new(&displacements.operator, Order::Shuffled).solve(
            &displacements,
            &mut pushes,
            UNTIL,
        );
        let moved = displacements.operator.product(&pushes);
        let mut given = 0.0;
        for (b, [way, turn]) in moved.rigid.into_iter().enumerate() {
            let strains = self.is_driven(b) && self.is_deformable(b) && self.hold_of(b).is_none();
            if self.derived.update[b] != Update::Rigid && !strains {
                continue;
            }
            let before = self.kinetic_energy(b);
            let spatial = self.state.attitude[b] * self.state.angular_momentum[b];
            let turn = UnitQuaternion::from_scaled_axis(turn);
            self.state.centroid[b] += way;
            if strains {
                self.turn_straining(b, &turn);
            } else {
                self.state.attitude[b] = turn * self.state.attitude[b];
                self.state.angular_momentum[b] =
                    self.state.attitude[b].inverse_transform_vector(&spatial);
            }
            let weight = self.constants.settings.gravity * self.constants.mass[b];
            given += self.kinetic_energy(b) - before - weight.dot(&way);
        }
        self.state.totals.overlap_removal.book(given);
    }
}
