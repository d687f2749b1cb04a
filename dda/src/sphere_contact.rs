//! Contact of balls, with each other and with polyhedra: one point, linear or Hertz's spring, shear
//! spring with history, rolling resistance.
//!
//! ```text
//! linear   F_n = k δ − 2 ξ √(k m̃) u_n ≥ 0
//! Hertz    F_n = K δ^3/2 − β √(m̃ K) δ^1/4 u_n ≥ 0,    K = 4/3 E* √R̃                                [N]
//! shear    F_t = −k_t ξ − 2 ξ_t √(k_t m̃) u_t,   |F_t| ≤ μ_s F_n, once it slips μ_d F_n, until it holds again
//! rolling  M = −k_r θ − c_r ω_t,   k_r = 9/4 k_n μ_r² R̃²,   |M| ≤ μ_r R̃ F_n,el                      [N m]
//! ```
//! `1/m̃` is the sum of both sides' compliances along the normal, `R̃ = r_i r_j/(r_i + r_j)`, or `r` against
//! a polyhedron; ξ and β are those that give the restitution with a force that never pulls (Schwager &
//! Pöschel 2007). Sources: Cundall & Strack (1979), Tsuji, Tanaka & Ishida (1992), Luding (2008); rolling:
//! Ai, Chen, Rotter & Ooi (2011), whose limit is the constant directional torque of Zhou et al. (1999) and
//! whose spring lets a ball come to rest.
//!
//! The force acts in the middle of the overlap, so that angular momentum is kept.

use crate::{
    SurfacePoint, Vec3,
    contact::{Medium, Rates},
    forces::Tally,
    friction::carry,
    kinematics::{Kinematics, Load},
    material::SphereJoint,
    parts::Part,
};

/// Two parts that may touch, a ball at least one of them.
#[derive(Clone, Debug)]
pub(crate) struct SpherePair {
    pub parts: (u32, u32),
    pub blocks: (u32, u32),
    pub contact: SphereContact,
    /// What the pair adds to the step bound of each block.
    pub rates: (Rates, Rates),
}

/// Memory of a touching pair.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct SphereContact {
    pub is_touching: bool,
    pub is_slipping: bool,
    /// Unit, from i to j.
    pub normal: Vec3,
    /// World; m.
    pub point: Vec3,
    /// On j; N.
    pub force: Vec3,
    /// `ξ`; m.
    pub shear: Vec3,
    /// `δ`; m.
    pub overlap: f64,
    /// With its viscous part; N.
    pub normal_force: f64,
    pub normal_viscous: f64,
    /// `k_t`; N/m.
    pub shear_stiffness: f64,
}

/// Memory of the rolling spring of a touching pair; only where a material resists rolling.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Rolling {
    /// `θ`, of j against i; rad.
    pub angle: Vec3,
    /// On j; N m.
    pub torque: Vec3,
    /// `k_r`; N m.
    pub stiffness: f64,
}

impl Rolling {
    pub fn energy(&self) -> f64 {
        0.5 * self.stiffness * self.angle.norm_squared()
    }
}

/// Where a ball and another part touch.
struct Touch {
    normal: Vec3,
    point: Vec3,
    overlap: f64,
    effective_radius: f64,
}

/// A side's velocities at the contact: of its material, and of turning.
struct Sides<'a>(&'a Kinematics, &'a Kinematics);

impl Sides<'_> {
    fn rate_at(&self, x: &Vec3) -> Vec3 {
        self.1.velocity_at(x) - self.0.velocity_at(x)
    }

    /// Of j against i, of the material that was at `x` a step ago; m/s.
    fn rate_from(&self, x: &Vec3, dt: f64) -> Vec3 {
        self.1.velocity_from(x, dt) - self.0.velocity_from(x, dt)
    }

    fn turning(&self) -> Vec3 {
        self.1.spin - self.0.spin
    }
}

impl SphereContact {
    pub fn shear_energy(&self) -> f64 {
        0.5 * self.shear_stiffness * self.shear.norm_squared()
    }
}

impl SpherePair {
    pub fn new(parts: (u32, u32), blocks: (u32, u32)) -> Self {
        Self {
            parts,
            blocks,
            contact: SphereContact::default(),
            rates: (Rates::default(), Rates::default()),
        }
    }

