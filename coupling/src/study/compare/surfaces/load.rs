//! Surfaces of files and of run folders.

use std::path::Path;

use riprap_dda::Vec3;

use super::SurfaceError;
use crate::files::vtk::{self, PolyData};
use crate::output::run_folder::{BLOCK_FRAMES, FIXED_BLOCKS, frame, read_scene};
use crate::scene::access::{Access, FilesFrom};
use crate::scene::geometry::crs::Crs;
use crate::scene::geometry::terrain::sources::Source;
use crate::world::ground::fan;

/// Surface in map coordinates of a raster, a mesh or a cloud, or the highest of the ground and the blocks at the end of a run in
/// its folder.
///
/// # Errors
///
/// [`SurfaceError::Unreadable`].
pub fn load(path: &Path) -> Result<Source, SurfaceError> {
    let is_folder = path.is_dir();
    let access = Access {
        files: FilesFrom::Anywhere,
        ..Access::of(if is_folder { path } else { Path::new("") })
    };
    let name = path.to_string_lossy();
    let refuse = |reason: String| SurfaceError::Unreadable(reason);
    if !is_folder {
        return Source::on_map(&name, &access).map_err(|error| refuse(error.to_string()));
    }
    let scene = read_scene(path).map_err(|error| refuse(error.to_string()))?;
    let (origin, crs) = scene.map;
    let mut files: Vec<String> = (path.join(FIXED_BLOCKS).exists())
        .then(|| FIXED_BLOCKS.to_owned())
        .into_iter()
        .collect();
    let last = (0..)
        .map(|number| frame(BLOCK_FRAMES, number))
        .take_while(|file| path.join(file).exists())
        .last();
    files.extend(last);
    let origin = Vec3::new(origin.0, origin.1, origin.2);
    let mut triangles = Vec::new();
    for file in &files {
        let data = vtk::read(&path.join(file)).map_err(|error| refuse(error.to_string()))?;
        triangles.extend(triangles_of(&data, &origin));
    }
    let crs = crs.and_then(|written| written.parse::<Crs>().ok());
    Source::of_triangles(name.clone().into_owned(), triangles, crs).ok_or_else(|| {
        let wanted = format!("{FIXED_BLOCKS} and {}", frame(BLOCK_FRAMES, 0));
        refuse(format!(
            "{name} has no blocks that look up in {wanted}; run the scene to its end"
        ))
    })
}

/// Polygons as triangles, from an origin on; m.
fn triangles_of(data: &PolyData, origin: &Vec3) -> Vec<[Vec3; 3]> {
    let point = |&k: &i32| {
        let place = data.points.get(usize::try_from(k).ok()?)?;
        Some(origin + Vec3::from(place.map(f64::from)))
    };
    let ends = data.polygons.offsets.iter().map(|&end| end as usize);
    let mut start = 0;
    let mut triangles = Vec::new();
    for end in ends {
        let corners = data
            .polygons
            .connectivity
            .get(start..end)
            .unwrap_or_default();
        let corners: Option<Vec<Vec3>> = corners.iter().map(point).collect();
        triangles.extend(fan(&corners.unwrap_or_default()));
        start = end;
    }
    triangles
}
