//! Mesh files: the same bodies in every format, and what is wrong with bad ones.

use std::path::Path;

use riprap::scene::access::Access;
use riprap::scene::mesh::{MeshError, Split, Survey, solid, survey};
use riprap_dda::{Polyhedron, Shape, Vec3};
use tempfile::TempDir;

/// Points and faces, counter-clockwise from outside.
type Faces = (Vec<Vec3>, Vec<Vec<u32>>);

fn cuboid(min: [f64; 3], max: [f64; 3]) -> Faces {
    let body = Polyhedron::cuboid(min.into(), max.into()).unwrap();
    let faces = (0..body.n_faces())
        .map(|face| body.face_vertices(face).collect())
        .collect();
    (body.vertices().to_vec(), faces)
}

fn triangles((points, faces): &Faces) -> Vec<[Vec3; 3]> {
    faces
        .iter()
        .flat_map(|face| (1..face.len() - 1).map(|k| [face[0], face[k], face[k + 1]]))
        .map(|corners| corners.map(|v| points[v as usize]))
        .collect()
}

fn ascii_stl(solids: &[Vec<[Vec3; 3]>]) -> String {
    let mut text = String::new();
    for (k, solid) in solids.iter().enumerate() {
        text += &format!("solid part {k}\n");
        for corners in solid {
            text += "facet normal 0 0 0\n outer loop\n";
            for x in corners {
                text += &format!("  vertex {:e} {} {}\n", x.x, x.y, x.z);
            }
            text += " endloop\nendfacet\n";
        }
        text += &format!("endsolid part {k}\n");
    }
    text
}

/// The header begins with "solid", as some programs write it.
fn binary_stl(triangles: &[[Vec3; 3]]) -> Vec<u8> {
    let mut bytes = b"solid but binary".to_vec();
    bytes.resize(80, b' ');
    bytes.extend((triangles.len() as u32).to_le_bytes());
    for corners in triangles {
        bytes.extend([0; 12]);
        for x in corners {
            x.iter()
                .for_each(|c| bytes.extend((*c as f32).to_le_bytes()));
        }
        bytes.extend([0; 2]);
    }
    bytes
}

fn obj((points, faces): &Faces) -> String {
    let mut text = "mtllib missing.mtl\no cube\n".to_owned();
    for x in points {
        text += &format!("v {} {} {}\n", x.x, x.y, x.z);
    }
    for (k, face) in faces.iter().enumerate() {
        // materials cut a body into models
        text += &format!("usemtl side{k}\nf");
        face.iter().for_each(|v| text += &format!(" {}", v + 1));
        text += "\n";
    }
    text
}

fn numbers(points: &[Vec3]) -> String {
    let row = |x: &Vec3| format!("{} {} {}\n", x.x, x.y, x.z);
    points.iter().map(row).collect()
}

fn legacy_vtk((points, faces): &Faces) -> String {
    let size: usize = faces.iter().map(|face| face.len() + 1).sum();
    let mut text = format!(
        "# vtk DataFile Version 3.0\ncube\nASCII\nDATASET POLYDATA\nPOINTS {} double\n{}POLYGONS {} {size}\n",
        points.len(),
        numbers(points),
        faces.len()
    );
    for face in faces {
        text += &format!("{}", face.len());
        face.iter().for_each(|v| text += &format!(" {v}"));
        text += "\n";
    }
    text
}

fn xml_arrays(faces: &[Vec<u32>]) -> String {
    let connectivity: Vec<String> = faces.iter().flatten().map(u32::to_string).collect();
    let mut end = 0;
    let offsets: Vec<String> = faces
        .iter()
        .map(|face| {
            end += face.len();
            end.to_string()
        })
        .collect();
    format!(
        "<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">{}</DataArray>\n\
         <DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">{}</DataArray>\n",
        connectivity.join(" "),
        offsets.join(" ")
    )
}

fn xml_points(points: &[Vec3]) -> String {
    format!(
        "<Points><DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" format=\"ascii\">{}\
         </DataArray></Points>",
        numbers(points)
    )
}

