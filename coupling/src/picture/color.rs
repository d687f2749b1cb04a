//! Color maps: those with usual names, speed from deep blue at rest to amber, and the quantities of plan views.
//!
//! The project's own maps are perceptually uniform: they have a constant rate in OKLab, a color space with perceptual distances (Ottosson
//! 2020), and monotonic lightness, which suits gray printing and the common forms of color blindness.

mod tables;

use std::str::FromStr;

/// A map from small to large values by its usual name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColorMap {
    /// The project's own for each quantity: speed from deep blue to amber.
    #[default]
    Riprap,
    /// Dark violet over teal to yellow; evenly spaced in lightness.
    Viridis,
    /// Dark blue over gray to yellow; alike for all readers, with and without color blindness.
    Cividis,
    /// The colors of the rainbow with smooth lightness; details stand out, but not in gray.
    Turbo,
}

impl ColorMap {
    /// All of them, with their names.
    pub const ALL: [(Self, &'static str); 4] = [
        (Self::Riprap, "riprap"),
        (Self::Viridis, "viridis"),
        (Self::Cividis, "cividis"),
        (Self::Turbo, "turbo"),
    ];

    /// `n` colors, slow to fast.
    pub fn speeds(self, n: usize) -> Vec<[u8; 3]> {
        self.published(n).unwrap_or_else(|| map(n))
    }

    /// `n` colors of the published map, between its entries linear in sRGB; `None` for the project's own.
    pub(in crate::picture) fn published(self, n: usize) -> Option<Vec<[u8; 3]>> {
        let table = match self {
            Self::Riprap => return None,
            Self::Viridis => tables::VIRIDIS,
            Self::Cividis => tables::CIVIDIS,
            Self::Turbo => tables::TURBO,
        };
        let entries = tables::entries(table);
        let last = entries.len().saturating_sub(1);
        let at = |i: usize| {
            let place = last as f64 * i as f64 / (n.max(2) - 1) as f64;
            let below = (place as usize).min(last.saturating_sub(1));
            over(entries[below + 1], place - below as f64, entries[below])
        };
        Some((0..n).map(at).collect())
    }
}

impl FromStr for ColorMap {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|(_, name)| *name == text);
        found.map(|(map, _)| map).ok_or_else(|| {
            let names = Self::ALL.map(|(_, name)| name);
            format!(
                "`{text}` is not a color map; known are {}",
                names.join(", ")
            )
        })
    }
}

/// Vertices of the path through the color space, as sRGB.
const STOPS: [[u8; 3]; 4] = [
    [0x1d, 0x35, 0x6e],
    [0x1f, 0x7f, 0x9c],
    [0x6d, 0xbd, 0x8f],
    [0xf7, 0xc5, 0x3b],
];
/// Bed of the water, without elevation tint: the water above has its own colors.
pub(in crate::picture) const BED: [u8; 3] = [0xc4, 0xcd, 0xd2];
/// Water at its rest level: almost white.
const AT_REST: [u8; 3] = [0xee, 0xf2, 0xf3];
/// From water at rest down to the deepest trough.
const TROUGH: [[u8; 3]; 4] = [
    AT_REST,
    [0x9c, 0xc4, 0xdf],
    [0x3f, 0x86, 0xbd],
    [0x17, 0x3f, 0x7c],
];
/// From water at rest up to the highest crest.
const CREST: [[u8; 3]; 4] = [
    AT_REST,
    [0xf2, 0xbf, 0x98],
    [0xd8, 0x66, 0x4b],
    [0x86, 0x18, 0x2c],
];
/// Highest water: pale for a small rise.
const HIGHEST: [[u8; 3]; 5] = [
    [0xf3, 0xf1, 0xd2],
    [0x9b, 0xcf, 0xb4],
    [0x38, 0x97, 0xae],
    [0x25, 0x4e, 0x8c],
    [0x2c, 0x1a, 0x55],
];
/// Arrival: dark where water arrived first.
const ARRIVAL: [[u8; 3]; 4] = [
    [0x4a, 0x16, 0x4e],
    [0xb0, 0x38, 0x5f],
    [0xee, 0x91, 0x66],
    [0xfb, 0xea, 0xc6],
];
/// Dry land from the shore up, muted, so that objects on it stand out.
const LAND: [[u8; 3]; 5] = [
    [0xd3, 0xdd, 0xc4],
    [0xe6, 0xe3, 0xc6],
    [0xe2, 0xd2, 0xb0],
    [0xcd, 0xb7, 0x9c],
    [0xee, 0xea, 0xe4],
];

