//! Gauges in map coordinates and from files, as gauges in the coordinates of the scene.

use std::path::Path;

use super::access::Access;
use super::error::Problem;
use super::file::{GaugeFile, GaugeKindFile, SceneFile, Triple};
use super::geometry::crs::{Content, Crs};
use super::geometry::features;
use super::resolved::Scene;
use crate::files::features::{Feature, Form};
use crate::messages::Code;

/// A scene with all gauges in its own coordinates.
pub(super) struct Placed {
    pub(super) file: SceneFile,
    pub(super) written: Written,
    /// Files of gauges with a reference system.
    pub(super) systems: Vec<FileSystem>,
}

/// A file of gauges with a reference system.
pub(super) struct FileSystem {
    /// Path of its name in the scene.
    path: String,
    file: String,
    crs: Crs,
}

/// How each gauge is written in the scene.
pub(super) struct Written(Vec<Origin>);

#[derive(Clone, Copy)]
enum Origin {
    /// As it is, the gauge of this number.
    Plain(usize),
    /// Within `OnMap` of this number.
    OnMap(usize),
    /// In the file of this number.
    File(usize),
}

impl Written {
    /// Problems with the paths of the scene as it is written.
    pub(super) fn located(&self, problems: Vec<Problem>) -> Vec<Problem> {
        let located = |problem: Problem| Problem {
            path: self.path(&problem.path).unwrap_or(problem.path),
            ..problem
        };
        problems.into_iter().map(located).collect()
    }

    /// Path of a gauge or its field as it is written.
    fn path(&self, path: &str) -> Option<String> {
        let (number, field) = path.strip_prefix("gauges[")?.split_once(']')?;
        Some(match self.0.get(number.parse::<usize>().ok()?)? {
            Origin::Plain(k) => format!("gauges[{k}]{field}"),
            Origin::OnMap(k) => format!("gauges[{k}][0]{field}"),
            Origin::File(k) => format!("gauges[{k}].file"),
        })
    }
}

/// Places all gauges; a scene without any of the map is unchanged.
///
/// # Errors
///
/// Problems of the files, and of gauges of a map in a scene that has none.
pub(super) fn placed(mut file: SceneFile, access: &Access) -> Result<Placed, Vec<Problem>> {
    let origin = file.terrain.as_ref().map(|terrain| terrain.origin);
    let (mut gauges, mut written) = (Vec::new(), Vec::new());
    let (mut systems, mut problems) = (Vec::new(), Vec::new());
    let at = |index: usize| format!("gauges[{index}]");
    for (index, gauge) in std::mem::take(&mut file.gauges).into_iter().enumerate() {
        match gauge {
            GaugeFile::OnMap(inner) => match (origin, from_map(*inner, origin)) {
                (Some(_), Ok(gauge)) => {
                    gauges.push(gauge);
                    written.push(Origin::OnMap(index));
                }
                (None, _) => {
                    let what = "the scene has no terrain and no map; write the gauge without OnMap, from (0, 0, 0) of the scene";
                    problems.push(Problem::error(Code::TerrainBlock, at(index), what));
                }
                (_, Err(what)) => {
                    problems.push(Problem::error(Code::IncompatibleOptions, at(index), what));
                }
            },
            GaugeFile::FromFile { file, kind } => {
                let path = format!("gauges[{index}].file");
                match of_file(&file, kind, origin.unwrap_or_default(), access) {
                    Ok((found, crs)) => {
                        written.extend(found.iter().map(|_| Origin::File(index)));
                        gauges.extend(found);
                        systems.extend(crs.map(|crs| FileSystem { path, file, crs }));
                    }
                    Err(what) => problems.push(Problem::error(Code::UnusableFile, path, what)),
                }
            }
            plain => {
                gauges.push(plain);
                written.push(Origin::Plain(index));
            }
        }
    }
    if !problems.is_empty() {
        return Err(problems);
    }
    file.gauges = gauges;
    Ok(Placed {
        file,
        written: Written(written),
        systems,
    })
}

/// Error for the first file whose reference system is not that of the terrain.
pub(super) fn other_system(systems: &[FileSystem], scene: &Scene) -> Option<Problem> {
    let map = scene.terrain.as_ref()?.crs.as_ref()?;
    let other = systems.iter().find(|system| !system.crs.agrees_with(map))?;
    let what = format!(
        "`{}` is in {}, the terrain in {map}; project it: {}",
        other.file,
        other.crs,
        Content::Features.projected_to(map)
    );
    Some(Problem::error(Code::UnusableMapSystem, &other.path, what))
}

