//! Lengths that a LAS file promises, before memory is reserved for them.

use std::io::Cursor;

use laz::LazVlr;
use laz::laszip::ChunkTable;

use crate::scene::access::fault::Fault;
use crate::scene::geometry::cloud::MOST_POINTS;

/// Places and sizes in the header (LAS 1.4 R15, table 3); bytes.
const HEADER: usize = 227;
const MINOR_VERSION: usize = 25;
const HEADER_SIZE: usize = 94;
const POINTS_START: usize = 96;
const N_RECORDS: usize = 100;
const FORMAT: usize = 104;
const POINT_SIZE: usize = 105;
const N_POINTS: usize = 107;
const SCALES: usize = 131;
const EXTENDED_START: usize = 235;
const N_EXTENDED: usize = 243;
const N_POINTS_14: usize = 247;
/// Sizes of the heads of variable length records, and the place of the length in them; bytes.
const RECORD_HEAD: usize = 54;
const EXTENDED_HEAD: usize = 60;
const RECORD_LENGTH: usize = 18 + 2;
/// Bits of the format of compressed points.
const IS_COMPRESSED: u8 = 0xC0;
/// Sizes of layers before a compressed chunk of points of 1.4; bytes.
const LAYER: usize = 4;
const LAYERS_OF_POINT: usize = 9;
/// Kinds of compression, the first number of their record: all points in one chunk, and chunks of layers.
const ONE_CHUNK: u16 = 1;
const LAYERED: u16 = 3;

/// Check of all lengths in the header, the records and the chunks against the length of the file.
///
/// # Errors
///
/// [`Fault::Format`].
pub(super) fn check(content: &[u8]) -> Result<(), Fault> {
    let file = File(content);
    let (Some(minor), true) = (content.get(MINOR_VERSION).copied(), content.len() >= HEADER) else {
        return Err(cut_off("its header"));
    };
    let header_size = usize::from(file.u16(HEADER_SIZE)?);
    let start = file.u32(POINTS_START)? as usize;
    if header_size < HEADER || start < header_size || content.len() < start {
        return Err(cut_off("its header"));
    }
    for axis in 0..3 {
        let scale = f64::from_bits(file.u64(SCALES + 8 * axis)?);
        if !(scale.is_finite() && scale > 0.0) {
            return Err(Fault::Format(format!(
                "has a scale of {scale} in its header, needed is one above 0; write it again: pdal translate in out.laz"
            )));
        }
    }
    let mut n_points = u64::from(file.u32(N_POINTS)?);
    if minor >= 4 {
        if n_points == 0 {
            n_points = file.u64(N_POINTS_14)?;
        }
        let extended = file.u64(EXTENDED_START)?;
        if file.u32(N_EXTENDED)? > 0 && extended > 0 {
            let at = usize::try_from(extended).map_err(|_| cut_off("its records"))?;
            let length = file.u64(at.saturating_add(RECORD_LENGTH))?;
            let end = extended.saturating_add(EXTENDED_HEAD as u64);
            if end.saturating_add(length) > content.len() as u64 {
                return Err(cut_off("its records"));
            }
        }
    }
    if n_points == 0 {
        return Err(Fault::Format("has no points; export it again".into()));
    }
    if n_points > MOST_POINTS as u64 {
        return Err(Fault::Format(format!(
            "has {n_points} points, more than {MOST_POINTS}; thin it: pdal translate in out.laz decimation --filters.decimation.step=10"
        )));
    }
    let size = u64::from(file.u16(POINT_SIZE)?);
    let compressed = content[FORMAT] & IS_COMPRESSED != 0;
    if !compressed {
        let held = (content.len() - start) as u64 / size.max(1);
        if n_points > held {
            return Err(Fault::Format(format!(
                "is cut off: its header promises {n_points} points, it has {held}; copy it again"
            )));
        }
        return Ok(());
    }
    let mut at = header_size;
    for _ in 0..file.u32(N_RECORDS)? {
        let length = usize::from(file.u16(at.saturating_add(RECORD_LENGTH))?);
        let data = at + RECORD_HEAD;
        let record = content.get(data..data + length);
        let record = record.ok_or_else(|| cut_off("its records"))?;
        if content[at + 2..at + 18].starts_with(LazVlr::USER_ID.as_bytes()) {
            let kind = file.u16(data)?;
            let vlr = LazVlr::from_buffer(record).map_err(unread)?;
            if vlr.items_size() != size {
                return Err(unread("its compression is of other points than its header"));
            }
            return match kind {
                // each byte is of a point or of the next
                ONE_CHUNK => Ok(()),
                _ => chunks(content, start, (&vlr, kind == LAYERED), n_points),
            };
        }
        at = data + length;
    }
    Err(unread("it has no record of its compression"))
}

