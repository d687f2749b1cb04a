//! Properties of a cloud that a terrain is made of.

use std::fmt;

use crate::scene::geometry::terrain::grid::Grid;

/// Points, spacing, outliers and gaps of a cloud.
#[derive(Clone, Debug, PartialEq)]
pub struct CloudReport {
    /// Points in the file.
    pub n_in_file: usize,
    /// Those of the ground, where the file tells them from others.
    pub n_points: usize,
    /// Median of the spacings, each the mean distance of a point to its four nearest neighbors in plan view; m.
    pub spacing: f64,
    /// Spacing that 95 % of the points do not exceed; m.
    pub widest_spacing: f64,
    /// Points far from the plane of their neighbors, in map coordinates from west to east, which are left out; m.
    pub outliers: Vec<[f64; 3]>,
    /// Places with several heights.
    pub steps: Steps,
    /// Distance from the nearest point beyond which a place has no elevation; m.
    pub widest_gap: f64,
    /// Points of the grid beyond that.
    pub n_gaps: usize,
    /// Place within the extent that is farthest from any point.
    pub gap: Gap,
    /// Shares of the extent within one and two spacings of a point; –.
    pub within: [f64; 2],
}

/// Places with several heights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Steps {
    /// Number of places whose heights differ by more than a tenth of the spacing.
    pub n: usize,
    /// Largest difference; m.
    pub largest: f64,
    /// Its place on the map; m.
    pub at: [f64; 2],
}

impl Steps {
    /// Of places with a difference of heights, those above a height; m.
    pub(super) fn of(apart: &[[f64; 3]], least: f64) -> Self {
        let told = apart.iter().filter(|step| least < step[2]);
        told.fold(Self::default(), |found, &[x, y, height]| {
            let n = found.n + 1;
            if found.largest < height {
                Self {
                    n,
                    largest: height,
                    at: [x, y],
                }
            } else {
                Self { n, ..found }
            }
        })
    }
}

/// Place far from any point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// On the map; m.
    pub at: [f64; 2],
    /// Distance of the nearest point; m.
    pub distance: f64,
}

impl Gap {
    /// The largest of the distances at the points of a grid, whose coordinates are from a corner (m) on the map.
    pub(super) fn of(grid: &Grid, distances: &[f64], corner: [f64; 2]) -> Self {
        let first = (0, f64::NEG_INFINITY);
        let (k, distance) = (distances.iter().enumerate()).fold(first, |found, (k, &distance)| {
            if found.1 < distance {
                (k, distance)
            } else {
                found
            }
        });
        let place = grid.place([k % grid.n[0], k / grid.n[0]]);
        Self {
            at: [0, 1].map(|axis| corner[axis] + place[axis]),
            distance,
        }
    }
}

impl fmt::Display for CloudReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} points", self.n_points)?;
        if self.n_points < self.n_in_file {
            write!(f, " of the ground among {}", self.n_in_file)?;
        }
        write!(
            f,
            ", spacing {:.3} m (median), {:.3} m (95 %); ",
            self.spacing, self.widest_spacing
        )?;
        match self.outliers.first() {
            None => write!(f, "no outliers")?,
            Some([x, y, z]) => write!(
                f,
                "{} outliers left out, first ({x:.2}, {y:.2}, {z:.2})",
                self.outliers.len()
            )?,
        }
        write!(
            f,
            "; largest gap at ({:.2}, {:.2}) on the map, {:.2} m from the nearest point",
            self.gap.at[0], self.gap.at[1], self.gap.distance
        )?;
        if self.n_gaps > 0 {
            write!(
                f,
                ", no height where it exceeds {1:.2} m, at {0} of the points",
                self.n_gaps, self.widest_gap
            )?;
        }
        write!(
            f,
            "; {:.2} % of the extent is within one spacing of a point, {:.2} % within two",
            100.0 * self.within[0],
            100.0 * self.within[1]
        )
    }
}
