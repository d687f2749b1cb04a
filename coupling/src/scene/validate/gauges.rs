//! Checks of gauges, tracked blocks, maps and the camera.

use super::checks::{Checks, is_inside};
use crate::messages::Code;
use crate::scene::file::{
    BlockFile, CameraFile, DimensionsFile, ForcesFile, GaugeFile, MapsFile, MassFile, MotionFile,
    SceneFile, TrajectoriesFile, Triple,
};
use crate::scene::parse::suggestion;

pub(super) fn gauge_name(gauge: &GaugeFile) -> &str {
    match gauge {
        GaugeFile::SurfaceElevation { name, .. }
        | GaugeFile::Pressure { name, .. }
        | GaugeFile::Velocity { name, .. }
        | GaugeFile::BlockForce { name, .. }
        | GaugeFile::PointMotion { name, .. }
        | GaugeFile::RunUp { name, .. }
        | GaugeFile::Front { name, .. }
        | GaugeFile::Overtopping { name, .. }
        | GaugeFile::Displaced { name, .. } => name,
        GaugeFile::OnMap(gauge) => gauge_name(gauge),
        GaugeFile::FromFile { file, .. } => file,
    }
}

/// True for a line in plan view that passes through the domain; its ends may be outside.
fn meets_the_plan(from: (f64, f64), to: (f64, f64), scene: &SceneFile) -> bool {
    let (min, max) = (scene.domain.min, scene.domain.max);
    let axes = [(from.0, to.0, min.0, max.0), (from.1, to.1, min.1, max.1)];
    let mut shares = (0.0_f64, 1.0_f64);
    for (from, to, min, max) in axes {
        if from == to {
            if !(min..=max).contains(&from) {
                return false;
            }
            continue;
        }
        let (a, b) = ((min - from) / (to - from), (max - from) / (to - from));
        shares = (shares.0.max(a.min(b)), shares.1.min(a.max(b)));
    }
    shares.0 <= shares.1
}

impl Checks {
    pub(super) fn gauge(&mut self, index: usize, gauge: &GaugeFile, scene: &SceneFile) {
        let who = format!("gauge `{}`", gauge_name(gauge));
        let level = scene.domain.min.2;
        let path = |field: &str| format!("gauges[{index}].{field}");
        let mut inside = |field: &str, x: Triple| {
            if !is_inside(x, scene) {
                self.refuse(
                    Code::OutsideDomain,
                    path(field),
                    format!("{who} at {x:?} is outside of the domain"),
                );
            }
        };
        match gauge {
            GaugeFile::SurfaceElevation { x, y, .. } => inside("x", (*x, *y, level)),
            GaugeFile::Velocity { position, .. } => inside("position", *position),
            GaugeFile::Pressure {
                position,
                diameter,
                averaging_time,
                ..
            } => {
                inside("position", *position);
                for (field, value) in [("diameter", diameter), ("averaging_time", averaging_time)] {
                    if !(0.0 <= *value && value.is_finite()) {
                        let what = format!("{who}: {field} must be finite and >= 0, got {value}");
                        self.refuse(Code::ValueOutOfRange, path(field), what);
                    }
                }
            }
            GaugeFile::RunUp { from, to, .. } | GaugeFile::Front { from, to, .. } => {
                inside("from", (from.0, from.1, level));
                inside("to", (to.0, to.1, level));
            }
            GaugeFile::Overtopping { from, to, .. } => {
                if from == to {
                    self.refuse(
                        Code::ValuesOutOfOrder,
                        path("to"),
                        format!("{who} has a line of no length"),
                    );
                } else if !meets_the_plan(*from, *to, scene) {
                    let what = format!("{who}: its line from {from:?} to {to:?} misses the domain");
                    self.refuse(Code::OutsideDomain, path("from"), what);
                }
            }
            GaugeFile::BlockForce { block, .. } | GaugeFile::PointMotion { block, .. } => {
                if !is_made_later(scene, block) {
                    self.block_exists(path("block"), &who, block, scene);
                }
            }
            GaugeFile::Displaced {
                blocks,
                farther_than,
                ..
            } => {
                self.positive(
                    path("farther_than"),
                    &format!("{who}: farther_than"),
                    Some(*farther_than),
                );
                self.free_blocks_begin_with(&path("blocks"), &who, blocks, scene);
            }
            // checked where they are in the scene
            GaugeFile::OnMap(_) | GaugeFile::FromFile { .. } => {}
        }
        let is_dry = matches!(
            gauge,
            GaugeFile::BlockForce { .. }
                | GaugeFile::PointMotion { .. }
                | GaugeFile::Displaced { .. }
        );
        if scene.fluid.is_none() && !is_dry {
            self.warn(
                Code::NeedsWater,
                format!("gauges[{index}]"),
                format!("{who} measures water, but the scene has none"),
            );
        }
    }

