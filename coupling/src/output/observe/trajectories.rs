//! Trajectories of falling blocks: `trajectories.csv` over time, `rockfall.csv` with one row per block.
//!
//! The ground ([`Ground`]) consists of the upward faces of fixed blocks. A height above ground is that of the block's
//! centroid, along z; that of a block at rest is about half its size.

use serde::{Deserialize, Serialize};
use std::path::Path;

use riprap_dda::Vec3;

use super::{ObserveError, Observer, Schedule, name_of};
use crate::files::table::{Cell, Column, Start, Table};
use crate::output::run_folder;
use crate::saved::Saved;
use crate::scene::resolved::recording::Tracking;
use crate::world::World;
use crate::world::ground::Ground;

/// Number of bins of horizontal distance for the heights in the overview, over the longest path in plan view
/// of the domain.
const STRETCHES: f64 = 200.0;

/// Columns of `trajectories.csv`: one row per block and time.
const SAMPLE_COLUMNS: [(&str, &str); 14] = [
    ("time", "s"),
    ("block", "-"),
    ("x", "m"),
    ("y", "m"),
    ("z", "m"),
    ("path_length", "m"),
    ("distance", "m"),
    ("height", "m"),
    ("kinetic_energy", "J"),
    // attitude: the turn since the start
    ("qx", "-"),
    ("qy", "-"),
    ("qz", "-"),
    ("qw", "-"),
    ("name", ""),
];

/// Columns of `rockfall.csv`: one row per block.
const BLOCK_COLUMNS: [(&str, &str); 18] = [
    ("block", "-"),
    ("mass", "kg"),
    ("start_x", "m"),
    ("start_y", "m"),
    ("start_z", "m"),
    ("end_x", "m"),
    ("end_y", "m"),
    ("end_z", "m"),
    ("end_time", "s"),
    ("end_speed", "m/s"),
    ("path_length", "m"),
    ("run_out", "m"),
    ("drop", "m"),
    ("run_out_angle", "rad"),
    ("bounce_height", "m"),
    ("max_speed", "m/s"),
    ("max_kinetic_energy", "J"),
    ("name", ""),
];

/// Tracks blocks and writes both tables.
#[derive(Debug)]
pub struct Trajectories {
    schedule: Schedule,
    ground: Ground,
    samples: Table,
    blocks: Table,
    tracks: Vec<Track>,
    /// Of all blocks, by their numbers.
    names: Vec<String>,
    /// Width of a bin of horizontal distance; m.
    stretch: f64,
}

/// Trajectory of a block; extremes are those of the samples.
#[derive(Clone, Debug, Serialize, Deserialize)]
struct Track {
    block: usize,
    start: Vec3,
    end: Vec3,
    /// Time of its last sample, since it may have left the domain; s.
    end_time: f64,
    /// m/s.
    end_speed: f64,
    /// m.
    path_length: f64,
    /// Largest height of the centroid above ground, NaN if there was never ground below; m.
    bounce_height: f64,
    /// m/s.
    max_speed: f64,
    /// J.
    max_kinetic_energy: f64,
    /// Largest height above ground in each bin of horizontal distance, NaN if not visited; m.
    highest: Vec<f64>,
}

impl Trajectories {
    /// Tables in `folder` for the blocks requested by the scene.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] when a table cannot be created.
    pub fn new(
        folder: &Path,
        (asked, block_names): (&Tracking, &[String]),
        world: &World,
        start: Start,
    ) -> Result<Self, ObserveError> {
        let table = |name: &str, list: &[(&str, &str)]| {
            let columns = list.iter().map(|(name, unit)| Column::new(*name, *unit));
            Table::open(&folder.join(name), &columns.collect::<Vec<_>>(), start)
        };
        let tracks = (asked.blocks.iter())
            .map(|&b| Track::new(b, world.blocks.centroid(b)))
            .collect();
        let extent = (world.domain().1 - world.domain().0).xy();
        Ok(Self {
            schedule: Schedule::every(asked.interval),
            ground: Ground::of(&world.blocks),
            samples: table(run_folder::TRAJECTORIES, &SAMPLE_COLUMNS)?,
            blocks: table(run_folder::ROCKFALL, &BLOCK_COLUMNS)?,
            tracks,
            names: block_names.to_vec(),
            stretch: extent.norm() / STRETCHES,
        })
    }

