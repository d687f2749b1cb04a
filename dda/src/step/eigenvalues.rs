//! Bound of the eigenvalues of stiffness and damping by those of each block.
//!
//! ```text
//! v·Kv = Σ k (v_i·g_i − v_j·g_j)² ≤ Σ k ((1 + t) (v_i·g_i)² + (1 + 1/t) (v_j·g_j)²)     for any t > 0 of a pair
//! λ_max(M⁻¹K) ≤ max_i λ_max(M_i⁻¹ K_i),   K_i = Σ k (1 + t) g_i g_iᵀ                                 [1/s²]
//! ```
//! with `t` the rates of the partner over those of the block: a partner that is held less stiffly hardly counts.
//!
//! Of the pairs that do not touch yet, only those count that may until the next bound.

use crate::contact::context::travel_of;
use crate::contact::rates::{BlockRates, Rates};
use crate::contact::spread::Spread;
use crate::contact::spring::Spring;
use crate::geometry::bounds;
use crate::motion::kinematics::Kinematics;
use crate::motion::rigid::is_isotropic;
use crate::{Blocks, Vec3};
use nalgebra::{Matrix3, Matrix6};

/// Symmetric matrix of the forces and torques of a block that answer its velocity and spin.
#[derive(Clone, Copy, Default)]
struct Response {
    translation: Matrix3<f64>,
    mixed: Matrix3<f64>,
    rotation: Matrix3<f64>,
}

/// Products of an arm and a normal in the response to a spring.
struct Products {
    /// `n nᵀ`, `(r × n) nᵀ` and `(r × n)(r × n)ᵀ`.
    along: [Matrix3<f64>; 3],
    /// `[r]×` and `r² − r rᵀ`.
    in_all: [Matrix3<f64>; 2],
}

impl Products {
    /// Of a point from the centroid (m) and the unit normal there.
    fn of(r: &Vec3, normal: &Vec3) -> Self {
        let arm = r.cross(normal);
        let (n, square) = (normal.transpose(), r.norm_squared());
        Self {
            along: [normal * n, arm * n, arm * arm.transpose()],
            in_all: [
                r.cross_matrix(),
                Matrix3::from_diagonal_element(square) - r * r.transpose(),
            ],
        }
    }
}

impl Response {
    /// Responses to the springs of a patch along its normal and across it, of unit coefficients.
    fn of_spread(spread: &Spread, centroid: &Vec3) -> [Self; 2] {
        let [along, across] = spread.about(centroid);
        let n = &spread.normal;
        let product = n * n.transpose();
        let arm = along.first.cross(n) * n.transpose();
        let arm_across = across.first.cross(n) * n.transpose();
        let inertia = Matrix3::from_diagonal_element(across.second.trace()) - across.second;
        [
            Self {
                translation: product * along.total,
                mixed: arm,
                rotation: along.across(n),
            },
            Self {
                translation: (Matrix3::identity() - product) * across.total,
                mixed: across.first.cross_matrix() - arm_across,
                rotation: inertia - across.across(n),
            },
        ]
    }

    fn add_scaled(&mut self, other: &Self, factor: f64) {
        self.translation += other.translation * factor;
        self.mixed += other.mixed * factor;
        self.rotation += other.rotation * factor;
    }

    /// Adds a spring along the normal and across it.
    fn add(&mut self, products: &Products, [along, across]: [f64; 2]) {
        let more = along - across;
        let [translation, mixed, rotation] = &products.along;
        let [arm, inertia] = &products.in_all;
        self.translation += Matrix3::from_diagonal_element(across) + translation * more;
        self.mixed += arm * across + mixed * more;
        self.rotation += inertia * across + rotation * more;
    }