    /// Load of the contact on the i or the j side.
    pub fn load_on(&self, is_j: bool, centroid: &Vec3, rolling: Option<&Rolling>) -> Load {
        let sign = if is_j { 1.0 } else { -1.0 };
        let force = self.contact.force * sign;
        let mut torque = (self.contact.point - centroid).cross(&force);
        if let Some(rolling) = rolling {
            torque += rolling.torque * sign;
        }
        Load { force, torque }
    }

    /// Energy of the springs; J.
    pub fn energy(&self, law: &SphereJoint, parts: &[Part], rolling: Option<&Rolling>) -> f64 {
        if !self.contact.is_touching {
            return 0.0;
        }
        law.energy(self.contact.overlap, effective_radius(parts, self.parts))
            + self.contact.shear_energy()
            + rolling.map_or(0.0, Rolling::energy)
    }

    /// Finds the contact in the present place and its force at the present velocities; books what was
    /// lost during the last `dt` (s).
    pub fn evaluate(
        &mut self,
        medium: &Medium,
        rolling: Option<&mut Rolling>,
        dt: f64,
        tally: &mut Tally,
    ) {
        let sides = Sides(
            &medium.kinematics[self.blocks.0 as usize],
            &medium.kinematics[self.blocks.1 as usize],
        );
        if self.contact.is_touching {
            self.book_first_half(&sides, rolling.as_deref(), dt, tally);
        }
        match touch(medium, self.parts) {
            Some(found) => {
                let law = &medium.joint_of(self.parts).spheres;
                self.apply_law(&found, law, medium, &sides, rolling, dt, tally);
                tally.note_overlap(
                    self.parts,
                    found.overlap / medium.least_of(self.parts, medium.deepest_allowed),
                    found.overlap / medium.least_of(self.parts, medium.size),
                );
            }
            None if self.contact.is_touching => {
                let law = &medium.joint_of(self.parts).spheres;
                let radius = effective_radius(medium.parts, self.parts);
                if self.contact.normal_force == 0.0 {
                    // No force acted any more: what the spring still held is lost.
                    tally.damping += law.energy(self.contact.overlap, radius);
                }
                // The shear and rolling springs' energy was booked with the first half.
                if let Some(rolling) = rolling {
                    *rolling = Rolling::default();
                }
                self.contact = SphereContact::default();
                self.note_rates_before_touch(law, medium, &sides);
            }
            None if self.rates.0.stiffness + self.rates.1.stiffness == 0.0 || medium.is_hertz => {
                let law = &medium.joint_of(self.parts).spheres;
                self.note_rates_before_touch(law, medium, &sides);
            }
            None => {}
        }
    }

    /// Work of the forces in the first half of the step, and what the springs across the normal held.
    fn book_first_half(
        &self,
        sides: &Sides,
        rolling: Option<&Rolling>,
        dt: f64,
        tally: &mut Tally,
    ) {
        let contact = &self.contact;
        let rate = sides.rate_from(&contact.point, dt);
        let along = contact.normal.dot(&rate);
        let shear = contact.force.dot(&rate) - contact.normal_force * along;
        tally.damping -= 0.5 * dt * contact.normal_viscous * along;
        tally.friction -= 0.5 * dt * shear;
        tally.friction += contact.shear_energy();
        if let Some(rolling) = rolling {
            tally.friction -= 0.5 * dt * rolling.torque.dot(&sides.turning());
            tally.friction += rolling.energy();
        }
    }

