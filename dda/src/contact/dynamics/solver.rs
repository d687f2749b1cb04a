//! Choice between the two solvers of all contacts.

use super::ContactProblem;
use super::delassus::Delassus;
use super::gauss_seidel::{Ended, GaussSeidel, Order, Until};
use super::gradient;
use crate::Vec3;

/// Solver of all contacts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ContactSolver {
    /// Gauss-Seidel, and the gradient where it is slow.
    #[default]
    Chosen,
    /// Gauss-Seidel alone.
    GaussSeidel,
    /// The gradient alone; rolling resistance is left to Gauss-Seidel.
    Gradient,
}

/// Sweeps in which Gauss-Seidel must halve its residual.
const TRIAL: usize = 20;
/// Tolerance below which the gradient goes on at once after the trial; –.
const TIGHT: f64 = 1e-5;

/// Impulses (N s) of a problem from a guess, by a solver.
pub fn solve_by<D: Delassus>(
    solver: ContactSolver,
    problem: &ContactProblem<D>,
    impulses: &mut [Vec3],
    until: Until,
) -> Ended {
    match solver {
        ContactSolver::Gradient if problem.rolling.is_empty() => {
            gradient::solve(problem, impulses, until)
        }
        ContactSolver::Chosen => solve(problem, impulses, until),
        ContactSolver::GaussSeidel | ContactSolver::Gradient => {
            GaussSeidel::new(&problem.operator, Order::Shuffled).solve(problem, impulses, until)
        }
    }
}

/// Impulses (N s) of a problem from a guess, such as those of the last step: by Gauss-Seidel, and where it does not halve its residual within
/// twenty sweeps, or the tolerance is tight, by the gradient from there. Keeps the better of the two.
///
/// Rolling resistance is left to Gauss-Seidel: its bound moves with the impulse of another row, and the set of both is no cone of a contact.
pub fn solve<D: Delassus>(
    problem: &ContactProblem<D>,
    impulses: &mut [Vec3],
    until: Until,
) -> Ended {
    let mut sweeps = GaussSeidel::new(&problem.operator, Order::Shuffled);
    let mut before = f64::INFINITY;
    let mut n_taken = 0;
    loop {
        let trial = Until {
            n_iterations: TRIAL.min(until.n_iterations - n_taken),
            ..until
        };
        let ended = sweeps.solve(problem, impulses, trial);
        n_taken += ended.n_iterations;
        let is_done = ended.residual <= until.tolerance || until.n_iterations <= n_taken;
        if is_done {
            return Ended {
                n_iterations: n_taken,
                ..ended
            };
        }
        let is_slow = until.tolerance < TIGHT || 0.5 * before < ended.residual;
        if is_slow && problem.rolling.is_empty() {
            break;
        }
        before = ended.residual;
    }
    let ended = gradient::solve(
        problem,
        impulses,
        Until {
            n_iterations: until.n_iterations - n_taken,
            ..until
        },
    );
    Ended {
        n_iterations: n_taken + ended.n_iterations,
        ..ended
    }
}
