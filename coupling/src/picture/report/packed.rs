//! Numbers packed for a page: quantized, as differences to the frame before, deflated, in base64.
//!
//! ```text
//! q = round((x − lo)/(hi − lo) · (2ᵇ − 2))        2ᵇ − 1: absent
//! d = q(frame, i) − q(frame − 1, i)               the first frame against its own neighbor i − 1
//! z = (d << 1) ^ (d >> 15)                        small for small differences of either sign
//! ```
//! A frame is one component after the other, each with its low bytes first and then its high bytes; then come the speeds in 8 bits, as
//! differences, too.

use std::io::Write;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::ZlibEncoder;

/// Levels of a speed.
const SPEED_LEVELS: f32 = 255.0;

/// Interval of a quantity, and its number of bits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Range {
    pub lo: f32,
    pub hi: f32,
    /// At most 16.
    pub bits: u32,
}

impl Range {
    /// Code of what is absent.
    pub fn absent(self) -> u16 {
        ((1_u32 << self.bits) - 1) as u16
    }

    /// Width of a quantum.
    pub fn quantum(self) -> f64 {
        f64::from(self.hi - self.lo) / f64::from(self.absent() - 1)
    }

    /// Code of a value, the nearest one inside of the range; that of what is absent for NaN.
    pub fn code(self, value: f32) -> u16 {
        if value.is_nan() {
            return self.absent();
        }
        let width = (self.hi - self.lo).max(f32::MIN_POSITIVE);
        let share = ((value - self.lo) / width).clamp(0.0, 1.0);
        (share * f32::from(self.absent() - 1)).round() as u16
    }
}

/// Frames of items with a number of components each, and with speeds or without.
#[derive(Clone, Debug, Default)]
pub(super) struct Frames {
    /// Items in a frame.
    pub n_items: usize,
    /// Codes of each frame, component after component.
    pub codes: Vec<Vec<u16>>,
    /// Speeds of each frame, in 255ths of the largest; empty without.
    pub speeds: Vec<Vec<u8>>,
}

/// Code of a speed.
pub(super) fn speed_code(speed: f32, largest: f32) -> u8 {
    let share = speed / largest.max(f32::MIN_POSITIVE);
    (share.clamp(0.0, 1.0) * SPEED_LEVELS).round() as u8
}

fn zigzag(difference: u16) -> u16 {
    let signed = difference.cast_signed();
    ((signed << 1) ^ (signed >> 15)).cast_unsigned()
}

impl Frames {
    /// The frames at some steps apart, deflated.
    pub fn packed(&self, stride: usize) -> Vec<u8> {
        let mut raw = Vec::new();
        let mut before: Option<usize> = None;
        for now in (0..self.codes.len()).step_by(stride) {
            let codes = &self.codes[now];
            for start in (0..codes.len()).step_by(self.n_items.max(1)) {
                let own = &codes[start..start + self.n_items];
                let difference = |i: usize| {
                    let reference = match before {
                        Some(frame) => self.codes[frame][start + i],
                        None if 0 < i => own[i - 1],
                        None => 0,
                    };
                    zigzag(own[i].wrapping_sub(reference))
                };
                let all: Vec<u16> = (0..self.n_items).map(difference).collect();
                raw.extend(all.iter().map(|z| (z & 0xff) as u8));
                raw.extend(all.iter().map(|z| (z >> 8) as u8));
            }
            if let Some(speeds) = self.speeds.get(now) {
                let reference = |i: usize| match before {
                    Some(frame) => self.speeds[frame][i],
                    None if 0 < i => speeds[i - 1],
                    None => 0,
                };
                raw.extend((0..speeds.len()).map(|i| speeds[i].wrapping_sub(reference(i))));
            }
            before = Some(now);
        }
        deflated(&raw)
    }
}

/// A zlib stream.
pub(super) fn deflated(raw: &[u8]) -> Vec<u8> {
    let mut encoder = ZlibEncoder::new(Vec::new(), Compression::new(7));
    // writing to memory does not fail
    let written = encoder.write_all(raw).and_then(|()| encoder.finish());
    written.unwrap_or_default()
}

/// As text that a page can hold.
pub(super) fn in_base64(bytes: &[u8]) -> String {
    STANDARD.encode(bytes)
}

#[cfg(test)]
mod tests {
    use std::io::Read;

    use flate2::read::ZlibDecoder;

    use super::*;

    /// As the page does it.
    fn unpacked(bytes: &[u8], n: usize, components: usize, has_speeds: bool) -> Vec<Vec<u16>> {
        let mut raw = Vec::new();
        ZlibDecoder::new(bytes).read_to_end(&mut raw).unwrap_or(0);
        let size = n * components * 2 + if has_speeds { n } else { 0 };
        let mut frames: Vec<Vec<u16>> = Vec::new();
        for frame in raw.chunks(size) {
            let mut codes = vec![0_u16; n * components];
            for c in 0..components {
                for i in 0..n {
                    let z = u16::from(frame[2 * c * n + i])
                        | u16::from(frame[(2 * c + 1) * n + i]) << 8;
                    let difference = (z >> 1) ^ 0_u16.wrapping_sub(z & 1);
                    let reference = match frames.last() {
                        Some(before) => before[c * n + i],
                        None if 0 < i => codes[c * n + i - 1],
                        None => 0,
                    };
                    codes[c * n + i] = reference.wrapping_add(difference);
                }
            }
            frames.push(codes);
        }
        frames
    }

    #[test]
    fn what_is_packed_is_what_comes_out() {
        let (n, components) = (37, 2);
        let code = |frame: usize, i: usize| (i * 1973 + frame * 40_503) as u16;
        let codes: Vec<Vec<u16>> = (0..5)
            .map(|frame| (0..n * components).map(|i| code(frame, i)).collect())
            .collect();
        let speeds = (0..5).map(|k| vec![k as u8 * 50; n]).collect();
        let frames = Frames {
            n_items: n,
            codes: codes.clone(),
            speeds,
        };
        assert_eq!(unpacked(&frames.packed(1), n, components, true), codes);
        let thinned: Vec<_> = codes.iter().step_by(2).cloned().collect();
        assert_eq!(unpacked(&frames.packed(2), n, components, true), thinned);
    }

    #[test]
    fn a_value_is_within_half_a_quantum_and_what_is_not_a_number_is_absent() {
        let range = Range {
            lo: -3.0,
            hi: 7.0,
            bits: 12,
        };
        for k in 0..1000_i16 {
            let value = -3.0 + 0.01 * f32::from(k);
            let back = f64::from(range.lo) + f64::from(range.code(value)) * range.quantum();
            // half a quantum, and round-off
            assert!(
                (back - f64::from(value)).abs() <= 0.501 * range.quantum(),
                "{value}"
            );
        }
        assert_eq!(range.code(f32::NAN), range.absent());
        assert_eq!(range.code(1e9), range.absent() - 1);
    }
}