fn vtp((points, faces): &Faces) -> String {
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\"><PolyData><Piece NumberOfPoints=\"{}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" \
         NumberOfStrips=\"0\" NumberOfPolys=\"{}\">{}<Polys>{}</Polys></Piece></PolyData></VTKFile>",
        points.len(),
        faces.len(),
        xml_points(points),
        xml_arrays(faces)
    )
}

fn vtu((points, faces): &Faces, kind: u8) -> String {
    let types = vec![kind.to_string(); faces.len()].join(" ");
    format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\"><UnstructuredGrid><Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\">{}<Cells>{}\
         <DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">{types}</DataArray></Cells></Piece>\
         </UnstructuredGrid></VTKFile>",
        points.len(),
        faces.len(),
        xml_points(points),
        xml_arrays(faces)
    )
}

fn folder_with(name: &str, content: impl AsRef<[u8]>) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join(name), content).unwrap();
    folder
}

fn load(name: &str, content: impl AsRef<[u8]>, scale: f64) -> Result<Shape, MeshError> {
    let folder = folder_with(name, content);
    solid(&Access::of(folder.path()), name, scale, Split::default())
}

fn look(name: &str, content: impl AsRef<[u8]>) -> Survey {
    let folder = folder_with(name, content);
    survey(&Access::of(folder.path()), name, 1.0).unwrap()
}

fn n_parts(shape: &Shape) -> usize {
    match shape {
        Shape::Polyhedra(parts) => parts.len(),
        Shape::Sphere { .. } | Shape::Surface(_) => 0,
    }
}

#[test]
fn a_cuboid_in_millimetres_is_the_same_in_every_format() {
    // no corner but one is a round binary number
    let body = cuboid([100.1, -33.3, 0.0], [1100.1, 1966.7, 700.0]);
    let files: [(&str, Vec<u8>); 6] = [
        ("ascii.stl", ascii_stl(&[triangles(&body)]).into()),
        (
            "capitals.STL",
            ascii_stl(&[triangles(&body)]).to_uppercase().into(),
        ),
        ("quads.obj", obj(&body).into()),
        ("legacy.vtk", legacy_vtk(&body).into()),
        ("surface.vtp", vtp(&body).into()),
        ("surface.vtu", vtu(&body, 9).into()),
    ];
    for (name, content) in files {
        let shape = load(name, content, 1e-3).unwrap();
        assert_eq!(n_parts(&shape), 1, "{name}");
        assert!(
            (shape.volume() / 1.4 - 1.0).abs() < 1e-12,
            "{name}: {}",
            shape.volume()
        );
        let (min, max) = shape.aabb();
        assert!(
            (min - Vec3::new(0.1001, -0.0333, 0.0)).norm() < 1e-12,
            "{name}"
        );
        assert!(
            (max - Vec3::new(1.1001, 1.9667, 0.7)).norm() < 1e-12,
            "{name}"
        );
        // twelve triangles are six faces again
        let Shape::Polyhedra(parts) = shape else {
            unreachable!()
        };
        assert_eq!(parts[0].n_faces(), 6, "{name}");
    }
    // single precision: half a unit in the last of 24 bits of each coordinate
    let shape = load("binary.stl", binary_stl(&triangles(&body)), 1e-3).unwrap();
    assert!(
        (shape.volume() / 1.4 - 1.0).abs() < 2e-7,
        "{}",
        shape.volume()
    );
    let round = cuboid([0.0; 3], [1.0, 2.0, 0.5]);
    let shape = load("binary.stl", binary_stl(&triangles(&round)), 1.0).unwrap();
    assert!((shape.volume() - 1.0).abs() < 1e-12);
}

#[test]
fn two_solids_of_one_file_are_two_parts() {
    let (a, b) = (cuboid([0.0; 3], [1.0; 3]), cuboid([3.0; 3], [5.0; 3]));
    let text = ascii_stl(&[triangles(&a), triangles(&b)]);
    let shape = load("two.stl", &text, 1.0).unwrap();
    assert_eq!(n_parts(&shape), 2);
    assert!((shape.volume() - 9.0).abs() < 1e-12);
    let found = look("two.stl", &text);
    assert_eq!(
        (found.is_watertight, found.n_shells, found.n_triangles),
        (true, 2, 24)
    );
    assert!((found.drawn.volume - 9.0).abs() < 1e-12);
    assert_eq!((found.min, found.max), (Vec3::zeros(), Vec3::repeat(5.0)));
}

