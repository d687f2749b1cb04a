//! Clouds from LAS and LAZ files (ASPRS LAS 1.0 to 1.4).

mod lengths;

use std::io::Cursor;

use las::{PointDataBuilder, Reader};

use super::Cloud;
use crate::scene::access::fault::Fault;
use crate::scene::geometry::crs::{Content, Crs};
use crate::scene::geometry::geotiff::Keys;

/// Points decoded at once.
const BATCH: u64 = 1 << 16;
/// Classes of points on the ground and on the bed of water (LAS 1.4 R15, table 17).
const GROUND: u8 = 2;
const KEY_POINT: u8 = 8;
const BED: u8 = 40;
/// Classes of noise.
const NOISE: [u8; 2] = [7, 18];
/// Records of the reference system.
const SYSTEM_OF: &str = "LASF_Projection";
const GEO_KEYS: u16 = 34_735;
const GEO_TEXTS: u16 = 34_737;

/// True for the first bytes of a LAS or LAZ file.
pub(super) fn is_las(content: &[u8]) -> bool {
    content.starts_with(b"LASF")
}

/// Cloud in the content of a file: the points of the ground, if some are classified so, all but noise if not.
///
/// # Errors
///
/// [`Fault`], with the remedy.
pub(super) fn cloud_of(content: &[u8]) -> Result<Cloud, Fault> {
    lengths::check(content)?;
    // the reader takes what lives as long as itself
    let mut reader = Reader::new(Cursor::new(content.to_vec())).map_err(unread)?;
    let crs = crs_of(&reader)?;
    let n = reader.header().number_of_points();
    let mut batch = PointDataBuilder::new().for_header(reader.header()).build();
    let (mut points, mut classes) = (Vec::new(), Vec::new());
    while (points.len() as u64) < n {
        let n_read = reader.fill_points(BATCH, &mut batch).map_err(unread)?;
        if n_read == 0 {
            break;
        }
        classes.extend(batch.classification());
        points.extend((batch.x().zip(batch.y()).zip(batch.z())).map(|((x, y), z)| [x, y, z]));
    }
    if !points.iter().flatten().all(|value| value.is_finite()) {
        let what =
            "has scales or offsets that are no numbers; write it again: pdal translate in out.laz";
        return Err(Fault::Format(what.into()));
    }
    let n_in_file = points.len();
    let is_ground = |class: u8| [GROUND, KEY_POINT, BED].contains(&class);
    let has_ground = classes.iter().any(|&class| class == GROUND || class == BED);
    let is_wanted = |class: u8| {
        if has_ground {
            is_ground(class)
        } else {
            !NOISE.contains(&class)
        }
    };
    let mut class = classes.into_iter();
    points.retain(|_| class.next().is_some_and(is_wanted));
    if points.is_empty() {
        return Err(Fault::Format(format!(
            "has {n_in_file} points, none of the ground; export those of class 2"
        )));
    }
    Ok(Cloud {
        points,
        n_in_file,
        crs,
    })
}

fn unread(error: las::Error) -> Fault {
    Fault::Format(format!(
        "is not a readable LAS file: {error}; write it again: pdal translate in out.laz"
    ))
}

/// The system, from well-known text or from GeoKeys.
fn crs_of(reader: &Reader) -> Result<Option<Crs>, Fault> {
    let header = reader.header();
    if let Some(text) = header.get_wkt_crs_bytes() {
        let text = String::from_utf8_lossy(text);
        let crs = Crs::of_wkt(text.trim_end_matches('\0'));
        return Ok(crs.ok());
    }
    let record = |id: u16| {
        let mut records = header.all_vlrs();
        let found = records.find(|vlr| vlr.user_id == SYSTEM_OF && vlr.record_id == id);
        found.map(|vlr| vlr.data.as_slice())
    };
    let Some(entries) = record(GEO_KEYS) else {
        return Ok(None);
    };
    let words = entries.chunks_exact(2);
    let mut entries: Vec<u16> = words.map(|b| u16::from_le_bytes([b[0], b[1]])).collect();
    // some writers pad the directory
    let n_keys = entries.get(3).copied().unwrap_or_default();
    entries.truncate(4 * (usize::from(n_keys) + 1));
    let texts = record(GEO_TEXTS).map(|text| String::from_utf8_lossy(text).into_owned());
    let keys = Keys::of(entries, texts.unwrap_or_default())?;
    let crs = keys.crs();
    if crs.is_none() {
        keys.in_meters(Content::Cloud)?;
    }
    Ok(crs)
}