/// Particles with a NaN speed, highlighted.
pub(in crate::picture) const NOT_A_NUMBER: [u8; 3] = [0xff, 0x00, 0xff];

/// `n` colors, slow to fast.
pub(in crate::picture) fn map(n: usize) -> Vec<[u8; 3]> {
    along(&STOPS, n)
}

/// `2 n + 1` colors, deep trough to high crest; the one in the middle is water at rest.
pub(in crate::picture) fn elevation(n: usize) -> Vec<[u8; 3]> {
    let troughs = along(&TROUGH, n + 1).into_iter().rev();
    troughs
        .chain(along(&CREST, n + 1).into_iter().skip(1))
        .collect()
}

/// `n` colors, low to high.
pub(in crate::picture) fn highest(n: usize) -> Vec<[u8; 3]> {
    along(&HIGHEST, n)
}

/// `n` colors, early to late.
pub(in crate::picture) fn arrival(n: usize) -> Vec<[u8; 3]> {
    along(&ARRIVAL, n)
}

/// `n` colors, from the shore up.
pub(in crate::picture) fn land(n: usize) -> Vec<[u8; 3]> {
    along(&LAND, n)
}

/// A color (opacity 0 to 1) composited over another.
pub(in crate::picture) fn over(top: [u8; 3], opacity: f64, below: [u8; 3]) -> [u8; 3] {
    std::array::from_fn(|k| {
        let (top, below) = (f64::from(top[k]), f64::from(below[k]));
        (below + opacity * (top - below)).round().clamp(0.0, 255.0) as u8
    })
}

/// `n` colors at a constant perceptual rate.
fn along(stops: &[[u8; 3]], n: usize) -> Vec<[u8; 3]> {
    let stops: Vec<[f64; 3]> = stops.iter().copied().map(oklab).collect();
    let lengths: Vec<f64> = stops
        .windows(2)
        .map(|pair| distance(pair[0], pair[1]))
        .collect();
    let total: f64 = lengths.iter().sum();
    (0..n)
        .map(|i| {
            let mut way = total * i as f64 / (n.max(2) - 1) as f64;
            let mut leg = 0;
            while leg + 1 < lengths.len() && way > lengths[leg] {
                way -= lengths[leg];
                leg += 1;
            }
            let part = (way / lengths[leg]).min(1.0);
            let (a, b) = (stops[leg], stops[leg + 1]);
            srgb(std::array::from_fn(|k| a[k] + part * (b[k] - a[k])))
        })
        .collect()
}

/// `#rrggbb`.
pub(in crate::picture) fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter()
        .zip(b)
        .map(|(a, b)| (a - b).powi(2))
        .sum::<f64>()
        .sqrt()
}

/// Source of both matrices and their inverses: Ottosson (2020), "A perceptual color space for image processing".
fn oklab(color: [u8; 3]) -> [f64; 3] {
    let [r, g, b] = color.map(|value| {
        let value = f64::from(value) / 255.0;
        if value <= 0.04045 {
            value / 12.92
        } else {
            ((value + 0.055) / 1.055).powf(2.4)
        }
    });
    let l = (0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b).cbrt();
    let m = (0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b).cbrt();
    let s = (0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b).cbrt();
    [
        0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
        1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
        0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s,
    ]
}

