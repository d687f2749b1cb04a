//! Meshes that are not convex: their convex parts, how these differ from the drawing, and how such bodies move.

use std::fmt::Write as _;
use std::path::Path;

use riprap::messages::Code;
use riprap::run::build;
use riprap::scene::access::Access;
use riprap::scene::error::{Problem, Severity};
use riprap::scene::mesh::{Split, solid, survey};
use riprap::scene::resolve::Scene;
use riprap_dda::{MassProperties, Polyhedron, Shape, Vec3, separating_axes};
use tempfile::TempDir;

use crate::support::riprap;
use crate::support::scene::{advance, resolved_in};

/// Corners of faces, counter-clockwise from outside.
type Faces = Vec<Vec<Vec3>>;

/// Unit cubes where `is_solid`, in a cube of `n` a side: the faces between solid and void.
fn of_cubes(n: i32, is_solid: impl Fn([i32; 3]) -> bool) -> Faces {
    let within = |at: [i32; 3]| at.iter().all(|x| (0..n).contains(x)) && is_solid(at);
    let mut faces = Faces::new();
    for k in 0..n * n * n {
        let at = [k % n, k / n % n, k / (n * n)];
        for (axis, step) in (0..3).flat_map(|axis| [(axis, 0), (axis, 1)]) {
            let mut beside = at;
            beside[axis] += 2 * step - 1;
            if !within(at) || within(beside) {
                continue;
            }
            let corner = |a: i32, b: i32| {
                let mut x = at;
                x[axis] += step;
                x[(axis + 1) % 3] += a;
                x[(axis + 2) % 3] += b;
                Vec3::from(x.map(f64::from))
            };
            let mut face = vec![corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
            if step == 0 {
                face.reverse();
            }
            faces.push(face);
        }
    }
    faces
}

/// Three cubes in the plane y = 0: 3 m³ in a hull of 3.5 m³.
fn l_shape() -> Faces {
    of_cubes(2, |[x, y, z]| y == 0 && (x == 0 || z == 0))
}

/// A bridge of two piers in x, open below: 5 m³.
fn u_shape() -> Faces {
    of_cubes(3, |[x, y, z]| y == 0 && z < 2 && (z == 1 || x != 1))
}

/// A shank of 2 x 2 x 6 m between two flukes of that size, across each other: 56 m³.
fn dolos() -> Faces {
    of_cubes(6, |[x, y, z]| {
        let is_middle = |a: i32| (2..4).contains(&a);
        (is_middle(x) && is_middle(y)) || (z < 2 && is_middle(y)) || (z >= 4 && is_middle(x))
    })
}

/// A ring about z of radius 1 m and a thickness of 0.6 m: `n` segments of `m` sides.
fn ring(n: usize, m: usize) -> Faces {
    let at = |i: usize, j: usize| {
        let [a, b] =
            [(i, n), (j, m)].map(|(k, n)| std::f64::consts::TAU * (k % n) as f64 / n as f64);
        let radius = 1.0 + 0.3 * b.cos();
        Vec3::new(radius * a.cos(), radius * a.sin(), 0.3 * b.sin())
    };
    let sides = (0..n).flat_map(|i| (0..m).map(move |j| (i, j)));
    sides
        .map(|(i, j)| vec![at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)])
        .collect()
}

/// Four legs from the middle to the corners of a tetrahedron, smooth: a cube's grid of 2 x 12 x 12 m² moved out to
/// r = 0.45 m + 0.55 m ((cos θ − 0.6)/0.4)², θ the angle from the nearest leg.
fn tetrapod() -> Faces {
    let legs = [
        [1.0, 1.0, 1.0],
        [1.0, -1.0, -1.0],
        [-1.0, 1.0, -1.0],
        [-1.0, -1.0, 1.0],
    ];
    let legs = legs.map(|leg| Vec3::from(leg).normalize());
    let moved = |x: Vec3| {
        let direction = (x - Vec3::repeat(6.0)).normalize();
        let nearest = legs
            .iter()
            .map(|leg| leg.dot(&direction))
            .fold(-1.0, f64::max);
        direction * (0.45 + 0.55 * ((nearest - 0.6) / 0.4).max(0.0).powi(2))
    };
    let cube = of_cubes(12, |_| true).into_iter();
    // two triangles each: moved corners are not in one plane
    cube.map(|face| face.into_iter().map(moved).collect::<Vec<_>>())
        .flat_map(|f| [vec![f[0], f[1], f[2]], vec![f[0], f[2], f[3]]])
        .collect()
}

/// Turned about an axis that no coordinate axis is near, and moved to map coordinates.
fn turned(mut faces: Faces) -> Faces {
    let turn = nalgebra::Rotation3::from_euler_angles(0.5, 0.35, 0.65);
    for x in faces.iter_mut().flatten() {
        *x = turn * *x + Vec3::new(4000.0, -2000.0, 100.0);
    }
    faces
}

