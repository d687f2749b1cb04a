//! Contact of balls, with each other and with polyhedra: one point, linear or Hertz's spring, shear
//! spring with history, rolling resistance.
//!
//! ```text
//! linear   F_n = k δ − 2 ξ √(k m̃) u_n ≥ 0
//! Hertz    F_n = K δ^3/2 − β √(m̃ K) δ^1/4 u_n ≥ 0,    K = 4/3 E* √R̃                                [N]
//! shear    F_t = −k_t ξ − 2 ξ_t √(k_t m̃) u_t,   |F_t| ≤ μ_s F_n, once it slips μ_d F_n, until it holds again
//! rolling  M = −k_r θ − c_r ω_r,   k_r = 9/4 k_n μ_r² R̃²,   |M| ≤ μ_r R̃ F_n,el                      [N m]
//! ```
//! `1/m̃` is the sum of both sides' compliances along the normal, `R̃ = r_i r_j/(r_i + r_j)`, or `r` against
//! a polyhedron; ξ and β are those that give the restitution with a force that never pulls (Schwager &
//! Pöschel 2007). Sources: Cundall & Strack (1979), Tsuji, Tanaka & Ishida (1992), Luding (2008); rolling:
//! Ai, Chen, Rotter & Ooi (2011), whose spring lets a ball come to rest. What `ω_r` and `θ`, its integral, turn
//! against: see [`RollingLaw`].
//!
//! The force acts in the middle of the overlap, so that angular momentum is kept, but for
//! [`RollingLaw::OwnSpin`], whose sink is booked.

use crate::{
    SurfacePoint, Vec3,
    contact::{ContactState, Medium, Rates, dashpot_share},
    forces::Tally,
    friction::carry,
    kinematics::{Kinematics, Load},
    material::{RollingLaw, SphereJoint},
    parts::Part,
};

/// Two parts that may touch, a ball at least one of them: what is read of a pair that stays apart, as half of
/// them do. The rest lies in columns of its own, which only those that touch bring into the caches.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SpherePair {
    pub parts: (u32, u32),
    pub blocks: (u32, u32),
}

/// Where a pair stands.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SphereMark {
    pub is_touching: bool,
    /// Are its rates others than after the last evaluation?
    pub has_new_rates: bool,
    /// Was it ever looked at?
    is_known: bool,
}

/// One row of all columns of a pair.
pub(crate) struct SphereRow<'a> {
    pub pair: &'a SpherePair,
    pub mark: &'a mut SphereMark,
    pub contact: &'a mut SphereContact,
    pub loads: &'a mut SphereLoads,
    pub rates: &'a mut PairRates,
    /// Only where a joint resists rolling.
    pub rolling: Option<&'a mut Rolling>,
}

/// What a pair adds to the step bound of each of its blocks.
pub(crate) type PairRates = (Rates, Rates);

/// Lengths of a pair; m.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Scales {
    /// `R̃`.
    pub effective_radius: f64,
    /// One over the deepest overlap allowed, and over the size of the smaller part; 1/m.
    per_allowed: f64,
    per_size: f64,
}

impl Scales {
    /// Of two parts, a ball at least one of them; the lesser of what is allowed and of their sizes.
    pub fn of(parts: (&Part, &Part), allowed_overlap: f64, size: f64) -> Self {
        let radius = |part: &Part| match part {
            Part::Sphere { radius, .. } => *radius,
            Part::Polyhedron(_) | Part::Surface(_) => f64::INFINITY,
        };
        // 1/R̃ = 1/r_i + 1/r_j, a polyhedron being flat.
        let curvature = 1.0 / radius(parts.0) + 1.0 / radius(parts.1);
        Self {
            effective_radius: 1.0 / curvature,
            per_allowed: 1.0 / allowed_overlap,
            per_size: 1.0 / size,
        }
    }
}

/// Memory of a touching pair.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
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
    /// `1/m̃` (1/kg), normal and shear dashpot (N s/m) of the last evaluation: the same again for two balls.
    mobility: f64,
    viscosity: f64,
    dashpot: f64,
    scales: Scales,
    pub is_slipping: bool,
}

