//! Results and memory of the law, one of each for a pair.

use super::PointForce;
use super::work::Losses;
use crate::Vec3;
use crate::contact::detection::manifold::ManifoldPoint;
use crate::contact::report::PointState;
use crate::motion::kinematics::Load;
use serde::{Deserialize, Serialize};

/// Loads of a pair on its blocks, and its account of the last step.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
pub(crate) struct PairLoads {
    /// On the blocks i and j, torque about their centroids.
    pub on_blocks: (Load, Load),
    pub losses: Losses,
    /// See [`Tally::rolling_impulse`](crate::contact::tally::Tally::rolling_impulse); N m s.
    pub rolling_impulse: Vec3,
    /// Deepest overlap; m.
    pub deepest: f64,
    /// Did the bond break in the last evaluation?
    pub has_broken: bool,
    /// Normal dashpot per unit of weight and shear dashpot of the whole; N s/m.
    pub dashpots: (f64, f64),
    /// Corrections to the next half kick, on j; empty between two steps, see `impact`.
    #[serde(skip)]
    pub half_kick_corrections: Vec<PointForce>,
}

impl PairLoads {
    /// Forgets the last step.
    pub fn clear(&mut self) {
        let mut half_kick_corrections = std::mem::take(&mut self.half_kick_corrections);
        half_kick_corrections.clear();
        *self = Self {
            half_kick_corrections,
            ..Self::default()
        };
    }

    /// Adds the forces of a point of unit normal, from i to j, on blocks of two centroids (m).
    pub fn add(&mut self, point: &PointState, normal: &Vec3, centroids: (&Vec3, &Vec3)) {
        let force = normal * point.normal_force + point.shear_force;
        let x = &point.at.position;
        self.on_blocks.0.add(&-force, &(x - centroids.0));
        self.on_blocks.1.add(&force, &(x - centroids.1));
    }
}

impl PointState {
    /// Point on which no force acts yet.
    pub fn free(at: ManifoldPoint) -> Self {
        Self {
            at,
            normal_force: 0.0,
            normal_viscous: 0.0,
            shear_force: Vec3::zeros(),
            shear_viscous: Vec3::zeros(),
            state: crate::ContactState::Open,
        }
    }
}
