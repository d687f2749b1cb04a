//! Wavefront OBJ: faces of any number of corners; colours, normals and materials are left aside.

use riprap_dda::Vec3;

use super::{Fault, Soup};

pub(super) fn read(content: &[u8]) -> Result<Soup, Fault> {
    let options = tobj::LoadOptions {
        ignore_points: true,
        ignore_lines: true,
        ..tobj::LoadOptions::default()
    };
    // a missing material library is no reason to refuse a block
    let no_materials = |_: &std::path::Path| -> tobj::MTLLoadResult { Ok(Default::default()) };
    let (models, _) = tobj::load_obj_buf(&mut &*content, &options, no_materials)
        .map_err(|error| Fault::Format(error.to_string()))?;
    let mut soup = Soup::default();
    for model in models {
        let mesh = model.mesh;
        let first = soup.points.len() as u32;
        let points = mesh.positions.as_chunks::<3>().0;
        soup.points.extend(points.iter().map(|p| Vec3::from(*p)));
        // no list of numbers of corners means triangles throughout
        let arities = if mesh.face_arities.is_empty() {
            vec![3; mesh.indices.len() / 3]
        } else {
            mesh.face_arities
        };
        let mut start = 0;
        for arity in arities {
            let end = start + arity as usize;
            let face = mesh.indices.get(start..end).unwrap_or_default();
            let corners: Vec<u32> = face.iter().map(|v| first + v).collect();
            soup.push_polygon(&corners)?;
            start = end;
        }
    }
    Ok(soup)
}
