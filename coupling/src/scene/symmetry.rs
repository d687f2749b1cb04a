//! Conditions of planes of symmetry on blocks and on the initial water.

use riprap_dda::{Motion, PrescribedMotion, Shape, Vec3};
use riprap_sph::{Symmetry, SymmetryPlane};

use super::error::Problem;
use super::file::vec3;
use super::file::{DomainFile, LatticeFile, SceneFile, SideFile};
use super::fill::Lattice;
use crate::world::TOUCH;

/// Way across a plane from which on a prescribed motion is not along it, of the size of the domain.
const ALONG: f64 = 1e-9;
/// Looks at a prescribed motion.
const LOOKS: u32 = 1000;
/// By how much the first row of water may be off half a spacing from a plane; × spacing.
const ROW_SLACK: f64 = 0.1;

/// Sides of the domain that are planes of symmetry.
pub(super) fn symmetry(domain: &DomainFile) -> Symmetry {
    let mut symmetry = Symmetry::default();
    for side in &domain.symmetry {
        let (axis, is_upper) = side.axis();
        symmetry[axis][usize::from(is_upper)] = true;
    }
    symmetry
}

fn planes(domain: &DomainFile) -> impl Iterator<Item = (SideFile, SymmetryPlane)> {
    let (min, max) = (vec3(domain.min), vec3(domain.max));
    domain.symmetry.iter().map(move |&side| {
        let (axis, is_upper) = side.axis();
        let place = if is_upper { max[axis] } else { min[axis] };
        let plane = SymmetryPlane {
            axis,
            is_upper,
            place,
        };
        (side, plane)
    })
}

/// Refuses blocks that would meet their own mirror image: those that touch a plane and can move across it.
pub(super) fn refuse_blocks(
    file: &SceneFile,
    solids: &[(String, Shape)],
    motions: &[Motion],
    problems: &mut Vec<Problem>,
) {
    let size = (vec3(file.domain.max) - vec3(file.domain.min)).norm();
    for (side, plane) in planes(&file.domain) {
        for (index, ((name, shape), motion)) in solids.iter().zip(motions).enumerate() {
            let (min, max) = shape.aabb();
            let nearest = if plane.is_upper { max } else { min };
            if TOUCH * size < plane.distance(&nearest) {
                continue;
            }
            let what = match motion {
                Motion::Fixed => continue,
                Motion::Prescribed(motion) => {
                    if farthest_across(motion, &plane, file.time.duration) <= ALONG * size {
                        continue;
                    }
                    "touches the plane of symmetry and moves across it; let it move along the plane"
                }
                Motion::Free => {
                    "touches the plane of symmetry and is free, and would meet its own mirror image; make it Fixed \
                     or prescribed along the plane, keep it clear of the plane, or model the whole"
                }
            };
            problems.push(Problem::error(
                format!("blocks[{index}].motion"),
                format!("block `{name}` {what} ({side:?})"),
            ));
        }
    }
}

fn farthest_across(motion: &PrescribedMotion, plane: &SymmetryPlane, duration: f64) -> f64 {
    // what turns about another axis comes across too: an arm of a meter stands for any
    let across = |t: f64| {
        let mut turning = motion.turn(t).scaled_axis();
        turning[plane.axis] = 0.0;
        motion.displacement(t)[plane.axis] + turning.norm()
    };
    let start = across(0.0);
    (1..=LOOKS)
        .map(|k| (across(duration * f64::from(k) / f64::from(LOOKS)) - start).abs())
        .fold(0.0, f64::max)
}

/// Says so where the first row of water does not stand half a spacing from a plane: the row and its image would
/// push each other apart, or leave a gap. Rows of staggered layers stand a quarter to and fro of that, and packing
/// spreads them.
pub(super) fn question_rows(
    (domain, arrangement): (&DomainFile, LatticeFile),
    lattice: &Lattice,
    problems: &mut Vec<Problem>,
) {
    let first = match arrangement {
        LatticeFile::Cubic => 0.5,
        LatticeFile::Staggered => 0.25,
    };
    for (side, plane) in planes(domain) {
        let spacing = lattice.spacing[plane.axis];
        let distance = |x: &Vec3| plane.distance(x) / spacing;
        let nearest = lattice
            .positions
            .iter()
            .map(distance)
            .fold(f64::INFINITY, f64::min);
        // farther off there is no water at the plane
        if nearest < 1.5 && ROW_SLACK < (nearest - first).abs() {
            problems.push(Problem::warning(
                "domain.symmetry",
                format!(
                    "{side:?}: the first row of water stands {nearest:.2} spacings from the plane of symmetry, not \
                     {first}; let regions end at the plane, and their length be a whole number of spacings"
                ),
            ));
        }
    }
}
