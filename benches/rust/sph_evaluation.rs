//! Speed of the water: a dam break column between walls, before it falls and while it falls.
//!
//! `cargo bench -p riprap-sph --bench sph_evaluation -- [SPACING ...]`, SPACING in meters: 0.0116
//! (50,000 particles) when left out, 0.0074 (200,000), 0.0043 (a million; 0.8 GB and some minutes).
//!
//! An evaluation is the density rates and the forces of all particles from fluid and walls at one
//! state. A step is kick-drift-kick, which needs as much. For each setting and number of threads there is a table
//! of the parts of an evaluation, with the share of each roof that they reach: bytes from memory, multiply-adds,
//! divisions and square roots, counted as `counts` says and measured as `roofs` does. The roof of the largest share
//! is the nearest; none binds that is far from 100 %. A line of all settings comes last; its pairs are those of
//! the fluid, each neighbor once per sum.

use std::time::Instant;

use rayon::ThreadPool;
use riprap_sph::{FluidError, Precision};

#[path = "sph_evaluation/counts.rs"]
mod counts;
#[path = "sph_evaluation/phases.rs"]
mod phases;
#[path = "sph_evaluation/roofs.rs"]
mod roofs;
#[path = "sph_evaluation/tank.rs"]
mod tank;

use counts::{Counts, Need, Needs};
use phases::{Beside, Seconds};
use roofs::Roofs;
use tank::{Tank, tank};

/// Numbers of threads, the first being the one that others are compared with.
const THREADS: [usize; 2] = [1, 2];
/// A tank of more particles is measured with fewer repetitions.
const MANY: f64 = 5e5;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let spacings: Vec<f64> = std::env::args()
        .skip(1)
        .filter_map(|a| a.parse().ok())
        .collect();
    let spacings = if spacings.is_empty() {
        vec![0.0116]
    } else {
        spacings
    };
    let mut crews = Vec::new();
    for threads in THREADS {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()?;
        let roofs = Roofs::measure(&pool);
        print_roofs(threads, &roofs);
        crews.push(Crew { pool, roofs });
    }
    let mut lines = Vec::new();
    for dp in spacings {
        for (ratio, precision) in [
            (1.3, Precision::Single),
            (1.3, Precision::Double),
            (3.0_f64.sqrt(), Precision::Single),
        ] {
            let setting = Setting {
                dp,
                ratio,
                precision,
            };
            let mut baseline = None;
            for crew in &crews {
                let found = crew.pool.install(|| Found::measure(setting))?;
                found.print_parts(crew);
                if lines.is_empty() {
                    // later tanks take the memory that this one leaves
                    found.print_resident();
                }
                let speed = found.evaluations_per_second();
                let scaling = speed / *baseline.get_or_insert(speed);
                let threads = crew.pool.current_num_threads();
                lines.push(format!("{} {threads:>7} x {scaling:.2}", found.line()));
            }
        }
    }
    print(&format!(
        "\n{:>9} {:>7} {:>6} {:>4} {:>7} {:>8} {:>9} {:>8} {:>9} {:>9} {:>9} {:>8} {:>7}",
        "particles",
        "walls",
        "h/dp",
        "sums",
        "neighb.",
        "rates ns",
        "forces ns",
        "walls ns",
        "evals/s",
        "pairs/s",
        "p.steps/s",
        "s per s",
        "threads"
    ));
    lines.iter().for_each(|line| print(line));
    if let Some(most) = memory("VmHWM") {
        print(&format!(
            "\nmost memory of the run: {:.0} MiB; the roofs take 384",
            most / MIB
        ));
    }
    Ok(())
}

#[expect(clippy::print_stdout, reason = "a benchmark prints")]
fn print(line: &str) {
    println!("{line}");
}

/// Threads, and what they can do at most.
struct Crew {
    pool: ThreadPool,
    roofs: Roofs,
}

fn print_roofs(threads: usize, roofs: &Roofs) {
    let giga = |x: f64| x / 1e9;
    print(&format!(
        "{threads} thread(s): memory {:.1} GB/s; multiply-adds {:.1} f32, {:.1} f64 G/s; divisions {:.2}, {:.2} G/s; \
         square roots {:.2}, {:.2} G/s",
        giga(roofs.bytes),
        giga(roofs.single.multiply_adds),
        giga(roofs.double.multiply_adds),
        giga(roofs.single.divisions),
        giga(roofs.double.divisions),
        giga(roofs.single.roots),
        giga(roofs.double.roots),
    ));
}

