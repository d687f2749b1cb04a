//! POV-Ray file of a frame.

use super::body::{Body, RoundFace, Stage, in_panel, sunny_side};
use super::camera::{Camera, Lens, Panel};
use super::surface::Surface;
use crate::picture::color::ColorMap;
use nalgebra::{Matrix3, Vector3};
use std::fmt::{Display, Write};

/// Files included by every frame, by name and text.
pub const INCLUDES: [(&str, &str); 3] = [
    ("scene.inc", include_str!("../../../../render/scene.inc")),
    (
        "materials.inc",
        include_str!("../../../../render/materials.inc"),
    ),
    ("labels.inc", include_str!("../../../../render/labels.inc")),
];

/// Colors in `materials.inc`.
const SPEED_COLORS: usize = 64;
/// Stops between which `materials.inc` interpolates them.
const SPEED_STOPS: usize = 9;

/// Declarations shared by all frames.
pub(crate) struct Setting<'a> {
    pub title: &'a str,
    pub camera: &'a Camera,
    pub stage: &'a Stage,
    /// Bodies in the first frame, to which their textures are attached.
    pub reference: &'a [Body],
    /// Length of the scene; m.
    pub size: f64,
    /// Depth of water at which its color becomes visible; m.
    pub clear: f64,
    /// Height of the ground; m.
    pub ground: f64,
    /// Particle spacing; m.
    pub spacing: f64,
    /// Speed at the upper end of the colors; m/s.
    pub speed_range: f64,
    pub colors: ColorMap,
}

/// Water as drawn.
pub(crate) enum Water {
    /// A surface, and the particles that are not part of it.
    Surface(Surface, Vec<[f32; 3]>),
    /// Particles with their speeds; m/s. Without speeds all have the color of still water.
    Particles(Vec<[f32; 3]>, Option<Vec<f32>>),
}

/// The text of one frame.
pub(crate) fn frame(setting: &Setting<'_>, time: f64, water: &Water, bodies: &[Body]) -> String {
    let mut pov = Pov {
        text: String::new(),
        unit: unit(setting.size),
    };
    head(&mut pov, setting, time);
    for panel in setting.camera.panels() {
        fixed(&mut pov, setting, panel);
        for body in bodies {
            rock(&mut pov, setting, body, panel);
        }
        match water {
            Water::Surface(surface, spray) => {
                water_mesh(&mut pov, surface, panel);
                spheres(&mut pov, spray, 0.3 * setting.spacing, panel, |_| {
                    "Riprap_Spray_Texture".to_owned()
                });
            }
            Water::Particles(points, speeds) => {
                spheres(&mut pov, points, 0.5 * setting.spacing, panel, |i| {
                    let speed = speeds
                        .as_ref()
                        .and_then(|s| s.get(i))
                        .copied()
                        .unwrap_or(0.0);
                    let share = (f64::from(speed) / setting.speed_range).clamp(0.0, 1.0);
                    let color = (share * SPEED_COLORS as f64) as usize;
                    format!("Riprap_Speed_Textures[{}]", color.min(SPEED_COLORS - 1))
                });
            }
        }
    }
    labels(&mut pov, setting, time, water);
    pov.text
}

/// Text under construction; writing to a `String` cannot fail.
struct Pov {
    text: String,
    /// POV-Ray units per meter.
    unit: f64,
}

impl Pov {
    fn line(&mut self, text: impl Display) {
        let _ = writeln!(self.text, "{text}");
    }

    /// A length given in meters.
    fn length(&self, meters: f64) -> f32 {
        number(self.unit * meters)
    }

    /// A position given in meters.
    fn place(&self, meters: Vector3<f64>) -> String {
        vector(self.unit * meters)
    }
}

/// Units per meter for a scene length of 100 to 1000: POV-Ray misses surfaces closer than
/// 0.001 to each other, a millimeter in a tank drawn in meters, which causes rings where water
/// touches walls.
fn unit(size: f64) -> f64 {
    10_f64.powf(3.0 - size.log10().ceil())
}

/// A POV-Ray vector.
fn vector(v: Vector3<f64>) -> String {
    format!("<{}, {}, {}>", number(v.x), number(v.y), number(v.z))
}

