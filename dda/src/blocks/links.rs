//! Pairs of each block.

/// Rows of pairs, one row per block.
#[derive(Clone, Debug, Default)]
pub(crate) struct Links {
    /// n_blocks + 1.
    start: Vec<u32>,
    /// Twice the pair's index in the list, plus one if the block is the second.
    entries: Vec<u32>,
}

impl Links {
    /// Lists, for each of `n_blocks`, its pairs in their order.
    pub fn set(&mut self, n_blocks: usize, pairs: impl Iterator<Item = (u32, u32)> + Clone) {
        self.start.clear();
        self.start.resize(n_blocks + 1, 0);
        for (i, j) in pairs.clone() {
            self.start[i as usize + 1] += 1;
            self.start[j as usize + 1] += 1;
        }
        for b in 0..n_blocks {
            self.start[b + 1] += self.start[b];
        }
        let n = self.start[n_blocks] as usize;
        self.entries.clear();
        self.entries.resize(n, 0);
        // Filled with `start` as cursors, which leaves each at the start of the next row.
        for (pair, (i, j)) in pairs.enumerate() {
            for (block, side) in [(i, 0), (j, 1)] {
                let cursor = &mut self.start[block as usize];
                self.entries[*cursor as usize] = 2 * pair as u32 + side;
                *cursor += 1;
            }
        }
        self.start.rotate_right(1);
        self.start[0] = 0;
    }

    /// Index in the list, and whether the block is the second of the pair.
    pub fn of(&self, block: usize) -> impl Iterator<Item = (usize, bool)> + '_ {
        let row = self.start[block] as usize..self.start[block + 1] as usize;
        self.entries[row]
            .iter()
            .map(|&entry| ((entry / 2) as usize, entry % 2 == 1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_pair_is_linked_from_both_blocks() {
        let mut links = Links::default();
        let pairs = [(0, 2), (0, 3), (2, 3)];
        for _ in 0..2 {
            links.set(5, pairs.iter().copied());
            let rows: Vec<Vec<(usize, bool)>> = (0..5).map(|b| links.of(b).collect()).collect();
            let expected = [
                vec![(0, false), (1, false)],
                vec![],
                vec![(0, true), (2, false)],
                vec![(1, true), (2, true)],
                vec![],
            ];
            assert_eq!(rows, expected);
        }
    }
}
