//! Blocks from mesh files: STL, OBJ and VTK.

use std::path::{Component, Path, PathBuf};

use riprap_dda::{Polyhedron, Shape, Vec3, volume};

/// Largest file that is read; bytes.
const LARGEST_FILE: u64 = 200_000_000;
/// Points nearer than this share of the mesh's diagonal are one.
const WELD_DISTANCE: f64 = 1e-9;
/// A shell is convex when its hull has its volume within this share.
const CONVEX_TOLERANCE: f64 = 1e-6;

/// Points and faces as a file lists them.
#[derive(Clone, Debug, Default, PartialEq)]
struct Soup {
    points: Vec<Vec3>,
    faces: Vec<Vec<u32>>,
}

/// A path of a scene, which must stay inside the scene's folder.
///
/// # Errors
///
/// A message when it does not.
pub fn file_inside(folder: &Path, file: &str) -> Result<PathBuf, String> {
    let path = Path::new(file);
    let stays = path
        .components()
        .all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    if stays {
        Ok(folder.join(path))
    } else {
        Err(format!(
            "`{file}` leads out of the scene's folder; put the file beside the scene and name it from there"
        ))
    }
}

/// The solid of a mesh file: each closed convex shell becomes a part.
///
/// # Errors
///
/// A message that names the file, the place and what would be right.
pub fn solid(folder: &Path, file: &str, scale: f64) -> Result<Shape, String> {
    let path = file_inside(folder, file)?;
    let size = std::fs::metadata(&path)
        .map_err(|error| format!("cannot read `{file}`: {error}"))?
        .len();
    if size > LARGEST_FILE {
        return Err(format!(
            "`{file}` has {size} bytes, more than {LARGEST_FILE}; simplify the mesh"
        ));
    }
    let extension = path
        .extension()
        .map(|e| e.to_string_lossy().to_lowercase())
        .unwrap_or_default();
    let mut soup = match extension.as_str() {
        "stl" => read_stl(&path),
        "obj" => read_obj(&path),
        "vtk" | "vtp" => read_vtk(&path),
        _ => Err(format!(
            "`{file}`: unknown kind of mesh; use .stl, .obj, .vtk or .vtp"
        )),
    }
    .map_err(|message| format!("`{file}`: {message}"))?;
    for point in &mut soup.points {
        *point *= scale;
        if !point.iter().all(|x| x.is_finite()) {
            return Err(format!("`{file}` has a corner that is not finite"));
        }
    }
    let shells = soup.welded().shells();
    let mut parts = Vec::with_capacity(shells.len());
    for (index, shell) in shells.iter().enumerate() {
        let part = convex_part(shell)
            .map_err(|message| format!("`{file}`, shell {}: {message}", index + 1))?;
        parts.push(part);
    }
    if parts.is_empty() {
        return Err(format!("`{file}` has no faces"));
    }
    Ok(Shape::Polyhedra(parts))
}

/// The hull of a shell, if the shell is closed and convex.
fn convex_part(shell: &Soup) -> Result<Polyhedron, String> {
    if let Some((a, b)) = shell.open_edge() {
        let x = 0.5 * (shell.points[a as usize] + shell.points[b as usize]);
        return Err(format!(
            "the surface is open at ({:.4}, {:.4}, {:.4}) m; a block needs a watertight mesh",
            x.x, x.y, x.z
        ));
    }
    let hull = Polyhedron::convex_hull(&shell.points).map_err(|error| error.to_string())?;
    let (inside, around) = (shell.volume().abs(), volume(&hull));
    if (around / inside - 1.0).abs() > CONVEX_TOLERANCE {
        return Err(format!(
            "it is not convex: its volume is {inside:.6e} m³, that of its hull {around:.6e} m³; split it into \
             convex closed shells, in one file"
        ));
    }
    Ok(hull)
}

impl Soup {
    /// Points at one place become one; those that no face uses go.
    fn welded(&self) -> Self {
        let Some(first) = self.points.first() else {
            return self.clone();
        };
        let (low, high) = self
            .points
            .iter()
            .fold((*first, *first), |(low, high), x| (low.inf(x), high.sup(x)));
        let near = WELD_DISTANCE * (high - low).norm();
        // sorted along x, only a short window of points can be near
        let mut order: Vec<usize> = (0..self.points.len()).collect();
        order.sort_by(|&a, &b| self.points[a].x.total_cmp(&self.points[b].x));
        let mut new = vec![u32::MAX; self.points.len()];
        let mut points: Vec<Vec3> = Vec::new();
        let mut window = 0;
        for &old in &order {
            let x = self.points[old];
            while window < points.len() && points[window].x < x.x - near {
                window += 1;
            }
            let found = (window..points.len()).find(|&k| (points[k] - x).norm() <= near);
            new[old] = found.unwrap_or_else(|| {
                points.push(x);
                points.len() - 1
            }) as u32;
        }
        let faces = self
            .faces
            .iter()
            .map(|face| {
                let mut face: Vec<u32> = face.iter().map(|&v| new[v as usize]).collect();
                face.dedup();
                if face.len() > 1 && face.first() == face.last() {
                    face.pop();
                }
                face
            })
            .filter(|face| face.len() > 2)
            .collect();
        Self { points, faces }
    }

