//! Shared setup of the pile benchmarks: bodies on a grid that fall into a bin, and the time of their steps.

use std::time::{Duration, Instant};

use riprap_dda::{
    BlockDefinition, Blocks, ContactDynamics, Integrator, Material, Motion, Phase, Polyhedron,
    Random, Settings, Shape, StepBound, Vec3,
};

pub type Failure = Box<dyn std::error::Error>;

/// Bodies in a bin.
pub struct Pile {
    /// Bodies along an edge of the grid.
    pub side: usize,
    /// Distance of the bodies at the start; m.
    pub pitch: f64,
    /// N/m.
    pub contact_stiffness: f64,
    pub shear_stiffness_ratio: f64,
}

/// About how many bodies the command line asks for.
pub fn wanted() -> Option<f64> {
    std::env::args()
        .skip(1)
        .find_map(|argument| argument.parse::<f64>().ok())
}

/// Bound of the step that the command line asks for.
fn step_bound() -> StepBound {
    if std::env::args().any(|argument| argument == "eigenvalues") {
        StepBound::Eigenvalues
    } else {
        StepBound::Compliances
    }
}

fn is_dynamics() -> bool {
    std::env::args().any(|argument| argument == "dynamics")
}

/// Step of contact dynamics if the command line asks for it, else the longest one within the bound; s.
fn step_of(blocks: &Blocks) -> f64 {
    match is_dynamics() {
        true => 5e-3,
        false => blocks.critical_time_step().dt,
    }
}

/// In the cube of side 2 about the origin; m.
pub fn vector(random: &mut Random) -> Vec3 {
    Vec3::new(random.uniform(), random.uniform(), random.uniform()) * 2.0 - Vec3::repeat(1.0)
}

impl Pile {
    /// The bin and in it what `body` makes around each point of the grid.
    pub fn build(
        &self,
        body: impl Fn(Vec3, &mut Random) -> Result<Shape, Failure>,
    ) -> Result<Blocks, Failure> {
        let rock = Material {
            density: 2600.0,
            friction_angle: 0.5_f64.atan(),
            residual_friction_angle: None,
            cohesion: 0.0,
            residual_cohesion: 0.0,
            tensile_strength: 0.0,
            restitution: 0.3,
            contact_stiffness: self.contact_stiffness,
            joint_stiffness: None,
            shear_stiffness_ratio: self.shear_stiffness_ratio,
            shear_damping_ratio: 0.2,
            rolling_friction: 0.0,
            twisting_friction: 0.0,
            elastic: None,
        };
        let mut random = Random::new(1);
        let width = self.pitch * self.side as f64;
        let far = width + 2.0;
        let mut definitions = Vec::new();
        let mut push = |shape, motion| {
            definitions.push(BlockDefinition {
                shape,
                material: 0,
                motion,
                velocity: Vec3::zeros(),
                angular_velocity: Vec3::zeros(),
                deformability: None,
            });
        };
        for (from, to) in [
            ([-2.0, -2.0, -2.0], [far, far, 0.0]),
            ([-2.0, -2.0, 0.0], [0.0, far, far]),
            ([width, -2.0, 0.0], [far, far, far]),
            ([-2.0, -2.0, 0.0], [far, 0.0, far]),
            ([-2.0, width, 0.0], [far, far, far]),
        ] {
            let wall = Polyhedron::cuboid(from.into(), to.into())?;
            push(Shape::Polyhedra(vec![wall]), Motion::Fixed);
        }
        let side = self.side;
        for k in 0..side * side * side {
            let place = [k % side, k / side % side, k / side / side].map(|i| i as f64);
            let center = Vec3::from(place).add_scalar(0.5) * self.pitch;
            push(body(center, &mut random)?, Motion::Free);
        }
        let settings = Settings {
            integrator: match is_dynamics() {
                true => Integrator::ContactDynamics(ContactDynamics::default()),
                false => Integrator::CentralDifference,
            },
            step_bound: step_bound(),
            ..Settings::default()
        };
        Ok(Blocks::new(definitions, vec![rock], settings)?)
    }
}