    /// Bound of the largest eigenvalue of `M⁻¹ K`, at most 1.25 times it: `(tr A⁸)^⅛`.
    fn largest_rate(&self, body: &Kinematics, is_isotropic: bool) -> Option<f64> {
        let (mixed, rotation) = if is_isotropic {
            let inverse = body.inverse_inertia[(0, 0)];
            (self.mixed * inverse.sqrt(), self.rotation * inverse)
        } else {
            let root = body.inverse_inertia.cholesky()?.l();
            (
                root.transpose() * self.mixed,
                root.transpose() * self.rotation * root,
            )
        };
        let mut a = Matrix6::zeros();
        let mixed = mixed * body.inverse_mass.sqrt();
        a.fixed_view_mut::<3, 3>(0, 0)
            .copy_from(&(self.translation * body.inverse_mass));
        a.fixed_view_mut::<3, 3>(3, 0).copy_from(&mixed);
        a.fixed_view_mut::<3, 3>(0, 3).copy_from(&mixed.transpose());
        a.fixed_view_mut::<3, 3>(3, 3).copy_from(&rotation);
        let trace = a.trace();
        if trace <= 0.0 {
            return Some(0.0);
        }
        a /= trace;
        let square = a * a;
        Some(trace * (square * square).norm().sqrt().sqrt())
    }
}

/// Response of a sphere to springs and to resistance against rolling, in sums that bound its largest eigenvalue at a fraction of the work
/// of a [`Response`].
///
/// ```text
/// T = Σ k_n n nᵀ + k_t (1 − n nᵀ),   R = Σ (k_t r² + k_r) (1 − n nᵀ),   C = r Σ k_t [n]×,   ‖C‖ = r |Σ k_t n|
/// λ_max ≤ (t + u)/2 + √((t − u)²/4 + ‖C‖²/(m J)),   t = λ_max(T)/m,   u = λ_max(R)/J                        [1/s²]
/// ```
#[derive(Clone, Copy, Default)]
struct ResponseOfSphere {
    /// `T` and `Σ k_t (1 − n nᵀ)`.
    translation: Matrix3<f64>,
    across: Matrix3<f64>,
    /// `Σ k_t n`.
    first: Vec3,
    /// `Σ k_r (1 − n nᵀ)`.
    rolling: Matrix3<f64>,
}

/// Directions of a contact of a sphere.
struct Directions {
    /// Unit, away from the sphere.
    normal: Vec3,
    /// `n nᵀ` and `1 − n nᵀ`.
    along: Matrix3<f64>,
    across: Matrix3<f64>,
}

impl ResponseOfSphere {
    /// Adds springs along the normal and across it, and one against rolling.
    fn add(&mut self, of: &Directions, [along, across]: [f64; 2], rolling: f64) {
        self.translation += of.along * along + of.across * across;
        self.across += of.across * across;
        self.first += of.normal * across;
        if rolling > 0.0 {
            self.rolling += of.across * rolling;
        }
    }

    /// Bound of the largest eigenvalue of `M⁻¹ K`, for an arm (m).
    fn largest_rate(&self, body: &Kinematics, arm: f64) -> f64 {
        let (mass, inertia) = (body.inverse_mass, body.inverse_inertia.m11);
        let translation = largest_eigenvalue(&self.translation) * mass;
        let turning = self.across * (arm * arm) + self.rolling;
        let rotation = largest_eigenvalue(&turning) * inertia;
        let mixed = self.first.norm_squared() * (arm * arm * mass * inertia);
        0.5 * (translation + rotation) + (0.25 * (translation - rotation).powi(2) + mixed).sqrt()
    }
}

/// Bound of the largest eigenvalue of a matrix without negative ones, at most 1.15 times it: `(tr A⁸)^⅛`.
fn largest_eigenvalue(a: &Matrix3<f64>) -> f64 {
    let trace = a.trace();
    if trace <= 0.0 {
        return 0.0;
    }
    let scaled = a / trace;
    let square = scaled * scaled;
    trace * (square * square).norm().sqrt().sqrt()
}

/// Sums over the contacts of a block.
#[derive(Default)]
struct Held {
    stiffness: Response,
    damping: Response,
}