    /// Check that a free block has a name with a prefix; those of rock masses and grains do not exist yet.
    pub(super) fn free_blocks_begin_with(
        &mut self,
        path: &str,
        who: &str,
        prefix: &str,
        scene: &SceneFile,
    ) {
        let free = scene.blocks.iter().filter(|block| is_free(block));
        let mut stems: Vec<&str> = free.map(|block| block.name.as_str()).collect();
        let is_made = makers(scene).any(|name| prefix.starts_with(name));
        stems.extend(makers(scene));
        if is_made || stems.iter().any(|name| name.starts_with(prefix)) {
            return;
        }
        // "armour_001" and its like are one answer, not hundreds
        for stem in &mut stems {
            let bare = stem.trim_end_matches(|c: char| c.is_ascii_digit() || "._- ".contains(c));
            *stem = if bare.is_empty() { stem } else { bare };
        }
        stems.sort_unstable();
        stems.dedup();
        let (code, message) = if stems.is_empty() {
            let message = format!("{who}: no block is free to move; leave it out");
            (Code::NeedsFreeBlock, message)
        } else {
            let names = suggestion(prefix, &stems);
            let message =
                format!("{who}: no free block has a name that begins with `{prefix}`{names}");
            (Code::UnknownName, message)
        };
        self.refuse(code, path, message);
    }

    pub(super) fn forces(&mut self, forces: &ForcesFile, scene: &SceneFile) {
        let ForcesFile { blocks, interval } = forces;
        let all = scene.blocks.iter().map(|block| block.name.as_str());
        self.followed(
            ("forces", scene),
            (blocks, *interval),
            ("block", &all.collect::<Vec<_>>()),
        );
        if blocks.is_empty() {
            self.needs_free_blocks("forces", scene);
        }
    }

    /// Check of blocks by name, sampled every `interval` seconds; `names` are those of their kind in `blocks`.
    fn followed(
        &mut self,
        (what, scene): (&str, &SceneFile),
        (blocks, interval): (&[String], Option<f64>),
        (kind, names): (&str, &[&str]),
    ) {
        self.positive(
            format!("{what}.interval"),
            &format!("{what}: interval"),
            interval,
        );
        for (index, name) in blocks.iter().enumerate() {
            let path = format!("{what}.blocks[{index}]");
            if !names.contains(&name.as_str()) && !is_made_later(scene, name) {
                self.refuse(
                    Code::UnknownName,
                    &path,
                    format!(
                        "{what}: `{name}` is not a {kind} of `blocks`{}",
                        suggestion(name, names)
                    ),
                );
            }
            self.listed_once(&path, format!("{what}: `{name}`"), (blocks, index));
        }
    }

    fn needs_free_blocks(&mut self, what: &str, scene: &SceneFile) {
        let are_none = makers(scene).next().is_none();
        if are_none && !scene.blocks.iter().any(is_free) {
            self.refuse(
                Code::NeedsFreeBlock,
                what,
                format!("{what}: no block is free to move; leave {what} out"),
            );
        }
    }

    pub(super) fn maps(&mut self, maps: &MapsFile, scene: &SceneFile) {
        self.positive("maps.spacing", "maps: spacing", maps.spacing);
        self.positive("maps.interval", "maps: interval", maps.interval);
        let what = "maps: arrival_threshold";
        self.positive("maps.arrival_threshold", what, maps.arrival_threshold);
        if scene.fluid.is_none() {
            self.refuse(
                Code::NeedsWater,
                "maps",
                "maps are of water, but the scene has none".to_owned(),
            );
        }
        if scene.domain.dimensions == DimensionsFile::Two {
            self.refuse(
                Code::IncompatibleOptions,
                "maps",
                "a flow in a plane has no plan to map; use gauges".to_owned(),
            );
        }
    }

    pub(super) fn mass(&mut self, index: usize, mass: &MassFile, scene: &SceneFile) {
        let who = format!("mass `{}`", mass.name);
        let path = format!("masses[{index}].blocks");
        self.free_blocks_begin_with(&path, &who, &mass.blocks, scene);
    }

    pub(super) fn trajectories(&mut self, trajectories: &TrajectoriesFile, scene: &SceneFile) {
        let free = scene.blocks.iter().filter(|block| is_free(block));
        let names: Vec<&str> = free.map(|block| block.name.as_str()).collect();
        self.followed(
            ("trajectories", scene),
            (&trajectories.blocks, trajectories.interval),
            ("free block", &names),
        );
        self.needs_free_blocks("trajectories", scene);
        if scene.blocks.iter().all(is_free) {
            self.warn(
                Code::OptionWithoutEffect,
                "trajectories",
                "trajectories: no block is fixed, so there is no ground to measure heights from"
                    .to_owned(),
            );
        }
    }

    pub(super) fn camera(&mut self, camera: &CameraFile) {
        if camera.position == camera.look_at {
            self.refuse(
                Code::UnusableDirection,
                "camera.look_at",
                "camera looks at itself; move position or look_at".to_owned(),
            );
        }
        let angle = camera.field_of_view_deg;
        if !(0.0 < angle && angle < 170.0) {
            self.refuse(
                Code::ValueOutOfRange,
                "camera.field_of_view_deg",
                format!("camera: field of view must be between 0 and 170 degrees, found {angle}"),
            );
        }
    }
}

fn is_free(block: &BlockFile) -> bool {
    matches!(block.motion, MotionFile::Free)
}

/// Names of what makes blocks.
fn makers(scene: &SceneFile) -> impl Iterator<Item = &str> {
    (scene.rock_masses.iter().map(|mass| mass.name.as_str()))
        .chain(scene.slides.iter().map(|slide| slide.name.as_str()))
        .chain(scene.grains.iter().map(|grains| grains.name.as_str()))
}

/// Whether a name is that of a block of a rock mass, a slide or grains, which are not made yet.
fn is_made_later(scene: &SceneFile, block: &str) -> bool {
    makers(scene)
        .any(|name| (block.strip_prefix(name)).is_some_and(|rest| rest.starts_with(['.', '_'])))
}