/// As a non-convex body is split: parts share a side, an edge or a corner, and four to eight
/// triangles meet at an edge.
#[test]
fn parts_that_adjoin_stay_parts() {
    let whole = [
        cuboid([0.0, 0.0, 0.0], [1.0, 1.0, 1.0]),
        cuboid([1.0, 0.0, 0.0], [2.0, 1.0, 1.0]),
        cuboid([0.0, 1.0, 0.0], [1.0, 2.0, 1.0]),
        cuboid([1.0, 1.0, 0.0], [2.0, 2.0, 1.0]),
        cuboid([2.0, 2.0, 1.0], [3.0, 3.0, 2.0]),
        cuboid([2.0, 2.0, 0.0], [3.0, 3.0, 1.0]),
    ];
    let all: Vec<[Vec3; 3]> = whole.iter().flat_map(triangles).collect();
    let turned: Vec<[Vec3; 3]> = all.iter().map(|&[a, b, c]| [a, c, b]).collect();
    for content in [binary_stl(&all), binary_stl(&turned)] {
        let shape = load("parts.stl", content, 1.0).unwrap();
        assert_eq!(n_parts(&shape), 6);
        assert!((shape.volume() - 6.0).abs() < 1e-12);
    }
}

#[test]
fn corners_off_by_round_off_are_welded() {
    let mut soup = triangles(&cuboid([0.0; 3], [1.0; 3]));
    for (k, corners) in soup.iter_mut().enumerate() {
        // -1.99e-16 beside 0 is a classic
        corners
            .iter_mut()
            .for_each(|x| *x += Vec3::repeat(2e-16 * (k as f64 - 5.5)));
    }
    let shape = load("rough.stl", ascii_stl(&[soup]), 1.0).unwrap();
    assert!((shape.volume() - 1.0).abs() < 1e-12);
}

#[test]
fn bad_meshes_say_what_and_where() {
    let cube = cuboid([0.0; 3], [1.0; 3]);
    let soup = triangles(&cube);
    let stl = |soup: &[[Vec3; 3]]| ascii_stl(&[soup.to_vec()]).into_bytes();
    let mut nan = soup.clone();
    nan[4][1].y = f64::NAN;
    let mut flipped = soup.clone();
    flipped[0].swap(1, 2);
    let mut hollow = triangles(&cuboid([-1.0; 3], [2.0; 3]));
    hollow.extend(soup.iter().map(|&[a, b, c]| [a, c, b]));
    let mut far = cube.clone();
    far.1[0][0] = 77;
    let cut = stl(&soup);
    let cases: [(&str, Vec<u8>, &str); 16] = [
        (
            "open.stl",
            stl(&soup[..11]),
            "`open.stl`: the surface is open: 3 edges have one side only, first at (",
        ),
        (
            "nan.stl",
            stl(&nan),
            "`nan.stl`: corner 2 of triangle 5 is not finite",
        ),
        (
            "nan.stl",
            binary_stl(&nan),
            "`nan.stl`: corner 2 of triangle 5 is not finite",
        ),
        (
            "flip.stl",
            stl(&flipped),
            "`flip.stl`: neighboring triangles at (",
        ),
        (
            "hollow.stl",
            stl(&hollow),
            "`hollow.stl`: shell 2 of 2 is inside out, as the wall of a cavity would be",
        ),
        (
            "cut.stl",
            cut[..cut.len() - 16].to_vec(),
            "`cut.stl`: ends without `endsolid`",
        ),
        (
            "cut.stl",
            binary_stl(&soup)[5..400].to_vec(),
            "`cut.stl`: not text, and as binary STL of ",
        ),
        (
            "word.stl",
            b"solid x\nvertex 1 2\nendsolid".to_vec(),
            "`word.stl`: line 2: found `vertex 1 2`, needed `vertex x y z`",
        ),
        (
            "none.stl",
            b"solid x\nendsolid x".to_vec(),
            "`none.stl`: has no triangles",
        ),
        (
            "far.vtp",
            vtp(&far).into(),
            "`far.vtp`: a face names point 77, but there are only 8",
        ),
        (
            "tets.vtu",
            vtu(&cube, 10).into(),
            "`tets.vtu`: has cells of type Tetra; extract the surface",
        ),
        (
            "zip.vtp",
            vtp(&cube)
                .replace(
                    "header_type",
                    "compressor=\"vtkZLibDataCompressor\" header_type",
                )
                .into(),
            "`zip.vtp`: is compressed or has appended data",
        ),
        (
            "far.obj",
            b"v 0 0 0\nf 1 2 3\n".to_vec(),
            "`far.obj`: line 2: `2` is not a corner: there are 1 points before it",
        ),
        (
            // found by fuzzing: a reader before this one panicked at the normal that is not there
            "normal.obj",
            b"v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1/1/1 2/1/1 3/-8/6\n".to_vec(),
            "`normal.obj`: the surface is open",
        ),
        (
            "word.obj",
            b"v 0 0 \\\nx # half\n".to_vec(),
            "`word.obj`: line 1: found `v 0 0  x`, needed `v x y z`",
        ),
        ("a.3ds", b"MM".to_vec(), "`a.3ds`: unknown kind of mesh"),
    ];
    for (name, content, expected) in cases {
        let text = load(name, content, 1.0).unwrap_err().to_string();
        assert!(text.starts_with(expected), "{text}");
    }
    let found = look("open.stl", stl(&soup[..11]));
    assert!(!found.is_watertight);
    assert_eq!(found.n_shells, 1);
}