    /// Takes a last sample and writes `rockfall.csv`.
    ///
    /// # Errors
    ///
    /// [`ObserveError`] names the file.
    pub fn finish(&mut self, world: &World) -> Result<(), ObserveError> {
        self.observe_last(world)?;
        for track in &self.tracks {
            let run_out = track.run_out();
            let drop = track.start.z - track.end.z;
            let mass = [world.blocks.mass(track.block)];
            let places = track.start.iter().chain(track.end.iter()).copied();
            let measures = [
                track.end_time,
                track.end_speed,
                track.path_length,
                run_out,
                drop,
                drop.atan2(run_out),
                track.bounce_height,
                track.max_speed,
                track.max_kinetic_energy,
            ];
            let numbers = mass.into_iter().chain(places).chain(measures);
            let cells = std::iter::once(Cell::Whole(track.block))
                .chain(numbers.map(Cell::Number))
                .chain(std::iter::once(name_of(&self.names, track.block)));
            self.blocks.cells(&cells.collect::<Vec<_>>())?;
        }
        Ok(())
    }

    /// Horizontal distances from start to end, ascending; m.
    pub fn run_outs(&self) -> Vec<f64> {
        let mut run_outs: Vec<f64> = self.tracks.iter().map(Track::run_out).collect();
        run_outs.sort_by(f64::total_cmp);
        run_outs
    }

    /// Center of each bin of horizontal distance (m), and the largest heights (m) there of the blocks that passed,
    /// ascending.
    pub fn heights(&self) -> Vec<(f64, Vec<f64>)> {
        let n = self.tracks.iter().map(|track| track.highest.len()).max();
        let of_stretch = |k: usize| {
            let heights = self.tracks.iter().filter_map(|track| track.highest.get(k));
            let mut heights: Vec<f64> = heights.copied().filter(|h| !h.is_nan()).collect();
            heights.sort_by(f64::total_cmp);
            ((k as f64 + 0.5) * self.stretch, heights)
        };
        (0..n.unwrap_or(0)).map(of_stretch).collect()
    }
}

impl Observer for Trajectories {
    fn schedule(&self) -> &Schedule {
        &self.schedule
    }

    fn observe(&mut self, world: &World) -> Result<(), ObserveError> {
        let blocks = &world.blocks;
        for track in &mut self.tracks {
            if blocks.is_removed(track.block) {
                continue;
            }
            let x = blocks.centroid(track.block);
            let height = self.ground.height_below(&x).map_or(f64::NAN, |z| x.z - z);
            let kinetic_energy = blocks.kinetic_energy(track.block);
            track.path_length += (x - track.end).norm();
            track.end = x;
            track.end_time = world.time();
            track.end_speed = blocks.velocity(track.block).norm();
            track.bounce_height = track.bounce_height.max(height);
            track.max_speed = track.max_speed.max(track.end_speed);
            track.max_kinetic_energy = track.max_kinetic_energy.max(kinetic_energy);
            track.record_height(height, self.stretch);
            let turn = blocks.orientation(track.block).coords;
            let numbers = [track.path_length, track.run_out(), height, kinetic_energy];
            let numbers = x.iter().chain(&numbers).chain(turn.iter()).copied();
            let cells = [Cell::Number(world.time()), Cell::Whole(track.block)]
                .into_iter()
                .chain(numbers.map(Cell::Number))
                .chain(std::iter::once(name_of(&self.names, track.block)));
            self.samples.cells(&cells.collect::<Vec<_>>())?;
        }
        self.schedule.done(world.time());
        Ok(())
    }

    fn save(&self, out: Vec<u8>) -> Saved {
        let lengths = (self.samples.length(), self.blocks.length());
        postcard::to_extend(&(self.schedule, lengths, &self.tracks), out)
    }

    fn sync(&mut self) -> Result<(), ObserveError> {
        self.samples.sync()?;
        self.blocks.sync()?;
        Ok(())
    }

    fn read<'a>(&mut self, bytes: &'a [u8]) -> Result<&'a [u8], ObserveError> {
        let (schedule, samples, blocks, rest);
        ((schedule, (samples, blocks), self.tracks), rest) = postcard::take_from_bytes(bytes)?;
        self.schedule.resume(schedule);
        self.samples.cut(samples)?;
        self.blocks.cut(blocks)?;
        Ok(rest)
    }
}

impl Track {
    fn new(block: usize, start: Vec3) -> Self {
        Self {
            block,
            start,
            end: start,
            end_time: 0.0,
            end_speed: 0.0,
            path_length: 0.0,
            // `max` takes a number over NaN
            bounce_height: f64::NAN,
            max_speed: 0.0,
            max_kinetic_energy: 0.0,
            highest: Vec::new(),
        }
    }

    /// Horizontal distance from the start; m.
    fn run_out(&self) -> f64 {
        (self.end - self.start).xy().norm()
    }

    fn record_height(&mut self, height: f64, stretch: f64) {
        let k = (self.run_out() / stretch) as usize;
        if self.highest.len() <= k {
            self.highest.resize(k + 1, f64::NAN);
        }
        self.highest[k] = self.highest[k].max(height);
    }
}
