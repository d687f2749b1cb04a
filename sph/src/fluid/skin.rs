//! Skin of the lists of neighbors: with a wide one they are made seldom and are long, with a narrow one often and short.
//!
//! Sorts are due only at certain times of a step. Lists whose skin holds for `n` of the intervals between these serve `n + 1`, and
//! each sum adds all of their entries:
//!
//! ```text
//! cost of a sum = (1 + s/H)ᵈ (1 + λ/(σ (n + 1))),   s = q n        over that without a skin
//! ```
//! `q` bounds the approach of a pair, or of a particle and a wall, in an interval, `σ` is the number of sums in it, both since the sort before; `λ` is the cost of
//! a sort and of making lists. The skin is the one of the least cost: a result of the state alone, never of a clock.

use serde::{Deserialize, Serialize};

/// Cost of a sort and of making lists, over that of a sum over them.
const LISTING: f64 = 3.0;
/// Widest skin to begin with; × support.
const FIRST: f64 = 0.1;
/// Narrowest skin; × support.
const LEAST: f64 = 0.02;
/// Widening of a skin for flow that becomes faster.
const ROOM: f64 = 1.05;

/// The skin at present, and what was counted since the last sort.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub(crate) struct Skin {
    /// m.
    now: f64,
    /// Bound on an approach between two times at which a sort may be due; m.
    way: f64,
    /// Such times, and sums.
    looks: u32,
    sums: u32,
}

impl Skin {
    /// Skin of a fluid at the start, for a support and at most this wide; m.
    pub(super) fn new(support: f64, widest: f64) -> Self {
        Self {
            now: widest.min(FIRST * support),
            way: 0.0,
            looks: 0,
            sums: 0,
        }
    }

    /// m.
    pub(super) fn now(&self) -> f64 {
        self.now
    }

    /// Whether it is one of a fluid with this support and widest skin; m.
    pub(super) fn is_of(&self, support: f64, widest: f64) -> bool {
        (LEAST * support..=widest).contains(&self.now) && self.way.is_finite()
    }

    /// Counts a time at which a sort may be due.
    pub(super) fn look(&mut self) {
        self.looks = self.looks.saturating_add(1);
    }

    /// Counts a sum over lists.
    pub(super) fn count_sum(&mut self) {
        self.sums = self.sums.saturating_add(1);
    }

    /// Chooses the skin for the next sort, before which `used` (m) at most was used up, unbounded where it does not tell.
    pub(super) fn choose(&mut self, used: f64, (support, widest): (f64, f64), dimensions: i32) {
        let (looks, sums) = (self.looks, self.sums);
        (self.looks, self.sums) = (0, 0);
        let mut longest = f64::INFINITY;
        if used.is_finite() {
            self.way = used / f64::from(looks.max(1));
        } else {
            // something else makes lists void: they need not hold for longer than the last ones did
            longest = f64::from(looks);
        }
        let step = ROOM * self.way;
        if sums == 0 || step == 0.0 {
            return;
        }
        let listing = LISTING * f64::from(looks) / f64::from(sums);
        let cost = |skin: f64, n: f64| {
            (1.0 + skin / support).powi(dimensions) * (1.0 + listing / (n.min(longest) + 1.0))
        };
        // where n is not whole: d s² + (d − 1) κ s = κ
        let ratio = listing * step / support;
        let d = f64::from(dimensions);
        let half = 0.5 * (d - 1.0) * ratio;
        let best = ((half * half + d * ratio).sqrt() - half) / d * support;
        let around = (best / step).floor();
        let least = LEAST * support;
        let narrowest = (least, (least / step).floor());
        let others = [-1.0, 0.0, 1.0].map(|more| ((around + more) * step, around + more));
        let allowed = others
            .into_iter()
            .filter(|&(skin, _)| least <= skin && skin <= widest);
        let by_cost = |a: &(f64, f64), b: &(f64, f64)| cost(a.0, a.1).total_cmp(&cost(b.0, b.1));
        let capped = (widest, (widest / step).floor());
        let chosen = allowed
            .chain([narrowest, capped])
            .min_by(by_cost)
            .unwrap_or(narrowest);
        self.now = chosen.0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SUPPORT: f64 = 1.0;
    const WIDEST: f64 = 0.15;

    /// The skin of steady flow in which particles move by `way` (m), and two approach by twice that, between two looks, with five sums to two looks.
    fn steady(way: f64) -> f64 {
        let mut skin = Skin::new(SUPPORT, WIDEST);
        for _ in 0..20 {
            let mut used = 0.0;
            while used <= skin.now() {
                skin.count_sum();
                skin.count_sum();
                if skin.looks.is_multiple_of(2) {
                    skin.count_sum();
                }
                used += 2.0 * way;
                skin.look();
            }
            skin.choose(used, (SUPPORT, WIDEST), 3);
        }
        skin.now()
    }

    #[test]
    fn slow_flow_has_a_narrow_skin_and_fast_flow_a_wide_one() {
        let ways = [1e-7, 1e-4, 1e-3, 1e-2, 0.03];
        let skins = ways.map(steady);
        assert!(skins.is_sorted(), "{skins:?}");
        assert_eq!(skins[0], LEAST * SUPPORT);
        // as wide as whole intervals need, where it is neither the narrowest nor the widest
        for (way, skin) in ways.into_iter().zip(skins).skip(3) {
            let intervals = skin / (2.0 * way * ROOM);
            assert!(
                (intervals - intervals.round()).abs() < 1e-9,
                "{way}: {skin}"
            );
        }
    }

    #[test]
    fn water_too_fast_for_any_skin_has_the_narrowest() {
        assert_eq!(steady(0.2), LEAST * SUPPORT);
    }

    #[test]
    fn lists_that_something_else_makes_void_are_short() {
        let mut skin = Skin::new(SUPPORT, WIDEST);
        skin.count_sum();
        skin.look();
        skin.choose(1e-2, (SUPPORT, WIDEST), 3);
        let wide = skin.now();
        skin.count_sum();
        skin.look();
        skin.choose(f64::INFINITY, (SUPPORT, WIDEST), 3);
        assert!(skin.now() < wide, "{} {wide}", skin.now());
    }
}
