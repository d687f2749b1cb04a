//! Keys of a GeoTIFF: the reference system, and the meaning of its pixels.

use tiff::tags::Tag;

use super::{File, refuse};
use crate::scene::access::fault::Fault;
use crate::scene::geometry::crs::{Content, Crs};

/// Numbers of keys.
pub(super) const MODEL_TYPE: u16 = 1024;
pub(super) const RASTER_TYPE: u16 = 1025;
const CITATION: u16 = 1026;
const GEOGRAPHIC_SYSTEM: u16 = 2048;
pub(super) const PROJECTED_SYSTEM: u16 = 3072;
pub(super) const PROJECTED_CITATION: u16 = 3073;
pub(super) const LINEAR_UNITS: u16 = 3076;
/// Values of keys.
pub(super) const PROJECTED: u16 = 1;
const GEOGRAPHIC: u16 = 2;
pub(super) const PIXEL_IS_AREA: u16 = 1;
pub(super) const PIXEL_IS_POINT: u16 = 2;
pub(super) const METER: u16 = 9001;
pub(super) const USER_DEFINED: u16 = 32_767;
/// Prefix of well-known text in a citation, a habit of ESRI that GDAL reads.
pub(super) const TEXT_OF_SYSTEM: &str = "ESRI PE String = ";
/// EPSG code of longitude and latitude on WGS 84.
const WGS_84: u16 = 4326;

/// Keys of a file.
pub(in crate::scene::geometry) struct Keys {
    /// Entries of four: key, place of the value, count, value or index.
    entries: Vec<u16>,
    texts: String,
}

impl Keys {
    /// Keys of a file, which may have none.
    ///
    /// # Errors
    ///
    /// [`Fault::Format`] for an entry that is cut off.
    pub(super) fn read(file: &mut File) -> Result<Self, Fault> {
        let entries = file.get_tag_u16_vec(Tag::GeoKeyDirectoryTag);
        let texts = file.get_tag_ascii_string(Tag::GeoAsciiParamsTag);
        Self::of(entries.unwrap_or_default(), texts.unwrap_or_default())
    }

    /// Keys of a directory and of the texts that it points into.
    ///
    /// # Errors
    ///
    /// As [`Keys::read`].
    pub(in crate::scene::geometry) fn of(entries: Vec<u16>, texts: String) -> Result<Self, Fault> {
        if !entries.len().is_multiple_of(4) {
            return Err(refuse(
                "has a directory of GeoKeys that is cut off; export it again",
            ));
        }
        Ok(Self { entries, texts })
    }

    fn entry(&self, key: u16) -> Option<&[u16]> {
        // the first four are the version and the count
        let mut entries = self.entries.chunks_exact(4).skip(1);
        entries.find(|entry| entry[0] == key)
    }

    fn value(&self, key: u16) -> Option<u16> {
        let entry = self.entry(key).filter(|entry| entry[1] == 0)?;
        Some(entry[3])
    }

    fn text(&self, key: u16) -> Option<&str> {
        let entry = self.entry(key).filter(|entry| entry[1] != 0)?;
        let (count, start) = (usize::from(entry[2]), usize::from(entry[3]));
        let text = self.texts.get(start..start + count)?;
        Some(text.trim_end_matches(['|', '\0']))
    }

    pub(super) fn is_point(&self) -> bool {
        self.value(RASTER_TYPE) == Some(PIXEL_IS_POINT)
    }

    /// The reference system, by its code or by the well-known text of its citation.
    pub(in crate::scene::geometry) fn crs(&self) -> Option<Crs> {
        let code = |key| self.value(key).filter(|code| *code != USER_DEFINED);
        if self.value(MODEL_TYPE) == Some(GEOGRAPHIC) {
            let code = code(GEOGRAPHIC_SYSTEM).and_then(|code| Crs::of_epsg(code).ok());
            return code.or_else(|| Crs::of_epsg(WGS_84).ok());
        }
        let by_code = code(PROJECTED_SYSTEM).and_then(|code| Crs::of_epsg(code).ok());
        by_code.or_else(|| {
            let citations = [PROJECTED_CITATION, CITATION].into_iter();
            let mut texts = citations.filter_map(|key| self.text(key));
            texts.find_map(|text| Crs::of_wkt(text.strip_prefix(TEXT_OF_SYSTEM)?).ok())
        })
    }

    /// Check of the unit of a system that has no known code.
    ///
    /// # Errors
    ///
    /// [`Fault::Format`].
    pub(in crate::scene::geometry) fn in_meters(&self, content: Content) -> Result<(), Fault> {
        match self.value(LINEAR_UNITS) {
            Some(unit) if unit != METER && unit != USER_DEFINED => Err(refuse(format!(
                "has a plan in units of EPSG {unit}, needed are meters (9001); project it with {}",
                content.tool()
            ))),
            _ => Ok(()),
        }
    }
}