/// Measured configuration.
#[derive(Clone, Copy)]
struct Setting {
    dp: f64,
    /// Smoothing length over spacing.
    ratio: f64,
    precision: Precision,
}

/// Result of a measurement.
struct Found {
    setting: Setting,
    needs: Needs,
    /// Neighbors of all particles.
    neighbors: f64,
    seconds: Seconds,
    beside: Beside,
    /// Step and its time; s.
    dt: f64,
    step: f64,
    /// Steps timed, and those that sorted.
    steps: u32,
    sorts: u32,
    /// Of the fluid's arrays, its lists of neighbors and the walls' arrays, and as the system counts it; bytes.
    arrays: [f64; 3],
    resident: Option<f64>,
}

impl Found {
    fn measure(setting: Setting) -> Result<Self, FluidError> {
        let Setting {
            dp,
            ratio,
            precision,
        } = setting;
        let before = memory("VmRSS");
        let mut tank = tank(dp, ratio, precision)?;
        let is_large = MANY < tank.fluid.particles().len() as f64;
        let (rounds, steps) = if is_large { (2, 3) } else { (5, 10) };
        let seconds = tank.evaluation(rounds)?;
        let neighbors = tank.fluid.n_pairs() as f64;
        let resident = memory("VmRSS").zip(before).map(|(a, b)| a - b);
        let counts = Counts::of(&tank);
        let (dt, step, sorts) = falling(&mut tank, steps)?;
        // these want particles that move, and sort them
        let beside = tank.beside();
        let needs = Needs { precision, counts };
        let n_cells = tank.fluid.grid().n_cells();
        let lists = tank.fluid.list_memory() as f64;
        Ok(Self {
            arrays: [
                needs.fluid_memory(n_cells),
                lists,
                needs.wall_memory(n_cells),
            ],
            setting,
            needs,
            neighbors,
            seconds,
            beside,
            dt,
            step,
            steps,
            sorts,
            resident,
        })
    }

    fn particles(&self) -> f64 {
        self.needs.counts.particles
    }

    fn evaluations_per_second(&self) -> f64 {
        self.particles() / self.seconds.total()
    }

    /// Nanoseconds a particle.
    fn ns(&self, seconds: f64) -> f64 {
        1e9 * seconds / self.particles()
    }

    /// The parts of an evaluation, and what they reach of each roof.
    fn print_parts(&self, crew: &Crew) {
        let Setting {
            ratio, precision, ..
        } = self.setting;
        print(&format!(
            "\n{} particles, {} points of walls, h/dp {ratio:.3}, {precision:?}, {} thread(s)",
            self.particles(),
            self.needs.counts.points,
            crew.pool.current_num_threads(),
        ));
        print(&format!(
            "  {:<28} {:>8} {:>6}   {:>8} {:>9} {:>8} {:>9} {:>9}",
            "part", "ns", "%", "bytes", "operat.", "memory %", "mul-add %", "div+rt %"
        ));
        let (s, n) = (&self.seconds, &self.needs);
        self.part(crew, "rates", s.rates, Some(n.rates()));
        self.part(crew, "  ~ packing", s.pressure, None);
        self.part(crew, "  ~ sums", s.rates - s.pressure, None);
        self.part(crew, "pressure and packing", s.pressure, Some(n.pressure()));
        self.part(crew, "forces", s.forces, Some(n.forces()));
        self.part(crew, "walls: what is wet", s.finding, None);
        self.part(crew, "walls: rates", s.wall_rates, Some(n.wall_rates()));
        let extrapolation = Some(n.extrapolation());
        self.part(crew, "walls: extrapolation", s.extrapolation, extrapolation);
        self.part(crew, "walls: forces", s.wall_forces, Some(n.wall_forces()));
        let whole = n.rates()
            + n.pressure()
            + n.forces()
            + n.wall_rates()
            + n.extrapolation()
            + n.wall_forces();
        self.part(crew, "evaluation", s.total(), Some(whole));
        let b = &self.beside;
        self.part(crew, "beside: density", b.advancing, None);
        self.part(crew, "beside: kick", b.kick, None);
        self.part(crew, "beside: drift", b.drift, None);
        self.part(crew, "beside: sorting, when due", b.sorting, None);
        self.part(crew, "beside: listing, when due", b.listing, None);
        self.print_summary(crew, &whole);
    }