/// A number exact in single precision, without exponent and -0.
fn number(x: f64) -> f32 {
    let x = x as f32;
    if x.abs() < 1e-12 { 0.0 } else { x }
}

/// A POV-Ray string with the characters of its built-in font, without quotes.
fn string(text: &str) -> String {
    let plain = |c: char| {
        if (' '..='~').contains(&c) && c != '"' && c != '\\' {
            c
        } else {
            '?'
        }
    };
    format!("\"{}\"", text.chars().map(plain).collect::<String>())
}

/// Declares the colors of speeds before `materials.inc`, which has viridis.
fn speed_colors(pov: &mut Pov, colors: ColorMap) {
    if colors == ColorMap::Viridis {
        return;
    }
    let part = |value: u8| number((f64::from(value) / 255.0 * 1e3).round() / 1e3);
    let stops = colors.speeds(SPEED_STOPS).into_iter();
    let stops = stops.map(|[r, g, b]| format!("srgb <{}, {}, {}>", part(r), part(g), part(b)));
    pov.line(format!(
        "#declare Riprap_Speed_Colors = array[{SPEED_STOPS}] {{ {} }}",
        stops.collect::<Vec<_>>().join(", ")
    ));
}

fn head(pov: &mut Pov, setting: &Setting<'_>, time: f64) {
    let camera = setting.camera;
    let axes = camera.axes();
    let strips = match &camera.lens {
        Lens::Perspective { .. } => 0,
        Lens::Strips { panels, .. } => panels.len(),
    };
    let to_target = (camera.look_at - camera.eye).norm();
    let (label_distance, half_width) = match camera.lens {
        // Close enough for an unobstructed view.
        Lens::Perspective { field_of_view_deg } => {
            let near = 0.02 * to_target;
            (near, near * (0.5 * field_of_view_deg.to_radians()).tan())
        }
        Lens::Strips { width, .. } => (0.02 * to_target, 0.5 * width),
    };
    // A comment ends at the end of the line, so the title must be a single line.
    pov.line(format!(
        "// {}, t = {time} s; written by riprap render",
        string(setting.title)
    ));
    pov.line("#version 3.7;");
    for (name, value) in [
        ("Time", time),
        ("Unit", pov.unit),
        ("Size", pov.unit * setting.size),
        ("Clear", pov.unit * setting.clear),
        ("Ground", pov.unit * setting.ground),
        ("Strips", strips as f64),
        ("Sunny_Side", sunny_side(&setting.stage.terrain, camera)),
        ("Label_Distance", pov.unit * label_distance),
        ("Half_Width", pov.unit * half_width),
    ] {
        pov.line(format!("#declare Riprap_{name} = {};", number(value)));
    }
    for (name, value) in [
        ("Eye", pov.unit * camera.eye),
        ("Target", pov.unit * camera.look_at),
        ("Right", axes.right),
        ("Up", axes.up),
        ("Forward", axes.forward),
    ] {
        pov.line(format!("#declare Riprap_{name} = {};", vector(value)));
    }
    speed_colors(pov, setting.colors);
    for (name, _) in INCLUDES {
        pov.line(format!("#include \"{name}\""));
    }
    // POV-Ray's own axes are left-handed; ours are right-handed with z up, hence the minus.
    match camera.lens {
        Lens::Perspective { field_of_view_deg } => pov.line(format!(
            "camera {{ location Riprap_Eye sky {} right -x*image_width/image_height \
             angle {} look_at Riprap_Target }}",
            if axes.forward.z.abs() < 0.9999 {
                "z"
            } else {
                "y"
            },
            number(field_of_view_deg)
        )),
        Lens::Strips { .. } => pov.line(
            "camera { orthographic location Riprap_Eye direction Riprap_Forward \
             right 2*Riprap_Half_Width*Riprap_Right \
             up 2*Riprap_Half_Width*Riprap_Up*image_height/image_width }",
        ),
    }
}

