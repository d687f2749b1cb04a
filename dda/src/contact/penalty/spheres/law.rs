//! The law of a touching pair: normal and shear spring with their dashpots, what they hold and what they take.

use super::{Law, PairRates, Scales, rolling::Rolling, sides::Side};
use crate::Vec3;
use crate::contact::detection::manifold::PointManifold;
use crate::contact::penalty::friction::carry;
use crate::contact::penalty::normal::dashpot_share;
use crate::contact::rates::Rates;
use crate::contact::report::ContactState;
use crate::contact::tally::Tally;
use crate::material::SphereJoint;
use serde::{Deserialize, Serialize};

/// Memory of a touching pair.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct SphereContact {
    /// Unit, from i to j.
    pub normal: Vec3,
    /// `ξ`; m.
    pub shear: Vec3,
    /// `δ`; m.
    pub overlap: f64,
    /// With its viscous part; N.
    pub normal_force: f64,
    pub normal_viscous: f64,
    /// `k_t`; N/m.
    pub shear_stiffness: f64,
    /// `1/m̃` (1/kg), normal and shear dashpot (N s/m) of the last evaluation: the same again for two spheres.
    mobility: f64,
    viscosity: f64,
    dashpot: f64,
    pub(super) scales: Scales,
    pub is_slipping: bool,
}

impl SphereContact {
    /// Of a pair that does not touch.
    pub fn apart(scales: Scales) -> Self {
        Self {
            scales,
            ..Self::default()
        }
    }

    /// Energy of the springs of a pair that touches; J.
    pub fn energy(&self, law: &SphereJoint, rolling: Option<&Rolling>) -> f64 {
        law.energy(self.overlap, self.scales.effective_radius)
            + self.shear_energy()
            + rolling.map_or(0.0, Rolling::energy)
    }

    pub(super) fn shear_energy(&self) -> f64 {
        0.5 * self.shear_stiffness * self.shear.norm_squared()
    }

    /// Normal stiffness at the present overlap; N/m.
    pub fn tangent(&self, law: &SphereJoint) -> f64 {
        law.normal(self.overlap, self.scales.effective_radius)
            .tangent
    }

    /// Normal and shear dashpot; N s/m.
    pub fn dashpots(&self) -> (f64, f64) {
        (self.viscosity, self.dashpot)
    }

    pub fn state(&self) -> ContactState {
        match (self.normal_force > 0.0, self.is_slipping) {
            (false, _) => ContactState::Open,
            (true, true) => ContactState::Slide,
            (true, false) => ContactState::Stick,
        }
    }
}

/// Loads of a pair on its blocks; stored apart from the pairs, since each block reads those of all its pairs.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub(crate) struct SphereLoads {
    /// On j; N. Zero when apart.
    pub force: Vec3,
    /// Point of application; world; m.
    pub point: Vec3,
}

/// Work of the forces in the first half of the step, and what the springs across the normal held.
#[inline]
pub(super) fn book_first_half<A: Side, B: Side>(
    contact: &SphereContact,
    loads: &SphereLoads,
    rolling: Option<&Rolling>,
    dt: f64,
    sides: &(A, B),
    tally: &mut Tally,
) {
    let x = &loads.point;
    let rate = sides.1.velocity_from(x, dt) - sides.0.velocity_from(x, dt);
    let along = contact.normal.dot(&rate);
    let shear = loads.force.dot(&rate) - contact.normal_force * along;
    tally.damping -= 0.5 * dt * contact.normal_viscous * along;
    tally.friction += contact.shear_energy() - 0.5 * dt * shear;
    if let Some(rolling) = rolling {
        tally.friction += rolling.energy();
        rolling.book_half(dt, sides, tally);
    }
}

/// Quantities of a just evaluated contact for the step bound.
pub(super) struct Pressed {
    /// m/s.
    opening: f64,
    /// Normal; N/m.
    tangent: f64,
    /// Of the rolling dashpots of both sides; N m s.
    rolling_dashpots: (f64, f64),
}

