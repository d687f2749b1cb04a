//! Projected block Gauss-Seidel: each contact exactly, with all others as they are.
//!
//! Contacts of a color act on no common body, and are solved at once. The order of colors is shuffled for each sweep, from a fixed seed: in a
//! fixed order redundant piles can go round for ever.
//!
//! A column of `n` equal blocks takes its error by `cos²(π/2n)` a sweep; [`super::gradient`] does not slow down so.

use super::ContactProblem;
use super::accuracy::{Scaling, residual};
use super::delassus::Delassus;
use crate::{Random, Vec3};
use rayon::prelude::*;

/// Contacts of a color from which on several threads solve them.
const LARGE_COLOR: usize = 256;
const SEED: u64 = 0x5eed;

/// Order of the colors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// Anew for each sweep.
    Shuffled,
    /// That of the contacts.
    Fixed,
}

/// When an iteration ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Until {
    /// Residual of the laws; –.
    pub tolerance: f64,
    /// Mass by which it is measured.
    pub scaling: Scaling,
    /// Sweeps, or iterations, at most.
    pub n_iterations: usize,
}

/// How an iteration ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ended {
    /// Sweeps, or iterations.
    pub n_iterations: usize,
    /// Residual of the laws; –.
    pub residual: f64,
}

/// Sweeps over the rows of a problem; keeps the colors and the last slip of each contact.
#[derive(Clone, Debug)]
pub struct GaussSeidel {
    colors: Vec<Vec<u32>>,
    order: Order,
    random: Random,
    /// Last `l` of each contact; 1/kg.
    slips: Vec<f64>,
}

impl GaussSeidel {
    /// For the contacts of an operator.
    pub fn new<D: Delassus>(operator: &D, order: Order) -> Self {
        let n = operator.n_contacts();
        let colors = match order {
            Order::Shuffled => operator.colors(),
            Order::Fixed => (0..n).map(|a| vec![a as u32]).collect(),
        };
        Self {
            colors,
            order,
            random: Random::new(SEED),
            slips: vec![0.0; n],
        }
    }

    /// Improves impulses (N s) until their residual is small enough, and the velocities that go with them. The residual is looked at after
    /// every sweep; there is at least one, so that bodies at rest come closer to it in each step.
    pub fn solve<D: Delassus>(
        &mut self,
        problem: &ContactProblem<D>,
        impulses: &mut [Vec3],
        until: Until,
    ) -> Ended {
        let mut velocities = problem.operator.product(impulses);
        let mut n_iterations = 0;
        loop {
            self.sweep(problem, impulses, &mut velocities);
            n_iterations += 1;
            let residual = residual(problem, (impulses, &velocities), until.scaling);
            if residual <= until.tolerance || until.n_iterations <= n_iterations {
                return Ended {
                    n_iterations,
                    residual,
                };
            }
        }
    }

    fn sweep<D: Delassus>(
        &mut self,
        problem: &ContactProblem<D>,
        impulses: &mut [Vec3],
        velocities: &mut D::Velocities,
    ) {
        if self.order == Order::Shuffled {
            self.shuffle();
        }
        let Self { colors, slips, .. } = self;
        for color in colors {
            let solve = |a: usize, (velocities, impulses, mut slip): (&_, &[Vec3], f64)| {
                let w = problem.operator.diagonal(a);
                let others = problem.velocity(velocities, a) - w * impulses[a];
                let found = problem.impulse(a, &others, impulses, &mut slip);
                (found, slip)
            };
            let found: Vec<(Vec3, f64)> = match LARGE_COLOR <= color.len() {
                true => (color.par_iter())
                    .map(|&a| solve(a as usize, (velocities, impulses, slips[a as usize])))
                    .collect(),
                // one at a time: those of a color do not see each other
                false => Vec::new(),
            };
            for (k, &a) in color.iter().enumerate() {
                let a = a as usize;
                let (impulse, slip) = match found.get(k) {
                    Some(found) => *found,
                    None => solve(a, (velocities, impulses, slips[a])),
                };
                let change = impulse - impulses[a];
                problem.operator.add(velocities, a, &change);
                impulses[a] = impulse;
                slips[a] = slip;
            }
        }
    }

    /// Fisher and Yates' shuffle.
    fn shuffle(&mut self) {
        for k in (1..self.colors.len()).rev() {
            let other = (self.random.uniform() * (k + 1) as f64) as usize;
            self.colors.swap(k, other);
        }
    }
}
