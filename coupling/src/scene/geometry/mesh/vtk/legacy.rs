//! Legacy files, text or binary.

use vtkio::model::{DataSet, Piece, VertexNumbers};

use super::{Soup, unreadable};
use super::{broken_lists, no_surface, push_cell, push_points, push_polygon, push_strip};
use crate::scene::access::fault::Fault;

/// The surface of a legacy file; a binary one is big-endian by definition.
pub(in crate::scene::geometry::mesh) fn read(content: &[u8]) -> Result<Soup, Fault> {
    let title = content.split(|&b| b == b'\n').next().unwrap_or_default();
    let title = String::from_utf8_lossy(title);
    if !title.starts_with("# vtk DataFile Version") {
        return Err(Fault::Format(
            "does not begin with `# vtk DataFile Version`".into(),
        ));
    }
    // version 5 lists offsets instead of counts, which the reader does not know
    if title.contains("Version 5") {
        return Err(Fault::Format(
            "is a legacy file of version 5; save it as version 4.2 or as .vtp".into(),
        ));
    }
    let mut soup = Soup::default();
    match vtkio::Vtk::parse_legacy_be(content)
        .map_err(unreadable)?
        .data
    {
        DataSet::PolyData { pieces, .. } => {
            for piece in pieces {
                let piece = inline(piece)?;
                let first = push_points(&mut soup, &numbers(piece.points)?);
                for corners in lists(piece.polys)? {
                    push_polygon(&mut soup, first, &corners)?;
                }
                for corners in lists(piece.strips)? {
                    push_strip(&mut soup, first, &corners)?;
                }
            }
        }
        DataSet::UnstructuredGrid { pieces, .. } => {
            for piece in pieces {
                let piece = inline(piece)?;
                let first = push_points(&mut soup, &numbers(piece.points)?);
                let cells = lists(Some(piece.cells.cell_verts))?;
                for (corners, kind) in cells.iter().zip(piece.cells.types) {
                    push_cell(&mut soup, first, kind as u8, corners)?;
                }
            }
        }
        _ => return Err(no_surface()),
    }
    Ok(soup)
}

fn inline<P>(piece: Piece<P>) -> Result<P, Fault> {
    match piece {
        Piece::Inline(piece) => Ok(*piece),
        _ => Err(no_surface()),
    }
}

fn numbers(points: vtkio::IOBuffer) -> Result<Vec<f64>, Fault> {
    points
        .cast_into()
        .ok_or_else(|| Fault::Format("has points that are not numbers".into()))
}

/// Corner numbers of each cell. The reader's own conversion panics on lists that do not add up.
fn lists(numbers: Option<VertexNumbers>) -> Result<Vec<Vec<u64>>, Fault> {
    let Some(VertexNumbers::Legacy { vertices, .. }) = numbers else {
        return Ok(Vec::new());
    };
    let mut cells = Vec::new();
    let mut rest = &vertices[..];
    while let Some((&n, after)) = rest.split_first() {
        let (corners, after) = after
            .split_at_checked(n as usize)
            .ok_or_else(broken_lists)?;
        cells.push(corners.iter().map(|&v| u64::from(v)).collect());
        rest = after;
    }
    Ok(cells)
}
