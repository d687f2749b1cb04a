//! Spheres on a surface of triangles: a contact for each foot.

use super::{
    Law, PairRates,
    law::{SphereContact, SphereLoads, book_first_half},
    rolling::Rolling,
    sides::{Ball, Body},
};
use crate::Vec3;
use crate::contact::detection::manifold::PointManifold;
use crate::contact::detection::terrain::{ONE_FOOT, SAME_FOOT};
use crate::contact::tally::Tally;
use crate::material::{RollingLaw, SphereJoint};
use crate::motion::kinematics::{Kinematics, Load};
use serde::{Deserialize, Serialize};

/// A place where a sphere touches a surface: i is the sphere, j the surface.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(crate) struct SphereOnSurface {
    pub contact: SphereContact,
    pub loads: SphereLoads,
    pub rates: PairRates,
    pub rolling: Rolling,
    is_touching: bool,
    /// From the sphere into the surface, and the overlap (m), as just found.
    found: Option<(Vec3, f64)>,
}

/// Law of a sphere on a surface, and the step.
#[derive(Clone, Copy)]
pub(crate) struct SurfaceLaw<'a> {
    pub joint: &'a SphereJoint,
    pub rolling_law: RollingLaw,
    /// s.
    pub dt: f64,
}

impl SphereOnSurface {
    /// Forgets where the feet are, not what they remember.
    pub fn forget(feet: &mut [Self]) {
        for foot in feet {
            foot.found = None;
        }
    }

    /// Notes a foot. Of several in one direction the deepest counts.
    pub fn note(feet: &mut Vec<Self>, normal: Vec3, overlap: f64) {
        let found = feet.iter_mut().find(|foot| {
            foot.found
                .is_some_and(|(known, _)| known.dot(&normal) > ONE_FOOT)
        });
        if let Some(foot) = found {
            if foot.found.is_some_and(|(_, known)| overlap > known) {
                foot.found = Some((normal, overlap));
            }
            return;
        }
        let old = feet
            .iter_mut()
            .filter(|foot| foot.found.is_none() && foot.contact.normal.dot(&normal) > SAME_FOOT)
            .max_by(|a, b| {
                let turned = |foot: &Self| foot.contact.normal.dot(&normal);
                turned(a).total_cmp(&turned(b))
            });
        match old {
            Some(foot) => foot.found = Some((normal, overlap)),
            None => feet.push(Self {
                contact: SphereContact::default(),
                loads: SphereLoads::default(),
                rates: PairRates::default(),
                rolling: Rolling::default(),
                is_touching: false,
                found: Some((normal, overlap)),
            }),
        }
    }

    pub fn is_found(&self) -> bool {
        self.found.is_some()
    }

    /// Energy of the springs of a sphere of a radius (m); J.
    pub fn energy(&self, law: &SphereJoint, radius: f64) -> f64 {
        law.energy(self.contact.overlap, radius)
            + self.contact.shear_energy()
            + self.rolling.energy()
    }

    /// Forces at the current position; books what the last `dt` (s) took.
    pub fn evaluate(
        &mut self,
        (ball, surface): (&Kinematics, &Kinematics),
        law: &SurfaceLaw,
        radius: f64,
        tally: &mut Tally,
    ) {
        let sides = (Ball(ball, radius), Body(surface));
        let SurfaceLaw {
            joint,
            rolling_law,
            dt,
        } = *law;
        if self.is_touching {
            let rolling = Some(&self.rolling);
            book_first_half(&self.contact, &self.loads, rolling, dt, &sides, tally);
        }
        let Some((normal, overlap)) = self.found else {
            if self.contact.normal_force == 0.0 {
                // No force acted any more: what the spring still held is lost.
                tally.damping += joint.energy(self.contact.overlap, radius);
            }
            return;
        };
        let law = Law {
            joint,
            effective_radius: radius,
            rolling_law,
            dt,
            is_meeting: !self.is_touching,
        };
        let middle = ball.centroid + normal * (radius - 0.5 * overlap);
        let found = PointManifold::single(normal, middle, overlap);
        let (loads, rolling) = (&mut self.loads, Some(&mut self.rolling));
        let pressed = self
            .contact
            .apply(&found, &law, &sides, loads, rolling, tally);
        let rolling = Some(&self.rolling);
        self.rates = self.contact.rates(&found, &law, &sides, &pressed, rolling);
        self.is_touching = true;
    }

    /// Force and torque on the sphere and on the surface, about their centroids.
    pub fn forces(&self, ball: &Kinematics, surface: &Kinematics) -> (Load, Load) {
        let SphereLoads { force, point } = self.loads;
        let torque = |body: &Kinematics, force: &Vec3| (point - body.centroid).cross(force);
        (
            Load {
                force: -force,
                torque: torque(ball, &-force) + self.rolling.torques.0,
            },
            Load {
                force,
                torque: torque(surface, &force) + self.rolling.torques.1,
            },
        )
    }
}
