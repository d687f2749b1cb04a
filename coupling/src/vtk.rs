//! VTK XML PolyData: what ParaView opens.

/// Points and polygons with their arrays, at one time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PolyData {
    /// Points; m.
    pub points: Vec<[f32; 3]>,
    /// Polygons over the points; empty for a cloud, which gets a vertex cell per point instead.
    pub polygons: Polygons,
    /// Arrays with a value per point.
    pub point_data: Vec<Array>,
    /// Arrays with a value per polygon.
    pub cell_data: Vec<Array>,
    /// Simulated time; s.
    pub time: f64,
}

/// Polygons as packed corner numbers.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Polygons {
    /// Corner numbers, polygon after polygon.
    pub connectivity: Vec<i32>,
    /// End of each polygon in `connectivity`.
    pub offsets: Vec<i32>,
}

/// A named array.
#[derive(Clone, Debug, PartialEq)]
pub struct Array {
    /// Stable name, e.g. `Velocity`.
    pub name: String,
    /// Numbers per tuple: 1 or 3.
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