    fn part(&self, crew: &Crew, name: &str, seconds: f64, need: Option<Need>) {
        let percent = 100.0 * seconds / self.seconds.total();
        let reached = need.map_or(String::new(), |need| {
            let n = self.particles();
            let [memory, arithmetic, slow] = self.shares(crew, &need, seconds);
            format!(
                "{:>8.0} {:>9.0} {memory:>8.1} {arithmetic:>9.1} {slow:>9.1}",
                need.bytes / n,
                need.operations / n
            )
        });
        let line = format!(
            "  {name:<28} {:>8.1} {percent:>6.1}   {reached}",
            self.ns(seconds)
        );
        print(line.trim_end());
    }

    /// Utilization of memory, multiply-adds, and the unit of divisions and square roots; percent.
    fn shares(&self, crew: &Crew, need: &Need, seconds: f64) -> [f64; 3] {
        let peak = crew.roofs.arithmetic(self.setting.precision);
        [
            need.bytes / crew.roofs.bytes,
            need.operations / peak.multiply_adds,
            need.divisions / peak.divisions + need.roots / peak.roots,
        ]
        .map(|least| 100.0 * least / seconds)
    }

    fn print_summary(&self, crew: &Crew, whole: &Need) {
        let (c, n) = (&self.needs.counts, self.particles());
        let total = self.seconds.total();
        let shares = self.shares(crew, whole, total);
        let names = ["memory", "multiply-adds", "divisions and square roots"];
        let nearest = (0..3).fold(0, |a, b| if shares[a] < shares[b] { b } else { a });
        print(&format!(
            "  nearest roof: {}, {:.0} % reached",
            names[nearest], shares[nearest]
        ));
        let pairs = 2.0 * self.neighbors + 2.0 * c.from_walls.pairs + c.to_walls.pairs;
        print(&format!(
            "  {:.1} neighbors in lists of {:.1}; {pairs:.3e} pairs an evaluation with those of the walls, {:.3e} a second",
            self.neighbors / n,
            c.entries / n,
            pairs / total,
        ));
        let [fluid, lists, walls] = self.arrays.map(|bytes| bytes / n);
        print(&format!(
            "  bytes a particle: {fluid:.0} in the fluid's arrays, {lists:.0} in its lists, {walls:.0} in the walls'"
        ));
        print(&format!(
            "  sorted in {} of {} steps",
            self.sorts, self.steps
        ));
    }

    fn print_resident(&self) {
        if let Some(bytes) = self.resident {
            let each = bytes / self.particles();
            print(&format!(
                "  {each:.0} bytes a particle more in use than before, as the system counts it"
            ));
        }
    }

    /// The line of the last table.
    fn line(&self) -> String {
        let (n, s) = (self.particles(), &self.seconds);
        format!(
            "{n:>9} {:>7} {:>6.3} {:>4} {:>7.1} {:>8.0} {:>9.0} {:>8.0} {:>9.3e} {:>9.3e} {:>9.3e} {:>8.0}",
            self.needs.counts.points,
            self.setting.ratio,
            match self.setting.precision {
                Precision::Single => "f32",
                Precision::Double => "f64",
            },
            self.neighbors / n,
            self.ns(s.rates),
            self.ns(s.pressure + s.forces),
            self.ns(s.walls()),
            self.evaluations_per_second(),
            2.0 * self.neighbors / s.total(),
            n / self.step,
            self.step / self.dt,
        )
    }
}

/// Step, its time while the column falls, after as many to warm up, and how many of those timed sorted; s.
fn falling(tank: &mut Tank, steps: u32) -> Result<(f64, f64, u32), FluidError> {
    let dt = tank.fluid.step_limits().smallest();
    for _ in 0..steps {
        tank.step(dt)?;
    }
    let start = Instant::now();
    let mut sorts = 0;
    for _ in 0..steps {
        sorts += u32::from(tank.step(dt)?);
    }
    Ok((dt, start.elapsed().as_secs_f64() / f64::from(steps), sorts))
}

const MIB: f64 = 1024.0 * 1024.0;

/// Memory of this process, where the system says so; bytes.
fn memory(which: &str) -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with(which))?;
    let kib: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kib * 1024.0)
}
