//! Coordinate reference systems of maps, by EPSG code or as well-known text (OGC 01-009, ISO 19162).

mod wkt;

use std::fmt;
use std::io::ErrorKind;
use std::path::Path;
use std::str::FromStr;

use wkt::Node;

use crate::scene::access::Access;
use crate::scene::access::fault::{Fault, MeshError};

/// Unit of a plan in meters; m.
const METER: f64 = 1.0;
/// Tolerance of a unit and of parameters of a projection, relative.
const SAME: f64 = 1e-9;

/// A coordinate reference system in plan view.
#[derive(Clone, Debug)]
pub struct Crs {
    /// Its name.
    pub name: String,
    /// Its EPSG code.
    pub epsg: Option<u16>,
    /// Its well-known text, the content of a `.prj` file.
    pub wkt: String,
    plan: Plan,
}

/// Coordinates in plan view.
#[derive(Clone, Debug)]
enum Plan {
    /// Longitude and latitude; degrees.
    Geographic,
    /// Easting and northing.
    Projected {
        /// Length of their unit; m.
        unit: f64,
        /// Parameters of the projection, ascending.
        parameters: Vec<f64>,
    },
}

/// Reason why a text is no coordinate reference system.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CrsError {
    /// No code or not a known one.
    #[error("EPSG:{0} is not a known coordinate reference system in plan view")]
    Unknown(u16),
    /// Neither a code nor well-known text.
    #[error(
        "`{0}` is no coordinate reference system; write \"EPSG:25833\", or the text of a .prj file"
    )]
    NoText(String),
    /// Well-known text without a system in plan view.
    #[error("has no system in plan view, PROJCS[...] or GEOGCS[...]")]
    NoPlan,
}

impl Crs {
    /// System of an EPSG code; of a compound one its horizontal part.
    ///
    /// # Errors
    ///
    /// [`CrsError::Unknown`].
    pub fn of_epsg(code: u16) -> Result<Self, CrsError> {
        let definition = crs_definitions::from_code(code).ok_or(CrsError::Unknown(code))?;
        Self::of_wkt(definition.wkt).map_err(|_| CrsError::Unknown(code))
    }

    /// System of a well-known text; of a compound one its horizontal part.
    ///
    /// # Errors
    ///
    /// [`CrsError::NoText`] and [`CrsError::NoPlan`].
    pub fn of_wkt(text: &str) -> Result<Self, CrsError> {
        let text = text.trim_start_matches('\u{feff}').trim();
        let root = Node::parse(text).ok_or_else(|| {
            let start: String = text.chars().take(30).collect();
            CrsError::NoText(start)
        })?;
        let node = root.horizontal().ok_or(CrsError::NoPlan)?;
        let name = node.name().to_owned();
        let epsg = node.epsg().or_else(|| epsg_of_utm(&name));
        let plan = if node.is_geographic() {
            Plan::Geographic
        } else {
            let mut parameters = node.parameters();
            parameters.sort_by(f64::total_cmp);
            Plan::Projected {
                unit: node.unit().unwrap_or(METER),
                parameters,
            }
        };
        Ok(Self {
            name,
            epsg,
            wkt: node.text.to_owned(),
            plan,
        })
    }

    /// True for longitude and latitude in degrees.
    pub fn is_in_degrees(&self) -> bool {
        matches!(self.plan, Plan::Geographic)
    }

    /// Length of the unit of easting and northing, if that is not the meter; m.
    pub fn odd_unit(&self) -> Option<f64> {
        match self.plan {
            Plan::Projected { unit, .. } if (unit - METER).abs() > SAME => Some(unit),
            Plan::Projected { .. } | Plan::Geographic => None,
        }
    }

    /// True if coordinates of both have the same meaning: the same code, or the same projection where one has no code.
    pub fn agrees_with(&self, other: &Self) -> bool {
        if let (Some(code), Some(theirs)) = (self.epsg, other.epsg) {
            return code == theirs;
        }
        match (&self.plan, &other.plan) {
            (Plan::Geographic, Plan::Geographic) => true,
            (Plan::Projected { parameters: a, .. }, Plan::Projected { parameters: b, .. }) => {
                let is_near = |(a, b): (&f64, &f64)| (a - b).abs() <= SAME * a.abs().max(1.0);
                a.len() == b.len() && a.iter().zip(b).all(is_near)
            }
            _ => false,
        }
    }

    /// Check of the unit of coordinates; `at` is the middle of the map.
    ///
    /// # Errors
    ///
    /// [`Fault`], with the remedy.
    pub fn in_meters(&self, content: Content, at: [f64; 2]) -> Result<(), Fault> {
        if self.is_in_degrees() {
            return Err(content.in_degrees(Some(self), at));
        }
        match self.odd_unit() {
            None => Ok(()),
            Some(unit) => Err(Fault::Format(format!(
                "has a plan in units of {unit:.6} m, {self}; project it to meters with {}",
                content.tool()
            ))),
        }
    }