/// Check of the chunks of a LAZ file against its length and the number of its points.
fn chunks(
    content: &[u8],
    start: usize,
    (vlr, is_layered): (&LazVlr, bool),
    n_points: u64,
) -> Result<(), Fault> {
    let file = File(content);
    let end = content.len();
    let table = |at: usize| file.u64(at).ok().map(|at| at as usize);
    let table = table(start)
        .filter(|at| start < *at && *at < end)
        .or_else(|| table(end - 8).filter(|at| start < *at && *at < end))
        .ok_or_else(|| cut_off("its chunk table"))?;
    // each chunk begins with a whole point
    let n_chunks = file.u32(table.saturating_add(4))? as usize;
    if n_chunks.saturating_mul(vlr.items_size() as usize) > end {
        return Err(cut_off("its chunks"));
    }
    let mut source = Cursor::new(content);
    source.set_position(start as u64);
    let entries = ChunkTable::read_from(&mut source, vlr).map_err(unread)?;
    let entries = entries.as_ref();
    let held = (entries.iter()).fold(0, |n: u64, chunk| n.saturating_add(chunk.point_count));
    if held < n_points {
        return Err(Fault::Format(format!(
            "is cut off: its header promises {n_points} points, its chunks have {held}; copy it again"
        )));
    }
    let mut at = start + 8;
    for chunk in entries {
        let size = usize::try_from(chunk.byte_count).map_err(unread)?;
        if at.saturating_add(size) > table {
            return Err(cut_off("its chunks"));
        }
        if is_layered {
            layers(&file, at, size, vlr)?;
        }
        at += size;
    }
    Ok(())
}

/// Check of the layers of a chunk: a point, a count, the sizes, the layers.
fn layers(file: &File, at: usize, size: usize, vlr: &LazVlr) -> Result<(), Fault> {
    use laz::LazItemType as Item;
    let n_layers: usize = (vlr.items().iter())
        .map(|item| match item.item_type() {
            Item::Point14 => LAYERS_OF_POINT,
            Item::RGBNIR14 => 2,
            Item::Byte14(n) => usize::from(n),
            _ => 1,
        })
        .sum();
    let first = at + vlr.items_size() as usize + 4;
    let mut end = first + LAYER * n_layers;
    for layer in 0..n_layers {
        end = end.saturating_add(file.u32(first + LAYER * layer)? as usize);
    }
    if end != at + size {
        return Err(unread("a chunk is not as long as its layers"));
    }
    Ok(())
}

fn cut_off(what: &str) -> Fault {
    Fault::Format(format!("is cut off within {what}; copy or export it again"))
}

fn unread(error: impl std::fmt::Display) -> Fault {
    Fault::Format(format!(
        "is not a readable LAZ file: {error}; write it again: pdal translate in out.laz"
    ))
}

/// Numbers at places of a file.
struct File<'a>(&'a [u8]);

impl File<'_> {
    fn bytes<const N: usize>(&self, at: usize) -> Result<[u8; N], Fault> {
        let end = at.checked_add(N);
        let bytes = end.and_then(|end| self.0.get(at..end));
        let bytes = bytes.and_then(|bytes| bytes.try_into().ok());
        bytes.ok_or_else(|| cut_off("its header"))
    }

    fn u16(&self, at: usize) -> Result<u16, Fault> {
        self.bytes(at).map(u16::from_le_bytes)
    }

    fn u32(&self, at: usize) -> Result<u32, Fault> {
        self.bytes(at).map(u32::from_le_bytes)
    }

    fn u64(&self, at: usize) -> Result<u64, Fault> {
        self.bytes(at).map(u64::from_le_bytes)
    }
}
