//! Peak rates of the processor: memory bandwidth, multiply-adds, divisions and square roots.
//!
//! The registers are those of the sums, AVX2 with fused multiply-add, whatever wider ones there may be. Every
//! rate is the fastest of a few tries, all threads at once.

use std::hint::black_box;
use std::time::Instant;

use rayon::ThreadPool;
use rayon::prelude::*;
use riprap_sph::Precision;

/// Numbers in each of the three arrays of the triad: 128 MiB, far more than any cache.
const LENGTH: usize = 1 << 24;
/// Numbers that a thread takes at a time.
const PIECE: usize = 1 << 16;
/// Tries of each measurement.
const TRIES: usize = 5;
/// Turns of a loop of arithmetic.
const TURNS: usize = 1 << 21;

/// Rates with a number of threads; per second.
#[derive(Clone, Copy)]
pub struct Roofs {
    /// Bytes read and written by a triad; what a write first reads is not counted.
    pub bytes: f64,
    pub single: Arithmetic,
    pub double: Arithmetic,
}

/// Numbers that leave the arithmetic units; per second, NaN where there is no AVX2.
#[derive(Clone, Copy)]
pub struct Arithmetic {
    pub multiply_adds: f64,
    pub divisions: f64,
    pub roots: f64,
}

impl Roofs {
    /// Measures them on the threads of a pool.
    pub fn measure(pool: &ThreadPool) -> Self {
        Self {
            bytes: pool.install(triad),
            single: arithmetic(pool, Precision::Single),
            double: arithmetic(pool, Precision::Double),
        }
    }

    /// Those of a precision.
    pub fn arithmetic(&self, precision: Precision) -> &Arithmetic {
        match precision {
            Precision::Single => &self.single,
            Precision::Double => &self.double,
        }
    }
}

/// `a = b + 3 c`; bytes per second.
fn triad() -> f64 {
    let filled = |value: f64| -> Vec<f64> {
        // by the threads that use it: a page belongs where it is first written
        (0..LENGTH).into_par_iter().map(|_| value).collect()
    };
    let (mut a, b, c) = (filled(0.0), filled(1.0), filled(2.0));
    let fastest = fastest(|| {
        a.par_chunks_mut(PIECE)
            .zip(b.par_chunks(PIECE))
            .zip(c.par_chunks(PIECE))
            .for_each(|((a, b), c)| {
                for ((a, b), c) in a.iter_mut().zip(b).zip(c) {
                    *a = b + 3.0 * c;
                }
            });
        black_box(&a);
    });
    (3 * LENGTH * size_of::<f64>()) as f64 / fastest
}

/// Seconds of the fastest of a few tries.
pub fn fastest(mut work: impl FnMut()) -> f64 {
    (0..TRIES)
        .map(|_| {
            let start = Instant::now();
            work();
            start.elapsed().as_secs_f64()
        })
        .fold(f64::INFINITY, f64::min)
}

#[cfg(not(target_arch = "x86_64"))]
fn arithmetic(_: &ThreadPool, _: Precision) -> Arithmetic {
    NONE
}

#[cfg(target_arch = "x86_64")]
fn arithmetic(pool: &ThreadPool, precision: Precision) -> Arithmetic {
    use avx2::{Double, Single};

    let Some(machine) = pulp::x86::V3::try_new() else {
        return NONE;
    };
    match precision {
        Precision::Single => Arithmetic {
            multiply_adds: avx2::rate(pool, machine, Single::MultiplyAdd),
            divisions: avx2::rate(pool, machine, Single::Division),
            roots: avx2::rate(pool, machine, Single::Root),
        },
        Precision::Double => Arithmetic {
            multiply_adds: avx2::rate(pool, machine, Double::MultiplyAdd),
            divisions: avx2::rate(pool, machine, Double::Division),
            roots: avx2::rate(pool, machine, Double::Root),
        },
    }
}

/// Where nothing was measured.
const NONE: Arithmetic = Arithmetic {
    multiply_adds: f64::NAN,
    divisions: f64::NAN,
    roots: f64::NAN,
};

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use pulp::NullaryFnOnce;
    use pulp::x86::V3;

    use super::{TURNS, ThreadPool, black_box, fastest};

    /// Sums under way: enough that two units never wait for their own results, few enough for the registers.
    const CHAINS: usize = 12;

    /// A loop on registers of one width.
    pub trait Loop: Copy + Send + Sync {
        /// Numbers in a register.
        const WIDTH: usize;
        /// Runs it, [`TURNS`] turns of [`CHAINS`] operations.
        fn run(self, machine: V3);
    }

    /// Numbers per second that leave the loop.
    pub fn rate<L: Loop>(pool: &ThreadPool, machine: V3, work: L) -> f64 {
        let seconds = fastest(|| {
            pool.broadcast(|_| machine.vectorize(Call { machine, work }));
        });
        (pool.current_num_threads() * TURNS * CHAINS * L::WIDTH) as f64 / seconds
    }

    /// A loop as the dispatcher wants it: closures are not inlined into what it compiles.
    struct Call<L> {
        machine: V3,
        work: L,
    }

    impl<L: Loop> NullaryFnOnce for Call<L> {
        type Output = ();

        #[inline(always)]
        fn call(self) {
            self.work.run(self.machine);
        }
    }

    macro_rules! loops {
        ($name:ident, $width:literal, $set:ident, $fma:ident, $add:ident, $div:ident, $sqrt:ident) => {
            /// One kind of operation.
            #[derive(Clone, Copy)]
            pub enum $name {
                MultiplyAdd,
                Division,
                Root,
            }

            impl Loop for $name {
                const WIDTH: usize = $width;

                #[inline(always)]
                fn run(self, machine: V3) {
                    let (avx, fma) = (machine.avx, machine.fma);
                    let half = avx.$set(black_box(0.5));
                    let mut sums = [avx.$set(black_box(1.0)); CHAINS];
                    // one loop each, and additions beside the slow units, so that nothing settles on a
                    // number that they know by heart
                    match self {
                        Self::MultiplyAdd => {
                            for _ in 0..TURNS {
                                for sum in &mut sums {
                                    *sum = fma.$fma(*sum, half, half);
                                }
                            }
                        }
                        Self::Division => {
                            for _ in 0..TURNS {
                                for sum in &mut sums {
                                    *sum = avx.$div(half, avx.$add(*sum, half));
                                }
                            }
                        }
                        Self::Root => {
                            for _ in 0..TURNS {
                                for sum in &mut sums {
                                    *sum = avx.$sqrt(avx.$add(*sum, half));
                                }
                            }
                        }
                    }
                    black_box(sums);
                }
            }
        };
    }

    loops!(
        Single,
        8,
        _mm256_set1_ps,
        _mm256_fmadd_ps,
        _mm256_add_ps,
        _mm256_div_ps,
        _mm256_sqrt_ps
    );
    loops!(
        Double,
        4,
        _mm256_set1_pd,
        _mm256_fmadd_pd,
        _mm256_add_pd,
        _mm256_div_pd,
        _mm256_sqrt_pd
    );
}
