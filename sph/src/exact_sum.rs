//! Sums whose bits depend neither on the order of their terms nor on how these are parted: over threads, over cells, over processes.
//!
//! An accumulator holds the sum as an integer in units of the smallest number, `Σ_i c_i 2^(32 i − 1074)`, in overlapping 64-bit digits, so
//! that adding is exact and merging is adding digit by digit. It is rounded once, when it is asked for its value.
//!
//! Source: Neal (2015), Fast exact summation using small and large superaccumulators, arXiv:1505.05571.

use rayon::prelude::*;

use crate::Vec3;

/// Digits: those of the largest number, of its upper part, and two for carries.
const DIGITS: usize = 67;
/// Bits between digits.
const WIDTH: u32 = 32;
/// Terms between carries: each adds at most 2⁵² to a digit of 63 bits.
const CARRY_AFTER: u32 = 1 << 10;
/// Terms that one thread takes at a time.
const TERMS_AT_A_TIME: usize = 4096;

/// Quantities over all particles that parts of the fluid find on their own.
pub trait Reduce {
    /// Takes up what another part found. In any order the result has the same bits.
    fn merge(&mut self, other: &Self);
}

/// Exact sum of finite numbers. Infinite terms and NaN make the value what adding them would.
#[derive(Clone, Debug)]
pub struct ExactSum {
    digits: [i64; DIGITS],
    /// Additions to the digits since the last carry.
    pending: u32,
    /// Sum of the terms that are not finite.
    not_finite: f64,
}

impl Default for ExactSum {
    fn default() -> Self {
        Self {
            digits: [0; DIGITS],
            pending: 0,
            not_finite: 0.0,
        }
    }
}

impl ExactSum {
    /// Of the terms at `0..n`.
    pub fn over(n: usize, term: impl Fn(usize) -> f64 + Sync) -> Self {
        // added where it stands: a fold would move it, half a kilobyte, for each term
        let of_part = |part: usize| {
            let mut sum = Self::default();
            for k in part * TERMS_AT_A_TIME..n.min((part + 1) * TERMS_AT_A_TIME) {
                sum.add(term(k));
            }
            sum
        };
        (0..n.div_ceil(TERMS_AT_A_TIME))
            .into_par_iter()
            .map(of_part)
            .reduce(Self::default, |mut sum, other| {
                sum.merge(&other);
                sum
            })
    }

    /// Adds a term.
    #[inline]
    pub fn add(&mut self, term: f64) {
        if !term.is_finite() {
            self.not_finite += term;
            return;
        }
        if self.pending == CARRY_AFTER {
            self.carry();
        }
        self.pending += 1;
        let bits = term.to_bits();
        let exponent = (bits >> 52 & 0x7ff) as u32;
        let fraction = bits & ((1 << 52) - 1);
        // subnormal numbers have the unit of the smallest normal ones, and no leading bit
        let (mantissa, exponent) = match exponent {
            0 => (fraction, 0),
            _ => (fraction | 1 << 52, exponent - 1),
        };
        let (digit, shift) = ((exponent / WIDTH) as usize, exponent % WIDTH);
        let shifted = u128::from(mantissa) << shift;
        let low = (shifted & 0xffff_ffff) as i64;
        let high = (shifted >> WIDTH) as i64;
        let sign = if term.is_sign_negative() { -1 } else { 1 };
        self.digits[digit] += sign * low;
        self.digits[digit + 1] += sign * high;
    }

    /// The sum, rounded to the nearest number, ties to even.
    pub fn value(&self) -> f64 {
        if self.not_finite != 0.0 || self.not_finite.is_nan() {
            return self.not_finite;
        }
        let mut sum = self.clone();
        sum.carry();
        let is_negative = sum.digits[DIGITS - 1] < 0;
        if is_negative {
            sum.digits.iter_mut().for_each(|digit| *digit = -*digit);
            sum.carry();
        }
        let digits = &sum.digits;
        let Some(top) = digits.iter().rposition(|&digit| digit != 0) else {
            return 0.0;
        };
        // three digits have 65 bits at least; what is below decides ties only
        let lowest = top.saturating_sub(2);
        let above = digits[lowest..=top].iter().rev();
        let whole = above.fold(0_u128, |whole, &digit| whole << WIDTH | digit as u128);
        let is_more = digits[..lowest].iter().any(|&digit| digit != 0);
        let rounded = (whole | u128::from(is_more)) as f64;
        let exponent = WIDTH as i32 * lowest as i32 - 1074;
        // in two halves, each of which is a normal number
        let half = exponent / 2;
        let value = rounded * 2.0_f64.powi(half) * 2.0_f64.powi(exponent - half);
        if is_negative { -value } else { value }
    }