fn obj(bodies: &[Faces]) -> String {
    let mut text = String::new();
    let mut n = 0;
    for face in bodies.iter().flatten() {
        for x in face {
            let _ = writeln!(text, "v {:?} {:?} {:?}", x.x, x.y, x.z);
        }
        let corners: String = (n + 1..=n + face.len()).map(|v| format!(" {v}")).collect();
        let _ = writeln!(text, "f{corners}");
        n += face.len();
    }
    text
}

fn folder_with(bodies: &[Faces]) -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("body.obj"), obj(bodies)).unwrap();
    folder
}

/// The convex parts of a body, and the properties of the drawing.
fn parts_of(faces: &Faces, split: Split) -> (Vec<Polyhedron>, MassProperties) {
    let folder = folder_with(std::slice::from_ref(faces));
    let access = Access::of(folder.path());
    let Shape::Polyhedra(parts) = solid(&access, "body.obj", 1.0, split).unwrap() else {
        unreachable!()
    };
    let drawn = survey(&access, "body.obj", 1.0).unwrap().drawn;
    (parts, drawn)
}

fn made(parts: &[Polyhedron]) -> MassProperties {
    Shape::Polyhedra(parts.to_vec()).mass_properties()
}

/// Deepest overlap of two parts; m.
fn deepest_overlap(parts: &[Polyhedron]) -> f64 {
    let pairs = (0..parts.len()).flat_map(|a| (0..a).map(move |b| (a, b)));
    pairs
        .map(|(a, b)| -separating_axes(&parts[a], &parts[b]).best().gap)
        .fold(0.0, f64::max)
}

const EXACT: Split = Split {
    most_parts: 64,
    volume_error: 0.0,
};

#[test]
fn bodies_of_plane_sides_are_split_exactly_and_into_the_fewest_parts() {
    for (name, faces, n_parts, volume) in [
        ("L", l_shape(), 2, 3.0),
        ("U", u_shape(), 3, 5.0),
        ("dolos", dolos(), 3, 56.0),
        ("turned L", turned(l_shape()), 2, 3.0),
        ("turned U", turned(u_shape()), 3, 5.0),
    ] {
        for split in [Split::default(), EXACT] {
            let (parts, drawn) = parts_of(&faces, split);
            assert_eq!(parts.len(), n_parts, "{name}");
            let made = made(&parts);
            // coordinates of 4000 m have 5e-13 m of round-off, over sides of 1 m
            assert!(
                (made.volume / volume - 1.0).abs() < 1e-11,
                "{name}: {}",
                made.volume
            );
            assert!(
                (drawn.volume / volume - 1.0).abs() < 1e-11,
                "{name}: {}",
                drawn.volume
            );
            assert!((made.centroid - drawn.centroid).norm() < 1e-11, "{name}");
            let moments = (made.second_moment - drawn.second_moment).norm();
            assert!(
                moments < 1e-11 * drawn.second_moment.norm(),
                "{name}: {moments}"
            );
            assert!(deepest_overlap(&parts) < 1e-11, "{name}");
        }
    }
    // by hand: an L of three squares of side 1 has its centroid at 5/6
    let drawn = parts_of(&l_shape(), EXACT).1;
    assert!((drawn.centroid - Vec3::new(5.0 / 6.0, 0.5, 5.0 / 6.0)).norm() < 1e-14);
}

/// Each straight segment of a ring is convex, and only a segment is.
#[test]
fn a_ring_is_split_into_its_segments() {
    let (parts, drawn) = parts_of(&turned(ring(24, 12)), EXACT);
    assert_eq!(parts.len(), 24);
    assert!((made(&parts).volume / drawn.volume - 1.0).abs() < 1e-9);
    let (parts, drawn) = parts_of(&ring(24, 12), Split::default());
    let error = made(&parts).volume / drawn.volume - 1.0;
    println!("{} parts, volume {:+.3} %", parts.len(), 100.0 * error);
    assert!(parts.len() < 24 && (0.0..=0.01).contains(&error));
    // not at all in the way of what goes through the middle
    let nearest = parts.iter().map(|part| {
        part.surface_point_within(&Vec3::zeros(), 9.0)
            .unwrap()
            .distance
    });
    assert!(nearest.fold(9.0, f64::min) > 0.6);
}

#[test]
fn a_smooth_body_is_split_within_the_error_and_its_parts_touch() {
    let (parts, drawn) = parts_of(&tetrapod(), Split::default());
    let made = made(&parts);
    let error = made.volume / drawn.volume - 1.0;
    println!("{} parts, volume {:+.3} %", parts.len(), 100.0 * error);
    assert!(parts.len() <= 32 && (0.0..=0.01).contains(&error));
    assert!(deepest_overlap(&parts) < 1e-9);
    // the volume gained, at most as far off as the legs reach
    assert!((made.centroid - drawn.centroid).norm() < error * 1.0);
    assert!(drawn.centroid.norm() < 1e-12); // by symmetry
    let again = parts_of(&tetrapod(), Split::default()).0;
    assert!(parts == again, "the same file is split otherwise");
}

