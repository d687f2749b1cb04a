//! PLY files, written by hand from the format's description.

use riprap::scene::mesh::{Fault, solid_from, surface_from};
use riprap_dda::{Shape, Vec3};

/// Corners of a box from the origin to (1, 2, 0.5), as numbers that fit every type in units of half a meter.
const CORNERS: [[i8; 3]; 8] = [
    [0, 0, 0],
    [2, 0, 0],
    [2, 4, 0],
    [0, 4, 0],
    [0, 0, 1],
    [2, 0, 1],
    [2, 4, 1],
    [0, 4, 1],
];

/// Its faces, counter-clockwise from outside.
const FACES: [[u8; 4]; 6] = [
    [3, 2, 1, 0],
    [4, 5, 6, 7],
    [0, 1, 5, 4],
    [1, 2, 6, 5],
    [2, 3, 7, 6],
    [3, 0, 4, 7],
];

/// The box as text, with what other programs add: comments, normals, colors, edges, Windows line ends.
fn text() -> String {
    let mut text = "ply\nformat ascii 1.0\ncomment by hand\nobj_info a box\n\
        element vertex 8\nproperty float nx\nproperty double x\nproperty double y\nproperty double z\n\
        property list uchar float weights\n\
        element edge 1\nproperty int vertex1\nproperty int vertex2\n\
        element face 6\nproperty uchar red\nproperty list uchar int vertex_indices\nend_header\n"
        .to_owned();
    for [x, y, z] in CORNERS {
        text += &format!("0.5 {x} {y}.0 {z}e0 2 0.25 0.75\n");
    }
    text += "0 1\n";
    for [a, b, c, d] in FACES {
        text += &format!("255 4 {a} {b} {c} {d}\n");
    }
    text.replace('\n', "\r\n")
}

/// The bytes of a value of one of the types of the format, little end first.
fn bytes(kind: &str, value: i8) -> Vec<u8> {
    match kind {
        "char" | "int8" => value.to_le_bytes().to_vec(),
        "uchar" | "uint8" => (value as u8).to_le_bytes().to_vec(),
        "short" | "int16" => i16::from(value).to_le_bytes().to_vec(),
        "ushort" | "uint16" => (value as u16).to_le_bytes().to_vec(),
        "int" | "int32" => i32::from(value).to_le_bytes().to_vec(),
        "uint" | "uint32" => (value as u32).to_le_bytes().to_vec(),
        "float" | "float32" => f32::from(value).to_le_bytes().to_vec(),
        "double" | "float64" => f64::from(value).to_le_bytes().to_vec(),
        _ => unreachable!(),
    }
}

/// The box in binary: types of a coordinate, of the counts of corners and of corners; an intensity and a flag beside.
fn binary(order: &str, [coordinate, count, corner]: [&str; 3]) -> Vec<u8> {
    let mut file = format!(
        "ply\nformat binary_{order}_endian 1.0\nelement vertex 8\nproperty {coordinate} x\nproperty {coordinate} y\n\
         property {coordinate} z\nproperty ushort intensity\nelement face 6\n\
         property list {count} {corner} vertex_index\nproperty list uchar float texcoord\nend_header\n"
    )
    .into_bytes();
    let mut push = |kind: &str, value: i8| {
        let mut bytes = bytes(kind, value);
        if order == "big" {
            bytes.reverse();
        }
        file.extend(bytes);
    };
    for corner in CORNERS {
        corner.iter().for_each(|&x| push(coordinate, x));
        push("ushort", 77);
    }
    for face in FACES {
        push(count, 4);
        face.iter().for_each(|&v| push(corner, v as i8));
        push("uchar", 2);
        push("float", 10); // the byte of a line end is no end of a line here
        push("float", 13);
    }
    file
}

fn box_of(file: &[u8]) -> Shape {
    solid_from(file, "ply", 0.5).unwrap()
}

#[test]
fn a_box_is_the_same_as_text_and_in_both_byte_orders_with_numbers_of_all_types() {
    let expected = box_of(text().as_bytes());
    assert_eq!(expected.aabb(), (Vec3::zeros(), Vec3::new(1.0, 2.0, 0.5)));
    assert!((expected.volume() - 1.0).abs() < 1e-15); // halves: exact but for the sum
    let types = [
        ["float", "uchar", "int"],
        ["double", "char", "uint"],
        ["float32", "uint8", "int32"],
        ["float64", "int8", "uint32"],
        ["char", "short", "ushort"],
        ["int8", "int16", "uint16"],
        ["short", "int", "uchar"],
        ["int32", "double", "float"],
    ];
    for kinds in types {
        for order in ["little", "big"] {
            assert_eq!(box_of(&binary(order, kinds)), expected, "{order} {kinds:?}");
        }
    }
}

