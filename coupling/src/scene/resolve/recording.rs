//! Records: blocks by number, intervals chosen where the file has none.

use riprap_sph::Dimensions;

use super::barriers::fits;
use crate::messages::Code;
use crate::scene::error::Problem;
use crate::scene::file::{
    BlockFile, BoxFile, FramesFile, GaugeFile, HandoffLineFile, HandoffTimesFile, MapsFile,
    MotionFile, OutputFile, SceneFile, TableFormatFile, WaterField, vec3,
};
use crate::scene::names::Names;
use crate::scene::parse::suggestion;
use crate::scene::resolved::FluidScene;
use crate::scene::resolved::recording::{
    BlockTable, Gauge, Handoff, HandoffTimes, Maps, NOTICED_RISE, Output, PlanLine, PressureGauge,
    Quantity, Sampling, TableFormat, TrackedMass, Tracking,
};

/// Number of frames in a run.
const FRAMES: f64 = 50.0;
/// Number of rows of the gauges in a run.
const GAUGE_ROWS: f64 = 500.0;
/// Samples of a falling block in a run: at 20 s one per 0.02 s, which misses 0.5 mm of the top of a bounce.
const TRAJECTORY_SAMPLES: f64 = 1000.0;
/// Spacing of the points of maps, which resolves every wave that the water resolves; × particle spacing.
const MAP_SPACING: f64 = 2.0;
/// Side of the cells of a hand-off; × particle spacing.
pub(crate) const HANDOFF_CELL: f64 = 2.0;
/// Samples of the water for maps in a run.
const MAP_SAMPLES: f64 = 200.0;

