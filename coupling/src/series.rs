//! Time series of a number.

/// Time series of a number: linear between rows, constant before and after.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series(Vec<(f64, f64)>);

impl Series {
    /// Rows of time (s) and value, the times increasing; without rows the value is always zero.
    pub fn new(rows: Vec<(f64, f64)>) -> Self {
        Self(rows)
    }

    /// Value at a time.
    pub fn at(&self, time: f64) -> f64 {
        let next = self.0.partition_point(|row| row.0 <= time);
        match (next.checked_sub(1).map(|k| self.0[k]), self.0.get(next)) {
            (Some((t0, a)), Some((t1, b))) => a + (b - a) * (time - t0) / (t1 - t0),
            (Some((_, a)), None) => a,
            (None, Some((_, b))) => *b,
            (None, None) => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_series_is_linear_between_rows_and_constant_outside() {
        let series = Series::new(vec![(1.0, 2.0), (3.0, 6.0)]);
        assert_eq!(
            [0.0, 1.0, 2.0, 3.0, 9.0].map(|t| series.at(t)),
            [2.0, 2.0, 4.0, 6.0, 6.0]
        );
        assert_eq!(Series::default().at(1.0), 0.0);
    }
}