/// Writes walls and terrain, and the outlines of cut walls.
fn fixed(pov: &mut Pov, setting: &Setting<'_>, panel: &Panel) {
    let Stage { drawn, terrain, .. } = setting.stage;
    let cut = |faces: &mut dyn Iterator<Item = &Vec<Vector3<f64>>>| -> Vec<_> {
        faces.map(|p| in_panel(p, panel)).collect()
    };
    let walls = cut(&mut drawn.iter());
    flat_mesh(pov, &walls, "texture { Riprap_Wall_Texture } no_shadow");
    let look = "texture { Riprap_Terrain_Texture }";
    match *panel == Panel::WHOLE {
        true => round_mesh(pov, terrain, look),
        false => flat_mesh(pov, &cut(&mut terrain.iter().map(|f| &f.corners)), look),
    }
    let radius = 0.0012 * setting.size;
    for polygon in &setting.stage.cut {
        let polygon = in_panel(polygon, panel);
        for (i, &p) in polygon.iter().enumerate() {
            let q = polygon[(i + 1) % polygon.len()];
            if (p - q).norm() > radius {
                let (from, to, thick) = (pov.place(p), pov.place(q), pov.length(radius));
                pov.line(format!(
                    "cylinder {{ {from}, {to}, {thick} texture {{ Riprap_Outline_Texture }} \
                     no_shadow no_reflection }}"
                ));
            }
        }
    }
}

/// Writes a block with a granite texture that moves with it.
fn rock(pov: &mut Pov, setting: &Setting<'_>, body: &Body, panel: &Panel) {
    let polygons: Vec<_> = body.polygons().map(|p| in_panel(&p, panel)).collect();
    let reference = setting
        .reference
        .iter()
        .find(|r| r.id == body.id)
        .unwrap_or(body);
    let (turn, shift) = body
        .motion_from(reference)
        .unwrap_or((Matrix3::identity(), Vector3::zeros()));
    let shift = shift + panel.shift;
    let extent =
        reference
            .corners
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| {
                let along = p.dot(&Vector3::new(0.577, 0.577, 0.577));
                (low.min(along), high.max(along))
            });
    let grain = 0.35 * (extent.1 - extent.0).max(1e-6);
    // Blocks of equal shape get different parts of the texture; the golden ratio spreads tints evenly.
    let tint = (f64::from(body.id) * 0.618_034).rem_euclid(1.0);
    let shift = pov.unit * shift;
    let matrix: Vec<String> = turn
        .iter()
        .chain(shift.iter())
        .map(|&x| number(x).to_string())
        .collect();
    // POV-Ray multiplies rows from the left: its rows are our columns, the order of `iter`.
    let texture = format!(
        "texture {{ Riprap_Rock({}, {}) translate {} matrix <{}> }}",
        number(tint),
        pov.length(grain),
        pov.length(7.3 * f64::from(body.id) * grain),
        matrix.join(", ")
    );
    flat_mesh(pov, &polygons, &texture);
}

/// Convex polygons as fans of triangles, without normals: edges stay sharp.
fn flat_mesh(pov: &mut Pov, polygons: &[Vec<Vector3<f64>>], texture: &str) {
    let solid: Vec<_> = polygons.iter().filter(|p| 3 <= p.len()).collect();
    fans(pov, solid.iter().map(|p| p.as_slice()), None, texture);
}

/// The same with normals, so that light changes gradually across edges.
fn round_mesh(pov: &mut Pov, faces: &[RoundFace], texture: &str) {
    let normals = faces.iter().flat_map(|face| &face.normals);
    let normals: Vec<String> = normals
        .map(|n| format!("<{:.4}, {:.4}, {:.4}>", n.x, n.y, n.z))
        .collect();
    let polygons = faces.iter().map(|face| face.corners.as_slice());
    fans(pov, polygons, Some(normals), texture);
}

fn fans<'a>(
    pov: &mut Pov,
    polygons: impl Iterator<Item = &'a [Vector3<f64>]> + Clone,
    normals: Option<Vec<String>>,
    texture: &str,
) {
    let n_vertices: usize = polygons.clone().map(<[_]>::len).sum();
    if n_vertices == 0 {
        return;
    }
    pov.line(format!("mesh2 {{\n vertex_vectors {{ {n_vertices},"));
    let corners = polygons.clone().flatten();
    let corners: Vec<String> = corners.map(|&p| pov.place(p)).collect();
    pov.line(corners.join(",\n"));
    if let Some(normals) = normals {
        pov.line(format!(" }}\n normal_vectors {{ {},", normals.len()));
        pov.line(normals.join(",\n"));
    }
    let mut first = 0;
    let mut triangles = Vec::new();
    for polygon in polygons {
        // left-handed, as in POV-Ray, which computes its own normals where those of all corners are equal
        triangles.extend(
            (1..polygon.len() - 1).map(|i| format!("<{first}, {}, {}>", first + i + 1, first + i)),
        );
        first += polygon.len();
    }
    pov.line(format!(" }}\n face_indices {{ {},", triangles.len()));
    pov.line(triangles.join(",\n"));
    pov.line(format!(" }}\n {texture}\n}}"));
}

