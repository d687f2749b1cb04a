//! Sums over neighbors: settings become types here, once per sum and not once per pair.
//!
//! A [`Formula`] makes a [`Term`] for the registers and the kernel at hand, and [`run_term`] sums it. A new term is a file
//! of its own, a formula in [`formulas`], and one function in [`crate::fluid::sums`] or [`crate::fluid::wall_sums`].

mod forces;
pub(crate) mod formulas;

use std::marker::PhantomData;

use crate::Vec3;
use crate::kernel::{AnyKernel, KernelChoice, PairKernel, PointKernel, WendlandC2};
use crate::neighbors::cells::CellGrid;
use crate::neighbors::lists::{Chosen, Lists};
use crate::neighbors::points::Frame;
use crate::neighbors::sweep::{
    AnyPoints, Occlusion, PackedIn, PairKind, Receivers, Sources, Sum, Term, dispatch, sweep,
};
use crate::neighbors::thin_solids::{Facet, ThinSolids};
use crate::settings::Settings;
use crate::simd::lanes::{Lanes, Machine};

pub(crate) use forces::{Drags, FluidForces, Reactions, Shearing, WallForces};

/// Registers with the records that fill them.
pub(crate) trait Registers: Lanes<Machine: Machine, Record: Default + PackedIn> {}

impl<L: Lanes<Machine: Machine, Record: Default + PackedIn>> Registers for L {}

/// Points in their cells.
#[derive(Clone, Copy)]
pub(crate) struct Neighborhood<'a> {
    pub grid: &'a CellGrid,
    pub frame: &'a Frame,
    pub points: &'a AnyPoints,
    /// Farthest that they, or the receivers, may be from where they were sorted; m.
    pub moved: f64,
    pub occlusion: Option<Occlusion<'a>>,
}

/// Occlusion between receivers and points at given positions; `None` without thin solids.
pub(crate) fn occlusion<'a>(
    thin_solids: &'a ThinSolids,
    positions: &'a [Vec3],
    between: PairKind<'a>,
) -> Option<Occlusion<'a>> {
    (0 < thin_solids.len()).then_some(Occlusion {
        thin_solids,
        positions,
        between,
    })
}

/// Wall points that receive.
#[derive(Clone, Copy)]
pub(crate) struct Places<'a> {
    /// m.
    pub positions: &'a [Vec3],
    /// Faces of thin solids that they are behind.
    pub facets: &'a [Facet],
}

/// Setup common to all sums.
pub(crate) struct Setup<'a> {
    pub settings: &'a Settings,
    pub from: Neighborhood<'a>,
    pub receivers: Receivers<'a>,
    /// Neighbor lists of the receivers.
    pub lists: Option<&'a Lists>,
}

impl Setup<'_> {
    fn sources<R: PackedIn>(&self) -> Sources<'_, R> {
        Sources {
            grid: self.from.grid,
            frame: self.from.frame,
            points: R::of(self.from.points),
            occlusion: self.from.occlusion,
            mirrors: self.settings.mirrors(),
            support_radius: self.settings.support_radius(),
            moved: self.from.moved,
        }
    }

    fn kernel<L: Lanes, K: PairKernel<L>>(&self, machine: L::Machine) -> K {
        let s = self.settings;
        let kernel = PointKernel::new(s.scheme.kernel, s.support_radius(), s.dimensions);
        K::new(machine, &kernel)
    }
}

/// Source of the neighbors of a sum: a type, so that unused combinations are not compiled.
pub(crate) trait PairSource {
    /// Whether [`Self::sum_clear`] applies.
    fn has_clear(setup: &Setup) -> bool;

    /// Sums a term into `out` for receivers without a thin solid nearby; returns the number of neighbors.
    fn sum_clear<L, T>(setup: &Setup, machine: L::Machine, term: &T, out: &mut [T::Out]) -> u64
    where
        L: Registers,
        T: Term<L>;

    /// Sums a term into `out`, past thin solids; returns the number of neighbors.
    fn sum<L, T>(
        setup: &Setup,
        machine: L::Machine,
        term: &T,
        chosen: Chosen,
        out: &mut [T::Out],
    ) -> u64
    where
        L: Registers,
        T: Term<L>,
    {
        let (sources, receivers) = (setup.sources(), setup.receivers);
        match setup.lists {
            Some(lists) => {
                lists.sum::<L, T, true>(machine, term, &sources, (receivers, chosen), out)
            }
            None => sweep::<L, T, true>(machine, term, &sources, receivers, out),
        }
    }
}

/// Pairs within the fluid. Only particles that moved farther than the skin without a sort have no lists.
pub(crate) struct FluidPairs;

impl PairSource for FluidPairs {
    fn has_clear(setup: &Setup) -> bool {
        setup.lists.is_some()
    }

