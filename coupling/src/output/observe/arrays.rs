//! Arrays of VTK frames from columns of the world.

use riprap_dda::Vec3;

use crate::files::vtk::{Array, Values};

/// A vector in single precision, as VTK files have it.
pub(crate) fn single(v: &Vec3) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

/// Array of a number per point or cell.
pub(crate) fn scalars(name: &str, values: Vec<f32>) -> Array {
    Array {
        name: name.to_owned(),
        components: 1,
        values: Values::F32(values),
    }
}

/// Array of a vector per point or cell.
pub(crate) fn vectors<'a>(name: &str, values: impl Iterator<Item = &'a Vec3>) -> Array {
    // collected as vectors, whose number is known, and not grown number by number
    let values: Vec<[f32; 3]> = values.map(single).collect();
    Array {
        name: name.to_owned(),
        components: 3,
        values: Values::F32(values.into_flattened()),
    }
}

/// Array of an integer per point or cell.
pub(crate) fn integers(name: &str, values: Vec<i32>) -> Array {
    Array {
        name: name.to_owned(),
        components: 1,
        values: Values::I32(values),
    }
}
