//! Wave makers: pistons that compute their motion from the waves asked for and the depth of the water before them.

use std::f64::consts::PI;

use riprap_dda::{Motion, PrescribedMotion, Shape, Vec3};

use super::error::Problem;
use super::file::{MotionFile, RegionShapeFile, SceneFile, SpectrumFile, WavesFile, vec3};
use super::fill::depth_at;
use super::resolved::FluidScene;
use crate::messages::Code;
use crate::waves::irregular::{Spectrum, Waves};
use crate::waves::regular::Regular;
use crate::waves::solitary::Solitary;
use crate::waves::theory::{Piston, Theory};
use crate::waves::{StillWater, Stroke};

/// Distance before a piston at which the depth is measured; × its size.
const BEFORE: f64 = 1e-3;
/// Distance within which water stands before a piston; × spacing.
const WET: f64 = 3.0;
/// Smooth start of waves with a period; × period.
const RAMP: f64 = 1.0;
/// Largest speed of a piston over that of sound.
const MACH: f64 = 0.1;
/// Share of the peak frequency up to which the waves of a group have to arrive at its focus in time.
const FASTEST_IN_GROUP: f64 = 2.0;

/// A piston and its waves.
#[derive(Clone, Debug)]
pub struct WaveMaker {
    /// Number of the block.
    pub block: usize,
    /// Unit vector into the water.
    pub direction: Vec3,
    /// Waves as written.
    pub waves: WavesFile,
    /// The same in theory, in the still water before the piston.
    pub piston: Piston,
    /// Whether it takes out waves that come back.
    pub absorbs: bool,
    /// Elevation of the still water before it, where it is found; m.
    level: Option<f64>,
    /// Motion along the direction.
    pub stroke: Stroke,
    /// Place before it at the start, at its middle height; m.
    pub front: Vec3,
    /// Half of its extent across; m.
    pub half_width: f64,
}

/// Wave maker of the block `index`, if its motion is one.
///
/// # Errors
///
/// A [`Problem`] where the depth of the water before the piston is not found.
pub(super) fn wave_maker(
    file: &SceneFile,
    index: usize,
    solids: &[(String, Shape)],
) -> Result<Option<WaveMaker>, Problem> {
    let MotionFile::Waves {
        direction,
        waves,
        depth,
        ramp,
        absorb,
    } = &file.blocks[index].motion
    else {
        return Ok(None);
    };
    let path = format!("blocks[{index}].motion");
    let name = &file.blocks[index].name;
    let direction = vec3(*direction).try_normalize(0.0).ok_or_else(|| {
        Problem::error(
            Code::UnusableDirection,
            format!("{path}.direction"),
            "the motion has no direction",
        )
    })?;
    let found = water_before(file, solids, (index, &direction));
    let depth = (depth.or(found.map(|(depth, _)| depth))).ok_or_else(|| {
        Problem::error(
            Code::PaddleWithoutWater,
            format!("{path}.direction"),
            no_water(name),
        )
    })?;
    let water = StillWater {
        depth,
        gravity: vec3(file.gravity).norm(),
    };
    let piston = piston(waves, water, (file.time.duration, *ramp));
    Ok(Some(WaveMaker {
        block: index,
        direction,
        waves: waves.clone(),
        stroke: piston.stroke(),
        piston,
        absorbs: *absorb,
        level: found.map(|(_, level)| level),
        front: front(solids, (index, &direction)).unwrap_or_default(),
        half_width: half_width(solids, (index, &direction)).unwrap_or_default(),
    }))
}

fn no_water(name: &str) -> String {
    format!(
        "block `{name}`: no water stands before it along its direction; turn the direction, or let a region of water end \
         at it"
    )
}

/// Half of the horizontal extent of a block across a direction; m.
fn half_width(solids: &[(String, Shape)], (index, direction): (usize, &Vec3)) -> Option<f64> {
    let (min, max) = solids.get(index)?.1.aabb();
    let across = Vec3::z().cross(direction).abs();
    Some(0.5 * (max - min).dot(&across))
}