impl Blocks {
    /// Bounds of stiffness and damping of a block by the contacts that touch; `None` of one that deforms.
    pub(super) fn largest_rates(&self, b: usize) -> Option<Rates> {
        let body = &self.state.kinematics[b];
        if body.strain_rate.is_some() {
            return None;
        }
        if self.only_sphere(b).is_some() {
            return Some(self.largest_rates_of_sphere(b));
        }
        let mut held = Held::default();
        for (k, _) in self.derived.links.of(b) {
            let pair = &self.contacts.pairs[k];
            if pair.is_touching {
                let twice = self.shares(b, pair.blocks);
                let coefficients = pair.coefficients(self.joint_between(pair.parts));
                held.add_spread(body, &pair.spread, coefficients, twice);
            }
        }
        for (k, _) in self.derived.sphere_links.of(b) {
            if self.contacts.sphere_marks[k].is_touching {
                let twice = self.shares(b, self.contacts.sphere_pairs[k].blocks);
                held.add(body, [self.spring_of_spheres(k)], twice);
            }
        }
        for (k, _) in self.derived.surface_links.of(b) {
            let pair = &self.contacts.surface_pairs[k];
            if pair.is_touching {
                held.add(body, pair.springs(self.joint_between(pair.parts)), ONCE);
            }
        }
        let is_isotropic = is_isotropic(&self.constants.inertia[b]);
        Some(Rates {
            stiffness: held.stiffness.largest_rate(body, is_isotropic)?,
            damping: held.damping.largest_rate(body, is_isotropic)?,
        })
    }

    /// The same of a sphere. Those of its contacts with surfaces are added up.
    fn largest_rates_of_sphere(&self, b: usize) -> Rates {
        let mut stiffness = ResponseOfSphere::default();
        let mut damping = ResponseOfSphere::default();
        for (k, is_second) in self.derived.sphere_links.of(b) {
            if !self.contacts.sphere_marks[k].is_touching {
                continue;
            }
            let blocks = self.contacts.sphere_pairs[k].blocks;
            let times = self.shares(b, blocks);
            let spring = self.spring_of_spheres(k);
            let along = spring.normal * spring.normal.transpose();
            let directions = Directions {
                normal: if is_second {
                    -spring.normal
                } else {
                    spring.normal
                },
                along,
                across: Matrix3::identity() - along,
            };
            let rolling = self
                .contacts
                .sphere_rolling
                .get(k)
                .map_or((0.0, 0.0), |rolling| {
                    let mobility =
                        |block: u32| self.state.kinematics[block as usize].rolling_mobility();
                    let mobilities = (mobility(blocks.0), mobility(blocks.1));
                    let dashpots =
                        rolling.dashpots(self.constants.settings.rolling_law, mobilities);
                    (
                        rolling.stiffness,
                        if is_second { dashpots.1 } else { dashpots.0 },
                    )
                });
            let of = |sides: [f64; 2], times: f64| sides.map(|side| side * times);
            stiffness.add(
                &directions,
                of(spring.stiffness, times.stiffness),
                rolling.0 * times.stiffness,
            );
            damping.add(
                &directions,
                of(spring.dashpot, times.damping),
                rolling.1 * times.damping,
            );
        }
        let (body, radius) = (&self.state.kinematics[b], self.constants.radius[b]);
        let mut largest = Rates {
            stiffness: stiffness.largest_rate(body, radius),
            damping: damping.largest_rate(body, radius),
        };
        for (k, is_second) in self.derived.surface_links.of(b) {
            let pair = &self.contacts.surface_pairs[k];
            if pair.is_touching && !is_second {
                largest.stiffness += pair.rates.stiffness;
                largest.damping += pair.rates.damping;
            }
        }
        largest
    }