/// A gauge of the map in the coordinates of the scene.
fn from_map(gauge: GaugeFile, origin: Option<Triple>) -> Result<GaugeFile, String> {
    let (dx, dy, dz) = origin.unwrap_or_default();
    let plan = |(x, y): (f64, f64)| (x - dx, y - dy);
    let point = |(x, y, z): Triple| (x - dx, y - dy, z - dz);
    Ok(match gauge {
        GaugeFile::SurfaceElevation { name, x, y } => GaugeFile::SurfaceElevation {
            name,
            x: x - dx,
            y: y - dy,
        },
        GaugeFile::Pressure {
            name,
            position,
            diameter,
            averaging_time,
        } => GaugeFile::Pressure {
            name,
            position: point(position),
            diameter,
            averaging_time,
        },
        GaugeFile::Velocity { name, position } => GaugeFile::Velocity {
            name,
            position: point(position),
        },
        GaugeFile::RunUp { name, from, to } => GaugeFile::RunUp {
            name,
            from: plan(from),
            to: plan(to),
        },
        GaugeFile::Front { name, from, to } => GaugeFile::Front {
            name,
            from: plan(from),
            to: plan(to),
        },
        GaugeFile::Overtopping { name, from, to } => GaugeFile::Overtopping {
            name,
            from: plan(from),
            to: plan(to),
        },
        GaugeFile::PointMotion {
            name,
            block,
            point: at,
        } => GaugeFile::PointMotion {
            name,
            block,
            point: point(at),
        },
        GaugeFile::BlockForce { name, .. } | GaugeFile::Displaced { name, .. } => {
            return Err(format!(
                "gauge `{name}` has no coordinates; write it without OnMap"
            ));
        }
        GaugeFile::OnMap(_) | GaugeFile::FromFile { .. } => {
            return Err("is on the map already; write it without OnMap".into());
        }
    })
}

/// Gauges of a file, and its reference system.
fn of_file(
    file: &str,
    kind: GaugeKindFile,
    origin: Triple,
    access: &Access,
) -> Result<(Vec<GaugeFile>, Option<Crs>), String> {
    let map = features::read(access, file, origin).map_err(|error| error.to_string())?;
    let stem = Path::new(file).file_stem().unwrap_or_default();
    let stem = stem.to_string_lossy();
    let mut gauges = Vec::new();
    for (k, feature) in map.list.iter().enumerate() {
        let name = (feature.name.clone()).unwrap_or_else(|| format!("{stem}_{}", k + 1));
        let gauge = gauge(name, kind, feature);
        gauges.push(gauge.map_err(|what| format!("`{file}`: {what}"))?);
    }
    Ok((gauges, map.crs))
}