/// Place before a block; m.
fn front(solids: &[(String, Shape)], (index, direction): (usize, &Vec3)) -> Option<Vec3> {
    let (min, max) = solids.get(index)?.1.aabb();
    let half = 0.5 * (max - min);
    let reach = half.dot(&direction.abs()) + BEFORE * half.norm();
    Some(0.5 * (min + max) + reach * direction)
}

/// Depth and level of the water in front of a block, the deepest where regions meet; m.
fn water_before(
    file: &SceneFile,
    solids: &[(String, Shape)],
    (index, direction): (usize, &Vec3),
) -> Option<(f64, f64)> {
    let place = front(solids, (index, direction))?;
    let regions = file.fluid.iter().flat_map(|fluid| &fluid.regions);
    let water_in = |shape: &RegionShapeFile| match *shape {
        RegionShapeFile::Box { min, max } => {
            let (low, high) = (vec3(min), vec3(max));
            let is_inside = low.x <= place.x && place.x <= high.x;
            let is_inside = is_inside && low.y <= place.y && place.y <= high.y;
            is_inside.then_some((high.z - low.z, high.z))
        }
        RegionShapeFile::Below { level, .. } => {
            let depth = depth_at(solids, [place.x, place.y], (file.domain.min.2, level))?;
            Some((depth, level))
        }
    };
    let found = regions.filter_map(|region| water_in(&region.shape));
    found
        .filter(|(depth, _)| 0.0 < *depth)
        .reduce(|a, b| if a.0 < b.0 { b } else { a })
}

fn piston(waves: &WavesFile, water: StillWater, (duration, ramp): (f64, Option<f64>)) -> Piston {
    let theory = match *waves {
        WavesFile::Regular { height, period } => {
            Theory::Regular(Regular::new(water, height, period))
        }
        WavesFile::Solitary { height } => Theory::Solitary(Solitary::new(water, height)),
        WavesFile::Irregular {
            spectrum,
            height,
            period,
            seed,
        } => Theory::Sum(Waves::irregular(
            water,
            (spectrum.into(), height, period),
            (duration, seed),
        )),
        WavesFile::Focused {
            spectrum,
            amplitude,
            period,
            distance,
            time,
        } => Theory::Sum(Waves::focused(
            water,
            (spectrum.into(), amplitude, period),
            (distance, time),
        )),
        WavesFile::Still { period } => Theory::Still(period),
    };
    Piston {
        water,
        ramp: ramp.unwrap_or(RAMP * theory.period()),
        theory,
        duration,
    }
}

impl From<SpectrumFile> for Spectrum {
    fn from(file: SpectrumFile) -> Self {
        match file {
            SpectrumFile::Jonswap(enhancement) => Self::Jonswap(enhancement),
            SpectrumFile::PiersonMoskowitz => Self::PiersonMoskowitz,
        }
    }
}

/// Scales of the waves of a wave maker.
struct Scales {
    /// Largest height expected; m.
    height: f64,
    /// m.
    length: f64,
    /// m.
    breaking: f64,
    /// Authors of the limit.
    limit: &'static str,
}

impl WaveMaker {
    /// Motion of the block.
    pub(super) fn motion(&self) -> Motion {
        let displacement = self
            .stroke
            .place
            .iter()
            .map(|place| self.direction * *place);
        Motion::Prescribed(PrescribedMotion::Table {
            time: self.stroke.time.clone(),
            displacement: displacement.collect(),
            turning: Vec::new(),
        })
    }

    /// Elevation of the surface at a place in theory, `None` behind the piston or where no level is known; m.
    pub fn elevation(&self, [x, y]: [f64; 2], time: f64) -> Option<f64> {
        let away = Vec3::new(x - self.front.x, y - self.front.y, 0.0);
        let distance = away.dot(&self.direction);
        let level = self.level.filter(|_| 0.0 < distance)?;
        Some(level + self.piston.surface(distance, time))
    }

