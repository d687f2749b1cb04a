//! One reference system for all files of a terrain.

use crate::messages::Code;
use crate::scene::error::Problem;
use crate::scene::file::TerrainFile;
use crate::scene::geometry::crs::{Content, Crs};

/// A file with a reference system.
pub(super) struct Named {
    /// Path of the file's name in the scene.
    pub(super) path: String,
    /// The file as the scene names it.
    pub(super) file: String,
    /// Its content.
    pub(super) content: Content,
    /// Its system.
    pub(super) crs: Crs,
}

/// The system that the scene and its files name. Files without one are taken to be in the same.
///
/// # Errors
///
/// A [`Problem`] for the first that differs, with both named.
pub(super) fn common(file: &TerrainFile, named: &[Named]) -> Result<Option<Crs>, Problem> {
    let mut known: Option<(String, Crs)> = None;
    if let Some(written) = &file.crs {
        let refuse = |what: String| Problem::error(Code::UnusableMapSystem, "terrain.crs", what);
        let crs: Crs = (written.parse()).map_err(|error| refuse(format!("{error}")))?;
        if crs.is_in_degrees() || crs.odd_unit().is_some() {
            let what = format!(
                "{crs} is not in meters; project the sources, to a zone of UTM say, and write its code"
            );
            return Err(refuse(what));
        }
        known = Some(("the terrain".into(), crs));
    }
    for other in named {
        match &known {
            None => known = Some((format!("`{}`", other.file), other.crs.clone())),
            Some((_, first)) if first.agrees_with(&other.crs) => {}
            Some((name, first)) => {
                let what = format!(
                    "`{}` is in {}, {name} in {first}; project it: {}",
                    other.file,
                    other.crs,
                    other.content.projected_to(first)
                );
                return Err(Problem::error(Code::UnusableMapSystem, &other.path, what));
            }
        }
    }
    Ok(known.map(|(_, crs)| crs))
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use std::fs;

    use crate::scene::access::Access;
    use crate::scene::file::SceneFile;
    use crate::scene::geometry::crs::Crs;
    use crate::scene::geometry::terrain::resolve;
    use crate::scene::parse;

    const GRID: &str =
        "ncols 3\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 10\n1 2 3\n1 2 3\n1 2 3\n";

    fn scene(terrain: &str) -> SceneFile {
        let text = format!(
            r#"(title: "two maps", domain: (min: (0, 0, 0), max: (30, 30, 9)), terrain: {terrain}, time: (duration: 1))"#
        );
        parse::read(&text).unwrap()
    }

    /// The system of `land.asc` from its `.prj`, of `sea.asc` with `sea` as its `.prj`.
    fn system(terrain: &str, sea: &str) -> Result<Option<Crs>, String> {
        let folder = tempfile::tempdir().unwrap();
        for (file, text) in [
            ("land.asc", GRID),
            ("sea.asc", GRID),
            ("land.prj", &Crs::of_epsg(25_832).unwrap().wkt),
            ("sea.prj", sea),
        ] {
            if !text.is_empty() {
                fs::write(folder.path().join(file), text).unwrap();
            }
        }
        match resolve(&scene(terrain), &Access::of(folder.path())) {
            Ok(terrain) => Ok(terrain.and_then(|terrain| terrain.crs)),
            Err(problems) => Err(problems[0].message.clone()),
        }
    }

    #[test]
    fn sources_agree_or_both_are_named() {
        let two = r#"(sources: [(file: "sea.asc"), (file: "land.asc")])"#;
        let of = |code| Crs::of_epsg(code).unwrap();
        assert_eq!(system(two, "").unwrap(), Some(of(25_832)));
        assert_eq!(system(two, &of(25_832).wkt).unwrap(), Some(of(25_832)));
        assert_eq!(
            system(two, &of(25_833).wkt).unwrap_err(),
            "`land.asc` is in EPSG:25832 (ETRS89 / UTM zone 32N), `sea.asc` in EPSG:25833 (ETRS89 / UTM zone 33N); project it: \
             gdalwarp -t_srs EPSG:25833 in out.tif"
        );
        let degrees = system(two, &of(4326).wkt).unwrap_err();
        assert!(
            degrees.starts_with("`sea.asc`: is in degrees of EPSG:4326 (WGS 84)"),
            "{degrees}"
        );
        let text = system(two, "UTM 32").unwrap_err();
        assert!(
            text.starts_with("`sea.prj`: is no well-known text"),
            "{text}"
        );
    }

    #[test]
    fn the_scene_may_name_its_system() {
        let named = |crs: &str, file: &str| {
            let text = format!(r#"(sources: [(file: "{file}.asc")], crs: "{crs}")"#);
            system(&text, "")
        };
        let code = |crs: Option<Crs>| crs.and_then(|crs| crs.epsg);
        assert_eq!(code(named("EPSG:2056", "sea").unwrap()), Some(2056));
        let other = named("EPSG:2056", "land").unwrap_err();
        assert!(
            other.contains("the terrain in EPSG:2056 (CH1903+ / LV95)"),
            "{other}"
        );
        assert!(
            named("EPSG:4326", "sea")
                .unwrap_err()
                .contains("is not in meters")
        );
        assert!(
            named("EPSG:9", "sea")
                .unwrap_err()
                .starts_with("EPSG:9 is not a known")
        );
    }

    /// A scene as it ran names the system that a `.prj` gave it: rerun without that file, it writes the same maps.
    #[test]
    fn a_frozen_scene_keeps_the_system() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("land.asc"), GRID).unwrap();
        let beside = folder.path().join("land.prj");
        fs::write(&beside, &Crs::of_epsg(25_832).unwrap().wkt).unwrap();
        let resolved =
            |file: SceneFile| crate::scene::resolved::Scene::resolve(file, folder.path()).unwrap();
        let frozen = resolved(scene(r#"(sources: [(file: "land.asc")])"#)).to_file();
        fs::remove_file(beside).unwrap();
        let again = resolved(frozen);
        assert_eq!(
            again.terrain.unwrap().crs,
            Some(Crs::of_epsg(25_832).unwrap())
        );
    }
}