/// What a pair does to its blocks; beside the pairs, because each block reads it of all its own.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct SphereLoads {
    /// On j; N. Zero when apart.
    pub force: Vec3,
    /// Where it acts; world; m.
    pub point: Vec3,
}

/// Memory of the rolling spring of a touching pair; only where a material resists rolling.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Rolling {
    /// `θ`, of i and of j on their own, or of j against i and nothing; rad.
    pub angles: (Vec3, Vec3),
    /// On i and j; N m.
    pub torques: (Vec3, Vec3),
    /// `k_r`; N m.
    pub stiffness: f64,
}

impl Rolling {
    pub fn energy(&self) -> f64 {
        0.5 * self.stiffness * (self.angles.0.norm_squared() + self.angles.1.norm_squared())
    }

    pub fn for_each_state_f64(&self, f: &mut dyn FnMut(f64)) {
        for v in [
            &self.angles.0,
            &self.angles.1,
            &self.torques.0,
            &self.torques.1,
        ] {
            v.iter().for_each(|&c| f(c));
        }
    }

    /// Books half a step (s) of the torques.
    fn book_half<A: Side, B: Side>(&self, dt: f64, sides: &(A, B), tally: &mut Tally) {
        let (a, b) = (sides.0.kinematics(), sides.1.kinematics());
        let power = self.torques.0.dot(&a.spin) + self.torques.1.dot(&b.spin);
        tally.friction -= 0.5 * dt * power;
        tally.rolling_impulse += (self.torques.0 + self.torques.1) * (0.5 * dt);
    }
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

    fn shear_energy(&self) -> f64 {
        0.5 * self.shear_stiffness * self.shear.norm_squared()
    }

    pub fn state(&self) -> ContactState {
        match (self.normal_force > 0.0, self.is_slipping) {
            (false, _) => ContactState::Open,
            (true, true) => ContactState::Slide,
            (true, false) => ContactState::Stick,
        }
    }
}

/// One side of a contact. A ball answers without its inertia tensor.
trait Side {
    fn kinematics(&self) -> &Kinematics;
    /// m/s.
    fn velocity_at(&self, x: &Vec3) -> Vec3;
    /// See [`Kinematics::compliance`]; 1/kg.
    fn compliance(&self, x: &Vec3, n: &Vec3) -> f64;
    /// See [`Kinematics::compliance_trace`], of a ball what no overlap exceeds; 1/kg.
    fn compliance_trace(&self, x: &Vec3) -> f64;
    /// `tr J⁻¹`; 1/(kg m²).
    fn turning_trace(&self) -> f64;
    /// What [`RollingLaw::OwnSpin`] opposes, nothing but of balls; rad/s.
    fn own_spin(&self) -> Vec3;

    /// Velocity of the material that was at `x` before the drift of the last `dt` (s); m/s.
    fn velocity_from(&self, x: &Vec3, dt: f64) -> Vec3 {
        self.velocity_at(&(x + self.kinematics().velocity * dt))
    }

    /// Do its compliances stay what they are?
    fn has_steady_rates(&self) -> bool {
        self.kinematics().inverse_mass == 0.0
    }

    /// Twice as much for the other side if this one gives way.
    fn twice(&self) -> f64 {
        if self.kinematics().inverse_mass > 0.0 {
            2.0
        } else {
            1.0
        }
    }
}

/// A ball and its radius (m).
struct Ball<'a>(&'a Kinematics, f64);

impl Side for Ball<'_> {
    fn kinematics(&self) -> &Kinematics {
        self.0
    }

    fn velocity_at(&self, x: &Vec3) -> Vec3 {
        self.0.velocity + self.0.spin.cross(&(x - self.0.centroid))
    }

    fn compliance(&self, _: &Vec3, _: &Vec3) -> f64 {
        self.0.inverse_mass
    }

    /// The arm is the radius less half the overlap. With the radius itself the bound stays the same for as long
    /// as two balls touch, and need not be summed again in every step.
    fn compliance_trace(&self, _: &Vec3) -> f64 {
        3.0 * self.0.inverse_mass + 2.0 * self.0.inverse_inertia.m11 * (self.1 * self.1)
    }

    fn turning_trace(&self) -> f64 {
        3.0 * self.0.inverse_inertia.m11
    }

    fn own_spin(&self) -> Vec3 {
        self.0.spin
    }

    fn has_steady_rates(&self) -> bool {
        true
    }
}