    /// Whether it makes waves.
    pub fn makes_waves(&self) -> bool {
        !matches!(self.waves, WavesFile::Still { .. })
    }

    /// Length of its waves; m.
    pub(super) fn wave_length(&self) -> f64 {
        self.scales().length
    }

    fn scales(&self) -> Scales {
        let water = self.piston.water;
        let of_period = |height: f64, period: f64| {
            let wave_number = water.wave_number(2.0 * PI / period);
            Scales {
                height,
                length: 2.0 * PI / wave_number,
                breaking: water.breaking_height(wave_number),
                limit: "Miche (1944)",
            }
        };
        match self.waves {
            WavesFile::Regular { height, period } => of_period(height, period),
            WavesFile::Solitary { height } => Scales {
                height,
                length: Solitary::new(water, height).length(),
                breaking: water.solitary_breaking_height(),
                limit: "McCowan (1894)",
            },
            WavesFile::Irregular { height, period, .. } => {
                // the highest of n waves whose heights follow Rayleigh
                let n = self.stroke.time.last().map_or(1.0, |end| end / period);
                let highest = (0.5 * n.max(2.0).ln()).sqrt().max(1.0);
                of_period(height * highest, period)
            }
            WavesFile::Focused {
                amplitude, period, ..
            } => of_period(2.0 * amplitude, period),
            WavesFile::Still { period } => of_period(0.0, period),
        }
    }

    /// Waves, piston and their scales in a line.
    pub fn description(&self, spacing: Option<f64>) -> String {
        let StillWater { depth, .. } = self.piston.water;
        let Scales { height, length, .. } = self.scales();
        let (kind, more) = match &self.waves {
            WavesFile::Regular { height, period } => {
                let found = Regular::new(self.piston.water, *height, *period);
                let share = found.ursell_share(self.piston.water);
                (
                    format!("regular waves, height {height} m, period {period} s"),
                    format!(
                        ", second harmonic {:.1e} m, H L2/h3 at {:.0} % of Madsen's limit",
                        2.0 * found.second.abs(),
                        100.0 * share
                    ),
                )
            }
            WavesFile::Solitary { height } => (
                format!("solitary wave, height {height} m"),
                format!(
                    ", celerity {:.4} m/s",
                    Solitary::new(self.piston.water, *height).celerity
                ),
            ),
            WavesFile::Irregular { height, period, .. } => (
                format!("irregular waves, significant height {height} m, peak period {period} s"),
                String::new(),
            ),
            WavesFile::Focused {
                amplitude,
                distance,
                time,
                ..
            } => (
                format!("group of waves, {amplitude} m high {distance} m before it at {time} s"),
                String::new(),
            ),
            WavesFile::Still { period } => {
                return format!(
                    "no waves, absorbs those that come, best of a period of {period} s: length {length:.4} m on {depth:.4} m"
                );
            }
        };
        let absorbs = match self.absorbs {
            true => ", absorbs what comes back",
            false => "",
        };
        let rows = spacing.map_or(String::new(), |spacing| {
            format!(", {:.1} spacings", height / spacing)
        });
        format!(
            "{kind}, on {depth:.4} m: length {length:.4} m, kh {:.3}, highest {height:.4} m{rows}, H/h {:.3}, H/L {:.4}; \
             stroke {:.4} m, at most {:.3} m/s{more}{absorbs}",
            2.0 * PI * depth / length,
            height / depth,
            height / length,
            self.stroke.length(),
            self.stroke.largest_speed(),
        )
    }

