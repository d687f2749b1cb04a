//! Text of the report of a rock mass.

use std::fmt;

use super::{RockMassReport, SLIVER};

/// Error of the volume of convex shells, by round-off in the file; –.
const ROUND_OFF: f64 = 1e-6;

impl fmt::Display for RockMassReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [smallest, median, largest] = self.volumes;
        write!(
            f,
            "`{}`: {} blocks of {smallest:.3e} to {largest:.3e} m3, median {median:.3e}; longest over thinnest up to {:.1}, \
             sharpest edge {:.1} deg",
            self.name,
            self.n_blocks,
            self.worst_aspect,
            self.smallest_dihedral.to_degrees()
        )?;
        if self.n_slivers > 0 {
            write!(f, "; {} slivers above {SLIVER}", self.n_slivers)?;
        }
        if self.n_merged > 0 {
            write!(
                f,
                "; {} slivers merged, {} blocks of several parts",
                self.n_merged, self.n_unions
            )?;
        }
        if self.n_merged + self.n_filled == 0 && self.n_unions > 0 {
            write!(f, "; {} blocks of several parts", self.n_unions)?;
        }
        if self.split_error.abs() > ROUND_OFF {
            let percent = 100.0 * self.split_error;
            write!(
                f,
                "; convex parts of its shells have {percent:+.2} % of their volume"
            )?;
        }
        if self.n_filled > 0 {
            write!(
                f,
                "; {} made convex, which adds {:.2e} of the volume, {} left of several parts",
                self.n_filled, self.gained_share, self.n_unions
            )?;
        }
        if self.n_unmerged > 0 {
            write!(f, "; {} slivers without a neighbor left", self.n_unmerged)?;
        }
        if self.n_uncut > 0 {
            write!(
                f,
                "; {} joints left out where they would shave off a piece too thin to be a block",
                self.n_uncut
            )?;
        }
        if self.n_removed > 0 {
            write!(
                f,
                "; {} below {:.3e} m3 left out, {:.2e} of the volume",
                self.n_removed, self.minimum_volume, self.removed_share
            )?;
        }
        Ok(())
    }
}