    /// Brings all digits but the last to 0..2³².
    fn carry(&mut self) {
        let mut carried = 0;
        for digit in &mut self.digits[..DIGITS - 1] {
            let whole = *digit + carried;
            carried = whole >> WIDTH;
            *digit = whole & 0xffff_ffff;
        }
        self.digits[DIGITS - 1] += carried;
        self.pending = 0;
    }
}

impl Reduce for ExactSum {
    fn merge(&mut self, other: &Self) {
        // digits that were not carried have at most 2⁶² of each: room for both after a carry of one
        self.carry();
        let mut other = other.clone();
        other.carry();
        for (digit, more) in self.digits.iter_mut().zip(&other.digits) {
            *digit += more;
        }
        self.pending = 1;
        self.not_finite += other.not_finite;
    }
}

impl<const N: usize> Reduce for [ExactSum; N] {
    fn merge(&mut self, other: &Self) {
        for (sum, other) in self.iter_mut().zip(other) {
            sum.merge(other);
        }
    }
}

/// Exact sums of the components of vectors at `0..n`.
pub fn vectors_over(n: usize, term: impl Fn(usize) -> Vec3 + Sync) -> [ExactSum; 3] {
    [0, 1, 2].map(|axis| ExactSum::over(n, |k| term(k)[axis]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn sum(terms: &[f64]) -> f64 {
        ExactSum::over(terms.len(), |k| terms[k]).value()
    }

    #[test]
    fn sums_are_rounded_once() {
        assert_eq!(sum(&[]), 0.0);
        assert_eq!(sum(&[1e300, 1.0, -1e300]), 1.0);
        assert_eq!(sum(&[0.1; 10]), 1.0);
        assert_eq!(sum(&[f64::MAX, f64::MAX, -f64::MAX]), f64::MAX);
        assert_eq!(sum(&[f64::MAX, f64::MAX]), f64::INFINITY);
        // subnormal numbers
        assert_eq!(sum(&[5e-324, 5e-324, -1e-323, 5e-324]), 5e-324);
        assert_eq!(
            sum(&[-f64::MIN_POSITIVE, f64::MIN_POSITIVE / 2.0]),
            -f64::MIN_POSITIVE / 2.0
        );
        // halfway between 1 and the next number goes to the even one, a little more does not
        let half = f64::EPSILON / 2.0;
        assert_eq!(sum(&[1.0, half]), 1.0);
        assert_eq!(sum(&[1.0, half, 1e-300]), 1.0 + f64::EPSILON);
        assert_eq!(sum(&[-1.0, -half, -1e-300]), -1.0 - f64::EPSILON);
        assert!(sum(&[f64::INFINITY, f64::NEG_INFINITY]).is_nan());
        assert_eq!(sum(&[f64::INFINITY, 1.0]), f64::INFINITY);
        assert!(sum(&[f64::NAN, 1.0]).is_nan());
    }

    /// More terms than a digit holds without carries.
    #[test]
    fn many_terms_of_one_sign_are_exact() {
        let n = 1 << 20;
        let largest = 1.0 - f64::EPSILON / 2.0;
        let sum = ExactSum::over(n, |_| largest).value();
        // n times a number is exact for a power of two
        assert_eq!(sum, n as f64 * largest);
    }

    proptest! {
        /// A single term is itself; two are what the machine adds.
        #[test]
        fn one_and_two_terms(a in proptest::num::f64::NORMAL, b in proptest::num::f64::NORMAL) {
            prop_assert_eq!(sum(&[a]), a);
            prop_assert_eq!(sum(&[a, b]), a + b);
        }

        /// Order and parts do not matter.
        #[test]
        fn any_order_and_any_parts(
            terms in proptest::collection::vec(-1e3..1e3_f64, 0..300),
            scales in proptest::collection::vec(-40..40_i32, 300),
            at in 0..300_usize,
        ) {
            let terms: Vec<f64> = terms.iter().zip(scales).map(|(t, s)| t * 2.0_f64.powi(s)).collect();
            let whole = sum(&terms);
            let reversed: Vec<f64> = terms.iter().rev().copied().collect();
            prop_assert_eq!(sum(&reversed).to_bits(), whole.to_bits());
            let (first, second) = terms.split_at(at.min(terms.len()));
            let part = |terms: &[f64]| ExactSum::over(terms.len(), |k| terms[k]);
            let mut merged = part(second);
            merged.merge(&part(first));
            prop_assert_eq!(merged.value().to_bits(), whole.to_bits());
            // and is near what adding in order gives
            let naive: f64 = terms.iter().sum();
            let size: f64 = terms.iter().map(|t| t.abs()).sum();
            prop_assert!((naive - whole).abs() <= 1e-13 * size);
        }
    }
}
