//! Shells that share space.

use riprap_dda::{Polyhedron, Vec3, separating_axes, volume};

/// Overlap of two shells above which what they share would count twice; × size of the smaller part.
const DEEPEST_OVERLAP: f64 = 1e-2;

/// The first two shells whose convex parts share space, and the depth of it; m.
pub(super) fn overlap(shells: &[Vec<Polyhedron>]) -> Option<(usize, usize, f64)> {
    let numbered = (0..).zip(shells);
    let (shell, parts): (Vec<usize>, Vec<&Polyhedron>) = numbered
        .flat_map(|(shell, parts)| parts.iter().map(move |part| (shell, part)))
        .unzip();
    let boxes: Vec<(Vec3, Vec3)> = parts.iter().map(|part| part.aabb()).collect();
    let sizes: Vec<f64> = parts.iter().map(|part| volume(part).cbrt()).collect();
    // sorted along x, a part meets only those that begin before it ends
    let mut order: Vec<usize> = (0..parts.len()).collect();
    order.sort_by(|&a, &b| boxes[a].0.x.total_cmp(&boxes[b].0.x).then(a.cmp(&b)));
    for (k, &a) in order.iter().enumerate() {
        let meets = order[k + 1..]
            .iter()
            .take_while(|&&b| boxes[b].0.x < boxes[a].1.x);
        for &b in meets {
            let is_apart =
                (1..3).any(|k| boxes[a].1[k] <= boxes[b].0[k] || boxes[b].1[k] <= boxes[a].0[k]);
            if is_apart || shell[a] == shell[b] {
                continue;
            }
            let depth = -separating_axes(parts[a], parts[b]).best().gap;
            if depth > DEEPEST_OVERLAP * sizes[a].min(sizes[b]) {
                let (a, b) = (shell[a], shell[b]);
                return Some((a.min(b), a.max(b), depth));
            }
        }
    }
    None
}