/// Steps until `duration` (s) has passed; reports the error of the ledger.
pub fn settle(blocks: &mut Blocks, duration: f64) -> Result<(), Failure> {
    let mut time = 0.0;
    let before = blocks.energies().balance();
    while time < duration {
        let dt = step_of(blocks);
        blocks.advance(time, dt, 1)?;
        time += dt;
    }
    let energies = blocks.energies();
    let lost = energies.friction + energies.damping;
    let error = (energies.balance() - before) / lost;
    println!("settled: ledger {error:+.1e} of what is lost");
    Ok(())
}

/// Steps on a number of threads, timed.
struct Timing {
    threads: usize,
    /// Of a step, median of five rounds; s.
    step: f64,
    /// The last; s.
    dt: f64,
    /// Pairs that touch, and full separating-axis tests, in a step.
    pairs: f64,
    searches: f64,
    /// Mean over all steps, by phase.
    phases: [Duration; 5],
}

/// In the order of `Phase`, and what no phase of a step is.
const NAMES: [&str; 5] = ["motion", "broad phase", "contacts", "sums", "step bound"];

/// Times five rounds of `steps` steps on one thread and on all, and says what they took.
pub fn report(blocks: &mut Blocks, what: &str, steps: u32) -> Result<(), Failure> {
    let mut baseline = None;
    for threads in [1, rayon::current_num_threads()] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()?;
        let timing = pool
            .install(|| Timing::on_this_pool(blocks, steps, threads).map_err(|e| e.to_string()))?;
        let ratio = *baseline.get_or_insert(timing.step) / timing.step;
        println!("{what}, {timing}, x {ratio:.2}");
        println!("    {}", timing.by_phase());
        if is_dynamics() {
            println!(
                "    last step: {:?}, {} steps unsolved so far",
                blocks.contact_solution(),
                blocks.solved_steps().n_unsolved
            );
        }
    }
    Ok(())
}

impl std::fmt::Display for Timing {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{} threads: {:.3} ms a step of {:.2e} s, {:.1} s a simulated second, {:.1} steps/s, {:.0} touching pairs, {:.0} ns per pair and step, \
             {:.3e} contact updates/s, {:.1} axis searches a step",
            self.threads,
            1e3 * self.step,
            self.dt,
            self.step / self.dt,
            1.0 / self.step,
            self.pairs,
            1e9 * self.step / self.pairs,
            self.pairs / self.step,
            self.searches,
        )
    }
}

impl Timing {
    fn on_this_pool(blocks: &mut Blocks, steps: u32, threads: usize) -> Result<Self, Failure> {
        let mut rounds = Vec::new();
        let mut phases = [Duration::ZERO; 5];
        let mut dt = 0.0;
        let before = (blocks.contact_updates(), blocks.axis_searches());
        for _ in 0..5 {
            let start = Instant::now();
            let mut last = start;
            let mut book = |place: usize| {
                let now = Instant::now();
                phases[place] += now - last;
                last = now;
            };
            for _ in 0..steps {
                dt = step_of(blocks);
                book(4);
                blocks.advance_watched(0.0, dt, 1, &mut |phase| {
                    book(match phase {
                        Phase::Motion => 0,
                        Phase::BroadPhase => 1,
                        Phase::Contacts => 2,
                        Phase::Sums => 3,
                    });
                })?;
            }
            rounds.push(start.elapsed().as_secs_f64() / f64::from(steps));
        }
        rounds.sort_by(f64::total_cmp);
        let updates = (blocks.contact_updates() - before.0) as f64;
        Ok(Self {
            threads,
            step: rounds[2],
            dt,
            pairs: updates / f64::from(5 * steps),
            searches: (blocks.axis_searches() - before.1) as f64 / f64::from(5 * steps),
            phases: phases.map(|time| time / (5 * steps)),
        })
    }

    /// Milliseconds a step, and shares.
    fn by_phase(&self) -> String {
        let total: Duration = self.phases.iter().sum();
        let of = |(name, time): (&str, &Duration)| {
            format!(
                "{name} {:.3} ({:.0} %)",
                1e3 * time.as_secs_f64(),
                100.0 * time.as_secs_f64() / total.as_secs_f64()
            )
        };
        let rows: Vec<String> = NAMES.into_iter().zip(&self.phases).map(of).collect();
        format!("ms a step: {}", rows.join(", "))
    }
}
