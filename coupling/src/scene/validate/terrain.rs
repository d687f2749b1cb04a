//! Checks of the terrain and of slides.

use super::checks::Checks;
use super::units::the_same_plane;
use crate::messages::Code;
use crate::scene::file::{
    FailureSurfaceFile, GapsFile, OutlineFile, PlacementFile, SceneFile, ShapeFile, SlideFile,
    TerrainFile,
};

impl Checks {
    pub(super) fn terrain(&mut self, scene: &SceneFile) {
        let is_terrain = |shape: &ShapeFile| matches!(shape, ShapeFile::Terrain);
        let mut of_terrain = scene
            .blocks
            .iter()
            .enumerate()
            .filter(|(_, block)| is_terrain(&block.shape));
        let first = of_terrain.next();
        if let Some((index, block)) = of_terrain.next() {
            self.refuse(
                Code::TerrainBlock,
                format!("blocks[{index}].shape"),
                format!(
                    "block `{}`: there is one terrain, and another block has it",
                    block.name
                ),
            );
        }
        let Some(terrain) = &scene.terrain else {
            if let Some((index, block)) = first {
                self.refuse(
                    Code::TerrainBlock,
                    format!("blocks[{index}].shape"),
                    format!(
                        "block `{}`: the scene has no terrain; say with `terrain` where its heights come from",
                        block.name
                    ),
                );
            }
            if !scene.slides.is_empty() {
                self.refuse(
                    Code::TerrainBlock,
                    "slides[0]",
                    "there is no terrain to slide off; add `terrain`".into(),
                );
            }
            return;
        };
        match first {
            None => self.refuse(
                Code::TerrainBlock,
                "terrain",
                "no block is made of the terrain; add one with `shape: Terrain, motion: Fixed`".into(),
            ),
            Some((index, block)) if block.placement != PlacementFile::default() => self.refuse(
                Code::TerrainBlock,
                format!("blocks[{index}].placement"),
                format!(
                    "block `{}`: the terrain is where its map has it; shift it with `terrain.origin`",
                    block.name
                ),
            ),
            Some(_) => {}
        }
        self.heights(terrain);
        for (index, excavation) in terrain.excavations.iter().enumerate() {
            let path = format!("terrain.excavations[{index}]");
            self.hole(&path, (&excavation.outline, &excavation.failure_surface));
        }
        for (index, slide) in scene.slides.iter().enumerate() {
            self.slide(index, slide, scene);
        }
        self.unique(
            "slides",
            scene.slides.iter().map(|slide| slide.name.as_str()),
        );
    }

    fn heights(&mut self, terrain: &TerrainFile) {
        if terrain.sources.is_empty() {
            self.refuse(
                Code::EmptyList,
                "terrain.sources",
                "terrain needs at least one raster or survey".into(),
            );
        }
        for (index, source) in terrain.sources.iter().enumerate() {
            let path = |field: &str| format!("terrain.sources[{index}].{field}");
            let what = format!("height_scale of `{}`", source.file);
            self.positive(path("height_scale"), &what, source.height_scale);
            let what = format!("cell of `{}`", source.file);
            self.positive(path("cell"), &what, source.cell);
            if let Some((low, high)) = source.heights
                && !(low < high)
            {
                self.refuse(
                    Code::ValuesOutOfOrder,
                    path("heights"),
                    format!(
                        "heights of `{}` are from {low} to {high} m; the second must be the larger",
                        source.file
                    ),
                );
            }
        }
        self.positive("terrain.spacing", "spacing of the terrain", terrain.spacing);
        self.positive(
            "terrain.tolerance",
            "tolerance of the terrain",
            terrain.tolerance,
        );
        if let Some((min, max)) = terrain.clip
            && !(min.0 < max.0 && min.1 < max.1)
        {
            self.refuse(
                Code::ValuesOutOfOrder,
                "terrain.clip",
                format!(
                    "clip: the second corner {max:?} must exceed the first {min:?} along x and y"
                ),
            );
        }
        if let GapsFile::Filled(width) = terrain.gaps {
            self.positive("terrain.gaps", "width of gaps that are filled", width);
        }
    }

    fn hole(&mut self, path: &str, (outline, beneath): (&OutlineFile, &FailureSurfaceFile)) {
        if let OutlineFile::Corners(corners) | OutlineFile::OnMap(corners) = outline
            && corners.len() < 3
        {
            self.refuse(
                Code::UnusableOutline,
                format!("{path}.outline"),
                format!(
                    "an outline needs at least three corners, found {}",
                    corners.len()
                ),
            );
        }
        match beneath {
            FailureSurfaceFile::Plane {
                dip_deg,
                dip_direction_deg,
                ..
            } => {
                let path = format!("{path}.failure_surface");
                if !(0.0..90.0).contains(dip_deg) {
                    let right = the_same_plane(*dip_deg, *dip_direction_deg);
                    self.refuse(
                        Code::ValueOutOfRange,
                        format!("{path}.dip_deg"),
                        format!("dip must be in [0, 90) degrees, found {dip_deg}{right}"),
                    );
                }
                self.dip(&path, "failure plane", (*dip_deg, *dip_direction_deg));
            }
            FailureSurfaceFile::Raster { height_scale, .. } => {
                let path = format!("{path}.failure_surface.height_scale");
                self.positive(path, "height_scale of the failure surface", *height_scale);
            }
        }
    }

    fn slide(&mut self, index: usize, slide: &SlideFile, scene: &SceneFile) {
        let at = |field: &str| format!("slides[{index}].{field}");
        let of = |what: &str| format!("slide `{}`: {what}", slide.name);
        self.material_exists(at("material"), &of("material"), &slide.material, scene);
        self.hole(
            &format!("slides[{index}]"),
            (&slide.outline, &slide.failure_surface),
        );
        let who = format!("slide `{}`", slide.name);
        self.joint_sets(&format!("slides[{index}]"), &who, &slide.joint_sets);
        self.not_negative(
            at("convex_within"),
            &of("convex_within"),
            slide.convex_within.unwrap_or(0.0),
        );
        self.not_negative(
            at("minimum_volume"),
            &of("minimum_volume"),
            slide.minimum_volume.unwrap_or(0.0),
        );
        if slide.maximum_blocks == 0 {
            self.refuse(
                Code::ValueOutOfRange,
                at("maximum_blocks"),
                of("maximum_blocks must be at least 1"),
            );
        }
    }
}
