//! Requirements of planes of symmetry on blocks and on the initial water.

use riprap_dda::{Motion, PrescribedMotion, Shape, Vec3};
use riprap_sph::SymmetryPlane;

use super::error::Problem;
use super::file::vec3;
use super::file::{DomainFile, LatticeFile, SceneFile, SideFile};
use super::fill::Lattice;
use crate::messages::Code;
use crate::world::TOUCH;

/// Displacement across a plane, over the size of the domain, above which a prescribed motion is not along it.
const ALONG: f64 = 1e-9;
/// Samples of a prescribed motion.
const SAMPLES: u32 = 1000;
/// Tolerance of the distance of the first row of water from a plane; × spacing.
const ROW_SLACK: f64 = 0.1;

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
                Code::BlockAtSymmetryPlane,
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
    (1..=SAMPLES)
        .map(|k| (across(duration * f64::from(k) / f64::from(SAMPLES)) - start).abs())
        .fold(0.0, f64::max)
}

/// Warnings where the first row of water is not half a spacing from a plane: the row and its image would push each
/// other apart, or leave a gap. Rows of staggered layers are a quarter to either side of that, and packing spreads
/// them.
pub(super) fn warn_about_rows(
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
                Code::WaterOffSymmetryPlane,
                "domain.symmetry",
                format!(
                    "{side:?}: the first row of water is {nearest:.2} spacings from the plane of symmetry, not \
                     {first}; let regions end at the plane, and their length be a whole number of spacings"
                ),
            ));
        }
    }
}
