//! Loops over columns, on all threads where there is enough to do.
//!
//! Columns are cut at multiples of a chunk, in a tree that depends on their length alone: sums come out
//! the same bits for any number of threads, and short columns never wake one. Threads are those of the pool
//! that the caller runs in, see [`in_pool`].

/// One column or several of one length.
pub(crate) trait Columns: Sized + Send {
    fn len(&self) -> usize;
    fn split_at(self, k: usize) -> (Self, Self);
}

impl<T: Sync> Columns for &[T] {
    fn len(&self) -> usize {
        <[T]>::len(self)
    }

    fn split_at(self, k: usize) -> (Self, Self) {
        <[T]>::split_at(self, k)
    }
}

impl<T: Send> Columns for &mut [T] {
    fn len(&self) -> usize {
        <[T]>::len(self)
    }

    fn split_at(self, k: usize) -> (Self, Self) {
        self.split_at_mut(k)
    }
}

/// A column of one row for each chunk of the others.
pub(crate) struct PerChunk<'a, T> {
    pub rows: &'a mut [T],
    /// Length of the other columns.
    pub len: usize,
    pub chunk: usize,
}

impl<T: Send> Columns for PerChunk<'_, T> {
    fn len(&self) -> usize {
        self.len
    }

    fn split_at(self, k: usize) -> (Self, Self) {
        let Self { rows, len, chunk } = self;
        let (left, right) = rows.split_at_mut(k / chunk);
        let of = |rows, len| Self { rows, len, chunk };
        (of(left, k), of(right, len - k))
    }
}

macro_rules! columns {
    ($($name:ident),+; $first:ident) => {
        impl<$($name: Columns),+> Columns for ($($name,)+) {
            #[expect(non_snake_case, reason = "a column is named by its type")]
            fn len(&self) -> usize {
                let ($($name,)+) = self;
                let n = $first.len();
                $(debug_assert_eq!($name.len(), n);)+
                n
            }

            #[expect(non_snake_case, reason = "a column is named by its type")]
            fn split_at(self, k: usize) -> (Self, Self) {
                let ($($name,)+) = self;
                $(let $name = $name.split_at(k);)+
                (($($name.0,)+), ($($name.1,)+))
            }
        }
    };
}
columns!(A, B; A);
columns!(A, B, C; A);
columns!(A, B, C, D; A);
columns!(A, B, C, D, E; A);

/// Runs `f` inside the thread pool used by the loops of this module, if there is enough work: entering the pool
/// for every loop would cost more than most loops.
pub(crate) fn in_pool<S: Send>(is_worthwhile: bool, f: impl FnOnce() -> S + Send) -> S {
    if is_worthwhile && rayon::current_thread_index().is_none() {
        rayon::scope(|_| f())
    } else {
        f()
    }
}

/// Runs `f(first, chunk)` over all chunks and combines what they give, in a fixed order.
pub(crate) fn reduce<C: Columns, S: Send>(
    columns: C,
    chunk: usize,
    f: &(impl Fn(usize, C) -> S + Sync),
    combine: &(impl Fn(S, S) -> S + Sync),
) -> S {
    reduce_from(0, columns, chunk, f, combine)
}

fn reduce_from<C: Columns, S: Send>(
    first: usize,
    columns: C,
    chunk: usize,
    f: &(impl Fn(usize, C) -> S + Sync),
    combine: &(impl Fn(S, S) -> S + Sync),
) -> S {
    let n = columns.len();
    if n <= chunk {
        return f(first, columns);
    }
    let middle = n.div_ceil(chunk) / 2 * chunk;
    let (left, right) = columns.split_at(middle);
    let left = || reduce_from(first, left, chunk, f, combine);
    let right = || reduce_from(first + middle, right, chunk, f, combine);
    let (left, right) = if rayon::current_thread_index().is_some() {
        rayon::join(left, right)
    } else {
        (left(), right())
    };
    combine(left, right)
}

/// Runs `f(first, chunk)` over all chunks.
pub(crate) fn for_each<C: Columns>(columns: C, chunk: usize, f: &(impl Fn(usize, C) + Sync)) {
    reduce(columns, chunk, f, &|(), ()| ());
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_chunk_has_its_own_row() {
        let mut rows = [0; 4];
        let numbers = [1; 23];
        let per_chunk = PerChunk {
            rows: &mut rows,
            len: numbers.len(),
            chunk: 7,
        };
        for_each((numbers.as_slice(), per_chunk), 7, &|_, (numbers, own)| {
            own.rows[0] += numbers.iter().sum::<usize>();
        });
        assert_eq!(rows, [7, 7, 7, 2]);
    }

    #[test]
    fn every_row_once_and_the_same_sum_for_any_number_of_threads() {
        let numbers: Vec<f64> = (0..1000).map(|k| 1.0 / f64::from(k + 1)).collect();
        let sum = |threads: usize| {
            let mut rows = vec![0_usize; numbers.len()];
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            let total = pool.map(|pool| {
                pool.install(|| {
                    let columns = (rows.as_mut_slice(), numbers.as_slice());
                    reduce(
                        columns,
                        7,
                        &|first, (rows, numbers): (&mut [usize], &[f64])| {
                            for (k, row) in rows.iter_mut().enumerate() {
                                *row += first + k + 1;
                            }
                            numbers.iter().sum::<f64>()
                        },
                        &|a, b| a + b,
                    )
                })
            });
            assert!(rows.iter().enumerate().all(|(k, row)| *row == k + 1));
            total.map(f64::to_bits).ok()
        };
        assert_eq!(sum(1), sum(3));
        assert!(sum(1).is_some());
    }
}
