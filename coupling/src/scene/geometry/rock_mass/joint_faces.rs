//! Faces of blocks on the joints that cut them.

use riprap_dda::{Joint, Polyhedron};

use crate::scene::file::{JointFacesFile, JointSetFile};

/// Distance from a joint within which a corner lies on it; × size of its part. Cuts, unions and hulls move no corner by more.
const ON_JOINT: f64 = 1e-6;

/// Name of a joint set: its own, or its number from 1.
pub(in crate::scene) fn name_of(set: usize, sets: &[JointSetFile]) -> String {
    let own = sets.get(set).and_then(|file| file.name.clone());
    own.unwrap_or_else(|| format!("set {}", set + 1))
}

/// Faces of a block of convex parts that lie on joints, by set.
pub(super) fn joint_faces(
    parts: &[Polyhedron],
    joints: &[Joint],
    sets: &[JointSetFile],
) -> Vec<JointFacesFile> {
    let mut faces: Vec<Vec<u32>> = vec![Vec::new(); sets.len()];
    let mut first = 0;
    for part in parts {
        let tolerance = ON_JOINT * riprap_dda::volume(part).cbrt();
        for face in 0..part.n_faces() {
            let is_on = |joint: &&Joint| {
                let mut corners = part
                    .face_vertices(face)
                    .map(|v| part.vertices()[v as usize]);
                corners.all(|x| joint.plane.height(&x).abs() <= tolerance)
            };
            if let Some(joint) = joints.iter().find(is_on)
                && let Some(of_set) = faces.get_mut(joint.set)
            {
                of_set.push(first + face as u32);
            }
        }
        first += part.n_faces() as u32;
    }
    let numbered = faces.into_iter().enumerate();
    numbered
        .filter(|(_, faces)| !faces.is_empty())
        .map(|(set, faces)| JointFacesFile {
            set: name_of(set, sets),
            faces,
        })
        .collect()
}