#[test]
fn paths_stay_in_the_folder_of_the_scene() {
    for name in ["../cube.stl", "/cube.stl", "a/../../cube.stl"] {
        let text = solid(&Access::of(Path::new(".")), name, 1.0, Split::default())
            .unwrap_err()
            .to_string();
        assert!(text.contains("leads out of the scene's folder"), "{text}");
    }
    let text = solid(
        &Access::of(Path::new(".")),
        "not there.stl",
        1.0,
        Split::default(),
    )
    .unwrap_err()
    .to_string();
    assert!(
        text.starts_with("`not there.stl`: cannot be read: "),
        "{text}"
    );
}

/// Any prefix of any file is refused or read, never a panic.
#[test]
fn cut_files_make_no_panic() {
    let body = cuboid([0.0; 3], [1.0; 3]);
    let files: [(&str, Vec<u8>); 6] = [
        ("a.stl", ascii_stl(&[triangles(&body)]).into()),
        ("b.stl", binary_stl(&triangles(&body))),
        ("c.obj", obj(&body).into()),
        ("d.vtk", legacy_vtk(&body).into()),
        ("e.vtp", vtp(&body).into()),
        ("f.vtu", vtu(&body, 9).into()),
    ];
    for (name, content) in files {
        let folder = tempfile::tempdir().unwrap();
        for end in (0..content.len()).step_by(7) {
            std::fs::write(folder.path().join(name), &content[..end]).unwrap();
            let _ = solid(&Access::of(folder.path()), name, 1.0, Split::default());
        }
    }
}

/// A fine sphere of 19 800 triangles, written in single precision, is convex enough.
#[test]
fn a_fine_ball_is_convex() {
    let (n, m) = (100, 100);
    let at = |i: usize, j: usize| {
        let (a, b) = (
            std::f64::consts::PI * i as f64 / m as f64,
            std::f64::consts::TAU * (j % n) as f64 / n as f64,
        );
        let ring = if i == 0 || i == m { 0.0 } else { a.sin() };
        Vec3::new(ring * b.cos(), ring * b.sin(), a.cos())
    };
    let mut soup = Vec::new();
    for i in 0..m {
        for j in 0..n {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            if i + 1 < m {
                soup.push([a, b, c]);
            }
            if i > 0 {
                soup.push([a, c, d]);
            }
        }
    }
    let shape = load("ball.stl", binary_stl(&soup), 1.0).unwrap();
    // chords of step a along the rings cost a²/6 of the volume, of step b from pole to pole b²/4
    let (a, b) = (
        std::f64::consts::TAU / n as f64,
        std::f64::consts::PI / m as f64,
    );
    let exact = 4.0 / 3.0 * std::f64::consts::PI * (1.0 - a * a / 6.0 - b * b / 4.0);
    assert!(
        (shape.volume() / exact - 1.0).abs() < 1e-5,
        "{}",
        shape.volume() / exact
    );
}