struct Body<'a>(&'a Kinematics);

impl Side for Body<'_> {
    fn kinematics(&self) -> &Kinematics {
        self.0
    }

    fn velocity_at(&self, x: &Vec3) -> Vec3 {
        self.0.velocity_at(x)
    }

    fn compliance(&self, x: &Vec3, n: &Vec3) -> f64 {
        self.0.compliance(x, n)
    }

    fn compliance_trace(&self, x: &Vec3) -> f64 {
        self.0.compliance_trace(x)
    }

    fn turning_trace(&self) -> f64 {
        self.0.inverse_inertia.trace()
    }

    fn own_spin(&self) -> Vec3 {
        Vec3::zeros()
    }
}

/// Where a ball and another part touch.
struct Touch {
    normal: Vec3,
    point: Vec3,
    overlap: f64,
}

impl Touch {
    /// Of balls of centre and radius.
    fn of_balls((a, r): (&Vec3, f64), (b, s): (&Vec3, f64)) -> Option<Self> {
        let offset = b - a;
        let square = offset.norm_squared();
        if square >= (r + s) * (r + s) {
            return None;
        }
        let distance = square.sqrt();
        let normal = if distance > 0.0 {
            offset * (1.0 / distance)
        } else {
            Vec3::z()
        };
        let overlap = r + s - distance;
        Some(Self {
            normal,
            point: a + normal * (r - 0.5 * overlap),
            overlap,
        })
    }

    fn on_surface(surface: &SurfacePoint, normal: Vec3, radius: f64) -> Self {
        let overlap = radius - surface.distance;
        Self {
            normal,
            point: surface.point - surface.normal * (0.5 * overlap),
            overlap,
        }
    }
}

/// The law of a pair, and the step.
struct Law<'a> {
    joint: &'a SphereJoint,
    effective_radius: f64,
    rolling_law: RollingLaw,
    shear_damping_ratio: f64,
    dt: f64,
    /// Do the bodies meet in this step?
    is_meeting: bool,
}