    /// Connected pieces, each with its own points.
    fn shells(&self) -> Vec<Self> {
        let mut root: Vec<u32> = (0..self.points.len() as u32).collect();
        fn find(root: &mut [u32], mut v: u32) -> u32 {
            while root[v as usize] != v {
                root[v as usize] = root[root[v as usize] as usize];
                v = root[v as usize];
            }
            v
        }
        for face in &self.faces {
            for pair in face.windows(2) {
                let (a, b) = (find(&mut root, pair[0]), find(&mut root, pair[1]));
                root[a.max(b) as usize] = a.min(b);
            }
        }
        let mut shells: Vec<(u32, Self)> = Vec::new();
        let mut place = vec![u32::MAX; self.points.len()];
        for face in &self.faces {
            let owner = find(&mut root, face[0]);
            let at = match shells.iter().position(|(id, _)| *id == owner) {
                Some(at) => at,
                None => {
                    shells.push((owner, Self::default()));
                    shells.len() - 1
                }
            };
            let shell = &mut shells[at].1;
            let mut own = Vec::with_capacity(face.len());
            for &v in face {
                if place[v as usize] == u32::MAX {
                    place[v as usize] = shell.points.len() as u32;
                    shell.points.push(self.points[v as usize]);
                }
                own.push(place[v as usize]);
            }
            shell.faces.push(own);
        }
        shells.into_iter().map(|(_, shell)| shell).collect()
    }

    /// An edge that is not passed once in each direction.
    fn open_edge(&self) -> Option<(u32, u32)> {
        let mut edges: Vec<(u32, u32)> = self
            .faces
            .iter()
            .flat_map(|face| (0..face.len()).map(|k| (face[k], face[(k + 1) % face.len()])))
            .collect();
        edges.sort_unstable();
        edges
            .iter()
            .copied()
            .find(|&(a, b)| edges.binary_search(&(b, a)).is_err())
            .or_else(|| {
                edges
                    .windows(2)
                    .find(|pair| pair[0] == pair[1])
                    .map(|pair| pair[0])
            })
    }

    /// By the divergence theorem, about the first point; m³.
    fn volume(&self) -> f64 {
        let Some(&origin) = self.points.first() else {
            return 0.0;
        };
        let corner = |v: u32| self.points[v as usize] - origin;
        self.faces
            .iter()
            .flat_map(|face| (1..face.len() - 1).map(|k| (face[0], face[k], face[k + 1])))
            .map(|(a, b, c)| corner(a).dot(&corner(b).cross(&corner(c))) / 6.0)
            .sum()
    }
}

/// All solids of an STL file, text or binary.
fn read_stl(path: &Path) -> Result<Soup, String> {
    let bytes = std::fs::read(path).map_err(|error| error.to_string())?;
    let count = bytes
        .get(80..84)
        .and_then(|b| b.try_into().ok())
        .map(u32::from_le_bytes);
    let mut soup = Soup::default();
    let mut push = |corner: Vec3| {
        soup.points.push(corner);
        let n = soup.points.len() as u32;
        if n.is_multiple_of(3) {
            soup.faces.push(vec![n - 3, n - 2, n - 1]);
        }
    };
    // a binary file may begin with "solid" too: its length decides
    if count.is_some_and(|count| bytes.len() as u64 == 84 + 50 * u64::from(count)) {
        for facet in bytes[84..].as_chunks::<50>().0 {
            for corner in 0..3 {
                let number = |k: usize| {
                    let at = 12 + 12 * corner + 4 * k;
                    f64::from(f32::from_le_bytes([
                        facet[at],
                        facet[at + 1],
                        facet[at + 2],
                        facet[at + 3],
                    ]))
                };
                push(Vec3::new(number(0), number(1), number(2)));
            }
        }
        return Ok(soup);
    }
    let text = std::str::from_utf8(&bytes).map_err(|_| {
        "neither a binary STL of the stated length nor text; the file may be cut".to_owned()
    })?;
    for (index, line) in text.lines().enumerate() {
        let mut words = line.split_whitespace();
        if words
            .next()
            .is_some_and(|word| word.eq_ignore_ascii_case("vertex"))
        {
            let numbers: Vec<f64> = words.map_while(|word| word.parse().ok()).collect();
            let [x, y, z] = numbers[..] else {
                return Err(format!(
                    "line {}: found `{}`, needed vertex x y z",
                    index + 1,
                    line.trim()
                ));
            };
            push(Vec3::new(x, y, z));
        }
    }
    Ok(soup)
}

