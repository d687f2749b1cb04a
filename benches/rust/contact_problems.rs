//! Frictional contact problems from files, cold: iterations and time of each solver to residuals of 1e-4 and 1e-6.
//!
//! `cargo bench --bench contact_problems -- FILE ...`. A file has a comment, a line `contacts N blocks M`, N lines `mu b_n b_t1 b_t2` and M
//! lines `row column` with a block of 3 x 3, row by row, in components (n, t1, t2).
#![expect(clippy::print_stdout, reason = "a bench prints its figures")]

use std::time::Instant;

use nalgebra::Matrix3;
use riprap_dda::Vec3;
use riprap_dda::contact_dynamics::ContactProblem;
use riprap_dda::contact_dynamics::accuracy::Scaling;
use riprap_dda::contact_dynamics::delassus::BlockMatrix;
use riprap_dda::contact_dynamics::gauss_seidel::{Ended, GaussSeidel, Order, Until};
use riprap_dda::contact_dynamics::{gradient, solver};

type Problem = ContactProblem<BlockMatrix>;

fn read(path: &str) -> Result<Problem, String> {
    let text = std::fs::read_to_string(path).map_err(|error| format!("{path}: {error}"))?;
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    let header = lines.next().ok_or("empty")?;
    let counts: Vec<usize> = header
        .split_whitespace()
        .filter_map(|word| word.parse().ok())
        .collect();
    let &[n, n_blocks] = counts.as_slice() else {
        return Err(format!(
            "{path}: `contacts N blocks M` expected, found `{header}`"
        ));
    };
    let mut numbers = || -> Result<Vec<f64>, String> {
        let line = lines.next().ok_or_else(|| format!("{path} ends early"))?;
        line.split_whitespace()
            .map(|word| {
                word.parse()
                    .map_err(|_| format!("{path}: `{word}` is not a number"))
            })
            .collect()
    };
    let (mut friction, mut free_velocity, mut blocks) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..n {
        let row = numbers()?;
        let &[mu, b_n, b_1, b_2] = row.as_slice() else {
            return Err(format!(
                "{path}: four numbers expected, found {}",
                row.len()
            ));
        };
        friction.push(mu);
        free_velocity.push(Vec3::new(b_n, b_1, b_2));
    }
    for _ in 0..n_blocks {
        let row = numbers()?;
        let [row_number, column, block @ ..] = row.as_slice() else {
            return Err(format!("{path}: a block expected"));
        };
        if block.len() != 9 {
            return Err(format!(
                "{path}: nine numbers expected, found {}",
                block.len()
            ));
        }
        blocks.push((
            *row_number as usize,
            *column as usize,
            Matrix3::from_row_slice(block),
        ));
    }
    let operator = BlockMatrix::new(n, blocks)
        .ok_or_else(|| format!("{path}: a block beyond the contacts"))?;
    Ok(ContactProblem {
        rolling: Vec::new(),
        operator,
        free_velocity,
        friction,
        joints: Vec::new(),
    })
}

fn measured(problem: &Problem, solve: impl Fn(&mut [Vec3], Until) -> Ended) -> String {
    let cells = [1e-4, 1e-6].map(|tolerance| {
        let until = Until {
            tolerance,
            scaling: Scaling::Unit,
            n_iterations: 20_000,
        };
        let mut impulses = vec![Vec3::zeros(); problem.len()];
        let begin = Instant::now();
        let ended = solve(&mut impulses, until);
        let time = 1e3 * begin.elapsed().as_secs_f64();
        match ended.residual <= tolerance {
            true => format!("{} ({time:.1} ms)", ended.n_iterations),
            false => format!("never ({:.0e}, {time:.0} ms)", ended.residual),
        }
    });
    cells.join(" / ")
}

fn main() -> Result<(), String> {
    println!(
        "| problem | contacts | fixed order | shuffled colors | gradient | chosen |\n|---|---|---|---|---|---|"
    );
    for path in std::env::args()
        .skip(1)
        .filter(|arg| !arg.starts_with("--"))
    {
        let problem = read(&path)?;
        let sweeps = |order: Order| {
            let problem = &problem;
            move |impulses: &mut [Vec3], until: Until| {
                GaussSeidel::new(&problem.operator, order).solve(problem, impulses, until)
            }
        };
        println!(
            "| {path} | {} | {} | {} | {} | {} |",
            problem.len(),
            measured(&problem, sweeps(Order::Fixed)),
            measured(&problem, sweeps(Order::Shuffled)),
            measured(&problem, |impulses, until| gradient::solve(
                &problem, impulses, until
            )),
            measured(&problem, |impulses, until| solver::solve(
                &problem, impulses, until
            )),
        );
    }
    Ok(())
}
