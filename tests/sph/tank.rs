//! Water at rest in a tank of wall particles.

use riprap_sph::boundary::wall_particles::{Slip, WallParticles};
use riprap_sph::state_equation::State;
use riprap_sph::{
    Dimensions, Fluid, NegativePressure, Precision, Scheme, Settings, Start, StateEquation, Vec3,
};

/// A plane tank of unit width, `length` by `depth`, with lattice walls three layers thick.
pub struct Tank {
    pub length: f64,
    pub depth: f64,
    pub spacing: f64,
    pub ratio: f64,
    pub scheme: Scheme,
    pub sound_speed: f64,
    pub time_step_factor: f64,
}

pub struct Filled {
    pub fluid: Fluid,
    pub walls: WallParticles,
}

impl Tank {
    pub fn fill(&self) -> Filled {
        let dp = self.spacing;
        let settings = Settings {
            particle_spacing: [dp, 1.0, dp],
            smoothing_length: self.ratio * dp,
            reference_density: 1000.0,
            sound_speed: self.sound_speed,
            scheme: self.scheme,
            dimensions: Dimensions::Two { width: 1.0 },
            gravity: Vec3::new(0.0, 0.0, -9.81),
            time_step_factor: self.time_step_factor,
            domain: (Vec3::zeros(), Vec3::new(self.length, 1.0, 1.5 * self.depth)),
            periodic: [false; 3],
        };
        let state = State {
            equation: self.scheme.state_equation,
            reference_density: 1000.0,
            sound_speed: self.sound_speed,
            negative: NegativePressure::Kept,
        };
        let n = [self.length, self.depth].map(|l| (l / dp).round() as i32);
        let layers = (2.0 * self.ratio).ceil() as i32;
        let mut start = Start::default();
        let mut walls = Vec::new();
        for k in -layers..(1.5 * f64::from(n[1])) as i32 {
            for i in -layers..n[0] + layers {
                let x = Vec3::new((f64::from(i) + 0.5) * dp, 0.5, (f64::from(k) + 0.5) * dp);
                if k < 0 || i < 0 || n[0] <= i {
                    walls.push(x);
                } else if k < n[1] {
                    start
                        .pressures
                        .push(state.hydrostatic_pressure(9.81, self.depth - x.z));
                    start.positions.push(x);
                    start.velocities.push(Vec3::zeros());
                }
            }
        }
        let mut fluid = Fluid::new(start, settings).unwrap();
        fluid.refresh();
        let mut set = WallParticles::new(&fluid, vec![dp * dp; walls.len()], Slip::Free);
        set.place(|w| [walls[w], Vec3::zeros(), Vec3::zeros()]);
        let mut filled = Filled { fluid, walls: set };
        filled.evaluate();
        filled
    }
}

impl Filled {
    fn evaluate(&mut self) {
        self.fluid.refresh();
        self.walls.find_wet(&self.fluid);
        self.fluid.update_pressure().unwrap();
        self.walls.extrapolate(&self.fluid, 1.0);
        self.fluid.update_accelerations();
        self.walls.add_forces(&mut self.fluid);
    }

    pub fn step(&mut self, dt: f64) {
        self.fluid.kick(0.5 * dt);
        self.fluid.drift(0.5 * dt);
        self.fluid.refresh();
        self.walls.find_wet(&self.fluid);
        self.fluid.update_rates();
        self.walls.add_rates(&mut self.fluid);
        self.fluid.advance_density(dt);
        self.fluid.drift(0.5 * dt);
        self.evaluate();
        self.fluid.kick(0.5 * dt);
    }
}

#[test]
fn still_water_stays_still() {
    for (ratio, alpha, dp) in [
        (1.3, 0.02, 0.02),
        (1.3, 0.05, 0.02),
        (1.3, 0.1, 0.02),
        (1.5, 0.05, 0.02),
        (2.0, 0.02, 0.02),
    ] {
        let tank = Tank {
            length: 1.0,
            depth: 0.5,
            spacing: dp,
            ratio,
            scheme: Scheme {
                viscosity: riprap_sph::scheme::Viscosity::Artificial { alpha },
                ..Scheme::standard()
            },
            sound_speed: 10.0 * (9.81_f64 * 0.5).sqrt(),
            time_step_factor: 0.5,
        };
        let mut filled = tank.fill();
        let mut t = 0.0;
        for n in 0..4001 {
            let dt = filled.fluid.step_limits().smallest();
            filled.step(dt);
            t += dt;
            if n % 500 == 0 {
                let p = filled.fluid.particles();
                let (mut e, mut v) = (0.0, 0.0);
                let mut low = f64::INFINITY;
                let mut vmax: f64 = 0.0;
                for k in 0..p.len() {
                    let z = 0.5 - p.position[k].z;
                    e += (p.pressure[k] - 9810.0 * z).powi(2);
                    v += p.velocity[k].norm_squared();
                    vmax = vmax.max(p.velocity[k].norm());
                    low = f64::min(
                        low,
                        p.position[k]
                            .z
                            .min(p.position[k].x)
                            .min(1.0 - p.position[k].x),
                    );
                }
                let n_p = p.len() as f64;
                println!(
                    "ratio {ratio} alpha {alpha} t {t:.2}: rms p {:.4} of rho g H, rms v {:.4}, vmax {vmax:.3} lowest {:.3} dp",
                    (e / n_p).sqrt() / 4905.0,
                    (v / n_p).sqrt(),
                    low / dp
                );
            }
        }
    }
}