impl SphereContact {
    /// The law, in the place just found:
    ///
    /// 1. springs and dashpots of the present overlap;
    /// 2. normal force, never a pull;
    /// 3. shear spring, up to Coulomb's limit;
    /// 4. work of the second half of the step;
    /// 5. rolling resistance.
    #[inline]
    pub(super) fn apply<A: Side, B: Side>(
        &mut self,
        found: &PointManifold,
        law: &Law,
        sides: &(A, B),
        loads: &mut SphereLoads,
        rolling: Option<&mut Rolling>,
        tally: &mut Tally,
    ) -> Pressed {
        let Law { joint, dt, .. } = *law;
        let (n, x) = (found.normal, found.position());
        let rate = sides.1.velocity_at(x) - sides.0.velocity_at(x);
        let opening = n.dot(&rate);
        let slip = rate - n * opening;
        let mobility = sides.0.compliance(x, &n) + sides.1.compliance(x, &n);
        let spring = joint.normal(found.depth, law.effective_radius);
        let shear_stiffness = joint.shear_ratio * spring.tangent;
        if !(mobility == self.mobility && joint.is_linear()) {
            self.mobility = mobility;
            self.viscosity = joint.viscosity(found.depth, law.effective_radius, 1.0 / mobility);
            self.dashpot = 2.0 * joint.shear_damping_ratio * (shear_stiffness / mobility).sqrt();
        }
        let share = if joint.is_linear() {
            let meeting = law.is_meeting.then_some((found.depth, -opening));
            dashpot_share(self.viscosity * mobility, dt, meeting)
        } else {
            // Hertz's dashpot starts from nothing, as its spring does.
            1.0
        };
        self.normal = n;
        self.overlap = found.depth;
        self.normal_force = f64::max(spring.force - share * self.viscosity * opening, 0.0);
        self.normal_viscous = self.normal_force - spring.force;
        let (a, b) = (sides.0.kinematics(), sides.1.kinematics());
        let turn = 0.5 * (a.spin + b.spin).dot(&n) * dt;
        let shear = self.slide(law, &n, (&slip, turn), shear_stiffness);
        tally.damping -= 0.5 * dt * self.normal_viscous * opening;
        tally.friction -= 0.5 * dt * shear.dot(&slip) + self.shear_energy();
        *loads = SphereLoads {
            force: n * self.normal_force + shear,
            point: *x,
        };
        let mut rolling_dashpots = (0.0, 0.0);
        if let Some(rolling) = rolling
            && joint.rolling_friction > 0.0
        {
            let limit = joint.rolling_friction * law.effective_radius * spring.force;
            rolling_dashpots = rolling.apply(law, found, spring.tangent, sides, limit);
            tally.friction -= rolling.energy();
            rolling.book_half(dt, sides, tally);
        }
        Pressed {
            opening,
            tangent: spring.tangent,
            rolling_dashpots,
        }
    }

    /// Advances the shear spring by a slip (m/s), turned with the pair about the normal (rad), under the present normal
    /// force; returns the shear force on j; N.
    #[inline(always)]
    fn slide(
        &mut self,
        law: &Law,
        normal: &Vec3,
        (slip, turn): (&Vec3, f64),
        stiffness: f64,
    ) -> Vec3 {
        let joint = law.joint;
        // A spring that has stiffened keeps its force, one that has softened its stretch: no energy is made.
        let kept = if stiffness > self.shear_stiffness {
            self.shear_stiffness / stiffness
        } else {
            1.0
        };
        let mut stretch = carry(&self.shear, normal, turn) * kept + slip * law.dt;
        let mut shear = -stretch * stiffness - slip * self.dashpot;
        let friction = if self.is_slipping {
            joint.dynamic_friction
        } else {
            joint.static_friction
        };
        self.is_slipping = shear.norm_squared() > (friction * self.normal_force).powi(2);
        if self.is_slipping {
            shear *= joint.dynamic_friction * self.normal_force / shear.norm();
            stretch = if stiffness > 0.0 {
                shear * (-1.0 / stiffness)
            } else {
                Vec3::zeros()
            };
        }
        self.shear = stretch;
        self.shear_stiffness = stiffness;
        shear
    }

    /// Contribution of the just evaluated contact to the step bound.
    pub(super) fn rates<A: Side, B: Side>(
        &self,
        found: &PointManifold,
        law: &Law,
        sides: &(A, B),
        pressed: &Pressed,
        rolling: Option<&Rolling>,
    ) -> PairRates {
        // Hertz's spring stiffens: what it may become counts.
        let bound = law.joint.tangent_bound(
            found.depth,
            law.effective_radius,
            pressed.opening,
            self.mobility,
        );
        let stiffening = if bound > pressed.tangent {
            bound / pressed.tangent.max(f64::MIN_POSITIVE)
        } else {
            1.0
        };
        let stiffness = pressed.tangent * stiffening;
        let across = self.shear_stiffness * stiffening;
        let turning_stiffness = rolling.map_or(0.0, |rolling| rolling.stiffness * stiffening);
        let turning = |dashpot: f64, trace: f64| Rates {
            stiffness: turning_stiffness * trace,
            damping: dashpot * trace,
        };
        let of = |along: f64, trace: f64, turning: Rates, twice: f64| {
            let rest = trace - along;
            Rates {
                stiffness: twice * (stiffness * along + across * rest + turning.stiffness),
                damping: twice * (self.viscosity * along + self.dashpot * rest + turning.damping),
            }
        };
        let (first, second) = sides;
        let (n, x) = (&found.normal, found.position());
        let dashpots = pressed.rolling_dashpots;
        (
            of(
                first.compliance(x, n),
                first.compliance_trace(x),
                turning(dashpots.0, first.turning_trace()),
                second.twice(),
            ),
            of(
                second.compliance(x, n),
                second.compliance_trace(x),
                turning(dashpots.1, second.turning_trace()),
                first.twice(),
            ),
        )
    }
}