fn scene_of(folder: &Path, blocks: &str, further: &str) -> Result<Scene, Vec<Problem>> {
    let text = format!(
        r#"(title: "meshes", domain: (min: (-20, -20, -20), max: (20, 20, 20)),
            materials: [(name: "m", density: 2400, friction_angle_deg: 35, contact_stiffness: 2e7, restitution: 0.2)],
            blocks: [{blocks}], {further} time: (duration: 3))"#
    );
    resolved_in(folder, &text)
}

fn bar(min: [f64; 3], max: [f64; 3]) -> String {
    let [low, high] = [min, max].map(|[x, y, z]| format!("({x:?}, {y:?}, {z:?})"));
    format!(r#"(name: "bar", material: "m", motion: Fixed, shape: Box(min: {low}, max: {high})),"#)
}

/// Centroids of the second block at the start and at the end (s).
fn start_and_end(scene: &Scene, until: f64) -> [Vec3; 2] {
    let mut world = build(scene).unwrap();
    let start = world.blocks.centroid(1);
    advance(&mut world, until, 3.0, |_| {});
    [start, world.blocks.centroid(1)]
}

/// A hull would come to rest on its lower side; the U straddles the bar and hangs from its bridge.
#[test]
fn a_u_dropped_over_a_bar_hangs_on_it() {
    let folder = folder_with(&[u_shape()]);
    let blocks = format!(
        r#"{} (name: "u", material: "m", shape: Mesh(file: "body.obj", scale: 1))"#,
        bar([1.2, -2.0, -1.0], [1.8, 3.0, 0.8])
    );
    let scene = scene_of(folder.path(), &blocks, "").unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    let [start, end] = start_and_end(&scene, 3.0);
    println!("moved by {:?}", (end - start).as_slice());
    // the bridge is 0.2 m above the bar; weight over stiffness is 6 mm
    assert!((end.z - start.z + 0.2).abs() < 0.01);
    assert!((end.x - start.x).abs() < 0.01 && (end.y - start.y).abs() < 0.01);
}

/// Nothing of the ring is where it is hollow: free fall to the last digits.
#[test]
fn a_sphere_falls_through_a_ring_and_a_ring_over_a_pole() {
    let folder = folder_with(&[ring(24, 12)]);
    let mesh = r#"shape: Mesh(file: "body.obj", scale: 1)"#;
    let sphere = r#"shape: Sphere(center: (0, 0, 1), radius: 0.65)"#;
    let pole = bar([-0.4, -0.4, -9.0], [0.4, 0.4, 0.5]);
    for (blocks, moves) in [
        (
            format!(r#"(name: "ring", material: "m", motion: Fixed, {mesh}),"#),
            sphere,
        ),
        (
            pole,
            r#"placement: (translate: (0, 0, 1)), shape: Mesh(file: "body.obj", scale: 1)"#,
        ),
    ] {
        let blocks = format!(r#"{blocks} (name: "falls", material: "m", {moves})"#);
        let [start, end] = start_and_end(&scene_of(folder.path(), &blocks, "").unwrap(), 0.7);
        let fall = 0.5 * 9.81 * 0.7 * 0.7;
        // the time of the last step is beyond 0.7 s by up to 3 ms at 6.9 m/s
        assert!(
            (start.z - end.z - fall).abs() < 0.025,
            "{} {fall}",
            start.z - end.z
        );
        let aside = (end - start).xy().norm();
        assert!(aside < 1e-12, "{aside}");
    }
}

/// Parts that touch within one body leave it alone: a turned dolos in free fall turns and falls as without contacts.
#[test]
fn parts_of_one_body_do_not_disturb_it() {
    let folder = folder_with(&[turned(dolos())]);
    let blocks = format!(
        r#"{} (name: "dolos", material: "m", shape: Mesh(file: "body.obj", scale: 1),
              placement: (translate: (-4000, 2000, -100)), velocity: (1, 0, 0))"#,
        bar([-19.0, -19.0, -20.0], [-18.0, -18.0, -19.0])
    );
    let scene = scene_of(folder.path(), &blocks, "gravity: (0, 0, 0),").unwrap();
    let mut world = build(&scene).unwrap();
    let energy = world.blocks.energies().kinetic;
    let start = world.blocks.centroid(1);
    advance(&mut world, 1.0, 3.0, |_| {});
    let end = world.blocks.centroid(1);
    let moved = end - start - Vec3::x() * world.time();
    assert!(moved.norm() < 1e-12, "{moved}");
    assert_eq!(world.blocks.energies().kinetic, energy);
}

/// Each shell of a file is a block of a rock mass, cut by its joints if it has any.
#[test]
fn shells_of_a_file_are_blocks_of_a_rock_mass() {
    let aside = |faces: Faces| -> Faces {
        let moved = |face: Vec<Vec3>| face.into_iter().map(|x| x + Vec3::x() * 8.0).collect();
        faces.into_iter().map(moved).collect()
    };
    let folder = folder_with(&[dolos(), aside(dolos()), aside(aside(l_shape()))]);
    let cut = |joints: &str| {
        let mass = format!(
            r#"rock_masses: [(name: "armor", material: "m", boundary: Mesh(file: "body.obj", scale: 1), {joints})],"#
        );
        scene_of(folder.path(), "", &mass).unwrap()
    };
    let volumes = |scene: &Scene| -> Vec<f64> {
        scene
            .blocks
            .iter()
            .map(|block| block.shape.volume())
            .collect()
    };
    let whole = cut("");
    assert_eq!(
        whole.block_names,
        ["armor.0001", "armor.0002", "armor.0003"]
    );
    for (found, expected) in volumes(&whole).iter().zip([56.0, 56.0, 3.0]) {
        assert!((found / expected - 1.0).abs() < 1e-12);
    }
    let said = whole.rock_masses[0].to_string();
    assert!(said.contains("; 3 blocks of several parts"), "{said}");
    // one level plane through the shanks of both, above the L
    let halves =
        cut("joint_sets: [(dip_deg: 0, dip_direction_deg: 0, spacing: 100, origin: (0, 0, 3))]");
    let halves = volumes(&halves);
    assert_eq!(halves.len(), 5);
    assert!((halves.iter().sum::<f64>() - 115.0).abs() < 1e-9);
    assert_eq!(
        halves
            .iter()
            .filter(|&&volume| (volume - 28.0).abs() < 1e-9)
            .count(),
        4
    );
}

#[test]
fn errors_of_a_split_are_stated_warned_of_and_refused() {
    let folder = folder_with(&[ring(24, 12)]);
    let scene = |n: u32| {
        let split = format!("split: (most_parts: {n}, volume_error: 0)");
        let block = format!(
            r#"(name: "ring", material: "m", shape: Mesh(file: "body.obj", scale: 1, {split}))"#
        );
        scene_of(folder.path(), &block, "")
    };
    let exact = scene(24).unwrap();
    assert!(exact.warnings.is_empty());
    let deviation = exact.meshes[0].deviation.unwrap();
    assert!(
        deviation.volume.abs() < 1e-9 && deviation.center < 1e-9 && deviation.inertia.abs() < 1e-9
    );
    let coarse = scene(8).unwrap();
    let deviation = coarse.meshes[0].deviation.unwrap();
    // chords of 45 degrees instead of 15 span more of the hollow
    assert!(
        (0.05..0.07).contains(&deviation.volume),
        "{}",
        deviation.volume
    );
    assert!(deviation.center < 1e-9); // by symmetry
    let [
        Problem {
            code: Code::MeshNotConvex,
            path,
            message,
            severity: Severity::Warning,
        },
    ] = &coarse.warnings[..]
    else {
        panic!("{:?}", coarse.warnings)
    };
    assert_eq!(path, "blocks[0].shape.file");
    let expected = "`body.obj` is not convex: 8 convex parts, volume +6.";
    assert!(
        message.starts_with(expected)
            && message.ends_with("; raise split.most_parts, or lower split.volume_error"),
        "{message}"
    );
    let refused = scene(4).unwrap_err().remove(0);
    let expected = "block `ring`: `body.obj`: shell 1 of 1 is not convex, and 4 convex parts have ";
    assert!(refused.message.starts_with(expected), "{}", refused.message);
    assert!(refused.message.ends_with(
        "; raise split.most_parts, or draw parts that are convex, one closed shell each"
    ));
}

#[test]
fn check_states_how_a_body_is_split() {
    let folder = folder_with(&[dolos()]);
    let text = r#"(title: "a dolos", domain: (min: (-9, -9, -9), max: (9, 9, 9)),
        materials: [(name: "m", density: 2400, friction_angle_deg: 35)],
        blocks: [(name: "d", material: "m", shape: Mesh(file: "body.obj", scale: 1))], time: (duration: 1))"#;
    let path = folder.path().join("case.ron");
    std::fs::write(&path, text).unwrap();
    let said = riprap(&["check", path.to_str().unwrap()]).stdout;
    let said = String::from_utf8(said).unwrap();
    let expected = "1 shells, 240 triangles, 56.000000 m3, box 6.000 x 6.000 x 6.000 m; not convex: split into 3 convex parts, \
                    volume +0.00 %, center of mass ";
    assert!(said.contains(expected), "{said}");
}