    /// System of the `.prj` file beside a file that the scene names, if there is one.
    ///
    /// # Errors
    ///
    /// [`MeshError`] names the `.prj` file.
    pub fn beside(access: &Access, file: &str) -> Result<Option<Self>, MeshError> {
        let file = Path::new(file).with_extension("prj");
        let file = file.to_string_lossy();
        let refuse = |fault| MeshError {
            file: file.clone().into_owned(),
            fault,
        };
        let text = match access.read(&file) {
            Ok(text) => text,
            Err(Fault::Unreadable(error)) if error.kind() == ErrorKind::NotFound => {
                return Ok(None);
            }
            Err(fault) => return Err(refuse(fault)),
        };
        let crs = Self::of_wkt(&String::from_utf8_lossy(&text));
        crs.map(Some).map_err(|_| {
            let what = "is no well-known text of a reference system; export it again, or remove it and name the system with `crs`";
            refuse(Fault::Format(what.into()))
        })
    }

    /// The system in a scene: its code, or its text where it has none.
    pub fn written(&self) -> String {
        self.epsg
            .map_or_else(|| self.wkt.clone(), |code| format!("EPSG:{code}"))
    }
}

impl PartialEq for Crs {
    fn eq(&self, other: &Self) -> bool {
        (self.epsg, &self.wkt) == (other.epsg, &other.wkt)
    }
}

impl fmt::Display for Crs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.epsg {
            Some(code) => write!(f, "EPSG:{code} ({})", self.name),
            None => write!(f, "{}", self.name),
        }
    }
}

impl FromStr for Crs {
    type Err = CrsError;

    /// `EPSG:25833`, `25833`, or well-known text.
    fn from_str(text: &str) -> Result<Self, CrsError> {
        let text = text.trim();
        let code = text.get(..5).filter(|p| p.eq_ignore_ascii_case("epsg:"));
        let digits = code.map_or(text, |prefix| &text[prefix.len()..]);
        match digits.trim().parse() {
            Ok(code) => Self::of_epsg(code),
            Err(_) => Self::of_wkt(text),
        }
    }
}

/// Code of a zone of UTM by the name that ESRI and others give it, such as `ETRS_1989_UTM_Zone_33N`.
fn epsg_of_utm(name: &str) -> Option<u16> {
    let words: String = name
        .chars()
        .filter(char::is_ascii_alphanumeric)
        .map(|c| c.to_ascii_lowercase())
        .collect();
    let (datum, zone) = words.split_once("utmzone")?;
    let (number, is_north) = match zone.strip_suffix('n') {
        Some(number) => (number, true),
        None => (zone.strip_suffix('s')?, false),
    };
    let number: u16 = number.parse().ok().filter(|n| (1..=60).contains(n))?;
    match (datum, is_north) {
        ("wgs1984" | "wgs84", true) => Some(32_600 + number),
        ("wgs1984" | "wgs84", false) => Some(32_700 + number),
        ("etrs1989" | "etrs89", true) if (28..=38).contains(&number) => Some(25_800 + number),
        ("nad1983" | "nad83", true) if (1..=23).contains(&number) => Some(26_900 + number),
        _ => None,
    }
}

/// Content of a map, for the command that projects it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// Elevations.
    Raster,
    /// Points, lines and polygons.
    Features,
    /// Scattered points with elevations.
    Cloud,
}

impl Content {
    /// Program that projects a file, and its option for the system.
    pub(super) fn tool(self) -> &'static str {
        match self {
            Self::Raster => "gdalwarp -t_srs",
            Self::Features => "ogr2ogr -t_srs",
            Self::Cloud => "pdal translate, --filters.reprojection.out_srs",
        }
    }

    /// Command that projects a file into a system; `source` for a file that does not name its own.
    fn command(self, target: &str, source: &str) -> String {
        let from = |option: &str| match source {
            "" => String::new(),
            system => format!("{option}{system} "),
        };
        match self {
            Self::Raster => format!("gdalwarp {}-t_srs {target} in out.tif", from("-s_srs ")),
            Self::Features => format!("ogr2ogr {}-t_srs {target} out.geojson in", from("-s_srs ")),
            Self::Cloud => format!(
                "pdal translate in out.laz reprojection {}--filters.reprojection.out_srs={target}",
                from("--filters.reprojection.in_srs=")
            ),
        }
    }

    /// Command that projects a file into another system.
    pub fn projected_to(self, crs: &Crs) -> String {
        let code = crs.epsg.map(|code| format!("EPSG:{code}"));
        self.command(code.as_deref().unwrap_or("other.prj"), "")
    }

    /// Fault of a map in degrees around a place, with its system if the file names it.
    pub fn in_degrees(self, crs: Option<&Crs>, at: [f64; 2]) -> Fault {
        let zone = utm_zone(at[0], at[1]);
        let source = crs.map_or("EPSG:4326", |_| "");
        Fault::Degrees {
            system: crs.map_or_else(String::new, |crs| format!(" of {crs}")),
            command: self.command(&format!("EPSG:{zone}"), source),
        }
    }
}