    /// Largest rates of the pairs of a block that may touch within a time (s).
    pub(super) fn next_rates(&self, b: usize, time: f64) -> Rates {
        let mut next = Rates::default();
        for (k, is_second) in self.derived.links.of(b) {
            let pair = &self.contacts.pairs[k];
            let between = self.boxes_apart(pair.parts);
            // the axis of a pair whose boxes overlap is that of this step, or of an earlier one less the travel since
            let apart = pair.axis.axis.filter(|_| between <= 0.0);
            let gap = apart.map_or(between, |axis| {
                let left = pair.apart_until - travel_of(&self.state.travel, pair.blocks);
                if left.is_finite() { left } else { axis.gap }
            });
            if !pair.is_touching && gap <= self.reach(pair.blocks, time) {
                next = next.larger(if is_second {
                    &pair.rates.1
                } else {
                    &pair.rates.0
                });
            }
        }
        for (k, is_second) in self.derived.sphere_links.of(b) {
            if self.contacts.sphere_marks[k].is_touching {
                continue;
            }
            let (first, second) = &self.contacts.sphere_rates[k];
            let with_it = next.larger(if is_second { second } else { first });
            let pair = &self.contacts.sphere_pairs[k];
            // what would not count need not be near
            if with_it != next && self.boxes_apart(pair.parts) <= self.reach(pair.blocks, time) {
                next = with_it;
            }
        }
        for (k, is_second) in self.derived.surface_links.of(b) {
            let pair = &self.contacts.surface_pairs[k];
            if !(is_second || pair.is_touching || pair.triangles.is_empty()) {
                next = next.larger(&pair.rates);
            }
        }
        next
    }

    fn boxes_apart(&self, parts: (u32, u32)) -> f64 {
        let of = |part: u32| &self.state.boxes[part as usize];
        bounds::gap(of(parts.0), of(parts.1))
    }

    /// Upper bound of the way by which two blocks approach each other within a time (s); m.
    fn reach(&self, blocks: (u32, u32), time: f64) -> f64 {
        let (a, b) = (blocks.0 as usize, blocks.1 as usize);
        let body = |b: usize| &self.state.kinematics[b];
        let turning = |b: usize| body(b).spin.norm() * self.constants.radius[b];
        let speed = (body(a).velocity - body(b).velocity).norm() + turning(a) + turning(b);
        (speed + self.constants.settings.gravity.norm() * time) * time
    }

    /// `1 + t` of stiffness and damping of a pair, at one of its blocks.
    fn shares(&self, b: usize, blocks: (u32, u32)) -> Rates {
        let (i, j) = (blocks.0 as usize, blocks.1 as usize);
        let partner = if i == b { j } else { i };
        if self.state.kinematics[partner].inverse_mass == 0.0 {
            return ONCE;
        }
        let BlockRates {
            stiffness, damping, ..
        } = self.state.rates[b];
        let other = &self.state.rates[partner];
        // without damping nothing is shared
        let share = |own: f64, other: f64| {
            if own > 0.0 { 1.0 + other / own } else { 2.0 }
        };
        Rates {
            stiffness: share(stiffness, other.stiffness),
            damping: share(damping, other.damping),
        }
    }
}

/// Shares against a partner that does not give way.
const ONCE: Rates = Rates {
    stiffness: 1.0,
    damping: 1.0,
};

impl Held {
    fn add_spread(
        &mut self,
        body: &Kinematics,
        spread: &Spread,
        [stiffness, dashpots]: [[f64; 2]; 2],
        times: Rates,
    ) {
        let [along, across] = Response::of_spread(spread, &body.centroid);
        for (response, sides, times) in [
            (&mut self.stiffness, stiffness, times.stiffness),
            (&mut self.damping, dashpots, times.damping),
        ] {
            response.add_scaled(&along, sides[0] * times);
            response.add_scaled(&across, sides[1] * times);
        }
    }

    fn add(&mut self, body: &Kinematics, springs: impl IntoIterator<Item = Spring>, times: Rates) {
        for spring in springs {
            let (r, normal) = (spring.point - body.centroid, spring.normal);
            let of = |sides: [f64; 2], times: f64| sides.map(|side| side * times);
            let products = Products::of(&r, &normal);
            (self.stiffness).add(&products, of(spring.stiffness, times.stiffness));
            (self.damping).add(&products, of(spring.dashpot, times.damping));
        }
    }
}
