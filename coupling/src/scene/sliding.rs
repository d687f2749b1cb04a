//! Motion of a block along a path: points, a record of the way, and whether they suit the block.

use riprap_dda::{Motion, Path, PathError, PrescribedMotion, Shape, Sliding, Vec3};

use super::access::Access;
use super::error::Problem;
use super::file::{MotionFile, SceneFile, vec3};
use super::motion::ways;
use crate::messages::Code;

/// Distance of a way beyond the path that is round-off; × length.
const ROUND_OFF: f64 = 1e-9;

/// Motion of the block `index`, of a shape, if it is one along a path.
///
/// # Errors
///
/// A [`Problem`] of the path, its record, or the two together.
pub(super) fn sliding(
    file: &SceneFile,
    index: usize,
    shape: Option<&Shape>,
    access: &Access,
) -> Result<Option<Motion>, Problem> {
    let block = &file.blocks[index];
    let MotionFile::Path {
        points,
        bend_radius,
        base,
        file: record,
    } = &block.motion
    else {
        return Ok(None);
    };
    let at = |field: &str| format!("blocks[{index}].motion.{field}");
    let corners: Vec<Vec3> = points.iter().copied().map(vec3).collect();
    let path = Path::through(&corners, bend_radius.unwrap_or(f64::INFINITY)).map_err(|fault| {
        let place = match fault {
            PathError::TooFewPoints => at("points"),
            PathError::Repeated(k) | PathError::NotPlane(k) | PathError::TurnsBack(k) => {
                at(&format!("points[{k}]"))
            }
        };
        Problem::error(
            Code::UnusablePath,
            place,
            format!("block `{}`: {fault}", block.name),
        )
    })?;
    let rows = ways(record, &format!("blocks[{index}].motion"), access)?;
    let centroid = shape.map_or_else(Vec3::zeros, |shape| shape.mass_properties().centroid);
    let length = path.length();
    let sliding = Sliding::new(path, *base, &rows, centroid);
    for [time, way] in rows {
        let [rear, front] = sliding.ends(way);
        if rear < -ROUND_OFF * length || (1.0 + ROUND_OFF) * length < front {
            let what = match *base {
                0.0 => format!("is not on the path, which is {length:.6} m long"),
                _ => format!(
                    "puts the base from {rear:.6} to {front:.6} m, beyond the path, which is {length:.6} m long"
                ),
            };
            return Err(Problem::error(
                Code::UnusablePath,
                at("file"),
                format!("`{record}`: the way {way} m at {time} s {what}"),
            ));
        }
    }
    Ok(Some(Motion::Prescribed(PrescribedMotion::Sliding(sliding))))
}

/// Warnings about bends that are tighter than the block, and about arcs that leave out more of a corner than a particle sees (m).
pub(super) fn warn_about_bends(
    (index, name): (usize, &str),
    (sliding, shape): (&Sliding, &Shape),
    spacing: Option<f64>,
    problems: &mut Vec<Problem>,
) {
    let (low, high) = shape.aabb();
    let (place, axis) = (sliding.place_drawn(), sliding.path().axis());
    // in the plane of the path
    let reach = (0..8)
        .map(|k| {
            Vec3::from_fn(|axis, _| {
                if k >> axis & 1 == 0 {
                    low[axis]
                } else {
                    high[axis]
                }
            })
        })
        .map(|corner| axis.cross(&(corner - place)).norm())
        .fold(0.0, f64::max);
    let path = |point: usize| format!("blocks[{index}].motion.points[{point}]");
    for cut in sliding.path().cuts() {
        if cut.radius < reach {
            problems.push(Problem::warning(
                Code::TightBend,
                path(cut.point),
                format!(
                    "block `{name}` reaches {reach:.4} m from its path, more than the radius of {:.4} m of this bend: its inner side \
                     moves backward there; round the bend by more points or a larger `bend_radius`",
                    cut.radius
                ),
            ));
        }
        if spacing.is_some_and(|spacing| spacing < cut.distance) {
            problems.push(Problem::warning(
                Code::TightBend,
                path(cut.point),
                format!(
                    "the path of block `{name}` passes this corner at a distance of {:.4} m, more than a particle spacing; give it a \
                     smaller `bend_radius`, or more points",
                    cut.distance
                ),
            ));
        }
    }
}