impl SphereRow<'_> {
    /// Finds the contact in the present place and its force at the present velocities; books what was
    /// lost during the last `dt` (s).
    pub fn evaluate(self, medium: &Medium, dt: f64, tally: &mut Tally) {
        let parts = self.pair.parts;
        let (first, second) = (
            &medium.parts[parts.0 as usize],
            &medium.parts[parts.1 as usize],
        );
        let (a, b) = (
            &medium.kinematics[self.pair.blocks.0 as usize],
            &medium.kinematics[self.pair.blocks.1 as usize],
        );
        match (first, second) {
            (
                Part::Sphere {
                    center: x,
                    radius: r,
                },
                Part::Sphere {
                    center: y,
                    radius: s,
                },
            ) => {
                let found = Touch::of_balls((x, *r), (y, *s));
                self.update(found, &(Ball(a, *r), Ball(b, *s)), medium, dt, tally);
            }
            (Part::Sphere { center, radius }, Part::Polyhedron(body)) => {
                let surface = body.touch_point_within(center, *radius);
                let found = surface.map(|at| Touch::on_surface(&at, -at.normal, *radius));
                self.update(found, &(Ball(a, *radius), Body(b)), medium, dt, tally);
            }
            (Part::Polyhedron(body), Part::Sphere { center, radius }) => {
                let surface = body.touch_point_within(center, *radius);
                let found = surface.map(|at| Touch::on_surface(&at, at.normal, *radius));
                self.update(found, &(Body(a), Ball(b, *radius)), medium, dt, tally);
            }
            _ => {}
        }
    }

    fn update<A: Side, B: Side>(
        mut self,
        found: Option<Touch>,
        sides: &(A, B),
        medium: &Medium,
        dt: f64,
        tally: &mut Tally,
    ) {
        let was_touching = self.mark.is_touching;
        self.mark.has_new_rates = false;
        if found.is_none() && !was_touching && self.mark.is_known && !medium.is_hertz {
            return;
        }
        let joint = &medium.joint_of(self.pair.parts).spheres;
        let scales = self.contact.scales;
        let law = Law {
            joint,
            effective_radius: scales.effective_radius,
            rolling_law: medium.rolling_law,
            shear_damping_ratio: medium.shear_damping_ratio,
            dt,
            is_meeting: !was_touching,
        };
        if was_touching {
            let rolling = self.rolling.as_deref();
            book_first_half(self.contact, self.loads, rolling, dt, sides, tally);
        }
        self.mark.is_known = true;
        self.mark.is_touching = found.is_some();
        let Some(found) = found else {
            if was_touching && self.contact.normal_force == 0.0 {
                // No force acted any more: what the spring still held is lost.
                tally.damping += joint.energy(self.contact.overlap, law.effective_radius);
            }
            // What shear and rolling springs held was booked with the first half.
            *self.contact = SphereContact::apart(scales);
            *self.loads = SphereLoads::default();
            *self.rates = self.pair.rates_before_touch(&law, sides, medium);
            self.mark.has_new_rates = true;
            if let Some(rolling) = self.rolling {
                *rolling = Rolling::default();
            }
            return;
        };
        tally.note_overlap(
            self.pair.parts,
            found.overlap * scales.per_allowed,
            found.overlap * scales.per_size,
        );
        let rolling = self.rolling.as_deref_mut();
        let pressed = self
            .contact
            .apply(&found, &law, sides, self.loads, rolling, tally);
        let is_steady = was_touching
            && joint.is_linear()
            && joint.rolling_friction == 0.0
            && sides.0.has_steady_rates()
            && sides.1.has_steady_rates();
        if !is_steady {
            *self.rates =
                self.contact
                    .rates(&found, &law, sides, &pressed, self.rolling.as_deref());
            self.mark.has_new_rates = true;
        }
    }
}

impl SpherePair {
    /// Rates of a pair that may touch in the next step.
    fn rates_before_touch<A: Side, B: Side>(
        &self,
        law: &Law,
        sides: &(A, B),
        medium: &Medium,
    ) -> (Rates, Rates) {
        let (a, b) = (sides.0.kinematics(), sides.1.kinematics());
        let joint = law.joint;
        let mobility = a.inverse_mass + b.inverse_mass;
        let approach = (b.velocity - a.velocity).norm();
        let stiffness = joint.tangent_bound(0.0, law.effective_radius, approach, mobility);
        let dashpot = |ratio: f64, k: f64| 2.0 * ratio * (k / mobility).sqrt();
        let viscosity = joint.damping_ratio_bound();
        let shear = joint.shear_ratio * stiffness;
        let of = |body: &Kinematics, twice: f64, block: u32| {
            let (along, sum) = body.worst_compliance(medium.radius[block as usize]);
            let across = sum - along;
            Rates {
                stiffness: twice * (stiffness * along + shear * across),
                damping: twice
                    * (dashpot(viscosity, stiffness) * along
                        + dashpot(law.shear_damping_ratio, shear) * across),
            }
        };
        (
            of(a, sides.1.twice(), self.blocks.0),
            of(b, sides.0.twice(), self.blocks.1),
        )
    }
}