    /// Error where no water stands before the piston; warnings about waves that break, a piston that is too fast for the
    /// speed of sound, and one that leaves the domain.
    pub(super) fn problems(
        &self,
        file: &SceneFile,
        (name, shape): &(String, Shape),
        fluid: &FluidScene,
    ) -> Vec<Problem> {
        let path = |field: &str| format!("blocks[{}].motion{field}", self.block);
        let mut problems = Vec::new();
        if !self.is_wet(fluid) {
            problems.push(Problem::error(
                Code::PaddleWithoutWater,
                path(".direction"),
                no_water(name),
            ));
        }
        let scales = self.scales();
        if scales.breaking < scales.height {
            problems.push(Problem::warning(
                Code::BreakingWaves,
                path(".waves"),
                format!(
                    "block `{name}`: waves of {:.4} m break on {:.4} m of water, by {} above {:.4} m; ask for lower or \
                     longer ones",
                    scales.height, self.piston.water.depth, scales.limit, scales.breaking
                ),
            ));
        }
        if let WavesFile::Regular { height, period } = self.waves {
            let share =
                Regular::new(self.piston.water, height, period).ursell_share(self.piston.water);
            if 1.0 < share {
                problems.push(Problem::warning(
                    Code::SecondCrest,
                    path(".waves"),
                    format!(
                        "block `{name}`: waves of {height} m and {period} s are too long for second order on {:.4} m, \
                         {share:.1} times H L2/h3 = 26.3: a second crest will travel behind each; ask for lower or shorter \
                         ones",
                        self.piston.water.depth
                    ),
                ));
            }
        }
        problems.extend(self.late(name));
        let fastest = self.stroke.largest_speed();
        let sound = fluid.settings.sound_speed;
        if MACH * sound < fastest {
            problems.push(Problem::warning(
                Code::LowSoundSpeed,
                path(".waves"),
                format!(
                    "block `{name}`: the piston moves at {fastest:.3} m/s, more than a tenth of the speed of sound of \
                     {sound:.3} m/s; let numerics.sound_speed be {:.1} or more",
                    fastest / MACH
                ),
            ));
        }
        let (low, high) = self.stroke.range();
        let (min, max) = shape.aabb();
        let (bottom, top) = (vec3(file.domain.min), vec3(file.domain.max));
        for (place, way) in [(low, "back"), (high, "forward")] {
            let by = self.direction * place;
            let out = (0..2).find(|&axis| {
                // a piston may be drawn across the border; it must not come to it
                let (a, b) = (min[axis] + by[axis], max[axis] + by[axis]);
                (bottom[axis] <= min[axis] && a < bottom[axis])
                    || (max[axis] <= top[axis] && top[axis] < b)
            });
            if let Some(axis) = out {
                problems.push(Problem::warning(
                    Code::StrokeLeavesDomain,
                    path(".waves"),
                    format!(
                        "block `{name}`: its stroke goes {:.4} m {way}, out of the domain; let domain.{} reach {:.4} m \
                         further along {}",
                        place.abs(),
                        if by[axis] < 0.0 { "min" } else { "max" },
                        by[axis].abs(),
                        ['x', 'y'][axis],
                    ),
                ));
            }
        }
        problems
    }

    /// Whether particles stand before the piston, within its reach across.
    fn is_wet(&self, fluid: &FluidScene) -> bool {
        let reach = WET * fluid.settings.mean_spacing();
        fluid.lattice.positions.iter().any(|x| {
            let away = Vec3::new(x.x - self.front.x, x.y - self.front.y, 0.0);
            let before = away.dot(&self.direction);
            // a flow in a plane has one row, which may be any width across
            0.0 < before
                && before < reach
                && (away - before * self.direction).norm() < reach + self.half_width
        })
    }

    /// A group whose short waves are too slow to be at the focus in time.
    fn late(&self, name: &str) -> Option<Problem> {
        let WavesFile::Focused {
            period,
            distance,
            time,
            ..
        } = self.waves
        else {
            return None;
        };
        let short = self
            .piston
            .water
            .wave_number(FASTEST_IN_GROUP * 2.0 * PI / period);
        let needed = distance / self.piston.water.group_speed(short);
        (time < needed).then(|| {
            Problem::warning(
                Code::FocusTooEarly,
                format!("blocks[{}].motion.waves.time", self.block),
                format!(
                    "block `{name}`: waves of half the period take {needed:.2} s to the focus, which is at {time} s: they \
                     come too late; let time be {needed:.2} or more"
                ),
            )
        })
    }
}
