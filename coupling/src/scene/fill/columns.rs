//! Columns of a basin: the particles that each has, and those of its volume.

/// Largest change of the particles of a column: a wall that stands off the lattice takes or gives half a column.
const MOST_CHANGED: f64 = 0.6;
/// Most that a column passes on to the next; particles.
const MOST_PASSED_ON: f64 = 1.5;
/// Share of the columns that the deepest are, from which on the floor counts as level.
const LEVEL: f64 = 0.1;
/// Difference of depths that are equal; × spacing.
const EQUAL: f64 = 1e-6;
/// Largest change of a spacing that makes whole rows reach the floor.
const LARGEST_STRETCH: f64 = 0.04;

/// Columns of a basin along z, x first.
pub(super) struct Columns {
    /// Columns along x.
    pub(super) per_row: usize,
    /// As drawn; m³.
    pub(super) volumes: Vec<f64>,
    /// Particles.
    pub(super) filled: Vec<usize>,
}

impl Columns {
    /// Particles of a volume (m³) that columns lack, or have too many when negative, in the order of a line to and fro along x, which
    /// passes on what is less than half a particle. What a wall cuts off a column without any particle is added to one beside it.
    pub(super) fn missing(&self, volume: f64) -> Vec<i32> {
        let mut wanted: Vec<f64> = self.volumes.iter().map(|drawn| drawn / volume).collect();
        for column in 0..wanted.len() {
            if self.filled[column] == 0
                && let Some(beside) = self.fullest_beside(column)
            {
                wanted[beside] += std::mem::take(&mut wanted[column]);
            }
        }
        let mut missing = vec![0; wanted.len()];
        let mut rest = 0.0_f64;
        for column in self.to_and_fro() {
            let filled = self.filled[column];
            if filled == 0 {
                continue;
            }
            rest += wanted[column] - filled as f64;
            let most = MOST_CHANGED * filled as f64;
            let change = rest.round().clamp(-most.floor(), most.ceil());
            missing[column] = change as i32;
            rest = (rest - change).clamp(-MOST_PASSED_ON, MOST_PASSED_ON);
        }
        missing
    }

    /// The column with the most particles of the eight around one.
    fn fullest_beside(&self, column: usize) -> Option<usize> {
        let n = self.per_row;
        let (i, j) = (column % n, column / n);
        let rows = self.volumes.len() / n;
        let around = (j.saturating_sub(1)..(j + 2).min(rows))
            .flat_map(|j| (i.saturating_sub(1)..(i + 2).min(n)).map(move |i| j * n + i));
        around
            .filter(|&beside| 0 < self.filled[beside])
            .max_by_key(|&beside| self.filled[beside])
    }

    fn to_and_fro(&self) -> impl Iterator<Item = usize> {
        let n = self.per_row;
        (0..self.volumes.len()).map(move |k| match (k / n) % 2 {
            0 => k,
            _ => (k / n) * n + n - 1 - k % n,
        })
    }

    /// Spacing along z with which whole rows reach the deepest floor, if that is level and not the spacing itself; m.
    pub(super) fn fitting_height(&self, [dx, dy, dz]: [f64; 3]) -> Option<f64> {
        let depth = |volume: &f64| volume / (dx * dy);
        let deepest = self.volumes.iter().map(depth).fold(0.0, f64::max);
        let is_deepest = |volume: &&f64| deepest - depth(volume) <= EQUAL * dz;
        let wet = self.filled.iter().filter(|&&filled| 0 < filled).count();
        let n = self.volumes.iter().filter(is_deepest).count();
        let height = deepest / (deepest / dz).round().max(1.0);
        let stretch = (height / dz - 1.0).abs();
        let is_worth_it = EQUAL < stretch && stretch <= LARGEST_STRETCH;
        (is_worth_it && LEVEL * wet as f64 <= n as f64).then_some(height)
    }
}