/// Files and intervals.
pub(super) fn output(file: &OutputFile, duration: f64, fluid: Option<&FluidScene>) -> Output {
    let gauge_interval = file.gauge_interval.unwrap_or(duration / GAUGE_ROWS);
    let chosen_fields = || {
        let mut fields = vec![
            WaterField::Velocity,
            WaterField::Density,
            WaterField::Pressure,
            WaterField::Id,
        ];
        if fluid.is_some_and(|fluid| !fluid.rheologies.is_empty()) {
            fields.extend([WaterField::Viscosity, WaterField::Yielded]);
        }
        if fluid.is_some_and(|fluid| fluid.averaged.is_some()) {
            fields.push(WaterField::Porosity);
        }
        fields
    };
    let frame_interval = file.frame_interval.unwrap_or(duration / FRAMES);
    let sampling = |interval: Option<f64>, within: Option<BoxFile>| Sampling {
        within: within.map(|corners| [vec3(corners.min), vec3(corners.max)]),
        ..Sampling::every(interval.unwrap_or(frame_interval))
    };
    let of = |frames: &FramesFile| sampling(frames.interval, frames.r#box);
    Output {
        frame_interval,
        water: Sampling {
            stride: file.water.stride.unwrap_or(1),
            ..sampling(file.water.interval, file.water.r#box)
        },
        blocks: of(&file.blocks),
        contact_frames: of(&file.contact_frames),
        face_frames: of(&file.face_frames),
        gauge_interval,
        ledger_interval: file.ledger_interval.unwrap_or(gauge_interval),
        water_fields: file.water_fields.clone().unwrap_or_else(chosen_fields),
        block_fields: file.block_fields.clone(),
        contacts: file.contacts,
        face_pressures: file.face_pressures,
    }
}

/// Table of the motion of blocks, with these by number.
pub(super) fn block_table(file: &SceneFile, output: &Output) -> BlockTable {
    let asked = &file.output.block_table;
    let is_asked = |block: &BlockFile| {
        asked.blocks.is_empty() || asked.blocks.iter().any(|name| fits(block, name))
    };
    let blocks = file.blocks.iter().enumerate();
    let moving = blocks.filter(|(_, block)| block.motion != MotionFile::Fixed && is_asked(block));
    BlockTable {
        blocks: moving.map(|(number, _)| number).collect(),
        interval: asked.interval.unwrap_or(output.ledger_interval),
        format: match asked.format {
            TableFormatFile::Csv => TableFormat::Csv,
            TableFormatFile::Npy => TableFormat::Npy,
        },
    }
}

/// Names in the table of the motion of blocks that no block has, or only fixed ones.
pub(super) fn unusable_rows(file: &SceneFile) -> Vec<Problem> {
    let all = || file.blocks.iter().map(|block| block.name.as_str());
    let names = file.output.block_table.blocks.iter().enumerate();
    let problem = |(k, name): (usize, &String)| {
        let members = || file.blocks.iter().filter(|block| fits(block, name));
        let path = format!("output.block_table.blocks[{k}]");
        if members().next().is_none() {
            let names: Vec<&str> = all().collect();
            let near = suggestion(name.trim_end_matches('*'), &names);
            let what = format!("table of blocks: no block is called `{name}`{near}");
            return Some(Problem::error(Code::UnknownName, path, what));
        }
        members().all(|block| block.motion == MotionFile::Fixed).then(|| {
            let what = format!(
                "table of blocks: `{name}` is fixed; it has rows of blocks that can move, fixed ones are in bodies.csv"
            );
            Problem::error(Code::IncompatibleOptions, path, what)
        })
    };
    names.filter_map(problem).collect()
}

/// Instruments, with their blocks by number.
pub(super) fn gauges(file: &SceneFile, names: &Names) -> Vec<Gauge> {
    let line = |from: (f64, f64), to: (f64, f64)| PlanLine {
        from: [from.0, from.1],
        to: [to.0, to.1],
    };
    let gauge = |gauge: &GaugeFile| {
        let (name, quantity) = match gauge {
            GaugeFile::SurfaceElevation { name, x, y } => {
                (name, Quantity::SurfaceElevation { x: *x, y: *y })
            }
            GaugeFile::Pressure {
                name,
                position,
                diameter,
                averaging_time,
            } => {
                let gauge = PressureGauge {
                    position: vec3(*position),
                    diameter: *diameter,
                    averaging_time: *averaging_time,
                };
                (name, Quantity::Pressure(gauge))
            }
            GaugeFile::Velocity { name, position } => {
                let position = vec3(*position);
                (name, Quantity::Velocity { position })
            }
            GaugeFile::BlockForce { name, block } => {
                let block = names.block(block);
                (name, Quantity::BlockForce { block })
            }
            GaugeFile::PointMotion { name, block, point } => {
                let (block, point) = (names.block(block), vec3(*point));
                (name, Quantity::PointMotion { block, point })
            }
            GaugeFile::RunUp { name, from, to } => (name, Quantity::RunUp(line(*from, *to))),
            GaugeFile::Front { name, from, to } => (name, Quantity::Front(line(*from, *to))),
            GaugeFile::Overtopping { name, from, to } => {
                (name, Quantity::Overtopping(line(*from, *to)))
            }
            GaugeFile::Displaced {
                name,
                blocks,
                farther_than,
            } => {
                let quantity = Quantity::Displaced {
                    blocks: free_blocks(file, |block| block.starts_with(blocks)),
                    farther_than: *farther_than,
                };
                (name, quantity)
            }
            // replaced by gauges in the coordinates of the scene
            GaugeFile::OnMap(_) | GaugeFile::FromFile { .. } => return None,
        };
        Some(Gauge {
            name: name.clone(),
            quantity,
        })
    };
    file.gauges.iter().filter_map(gauge).collect()
}

/// Recorded blocks that neither the file nor its rock masses, slides and grains have.
pub(super) fn unknown_blocks(file: &SceneFile) -> Vec<Problem> {
    let all: Vec<&str> = file.blocks.iter().map(|b| b.name.as_str()).collect();
    let gauges = file.gauges.iter().enumerate();
    let of_gauges = gauges.filter_map(|(k, gauge)| match gauge {
        GaugeFile::BlockForce { name, block } | GaugeFile::PointMotion { name, block, .. } => {
            Some((
                format!("gauges[{k}].block"),
                format!("gauge `{name}`"),
                block,
            ))
        }
        _ => None,
    });
    let forces = file.forces.iter().map(|asked| ("forces", &asked.blocks));
    let paths = (file.trajectories.iter()).map(|asked| ("trajectories", &asked.blocks));
    let followed = forces.chain(paths).flat_map(|(what, blocks)| {
        let blocks = blocks.iter().enumerate();
        blocks.map(move |(k, block)| (format!("{what}.blocks[{k}]"), what.to_owned(), block))
    });
    of_gauges
        .chain(followed)
        .filter(|(_, _, block)| !all.contains(&block.as_str()))
        .map(|(path, who, block)| {
            let what = format!(
                "{who}: no block is called `{block}`{}",
                suggestion(block, &all)
            );
            Problem::error(Code::UnknownName, path, what)
        })
        .collect()
}

/// Numbers of the free blocks whose name fits.
pub(super) fn free_blocks(file: &SceneFile, fits: impl Fn(&str) -> bool) -> Vec<usize> {
    let is_free = |block: &BlockFile| matches!(block.motion, MotionFile::Free);
    let blocks = file.blocks.iter().enumerate();
    blocks
        .filter(|(_, block)| is_free(block) && fits(&block.name))
        .map(|(number, _)| number)
        .collect()
}

/// Named blocks, every free block where there are no names.
fn tracking(file: &SceneFile, names: &[String], interval: f64) -> Tracking {
    let blocks = file.blocks.iter().enumerate();
    Tracking {
        blocks: if names.is_empty() {
            free_blocks(file, |_| true)
        } else {
            blocks
                .filter(|(_, block)| names.contains(&block.name))
                .map(|(number, _)| number)
                .collect()
        },
        interval,
    }
}

/// Blocks for which forces are recorded.
pub(super) fn forces(file: &SceneFile, output: &Output) -> Option<Tracking> {
    let asked = file.forces.as_ref()?;
    let interval = asked.interval.unwrap_or(output.gauge_interval);
    Some(tracking(file, &asked.blocks, interval))
}

/// Blocks whose paths are recorded.
pub(super) fn trajectories(file: &SceneFile) -> Option<Tracking> {
    let asked = file.trajectories.as_ref()?;
    let chosen = file.time.duration / TRAJECTORY_SAMPLES;
    Some(tracking(
        file,
        &asked.blocks,
        asked.interval.unwrap_or(chosen),
    ))
}

/// Maps of the water; none without water, which validation refuses.
pub(super) fn maps(file: &SceneFile, fluid: Option<&FluidScene>) -> Option<Maps> {
    let MapsFile {
        spacing,
        interval,
        arrival_threshold,
    } = file.maps.as_ref()?;
    let water = fluid?.lattice.particle_spacing(Dimensions::Three);
    Some(Maps {
        spacing: spacing.unwrap_or(MAP_SPACING * water),
        interval: interval.unwrap_or(file.time.duration / MAP_SAMPLES),
        arrival_threshold: arrival_threshold.unwrap_or(NOTICED_RISE * water),
    })
}

/// Hand-off of the water; none without water, which validation refuses.
pub(super) fn handoff(file: &SceneFile, fluid: Option<&FluidScene>) -> Option<Handoff> {
    let asked = file.handoff.as_ref()?;
    let fluid = fluid?;
    let line = |line: &HandoffLineFile| {
        let place = PlanLine {
            from: [line.from.0, line.from.1],
            to: [line.to.0, line.to.1],
        };
        (line.name.clone(), place)
    };
    Some(Handoff {
        times: match &asked.times {
            HandoffTimesFile::Auto => HandoffTimes::Auto,
            HandoffTimesFile::At(times) => {
                let mut times = times.clone();
                times.sort_by(f64::total_cmp);
                HandoffTimes::At(times)
            }
            HandoffTimesFile::Never => HandoffTimes::At(Vec::new()),
        },
        cell: asked
            .cell
            .unwrap_or(HANDOFF_CELL * fluid.walls.particle_spacing),
        level: asked.level.unwrap_or(fluid.lattice.still_water_level),
        formats: asked.formats.clone(),
        lines: asked.lines.iter().map(line).collect(),
    })
}

/// Groups of free blocks tracked as one body.
pub(super) fn masses(file: &SceneFile) -> Vec<TrackedMass> {
    let mass = |mass: &crate::scene::file::MassFile| TrackedMass {
        name: mass.name.clone(),
        blocks: free_blocks(file, |block| block.starts_with(&mass.blocks)),
    };
    file.masses.iter().map(mass).collect()
}