fn read_obj(path: &Path) -> Result<Soup, String> {
    let options = tobj::LoadOptions {
        single_index: true,
        ..tobj::LoadOptions::default()
    };
    let (models, _) = tobj::load_obj(path, &options).map_err(|error| error.to_string())?;
    let mut soup = Soup::default();
    for model in models {
        let mesh = model.mesh;
        let first = soup.points.len() as u32;
        soup.points.extend(
            mesh.positions
                .as_chunks::<3>()
                .0
                .iter()
                .map(|p| Vec3::from(p.map(f64::from))),
        );
        let arities = if mesh.face_arities.is_empty() {
            vec![3; mesh.indices.len() / 3]
        } else {
            mesh.face_arities
        };
        let mut at = 0;
        for arity in arities {
            let face = mesh
                .indices
                .get(at..at + arity as usize)
                .unwrap_or_default();
            soup.faces.push(face.iter().map(|v| first + v).collect());
            at += arity as usize;
        }
    }
    Ok(soup)
}

fn read_vtk(path: &Path) -> Result<Soup, String> {
    use vtkio::model::{DataSet, Piece};
    let vtk = vtkio::Vtk::import(path).map_err(|error| error.to_string())?;
    let DataSet::PolyData { pieces, .. } = vtk.data else {
        return Err("holds no PolyData; export the surface as PolyData".to_owned());
    };
    let mut soup = Soup::default();
    for piece in pieces {
        let Piece::Inline(piece) = piece else {
            return Err("points at another file; export it in one file".to_owned());
        };
        let first = soup.points.len() as u32;
        let points: Vec<f64> = piece
            .points
            .cast_into()
            .ok_or("has points of an unknown type")?;
        soup.points
            .extend(points.as_chunks::<3>().0.iter().map(|p| Vec3::from(*p)));
        if let Some(polys) = piece.polys {
            let (connectivity, offsets) = polys.into_xml();
            let mut start = 0;
            for end in offsets {
                let face = connectivity
                    .get(start as usize..end as usize)
                    .unwrap_or_default();
                soup.faces
                    .push(face.iter().map(|&v| first + v as u32).collect());
                start = end;
            }
        }
    }
    let n = soup.points.len() as u32;
    if soup.faces.iter().flatten().any(|&v| v >= n) {
        return Err("has a face with a corner that is not there".to_owned());
    }
    Ok(soup)
}

#[cfg(test)]
#[expect(
    clippy::unwrap_used,
    reason = "a test may stop where a library may not"
)]
mod tests {
    use super::*;

    /// Twelve triangles of a box, as text STL.
    fn stl_box(min: [f64; 3], max: [f64; 3], skip: usize) -> String {
        let solid = Polyhedron::cuboid(Vec3::from(min), Vec3::from(max)).unwrap();
        let mut text = "solid box\n".to_owned();
        for face in skip..solid.n_faces() {
            let loop_: Vec<u32> = solid.face_vertices(face).collect();
            for k in 1..loop_.len() - 1 {
                text += "facet normal 0 0 0\nouter loop\n";
                for v in [loop_[0], loop_[k], loop_[k + 1]] {
                    let x = solid.vertices()[v as usize];
                    text += &format!("vertex {} {} {}\n", x.x, x.y, x.z);
                }
                text += "endloop\nendfacet\n";
            }
        }
        text + "endsolid box\n"
    }

    fn load(name: &str, text: &str, scale: f64) -> Result<Shape, String> {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join(name), text).unwrap();
        solid(folder.path(), name, scale)
    }

    #[test]
    fn two_solids_of_one_stl_make_two_parts() {
        let text = stl_box([0.0; 3], [1000.0, 2000.0, 500.0], 0)
            + &stl_box([2000.0, 0.0, 0.0], [3000.0, 1000.0, 1000.0], 0);
        let shape = load("two.stl", &text, 1e-3).unwrap();
        assert!(matches!(&shape, Shape::Polyhedra(parts) if parts.len() == 2));
        assert!((shape.volume() - 2.0).abs() < 1e-12);
    }

    #[test]
    fn an_obj_of_quadrilaterals_is_read() {
        let text = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
                    f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
        assert!((load("cube.obj", text, 2.0).unwrap().volume() - 8.0).abs() < 1e-12);
    }

    #[test]
    fn an_open_mesh_says_where() {
        let message = load("open.stl", &stl_box([0.0; 3], [1.0; 3], 1), 1.0).unwrap_err();
        assert!(
            message.contains("`open.stl`, shell 1: the surface is open at ("),
            "{message}"
        );
    }

    #[test]
    fn a_path_out_of_the_folder_is_refused() {
        assert!(file_inside(Path::new("cases"), "../secret.stl").is_err());
        assert!(file_inside(Path::new("cases"), "/etc/passwd").is_err());
    }
}