/// EPSG code of the zone of UTM around a place, on WGS 84; of the polar stereographic systems beyond it.
pub fn utm_zone(longitude: f64, latitude: f64) -> u32 {
    let east = (longitude + 180.0).rem_euclid(360.0);
    let zone = (east / 6.0) as u32 % 60 + 1;
    match latitude {
        _ if latitude > 84.0 => 32_661,
        _ if latitude < -80.0 => 32_761,
        _ if latitude < 0.0 => 32_700 + zone,
        _ => 32_600 + zone,
    }
}

#[cfg(test)]
#[expect(clippy::unwrap_used, reason = "a test may fail")]
mod tests {
    use super::*;

    /// As ArcGIS writes it: no codes, names and parameters in another case.
    const ESRI: &str = r#"PROJCS["British_National_Grid",GEOGCS["GCS_OSGB_1936",DATUM["D_OSGB_1936",SPHEROID["Airy_1830",6377563.396,299.3249646]],PRIMEM["Greenwich",0.0],UNIT["Degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],PARAMETER["False_Easting",400000.0],PARAMETER["False_Northing",-100000.0],PARAMETER["Central_Meridian",-2.0],PARAMETER["Scale_Factor",0.9996012717],PARAMETER["Latitude_Of_Origin",49.0],UNIT["Meter",1.0]]"#;

    #[test]
    fn a_code_is_known_under_its_names() {
        let code = Crs::of_epsg(25_833).unwrap();
        assert_eq!(code.to_string(), "EPSG:25833 (ETRS89 / UTM zone 33N)");
        assert_eq!(code.written(), "EPSG:25833");
        for text in ["EPSG:25833", "epsg: 25833", "25833", &code.wkt] {
            assert_eq!(text.parse::<Crs>().unwrap(), code, "{text}");
        }
        // with the heights of Norway: the same plan
        assert_eq!(Crs::of_epsg(5973).unwrap(), code);
        let esri = code
            .wkt
            .replace("ETRS89 / UTM zone 33N", "ETRS_1989_UTM_Zone_33N");
        let esri = esri.replace(r#",AUTHORITY["EPSG","25833"]"#, "");
        let esri: Crs = esri.parse().unwrap();
        assert!(esri.epsg == code.epsg && esri.agrees_with(&code));
    }

    #[test]
    fn systems_without_a_code_agree_by_their_projection() {
        let esri: Crs = ESRI.parse().unwrap();
        assert_eq!((esri.epsg, esri.written()), (None, ESRI.to_owned()));
        assert!(esri.agrees_with(&Crs::of_epsg(27_700).unwrap()));
        assert!(!esri.agrees_with(&Crs::of_epsg(25_833).unwrap()));
        assert!(
            !Crs::of_epsg(25_832)
                .unwrap()
                .agrees_with(&Crs::of_epsg(25_833).unwrap())
        );
    }

    #[test]
    fn degrees_and_feet_are_known() {
        let degrees = Crs::of_epsg(4326).unwrap();
        assert!(degrees.is_in_degrees() && degrees.odd_unit().is_none());
        // California zone 6, US survey feet of 1200/3937 m
        let feet = Crs::of_epsg(2230).unwrap();
        assert!((feet.odd_unit().unwrap() - 1200.0 / 3937.0).abs() < 1e-9);
        let newer = r#"PROJCRS["x",BASEGEOGCRS["WGS 84",ID["EPSG",4326]],CONVERSION["c",METHOD["Transverse Mercator"],PARAMETER["Latitude of natural origin",0,ANGLEUNIT["degree",0.0174532925199433]]],CS[Cartesian,2],AXIS["(E)",east],AXIS["(N)",north],LENGTHUNIT["metre",1],ID["EPSG",32633]]"#;
        let newer: Crs = newer.parse().unwrap();
        assert_eq!(
            (newer.epsg, newer.odd_unit(), newer.is_in_degrees()),
            (Some(32_633), None, false)
        );
    }

    #[test]
    fn other_texts_are_refused() {
        for (text, expected) in [
            ("EPSG:1", CrsError::Unknown(1)),
            ("UTM 33", CrsError::NoText("UTM 33".to_owned())),
            ("PROJCS[\"x\"", CrsError::NoText("PROJCS[\"x\"".to_owned())),
            (r#"VERT_CS["NN2000 height"]"#, CrsError::NoPlan),
        ] {
            assert_eq!(text.parse::<Crs>(), Err(expected));
        }
    }

    #[test]
    fn zones_of_utm() {
        for (place, expected) in [
            ((7.0, 62.0), 32_632),
            ((15.0, 60.0), 32_633),
            ((-70.6, -33.4), 32_719),
            ((180.0, 10.0), 32_601),
            ((359.0, 10.0), 32_630),
            ((0.0, 88.0), 32_661),
        ] {
            assert_eq!(utm_zone(place.0, place.1), expected, "{place:?}");
        }
    }
}
