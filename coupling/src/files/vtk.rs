//! VTK XML PolyData, readable by ParaView.
//!
//! One file holds one kind of object at one time (`water_00042.vtp`); a [`Collection`] assigns times to the files of a
//! run. Layout of a file, as written by the VTK library:
//!
//! ```text
//! XML header        names, types, counts, one offset per array, TimeValue as text
//! appended data     '_', then array after array:
//!                   [blocks] [block size] [size of a shorter last block or 0] [compressed sizes …]  u64 each
//!                   zlib streams, one per block
//! ```
//!
//! Everything is little endian, raw after the underscore. Numbers are stored unchanged, including NaN.

mod check;
mod collection;
mod read;
mod write;

pub use check::{Fault, VtkError};
pub use collection::Collection;
pub use read::read;
pub(crate) use write::escape;
pub use write::{replace_file, write};

/// Points with polygons or lines over them and their arrays, at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PolyData {
    /// Points; m.
    pub points: Vec<[f32; 3]>,
    /// Lines through the points, in place of polygons.
    pub lines: Polygons,
    /// Polygons over the points. Without polygons and lines it is a cloud, which gets a vertex cell per point instead.
    pub polygons: Polygons,
    /// Arrays with a value per point.
    pub point_data: Vec<Array>,
    /// Arrays with a value per polygon, or per line.
    pub cell_data: Vec<Array>,
    /// Lists of names that integer arrays refer to by position, as string arrays among the field data.
    pub names: Vec<Names>,
    /// Simulated time; s.
    pub time: f64,
}

/// Polygons or lines as packed corner numbers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Polygons {
    /// Corner numbers, polygon after polygon.
    pub connectivity: Vec<i32>,
    /// End of each polygon in `connectivity`.
    pub offsets: Vec<i32>,
}

/// A list of names.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Names {
    /// Name of the list, e.g. `BlockNames`.
    pub name: String,
    /// Names without null characters.
    pub list: Vec<String>,
}

/// A named array.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// Stable name, e.g. `Velocity`.
    pub name: String,
    /// Numbers per tuple: 1, 3 or 6.
    pub components: usize,
    /// Values, tuple after tuple.
    pub values: Values,
}

/// The numbers of an array.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Single precision.
    F32(Vec<f32>),
    /// Double precision.
    F64(Vec<f64>),
    /// Integers.
    I32(Vec<i32>),
}

impl Polygons {
    /// Number of polygons.
    pub fn len(&self) -> usize {
        self.offsets.len()
    }

    /// Whether it is empty.
    pub fn is_empty(&self) -> bool {
        self.offsets.is_empty()
    }

    /// Corner numbers of each polygon; valid polygons only, as [`read()`] returns them.
    pub fn iter(&self) -> impl Iterator<Item = &[i32]> + '_ {
        let mut start = 0;
        self.offsets.iter().map_while(move |&end| {
            let corners = self.connectivity.get(start..end as usize)?;
            start = end as usize;
            Some(corners)
        })
    }
}

impl Values {
    /// Number of values, all components counted.
    pub fn len(&self) -> usize {
        match self {
            Self::F32(values) => values.len(),
            Self::F64(values) => values.len(),
            Self::I32(values) => values.len(),
        }
    }

    /// Whether it is empty.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