    #[expect(
        clippy::too_many_arguments,
        reason = "one place that needs all of the law"
    )]
    fn apply_law(
        &mut self,
        found: &Touch,
        law: &SphereJoint,
        medium: &Medium,
        sides: &Sides,
        rolling: Option<&mut Rolling>,
        dt: f64,
        tally: &mut Tally,
    ) {
        let contact = &mut self.contact;
        let n = found.normal;
        let rate = sides.rate_at(&found.point);
        let opening = n.dot(&rate);
        let slip = rate - n * opening;
        let compliances = (
            sides.0.compliance(&found.point, &n),
            sides.1.compliance(&found.point, &n),
        );
        let mobility = compliances.0 + compliances.1;
        let spring = law.normal(found.overlap, found.effective_radius, mobility);
        let elastic = spring.force;
        let normal_force = f64::max(elastic - spring.viscosity * opening, 0.0);

        let shear_stiffness = law.shear_ratio * spring.tangent;
        let turn = 0.5 * (sides.0.spin + sides.1.spin).dot(&n) * dt;
        // A spring that has stiffened keeps its force, one that has softened its stretch: no energy is made.
        let kept = if shear_stiffness > contact.shear_stiffness {
            contact.shear_stiffness / shear_stiffness
        } else {
            1.0
        };
        let mut stretch = carry(&contact.shear, &n, turn) * kept + slip * dt;
        let dashpot = 2.0 * medium.shear_damping_ratio * (shear_stiffness / mobility).sqrt();
        let mut shear = -stretch * shear_stiffness - slip * dashpot;
        let friction = if contact.is_slipping {
            law.dynamic_friction
        } else {
            law.static_friction
        };
        contact.is_slipping = shear.norm_squared() > (friction * normal_force).powi(2);
        if contact.is_slipping {
            shear *= law.dynamic_friction * normal_force / shear.norm();
            stretch = if shear_stiffness > 0.0 {
                -shear / shear_stiffness
            } else {
                Vec3::zeros()
            };
        }

        contact.is_touching = true;
        contact.normal = n;
        contact.point = found.point;
        contact.force = n * normal_force + shear;
        contact.shear = stretch;
        contact.overlap = found.overlap;
        contact.normal_force = normal_force;
        contact.normal_viscous = normal_force - elastic;
        contact.shear_stiffness = shear_stiffness;
        tally.damping -= 0.5 * dt * contact.normal_viscous * opening;
        tally.friction -= 0.5 * dt * shear.dot(&slip) + contact.shear_energy();

        let bound = law.tangent_bound(found.overlap, found.effective_radius, opening, mobility);
        let stiffening = bound / spring.tangent.max(f64::MIN_POSITIVE);
        let rolling_rate = match rolling {
            Some(rolling) if law.rolling_friction > 0.0 => {
                let limit = law.rolling_friction * found.effective_radius * elastic;
                rolling.apply(law, found, spring.tangent, sides, limit, dt);
                let turning = sides.turning();
                tally.friction -= 0.5 * dt * rolling.torque.dot(&turning) + rolling.energy();
                rolling.stiffness * stiffening
            }
            _ => 0.0,
        };
        let shear_bound = shear_stiffness * stiffening.max(1.0);
        let of = |body: &Kinematics, other: &Kinematics, along: f64| {
            let both = if other.inverse_mass > 0.0 { 2.0 } else { 1.0 };
            let across = body.compliance_trace(&found.point) - along;
            Rates {
                stiffness: both
                    * (bound.max(spring.tangent) * along
                        + shear_bound * across
                        + rolling_rate * body.inverse_inertia.trace()),
                damping: both
                    * (spring.viscosity * along
                        + dashpot * across
                        + rolling_dashpot(rolling_rate, body, other)
                            * body.inverse_inertia.trace()),
            }
        };
        self.rates = (
            of(sides.0, sides.1, compliances.0),
            of(sides.1, sides.0, compliances.1),
        );
    }

    /// Rates of a pair that may touch in the next step.
    fn note_rates_before_touch(&mut self, law: &SphereJoint, medium: &Medium, sides: &Sides) {
        let radius = effective_radius(medium.parts, self.parts);
        let mobility = sides.0.inverse_mass + sides.1.inverse_mass;
        let approach = (sides.1.velocity - sides.0.velocity).norm();
        let stiffness = law.tangent_bound(0.0, radius, approach, mobility);
        let dashpot = |ratio: f64, k: f64| 2.0 * ratio * (k / mobility).sqrt();
        let viscosity = law.damping_ratio_bound();
        let shear = law.shear_ratio * stiffness;
        let of = |body: &Kinematics, other: &Kinematics, block: u32| {
            let both = if other.inverse_mass > 0.0 { 2.0 } else { 1.0 };
            let (along, sum) = body.worst_compliance(medium.radius[block as usize]);
            let across = sum - along;
            Rates {
                stiffness: both * (stiffness * along + shear * across),
                damping: both
                    * (dashpot(viscosity, stiffness) * along
                        + dashpot(medium.shear_damping_ratio, shear) * across),
            }
        };
        self.rates = (
            of(sides.0, sides.1, self.blocks.0),
            of(sides.1, sides.0, self.blocks.1),
        );
    }
}