    fn sum_clear<L, T>(setup: &Setup, machine: L::Machine, term: &T, out: &mut [T::Out]) -> u64
    where
        L: Registers,
        T: Term<L>,
    {
        let (sources, receivers) = (setup.sources(), setup.receivers);
        setup.lists.map_or(0, |lists| {
            let chosen = Chosen::Clear;
            lists.sum::<L, T, false>(machine, term, &sources, (receivers, chosen), out)
        })
    }
}

/// Pairs of the fluid and its walls, listed or not.
pub(crate) struct WallPairs;

impl PairSource for WallPairs {
    fn has_clear(setup: &Setup) -> bool {
        setup.lists.is_some() || setup.from.occlusion.is_none()
    }

    fn sum_clear<L, T>(setup: &Setup, machine: L::Machine, term: &T, out: &mut [T::Out]) -> u64
    where
        L: Registers,
        T: Term<L>,
    {
        let (sources, receivers) = (setup.sources(), setup.receivers);
        match setup.lists {
            Some(lists) => {
                let receivers = (receivers, Chosen::Clear);
                lists.sum::<L, T, false>(machine, term, &sources, receivers, out)
            }
            None => sweep::<L, T, false>(machine, term, &sources, receivers, out),
        }
    }
}

/// A sum before registers, kernel and constants of its term are chosen.
pub(crate) trait Formula {
    /// Result of a receiver.
    type Out: Send;

    /// Makes the term and has it summed.
    fn apply<L, K, W>(&self, summing: Summing<L, K, W, Self::Out>) -> u64
    where
        L: Registers,
        K: PairKernel<L>,
        W: PairSource;
}

/// Registers and kernel at hand, and where the sums of a term go.
pub(crate) struct Summing<'a, L: Lanes, K, W, O> {
    settings: &'a Settings,
    machine: L::Machine,
    kernel: K,
    setup: &'a Setup<'a>,
    chosen: Chosen,
    out: &'a mut [O],
    source: PhantomData<W>,
}

impl<L: Registers, K: PairKernel<L>, W: PairSource, O: Send> Summing<'_, L, K, W, O> {
    /// Sums a term over the neighbors of the chosen receivers; returns the number of neighbors.
    fn of<T: Term<L, Out = O>>(self, term: &T) -> u64 {
        if K::IS_SPECIALIZED {
            W::sum_clear::<L, T>(self.setup, self.machine, term, self.out)
        } else {
            W::sum::<L, T>(self.setup, self.machine, term, self.chosen, self.out)
        }
    }
}

/// Sums a formula into `out`, one slot per receiver; returns how many neighbors were found, receivers that meet themselves
/// among them.
pub(crate) fn run_term<W: PairSource, F: Formula>(
    setup: &Setup,
    formula: &F,
    out: &mut [F::Out],
) -> u64 {
    let mut n_found = 0;
    let sum = FormulaSum::<W, F> {
        setup,
        formula,
        out,
        n_found: &mut n_found,
        source: PhantomData,
    };
    dispatch(setup.settings.scheme.precision, sum);
    n_found
}

struct FormulaSum<'a, W, F: Formula> {
    setup: &'a Setup<'a>,
    formula: &'a F,
    out: &'a mut [F::Out],
    n_found: &'a mut u64,
    source: PhantomData<W>,
}

impl<W: PairSource, F: Formula> FormulaSum<'_, W, F> {
    fn with<L: Registers, K: PairKernel<L>>(&mut self, machine: L::Machine, chosen: Chosen) {
        *self.n_found += self.formula.apply::<L, K, W>(Summing {
            settings: self.setup.settings,
            machine,
            kernel: self.setup.kernel::<L, K>(machine),
            setup: self.setup,
            chosen,
            out: self.out,
            source: PhantomData,
        });
    }
}

impl<W: PairSource, F: Formula> Sum for FormulaSum<'_, W, F> {
    /// Sums with Wendland's kernel in fast registers and away from thin solids have code of their own. All others choose
    /// kernel and terms at run time, and look for thin solids even if there are none: one copy for all of them.
    fn run<L>(mut self, machine: L::Machine)
    where
        L: Lanes,
        L::Machine: Machine,
        L::Record: Default + PackedIn,
    {
        let is_usual = self.setup.settings.scheme.kernel == KernelChoice::WendlandC2;
        if L::IS_SPECIALIZED && is_usual && W::has_clear(self.setup) {
            self.with::<L, WendlandC2<L>>(machine, Chosen::Clear);
            if self.setup.from.occlusion.is_some() {
                self.with::<L, AnyKernel<L>>(machine, Chosen::Occluded);
            }
        } else {
            self.with::<L, AnyKernel<L>>(machine, Chosen::All);
        }
    }
}