fn gauge(name: String, kind: GaugeKindFile, feature: &Feature) -> Result<GaugeFile, String> {
    let point = || match &feature.form {
        Form::Point(point) => Ok(*point),
        Form::Line(_) | Form::Polygon(_) => Err(format!(
            "`{name}` is a line or a polygon, a gauge of kind {kind:?} needs points"
        )),
    };
    let high_point = || match point()? {
        [_, _, z] if z.is_nan() => Err(format!(
            "`{name}` has no elevation, a gauge of kind {kind:?} needs one: a column z, or a third coordinate"
        )),
        [x, y, z] => Ok((x, y, z)),
    };
    let line = || match &feature.form {
        Form::Line(points) if points.len() == 2 => {
            let [from, to] = [points[0], points[1]].map(|[x, y, _]| (x, y));
            Ok((from, to))
        }
        other => Err(format!(
            "`{name}` has {} points, a gauge of kind {kind:?} needs a line from one point to another",
            other.points().len()
        )),
    };
    Ok(match kind {
        GaugeKindFile::SurfaceElevation => {
            let [x, y, _] = point()?;
            GaugeFile::SurfaceElevation { name, x, y }
        }
        GaugeKindFile::Pressure => {
            let position = high_point()?;
            GaugeFile::Pressure {
                name,
                position,
                diameter: 0.0,
                averaging_time: 0.0,
            }
        }
        GaugeKindFile::Velocity => {
            let position = high_point()?;
            GaugeFile::Velocity { name, position }
        }
        GaugeKindFile::RunUp => {
            let (from, to) = line()?;
            GaugeFile::RunUp { name, from, to }
        }
        GaugeKindFile::Front => {
            let (from, to) = line()?;
            GaugeFile::Front { name, from, to }
        }
        GaugeKindFile::Overtopping => {
            let (from, to) = line()?;
            GaugeFile::Overtopping { name, from, to }
        }
    })
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use std::fs;

    use super::*;
    use crate::scene::parse;

    fn scene(terrain: &str, gauges: &str) -> SceneFile {
        let text = format!(
            r#"(title: "a map", domain: (min: (0, 0, -9), max: (90, 90, 9)), {terrain} gauges: [{gauges}], time: (duration: 1))"#
        );
        parse::read(&text).unwrap()
    }

    const MAP: &str = r#"terrain: (sources: [(file: "land.asc")], origin: (412000, 6904000, 50)),"#;

    fn found(terrain: &str, gauges: &str, files: &[(&str, &str)]) -> Result<Placed, String> {
        let folder = tempfile::tempdir().unwrap();
        for (file, text) in files {
            fs::write(folder.path().join(file), text).unwrap();
        }
        let access = Access::of(folder.path());
        placed(scene(terrain, gauges), &access).map_err(|found| found[0].message.clone())
    }

    /// The gauges of the map are those typed in the scene's own coordinates.
    fn check(gauges: &str, files: &[(&str, &str)], expected: &str) {
        let found = found(MAP, gauges, files).unwrap().file;
        assert_eq!(found, scene(MAP, expected), "{gauges}");
    }

    #[test]
    fn gauges_of_the_map_are_shifted() {
        check(
            r#"OnMap(SurfaceElevation(name: "a", x: 412010.5, y: 6904020)), OnMap(Pressure(name: "p", position: (412001, 6904002, 53))),
               RunUp(name: "own", from: (1, 2), to: (3, 4)), OnMap(RunUp(name: "r", from: (412001, 6904002), to: (412003, 6904004)))"#,
            &[],
            r#"SurfaceElevation(name: "a", x: 10.5, y: 20), Pressure(name: "p", position: (1, 2, 3)),
               RunUp(name: "own", from: (1, 2), to: (3, 4)), RunUp(name: "r", from: (1, 2), to: (3, 4))"#,
        );
    }

    #[test]
    fn gauges_of_files_have_their_names() {
        let list = (
            "list.csv",
            "Name;E;N;Z\nquay;412001,5;6904002;53\n;412003;6904004;54\n",
        );
        check(
            r#"FromFile(file: "list.csv", kind: SurfaceElevation)"#,
            &[list],
            r#"SurfaceElevation(name: "quay", x: 1.5, y: 2), SurfaceElevation(name: "list_2", x: 3, y: 4)"#,
        );
        check(
            r#"FromFile(file: "list.csv", kind: Velocity)"#,
            &[list],
            r#"Velocity(name: "quay", position: (1.5, 2, 3)), Velocity(name: "list_2", position: (3, 4, 4))"#,
        );
        let lines = r#"{"type": "FeatureCollection", "features": [{"type": "Feature", "properties": {"name": "crest"},
            "geometry": {"type": "LineString", "coordinates": [[412001, 6904002], [412003, 6904004]]}}]}"#;
        check(
            r#"FromFile(file: "lines.geojson", kind: Overtopping)"#,
            &[("lines.geojson", lines)],
            r#"Overtopping(name: "crest", from: (1, 2), to: (3, 4))"#,
        );
    }

    /// Problems of a gauge are told where it is written.
    #[test]
    fn problems_are_those_of_the_written_gauge() {
        let files = [("two.csv", "x,y\n412001,6904002\n412003,6904004\n")];
        let gauges = r#"SurfaceElevation(name: "a", x: 1, y: 2), FromFile(file: "two.csv", kind: SurfaceElevation), OnMap(SurfaceElevation(name: "b", x: 412001, y: 6904002))"#;
        let written = found(MAP, gauges, &files).unwrap().written;
        let path = |path: &str| {
            written.located(vec![Problem::error(Code::DryGauge, path, "")])[0]
                .path
                .clone()
        };
        assert_eq!(path("gauges[0].x"), "gauges[0].x");
        assert_eq!(path("gauges[2].x"), "gauges[1].file");
        assert_eq!(path("gauges[3].x"), "gauges[2][0].x");
        assert_eq!(path("blocks[3].shape"), "blocks[3].shape");
    }

    #[test]
    fn what_has_no_place_is_refused() {
        let files = [
            ("flat.csv", "x,y\n412001,6904002\n"),
            (
                "round.geojson",
                r#"{"type": "LineString", "coordinates": [[412001, 6904002], [412003, 6904004], [412005, 6904004]]}"#,
            ),
            ("degrees.csv", "x,y\n7.3,62.2\n"),
        ];
        for (terrain, gauges, expected) in [
            (
                MAP,
                r#"OnMap(BlockForce(name: "f", block: "b"))"#,
                "gauge `f` has no coordinates; write it without OnMap",
            ),
            (
                MAP,
                r#"OnMap(OnMap(SurfaceElevation(name: "a", x: 1, y: 2)))"#,
                "is on the map already; write it without OnMap",
            ),
            (
                "",
                r#"OnMap(SurfaceElevation(name: "a", x: 1, y: 2))"#,
                "the scene has no terrain and no map; write the gauge without OnMap, from (0, 0, 0) of the scene",
            ),
            (
                MAP,
                r#"FromFile(file: "flat.csv", kind: Pressure)"#,
                "`flat.csv`: `flat_1` has no elevation, a gauge of kind Pressure needs one: a column z, or a third coordinate",
            ),
            (
                MAP,
                r#"FromFile(file: "round.geojson", kind: SurfaceElevation)"#,
                "`round.geojson`: `round_1` is a line or a polygon, a gauge of kind SurfaceElevation needs points",
            ),
            (
                MAP,
                r#"FromFile(file: "round.geojson", kind: RunUp)"#,
                "`round.geojson`: `round_1` has 3 points, a gauge of kind RunUp needs a line from one point to another",
            ),
            (
                MAP,
                r#"FromFile(file: "degrees.csv", kind: SurfaceElevation)"#,
                "`degrees.csv`: is in degrees, terrain is in meters; project it: ogr2ogr -s_srs EPSG:4326 -t_srs EPSG:32632 out.geojson in",
            ),
        ] {
            let refused = found(terrain, gauges, &files).err();
            assert_eq!(refused.as_deref(), Some(expected));
        }
    }
}