/// Writes the part of the surface in a panel; a triangle belongs to the panel of its first corner.
fn water_mesh(pov: &mut Pov, surface: &Surface, panel: &Panel) {
    let inside = |t: &&[u32; 3]| panel.contains(&surface.vertices[t[0] as usize]);
    let triangles: Vec<&[u32; 3]> = surface.triangles.iter().filter(inside).collect();
    if triangles.is_empty() {
        return;
    }
    let mut numbers = vec![u32::MAX; surface.vertices.len()];
    let mut used = Vec::new();
    for &corner in triangles.iter().copied().flatten() {
        let number = &mut numbers[corner as usize];
        if *number == u32::MAX {
            *number = used.len() as u32;
            used.push(corner as usize);
        }
    }
    let list = |values: &mut dyn Iterator<Item = String>| values.collect::<Vec<_>>().join(",\n");
    let place =
        |i: &usize| pov.place(Vector3::from(surface.vertices[*i].map(f64::from)) + panel.shift);
    let vertices = list(&mut used.iter().map(place));
    let normal = |i: &usize| {
        let [x, y, z] = surface.normals[*i];
        format!("<{x:.4}, {y:.4}, {z:.4}>")
    };
    let corners = |t: &&[u32; 3]| {
        // left-handed, as in POV-Ray, which computes its own normals where those of all corners are equal
        let [a, b, c] = t.map(|i| numbers[i as usize]);
        format!("<{a}, {c}, {b}>")
    };
    pov.line(format!("mesh2 {{\n vertex_vectors {{ {},", used.len()));
    pov.line(vertices);
    pov.line(format!(" }}\n normal_vectors {{ {},", used.len()));
    pov.line(list(&mut used.iter().map(normal)));
    pov.line(format!(" }}\n face_indices {{ {},", triangles.len()));
    pov.line(list(&mut triangles.iter().map(corners)));
    pov.line(
        " }\n inside_vector z\n texture { Riprap_Water_Texture } \
         interior_texture { Riprap_Water_Side } \
         interior { Riprap_Water_Interior } hollow no_shadow\n}",
    );
}

fn spheres(
    pov: &mut Pov,
    points: &[[f32; 3]],
    radius: f64,
    panel: &Panel,
    texture: impl Fn(usize) -> String,
) {
    let radius = pov.length(radius);
    for (i, point) in points.iter().enumerate().filter(|(_, p)| panel.contains(p)) {
        let at = pov.place(Vector3::from(point.map(f64::from)) + panel.shift);
        pov.line(format!(
            "sphere {{ {at}, {radius} texture {{ {} }} }}",
            texture(i)
        ));
    }
}

/// Time, strips and the range of colors.
fn labels(pov: &mut Pov, setting: &Setting<'_>, time: f64, water: &Water) {
    pov.line(format!(
        "Riprap_Label(\"t = {time:.2} s\", -0.95, 0.88, 0.075)"
    ));
    for (words, (x, y)) in setting.camera.strip_labels() {
        pov.line(format!(
            "Riprap_Label({}, {}, {}, 0.05)",
            string(&words),
            number(x),
            number(y)
        ));
    }
    if let Water::Particles(_, Some(_)) = water {
        pov.line(format!(
            "Riprap_Speed_Bar(\"0\", \"{} m/s\")",
            setting.speed_range
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_title_cannot_end_a_string_or_a_comment() {
        assert_eq!(string("a \"b\"\n\\ é"), "\"a ?b??? ?\"");
    }

    #[test]
    fn numbers_have_no_exponent() {
        for x in [1e-9, -1e-20, 123_456_789.0, -0.0] {
            let text = number(x).to_string();
            assert!(!text.contains(['e', 'E']), "{text}");
        }
    }
}
