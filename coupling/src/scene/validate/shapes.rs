//! Checks of the geometry of blocks that need the file alone.

use super::checks::Checks;
use crate::messages::Code;
use crate::scene::file::{ShapeFile, SplitFile};

impl Checks {
    /// Check of the shape at `path` of the block `name`.
    pub(super) fn shape(&mut self, path: &str, shape: &ShapeFile, name: &str) {
        let who = format!("block `{name}`");
        let of = |what: &str| format!("{who}: {what}");
        let at = |field: &str| format!("{path}.{field}");
        match shape {
            ShapeFile::Box { min, max } => self.extent(path, &who, (*min, *max)),
            ShapeFile::Wedge {
                length,
                height,
                width,
            } => {
                self.positive(at("length"), &of("length"), *length);
                self.positive(at("height"), &of("height"), *height);
                self.positive(at("width"), &of("width"), *width);
            }
            ShapeFile::Hull { points } => {
                if points.len() < 4 {
                    self.refuse(
                        Code::InvalidShape,
                        at("points"),
                        format!(
                            "{} needs at least four points, found {}",
                            of("hull"),
                            points.len()
                        ),
                    );
                }
            }
            ShapeFile::Polyhedron { vertices, faces } => {
                self.faces(path, vertices.len(), faces, name);
            }
            ShapeFile::Polyhedra { parts } => {
                if parts.is_empty() {
                    self.refuse(
                        Code::EmptyList,
                        at("parts"),
                        of("no part; give at least one polyhedron"),
                    );
                }
                for (k, part) in parts.iter().enumerate() {
                    let path = at(&format!("parts[{k}]"));
                    self.faces(&path, part.vertices.len(), &part.faces, name);
                }
            }
            ShapeFile::Extrusion {
                polygon, from, to, ..
            } => {
                if polygon.len() < 3 {
                    self.refuse(
                        Code::InvalidShape,
                        at("polygon"),
                        format!(
                            "{} needs at least three corners, found {}",
                            of("polygon"),
                            polygon.len()
                        ),
                    );
                }
                if from >= to {
                    self.refuse(
                        Code::ValuesOutOfOrder,
                        at("to"),
                        format!("{} {to} must exceed from {from}", of("to")),
                    );
                }
            }
            ShapeFile::Sphere { radius, .. } => {
                self.positive(at("radius"), &of("radius"), *radius);
            }
            ShapeFile::Mesh { scale, split, .. } => {
                self.positive(at("scale"), &of("scale"), *scale);
                self.split(&at("split"), split, &who);
            }
            ShapeFile::Surface { scale, .. } => {
                self.positive(at("scale"), &of("scale"), *scale);
            }
            ShapeFile::Raster { origin, .. } => {
                if !(origin.0.is_finite() && origin.1.is_finite()) {
                    self.refuse(
                        Code::ValueOutOfRange,
                        at("origin"),
                        of("origin must be finite"),
                    );
                }
            }
            ShapeFile::Terrain => {}
        }
    }

    fn split(&mut self, path: &str, split: &SplitFile, who: &str) {
        self.not_negative(
            format!("{path}.volume_error"),
            &format!("{who}: volume error"),
            split.volume_error,
        );
        if split.most_parts == 0 {
            self.refuse(
                Code::ValueOutOfRange,
                format!("{path}.most_parts"),
                format!("{who}: most parts must be at least 1"),
            );
        }
    }

    fn faces(&mut self, path: &str, n_vertices: usize, faces: &[Vec<u32>], name: &str) {
        for (k, face) in faces.iter().enumerate() {
            if let Some(v) = face.iter().find(|&&v| v as usize >= n_vertices) {
                self.refuse(
                    Code::InvalidShape,
                    format!("{path}.faces[{k}]"),
                    format!(
                        "block `{name}`: face {k} names vertex {v}, but there are {n_vertices}"
                    ),
                );
            }
        }
    }
}