fn srgb([lightness, a, b]: [f64; 3]) -> [u8; 3] {
    let l = (lightness + 0.3963377774 * a + 0.2158037573 * b).powi(3);
    let m = (lightness - 0.1055613458 * a - 0.0638541728 * b).powi(3);
    let s = (lightness - 0.0894841775 * a - 1.2914855480 * b).powi(3);
    let linear = [
        4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
        -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
        -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s,
    ];
    linear.map(|value| {
        let value = if value <= 0.0031308 {
            12.92 * value
        } else {
            1.055 * value.powf(1.0 / 2.4) - 0.055
        };
        (255.0 * value).round().clamp(0.0, 255.0) as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn published_maps_have_their_published_colors() {
        // first, middle and last entries of matplotlib 3
        for (map, first, last) in [
            (ColorMap::Viridis, "#440154", "#fde725"),
            (ColorMap::Cividis, "#00224e", "#fee838"),
            (ColorMap::Turbo, "#30123b", "#7a0403"),
        ] {
            let colors = map.published(256).unwrap_or_default();
            assert_eq!(colors.len(), 256);
            assert_eq!(
                (hex(colors[0]), hex(colors[255])),
                (first.to_owned(), last.to_owned())
            );
            let few = map.speeds(9);
            assert_eq!((few[0], few[8]), (colors[0], colors[255]));
        }
        for name in ["viridis", "cividis"] {
            let map: ColorMap = name.parse().unwrap_or_default();
            let lightness: Vec<f64> = map.speeds(33).into_iter().map(|c| oklab(c)[0]).collect();
            assert!(lightness.windows(2).all(|pair| pair[0] < pair[1]), "{name}");
        }
        assert_eq!(ColorMap::Riprap.speeds(5), map(5));
        let message = "jet".parse::<ColorMap>().err().unwrap_or_default();
        assert_eq!(
            message,
            "`jet` is not a color map; known are riprap, viridis, cividis, turbo"
        );
    }

    #[test]
    fn steps_look_equal_and_lightness_rises() {
        let colors: Vec<_> = map(33).into_iter().map(oklab).collect();
        let steps: Vec<f64> = colors
            .windows(2)
            .map(|pair| distance(pair[0], pair[1]))
            .collect();
        let mean = steps.iter().sum::<f64>() / steps.len() as f64;
        for (i, step) in steps.iter().enumerate() {
            // Rounding to 8 bits moves a color by up to 0.003 of the mean 0.02; vertices shorten the path.
            assert!(
                (step / mean - 1.0).abs() < 0.3,
                "step {i}: {step} of mean {mean}"
            );
            assert!(colors[i][0] < colors[i + 1][0], "lightness falls at {i}");
        }
    }

    #[test]
    fn lightness_tells_the_sequence() {
        let lightness = |colors: Vec<[u8; 3]>| -> Vec<f64> {
            colors.into_iter().map(|color| oklab(color)[0]).collect()
        };
        let falls = |of: &[f64]| of.windows(2).all(|pair| pair[1] < pair[0]);
        assert!(falls(&lightness(highest(33))));
        assert!(falls(&lightness(arrival(33).into_iter().rev().collect())));
        let both = lightness(elevation(16));
        assert_eq!((both.len(), elevation(16)[16]), (33, AT_REST));
        assert!(falls(&both[16..]));
        assert!(falls(
            &both[..=16].iter().rev().copied().collect::<Vec<_>>()
        ));
    }

    #[test]
    fn what_is_half_seen_through_is_half_way() {
        assert_eq!(over([200, 100, 0], 0.5, [100, 200, 0]), [150, 150, 0]);
        assert_eq!(over([1, 2, 3], 1.0, [9, 9, 9]), [1, 2, 3]);
    }

    #[test]
    fn the_ends_are_the_first_and_last_stop() {
        let colors = map(64);
        assert_eq!((colors[0], colors[63]), (STOPS[0], STOPS[3]));
        assert_eq!(hex(colors[0]), "#1d356e");
    }
}
