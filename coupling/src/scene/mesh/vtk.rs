//! Surfaces from VTK files: legacy `.vtk`, and XML `.vtp` and `.vtu`.

use riprap_dda::Vec3;
use vtkio::model::{CellType, DataSet, Piece, VertexNumbers};

use super::{Fault, Soup};

/// Binary legacy files are big-endian by definition.
pub(super) fn read_legacy(content: &[u8]) -> Result<Soup, Fault> {
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
    surface(vtkio::Vtk::parse_legacy_be(content))
}

/// The reader takes inline data only and trusts the offsets of the rest, so the rest is refused
/// before it starts.
pub(super) fn read_xml(content: &[u8]) -> Result<Soup, Fault> {
    let holds = |text: &[u8]| content.windows(text.len()).any(|window| window == text);
    if holds(b"compressor=\"vtk") || holds(b"<AppendedData") {
        return Err(Fault::Format(
            "is compressed or has appended data; save it with data mode Ascii or Binary and no compressor".into(),
        ));
    }
    if !holds(b"<Points") {
        return Err(Fault::Format("holds no points".into()));
    }
    surface(vtkio::Vtk::parse_xml(content))
}

fn surface(vtk: Result<vtkio::Vtk, vtkio::Error>) -> Result<Soup, Fault> {
    let data = vtk
        .map_err(|error| Fault::Format(format!("is not readable as VTK: {error}")))?
        .data;
    let mut soup = Soup::default();
    match data {
        DataSet::PolyData { pieces, .. } => {
            for piece in pieces {
                let piece = inline(piece)?;
                let first = push_points(&mut soup, piece.points)?;
                for corners in lists(piece.polys)? {
                    push(&mut soup, first, &corners)?;
                }
                for corners in lists(piece.strips)? {
                    push_strip(&mut soup, first, &corners)?;
                }
            }
        }
        DataSet::UnstructuredGrid { pieces, .. } => {
            for piece in pieces {
                let piece = inline(piece)?;
                let first = push_points(&mut soup, piece.points)?;
                let cells = lists(Some(piece.cells.cell_verts))?;
                for (corners, kind) in cells.iter().zip(piece.cells.types) {
                    match kind {
                        CellType::Triangle | CellType::Quad | CellType::Polygon => {
                            push(&mut soup, first, corners)?;
                        }
                        CellType::TriangleStrip => push_strip(&mut soup, first, corners)?,
                        CellType::Vertex | CellType::PolyVertex => {}
                        CellType::Line | CellType::PolyLine => {}
                        other => {
                            return Err(Fault::Format(format!(
                                "has cells of type {other:?}; extract the surface and save that"
                            )));
                        }
                    }
                }
            }
        }
        _ => {
            return Err(Fault::Format(
                "holds a grid, not a surface; extract the surface and save it as .vtp".into(),
            ));
        }
    }
    Ok(soup)
}

fn inline<P>(piece: Piece<P>) -> Result<P, Fault> {
    match piece {
        Piece::Inline(piece) => Ok(*piece),
        _ => Err(Fault::Format(
            "refers to other files; save it in one file".into(),
        )),
    }
}

/// Adds points and returns the number of the first.
fn push_points(soup: &mut Soup, points: vtkio::IOBuffer) -> Result<u64, Fault> {
    let first = soup.points.len() as u64;
    let numbers: Vec<f64> = points
        .cast_into()
        .ok_or_else(|| Fault::Format("has points that are not numbers".into()))?;
    let points = numbers.as_chunks::<3>().0;
    soup.points.extend(points.iter().map(|p| Vec3::from(*p)));
    Ok(first)
}

/// Corner numbers of each cell. The reader's own conversion panics on lists that do not add up.
fn lists(numbers: Option<VertexNumbers>) -> Result<Vec<Vec<u64>>, Fault> {
    let broken = || Fault::Format("has cells whose corner lists do not add up".into());
    let mut cells = Vec::new();
    match numbers {
        None => {}
        Some(VertexNumbers::Legacy { vertices, .. }) => {
            let mut rest = &vertices[..];
            while let Some((&n, after)) = rest.split_first() {
                let (corners, after) = after.split_at_checked(n as usize).ok_or_else(broken)?;
                cells.push(corners.iter().map(|&v| u64::from(v)).collect());
                rest = after;
            }
        }
        Some(VertexNumbers::XML {
            connectivity,
            offsets,
        }) => {
            let mut start = 0;
            for end in offsets {
                let corners = connectivity.get(start as usize..end as usize);
                cells.push(corners.ok_or_else(broken)?.to_vec());
                start = end;
            }
        }
    }
    Ok(cells)
}

fn push(soup: &mut Soup, first: u64, corners: &[u64]) -> Result<(), Fault> {
    let far = |_| Fault::Format("has a cell with a corner that is not there".into());
    let corners: Result<Vec<u32>, _> = corners
        .iter()
        .map(|v| u32::try_from(first.saturating_add(*v)))
        .collect();
    soup.push_polygon(&corners.map_err(far)?)
}

/// Every second triangle of a strip is turned.
fn push_strip(soup: &mut Soup, first: u64, corners: &[u64]) -> Result<(), Fault> {
    for (k, triangle) in corners.windows(3).enumerate() {
        let (a, b, c) = (triangle[0], triangle[1], triangle[2]);
        let turned = if k % 2 == 0 { [a, b, c] } else { [b, a, c] };
        push(soup, first, &turned)?;
    }
    Ok(())
}