/// Work of the forces in the first half of the step, and what the springs across the normal held.
fn book_first_half<A: Side, B: Side>(
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

/// What the step bound asks of a contact just evaluated.
struct Pressed {
    /// m/s.
    opening: f64,
    /// Normal; N/m.
    tangent: f64,
    /// Of the rolling dashpots of both sides; N m s.
    rolling_dashpots: (f64, f64),
}

impl SphereContact {
    /// The law, in the place just found.
    fn apply<A: Side, B: Side>(
        &mut self,
        found: &Touch,
        law: &Law,
        sides: &(A, B),
        loads: &mut SphereLoads,
        rolling: Option<&mut Rolling>,
        tally: &mut Tally,
    ) -> Pressed {
        let Law {
            joint,
            effective_radius,
            rolling_law: _,
            shear_damping_ratio,
            dt,
            is_meeting,
        } = *law;
        let (a, b) = (sides.0.kinematics(), sides.1.kinematics());
        let (n, x) = (found.normal, &found.point);
        let rate = sides.1.velocity_at(x) - sides.0.velocity_at(x);
        let opening = n.dot(&rate);
        let slip = rate - n * opening;
        let mobility = sides.0.compliance(x, &n) + sides.1.compliance(x, &n);
        let spring = joint.normal(found.overlap, effective_radius);
        let shear_stiffness = joint.shear_ratio * spring.tangent;
        if !(mobility == self.mobility && joint.is_linear()) {
            self.mobility = mobility;
            self.viscosity = joint.viscosity(found.overlap, effective_radius, 1.0 / mobility);
            self.dashpot = 2.0 * shear_damping_ratio * (shear_stiffness / mobility).sqrt();
        }
        let share = if joint.is_linear() {
            let meeting = is_meeting.then_some((found.overlap, -opening));
            dashpot_share(self.viscosity * mobility, dt, meeting)
        } else {
            // Hertz's dashpot starts from nothing, as its spring does.
            1.0
        };
        let normal_force = f64::max(spring.force - share * self.viscosity * opening, 0.0);

        // A spring that has stiffened keeps its force, one that has softened its stretch: no energy is made.
        let kept = if shear_stiffness > self.shear_stiffness {
            self.shear_stiffness / shear_stiffness
        } else {
            1.0
        };
        let turn = 0.5 * (a.spin + b.spin).dot(&n) * dt;
        let mut stretch = carry(&self.shear, &n, turn) * kept + slip * dt;
        let mut shear = -stretch * shear_stiffness - slip * self.dashpot;
        let friction = if self.is_slipping {
            joint.dynamic_friction
        } else {
            joint.static_friction
        };
        self.is_slipping = shear.norm_squared() > (friction * normal_force).powi(2);
        if self.is_slipping {
            shear *= joint.dynamic_friction * normal_force / shear.norm();
            stretch = if shear_stiffness > 0.0 {
                shear * (-1.0 / shear_stiffness)
            } else {
                Vec3::zeros()
            };
        }
        self.normal = n;
        self.shear = stretch;
        self.overlap = found.overlap;
        self.normal_force = normal_force;
        self.normal_viscous = normal_force - spring.force;
        self.shear_stiffness = shear_stiffness;
        tally.damping -= 0.5 * dt * self.normal_viscous * opening;
        tally.friction -= 0.5 * dt * shear.dot(&slip) + self.shear_energy();
        *loads = SphereLoads {
            force: n * normal_force + shear,
            point: *x,
        };
        let mut rolling_dashpots = (0.0, 0.0);
        if let Some(rolling) = rolling
            && joint.rolling_friction > 0.0
        {
            let limit = joint.rolling_friction * effective_radius * spring.force;
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

    /// What the contact just evaluated adds to the step bound.
    fn rates<A: Side, B: Side>(
        &self,
        found: &Touch,
        law: &Law,
        sides: &(A, B),
        pressed: &Pressed,
        rolling: Option<&Rolling>,
    ) -> PairRates {
        // Hertz's spring stiffens: what it may become counts.
        let bound = law.joint.tangent_bound(
            found.overlap,
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
        let (n, x) = (&found.normal, &found.point);
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

/// Damping ratio of the rolling dashpot while its spring holds; –.
const ROLLING_DAMPING_RATIO: f64 = 0.3;

impl Rolling {
    /// Advances the springs by the turning of a step and finds the torques, each at most `limit` (N m). Returns
    /// the dashpot of each side; N m s.
    fn apply<A: Side, B: Side>(
        &mut self,
        law: &Law,
        found: &Touch,
        normal_stiffness: f64,
        sides: &(A, B),
        limit: f64,
    ) -> (f64, f64) {
        let n = found.normal;
        let (a, b) = (sides.0.kinematics(), sides.1.kinematics());
        let arm = law.joint.rolling_friction * law.effective_radius;
        let stiffness = 2.25 * normal_stiffness * arm * arm;
        let kept = if stiffness > self.stiffness {
            self.stiffness / stiffness
        } else {
            1.0
        };
        self.stiffness = stiffness;
        let damping = |mobility: f64| 2.0 * ROLLING_DAMPING_RATIO * (stiffness / mobility).sqrt();
        let spring = |angle: Vec3, rate: Vec3, dashpot: f64| {
            let torque = -angle * stiffness - rate * dashpot;
            let size = torque.norm();
            if size > limit {
                let torque = torque * (limit / size);
                (torque * (-1.0 / stiffness), torque)
            } else {
                (angle, torque)
            }
        };
        // Mean over the axes: exact for balls.
        let mobilities = (sides.0.turning_trace() / 3.0, sides.1.turning_trace() / 3.0);
        match law.rolling_law {
            RollingLaw::Relative => {
                let turning = b.spin - a.spin;
                let rolling = turning - n * turning.dot(&n);
                let spin = 0.5 * (a.spin + b.spin).dot(&n) * law.dt;
                let angle = carry(&self.angles.0, &n, spin) * kept + rolling * law.dt;
                let dashpot = damping(mobilities.0 + mobilities.1);
                let (angle, torque) = spring(angle, rolling, dashpot);
                self.angles.0 = angle;
                self.torques = (-torque, torque);
                (dashpot, dashpot)
            }
            RollingLaw::OwnSpin => {
                let own = |angle: Vec3, rate: Vec3, mobility: f64| {
                    // What cannot turn needs no dashpot.
                    let dashpot = if mobility > 0.0 {
                        damping(mobility)
                    } else {
                        0.0
                    };
                    (spring(angle * kept + rate * law.dt, rate, dashpot), dashpot)
                };
                let first = own(self.angles.0, sides.0.own_spin(), mobilities.0);
                let second = own(self.angles.1, sides.1.own_spin(), mobilities.1);
                self.angles = (first.0.0, second.0.0);
                self.torques = (first.0.1, second.0.1);
                (first.1, second.1)
            }
        }
    }
}

/// A place where a ball touches a surface: i is the ball, j the surface.
#[derive(Clone, Debug)]
pub(crate) struct BallOnSurface {
    pub contact: SphereContact,
    pub loads: SphereLoads,
    pub rates: PairRates,
    pub rolling: Rolling,
    is_touching: bool,
    /// From the ball into the surface, and the overlap (m), as just found.
    found: Option<(Vec3, f64)>,
}

/// Feet whose normals turn by less are one; cos 5°.
const ONE_FOOT: f64 = 0.996_195;
/// A foot goes on from one of the last step if its normal turned by less; cos 45°.
const SAME_FOOT: f64 = 0.707;

impl BallOnSurface {
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

    /// Energy of the springs of a ball of a radius (m); J.
    pub fn energy(&self, law: &SphereJoint, radius: f64) -> f64 {
        law.energy(self.contact.overlap, radius)
            + self.contact.shear_energy()
            + self.rolling.energy()
    }

    /// Forces in the present place; books what the last `dt` (s) took.
    pub fn evaluate(
        &mut self,
        (ball, surface): (&Kinematics, &Kinematics),
        (joint, rolling_law, shear_damping_ratio): (&SphereJoint, RollingLaw, f64),
        radius: f64,
        dt: f64,
        tally: &mut Tally,
    ) {
        let sides = (Ball(ball, radius), Body(surface));
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
            shear_damping_ratio,
            dt,
            is_meeting: !self.is_touching,
        };
        let found = Touch {
            normal,
            point: ball.centroid + normal * (radius - 0.5 * overlap),
            overlap,
        };
        let (loads, rolling) = (&mut self.loads, Some(&mut self.rolling));
        let pressed = self
            .contact
            .apply(&found, &law, &sides, loads, rolling, tally);
        let rolling = Some(&self.rolling);
        self.rates = self.contact.rates(&found, &law, &sides, &pressed, rolling);
        self.is_touching = true;
    }

    /// Force and torque on the ball and on the surface, about their centroids.
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