#[test]
fn an_open_surface_is_read_as_ground() {
    let file = text().replace("face 6", "face 1");
    let end = file.rfind("255 4 4 5 6 7").unwrap();
    let Shape::Surface(surface) = surface_from(&file.as_bytes()[..end], "ply", 1.0).unwrap() else {
        unreachable!()
    };
    assert_eq!(surface.triangles().len(), 2); // one face of four corners
}

#[test]
fn what_is_wrong_is_said_with_its_place() {
    let with = |from: &str, to: &str| {
        let text = text().replace("\r\n", "\n");
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1).into_bytes()
    };
    let cut = binary("big", ["float", "uchar", "int"]);
    let cases = [
        (b"plx\n".to_vec(), "does not begin with a line `ply`"),
        (b"ply".to_vec(), "does not begin with a line `ply`"),
        (
            b"ply\nformat ascii 1.0\n".to_vec(),
            "ends without `end_header`",
        ),
        (
            with("ascii", "utf8"),
            "line 2: found `format utf8 1.0`, needed `format` ascii, binary_little_endian or",
        ),
        (
            with("format ascii 1.0\n", ""),
            "has no line `format` in its header",
        ),
        (
            with("element vertex 8", "element vertex eight"),
            "line 5: found `element vertex eight`, needed `element name count`",
        ),
        (
            with("double x", "triple x"),
            "line 7: found `property triple x`, needed `property type name`",
        ),
        (
            with("double x", "double lon"),
            "has vertices without the properties x, y and z",
        ),
        (
            with("vertex_indices", "corners"),
            "has faces without the list `vertex_indices`",
        ),
        (
            with("0.5 2 0.0 0e0", "0.5 2 0.0 low"),
            "line 19: vertex 2 of 8: found `low`, needed a number",
        ),
        (
            with("0.5 2 0.0 0e0 2 0.25 0.75", "0.5 2 0.0 0e0 2 0.25"),
            "line 19: vertex 2 of 8: fewer numbers than properties",
        ),
        (
            with("0.5 2 0.0 0e0 2 0.25 0.75", "0.5 2 0.0 0e0 2 0.25 0.75 9"),
            "line 19: vertex 2 of 8: `9` follows the last property",
        ),
        (
            with("255 4 4 5 6 7", "255 4 4 5 6 8"),
            "a face names point 8, but there are only 8 (0 to 7)",
        ),
        (
            with("255 4 4 5 6 7", "255 4 4 5 6 -1"),
            "a face names point -1; points are counted from 0",
        ),
        (
            with("255 4 3 0 4 7\n", ""),
            "ends within face 6 of 6; the file is cut: export it again",
        ),
        (
            cut[..cut.len() - 1].to_vec(),
            "ends within face 6 of 6; the file is cut: export it again",
        ),
        // a point cloud
        (
            with("element face 6", "element shape 6"),
            "has no triangles with an area; export the surface, not points or lines",
        ),
    ];
    for (file, expected) in cases {
        let said = solid_from(&file, "ply", 1.0).unwrap_err().to_string();
        assert!(said.starts_with(expected), "{said}");
    }
}

/// Counts that a header claims cost neither memory nor time; any prefix is read or refused.
#[test]
fn a_hostile_file_is_refused_at_once() {
    let most = u64::MAX;
    for header in [
        format!("element vertex {most}\nproperty float x\nproperty float y\nproperty float z"),
        format!("element void {most}"),
        "element face 1\nproperty list double char vertex_index".to_owned(),
    ] {
        let mut file =
            format!("ply\nformat binary_little_endian 1.0\n{header}\nend_header\n").into_bytes();
        file.extend(1e300_f64.to_le_bytes());
        let found = solid_from(&file, "ply", 1.0).unwrap_err();
        assert!(matches!(found, Fault::Format(_) | Fault::Empty), "{found}");
    }
    for file in [
        text().into_bytes(),
        binary("little", ["float", "uchar", "int"]),
    ] {
        for end in 0..file.len() {
            assert!(solid_from(&file[..end], "ply", 1.0).is_err() || end + 2 >= file.len());
        }
    }
}
