//! Accelerated projected gradient with De Saxcé's shift: parallel without colors, for redundant piles and tight tolerances.
//!
//! ```text
//! R_a = d_a s_a,  d_a = √(3/tr W_aa);   L = 1.1 λ_max(D W D)
//! u   = b + W D y
//! x₊  = P_K(y − D (u + σ n)/L)                             σ_a = μ|u_t,a|, renewed every tenth iteration
//! θ₊  = θ (√(θ² + 4) − θ)/2,   β = θ (1 − θ)/(θ² + θ₊)
//! y   = x₊ + β (x₊ − x), or x₊ and θ₊ = 1 where the step goes uphill
//! ```
//! One number per contact scales it, so that its cone stays one and masses of all sizes are alike. Renewed in each iteration the shift
//! stalls; never, a body that slides lifts off at `μ|U_t|`.
//!
//! Joints have their line or all of space as their cone, and rods a shift of their own.
//!
//! Sources: Nesterov (1983); O'Donoghue & Candès (2015) for the restart; Mazhar et al. (2015) for contacts.

use super::accuracy::residual;
use super::delassus::Delassus;
use super::gauss_seidel::{Ended, Until};
use super::{ContactProblem, ROWS_AT_A_TIME};
use crate::chunks::{for_each, reduce};
use crate::{Random, Vec3};

/// Iterations between renewals of the shift, after which the residual is looked at.
const RENEWAL: usize = 10;
/// Bound on the largest eigenvalue over its estimate.
const SAFETY: f64 = 1.1;
/// Few: an estimate that is low by some percent takes fewer iterations, and the restart catches what it costs.
const N_POWERS: usize = 10;
const SEED: u64 = 0x9e1;

/// Improves impulses (N s) until their residual is small enough; leaves the best that were found.
pub fn solve<D: Delassus>(
    problem: &ContactProblem<D>,
    impulses: &mut [Vec3],
    until: Until,
) -> Ended {
    let scales: Vec<f64> = (0..problem.len()).map(|a| problem.mass(a).sqrt()).collect();
    let stiffness = SAFETY * largest_eigenvalue(problem, &scales);
    let velocities = problem.operator.product(impulses);
    let mut best = Ended {
        n_iterations: 0,
        residual: residual(problem, (impulses, &velocities), until.scaling),
    };
    if best.residual <= until.tolerance || stiffness <= 0.0 {
        return best;
    }
    let mut descent = Descent::new(impulses, scales, 1.0 / stiffness);
    for iteration in 1..=until.n_iterations {
        descent.step(problem, (iteration - 1) % RENEWAL == 0);
        if iteration % RENEWAL != 0 && iteration != until.n_iterations {
            continue;
        }
        let found = descent.impulses();
        let velocities = problem.operator.product(&found);
        let residual = residual(problem, (&found, &velocities), until.scaling);
        if residual < best.residual {
            impulses.copy_from_slice(&found);
            best.residual = residual;
        }
        best.n_iterations = iteration;
        if residual <= until.tolerance {
            break;
        }
    }
    best
}

/// Largest eigenvalue of `D W D` by powers; –.
fn largest_eigenvalue<D: Delassus>(problem: &ContactProblem<D>, scales: &[f64]) -> f64 {
    let operator = &problem.operator;
    let mut random = Random::new(SEED);
    let mut x: Vec<Vec3> = (scales.iter())
        .enumerate()
        .map(|(a, _)| problem.acting(a, &Vec3::from_fn(|_, _| random.uniform() - 0.5)))
        .collect();
    let mut size = 0.0;
    for _ in 0..N_POWERS {
        let norm = x.iter().map(Vec3::norm_squared).sum::<f64>().sqrt();
        if norm <= 0.0 {
            return size;
        }
        let scaled: Vec<Vec3> = x.iter().zip(scales).map(|(x, d)| x * (d / norm)).collect();
        let velocities = operator.product(&scaled);
        for (a, (x, d)) in x.iter_mut().zip(scales).enumerate() {
            *x = problem.acting(a, &operator.velocity(&velocities, a)) * *d;
        }
        size = x.iter().map(Vec3::norm_squared).sum::<f64>().sqrt();
    }
    size
}

/// State of the descent, in scaled impulses.
struct Descent {
    scales: Vec<f64>,
    /// `1/L`.
    step_length: f64,
    x: Vec<Vec3>,
    y: Vec<Vec3>,
    /// The next `x`; before that impulses at `y`.
    next: Vec<Vec3>,
    shift: Vec<f64>,
    theta: f64,
}

impl Descent {
    fn new(impulses: &[Vec3], scales: Vec<f64>, step_length: f64) -> Self {
        let x: Vec<Vec3> = impulses.iter().zip(&scales).map(|(r, d)| r / *d).collect();
        Self {
            shift: vec![0.0; x.len()],
            y: x.clone(),
            next: x.clone(),
            x,
            scales,
            step_length,
            theta: 1.0,
        }
    }

    fn impulses(&self) -> Vec<Vec3> {
        let scaled = self.x.iter().zip(&self.scales);
        scaled.map(|(x, d)| x * *d).collect()
    }

    fn step<D: Delassus>(&mut self, problem: &ContactProblem<D>, renews: bool) {
        let (y, scales, step_length) = (&self.y, &self.scales, self.step_length);
        for_each(
            (self.next.as_mut_slice(), y.as_slice(), scales.as_slice()),
            ROWS_AT_A_TIME,
            &|_, (scaled, y, scales): (&mut [Vec3], &[Vec3], &[f64])| {
                for ((scaled, y), d) in scaled.iter_mut().zip(y).zip(scales) {
                    *scaled = y * *d;
                }
            },
        );
        let velocities = problem.operator.product(&self.next);
        let move_rows =
            |first: usize, (next, shift, x): (&mut [Vec3], &mut [f64], &[Vec3])| -> f64 {
                let mut uphill = 0.0;
                for (a, ((next, shift), x)) in (first..).zip(next.iter_mut().zip(shift).zip(x)) {
                    let mut u = problem.velocity(&velocities, a);
                    if renews {
                        *shift = problem.shift(a, &u);
                    }
                    u.x += *shift;
                    let gradient = u * scales[a];
                    let free = y[a] - gradient * step_length;
                    let pressed = |contact: usize| y[contact].x * scales[contact];
                    *next = problem.projected(a, &free, scales[a], pressed);
                    uphill += gradient.dot(&(*next - x));
                }
                uphill
            };
        let rows = (
            self.next.as_mut_slice(),
            self.shift.as_mut_slice(),
            self.x.as_slice(),
        );
        let uphill = reduce(rows, ROWS_AT_A_TIME, &move_rows, &|a, b| a + b);
        if 0.0 < uphill {
            self.theta = 1.0;
            self.y.copy_from_slice(&self.next);
        } else {
            let theta = self.theta;
            let after = 0.5 * theta * ((theta * theta + 4.0).sqrt() - theta);
            let beta = theta * (1.0 - theta) / (theta * theta + after);
            let rows = (
                self.y.as_mut_slice(),
                self.next.as_slice(),
                self.x.as_slice(),
            );
            for_each(rows, ROWS_AT_A_TIME, &|_,
                                             (y, next, x): (
                &mut [Vec3],
                &[Vec3],
                &[Vec3],
            )| {
                for ((y, next), x) in y.iter_mut().zip(next).zip(x) {
                    *y = next + (next - x) * beta;
                }
            });
            self.theta = after;
        }
        std::mem::swap(&mut self.x, &mut self.next);
    }
}