/// Damping ratio of the rolling dashpot while its spring holds; –.
const ROLLING_DAMPING_RATIO: f64 = 0.3;

fn rolling_dashpot(stiffness: f64, a: &Kinematics, b: &Kinematics) -> f64 {
    // Mean over the axes: exact for balls.
    let mobility = (a.inverse_inertia.trace() + b.inverse_inertia.trace()) / 3.0;
    if mobility > 0.0 {
        2.0 * ROLLING_DAMPING_RATIO * (stiffness / mobility).sqrt()
    } else {
        0.0
    }
}

impl Rolling {
    /// Advances the spring by the turning of a step and finds the torque, at most `limit` (N m).
    fn apply(
        &mut self,
        law: &SphereJoint,
        found: &Touch,
        normal_stiffness: f64,
        sides: &Sides,
        limit: f64,
        dt: f64,
    ) {
        let n = found.normal;
        let arm = law.rolling_friction * found.effective_radius;
        let stiffness = 2.25 * normal_stiffness * arm * arm;
        let turning = sides.turning();
        let rolling = turning - n * turning.dot(&n);
        let spin = 0.5 * (sides.0.spin + sides.1.spin).dot(&n) * dt;
        let kept = if stiffness > self.stiffness {
            self.stiffness / stiffness
        } else {
            1.0
        };
        let angle = carry(&self.angle, &n, spin) * kept + rolling * dt;
        let dashpot = rolling_dashpot(stiffness, sides.0, sides.1);
        self.stiffness = stiffness;
        self.angle = angle;
        self.torque = -angle * stiffness - rolling * dashpot;
        let size = self.torque.norm();
        if size > limit {
            // The limit is the spring's: the dashpot belongs to coming to rest.
            self.torque *= limit / size;
            self.angle = -self.torque / stiffness;
        }
    }
}

/// `r_i r_j/(r_i + r_j)` of two balls, `r` of a ball and a polyhedron; m.
fn effective_radius(parts: &[Part], pair: (u32, u32)) -> f64 {
    let radius = |part: u32| match &parts[part as usize] {
        Part::Sphere { radius, .. } => Some(*radius),
        Part::Polyhedron(_) => None,
    };
    match (radius(pair.0), radius(pair.1)) {
        (Some(r), Some(s)) => r * s / (r + s),
        (Some(r), None) | (None, Some(r)) => r,
        (None, None) => f64::INFINITY,
    }
}

fn touch(medium: &Medium, parts: (u32, u32)) -> Option<Touch> {
    let (first, second) = (
        &medium.parts[parts.0 as usize],
        &medium.parts[parts.1 as usize],
    );
    match (first, second) {
        (
            Part::Sphere {
                center: a,
                radius: r,
            },
            Part::Sphere {
                center: b,
                radius: s,
            },
        ) => {
            let offset = b - a;
            let square = offset.norm_squared();
            if square >= (r + s) * (r + s) {
                return None;
            }
            let distance = square.sqrt();
            let normal = if distance > 0.0 {
                offset / distance
            } else {
                Vec3::z()
            };
            let overlap = r + s - distance;
            Some(Touch {
                normal,
                point: a + normal * (r - 0.5 * overlap),
                overlap,
                effective_radius: r * s / (r + s),
            })
        }
        (Part::Sphere { center, radius }, Part::Polyhedron(body)) => {
            let surface = body.touch_point_within(center, *radius)?;
            Some(on_surface(&surface, -surface.normal, *radius))
        }
        (Part::Polyhedron(body), Part::Sphere { center, radius }) => {
            let surface = body.touch_point_within(center, *radius)?;
            Some(on_surface(&surface, surface.normal, *radius))
        }
        (Part::Polyhedron(_), Part::Polyhedron(_)) => None,
    }
}

fn on_surface(surface: &SurfacePoint, normal: Vec3, radius: f64) -> Touch {
    let overlap = radius - surface.distance;
    Touch {
        normal,
        point: surface.point - surface.normal * (0.5 * overlap),
        overlap,
        effective_radius: radius,
    }
}
