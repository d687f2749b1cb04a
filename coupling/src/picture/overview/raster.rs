//! Particles as a raster image.

use crate::picture::color;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// Number of shades of speed: few enough for compression, enough to avoid bands.
pub(super) const N_SHADES: usize = 64;
/// Palette indices: 0 is transparent, then the shades, then the color of a NaN speed.
pub(super) const CLEAR: u8 = 0;
const NOT_A_NUMBER: u8 = N_SHADES as u8 + 1;
/// Particle number of a pixel without any.
const NOTHING: u32 = u32::MAX;
/// Below this size in pixels a particle is drawn as a rectangle, so that no background shows between neighbors.
/// Smaller discs make patterns with the pixels that look like flow.
const SMALLEST_DISC: f64 = 12.0;
/// Size of a particle in the picture over its spacing.
const OVERLAP: f64 = 1.1;

/// Extent of an image in the x-z plane or in plan view, and its size in pixels.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    pub min: [f64; 2],
    pub max: [f64; 2],
    pub width: usize,
    pub height: usize,
}

/// Particles to draw.
#[derive(Clone, Copy, Debug)]
pub(super) struct Water<'a> {
    pub positions: &'a [[f32; 3]],
    pub speeds: &'a [f32],
    pub spacing: f64,
    /// Speed of the last shade; m/s.
    pub top_speed: f64,
}

/// Palette indices, row by row from the top.
pub(super) fn pixels(water: Water<'_>, window: Window) -> Vec<u8> {
    let order = far_to_near(water.positions);
    let nearest = nearest(water.positions, &order, water.spacing, window);
    let shade = |a: u32| match water.speeds.get(a as usize) {
        _ if a == NOTHING => CLEAR,
        None => NOT_A_NUMBER,
        Some(&speed) => shade(speed, water.top_speed),
    };
    nearest.into_iter().map(shade).collect()
}

/// Whether each particle shows in one of these windows.
pub(super) fn is_seen(
    positions: &[[f32; 3]],
    spacing: f64,
    windows: impl Iterator<Item = Window>,
) -> Vec<bool> {
    let order = far_to_near(positions);
    let mut is_seen = vec![false; positions.len()];
    for window in windows {
        for a in nearest(positions, &order, spacing, window) {
            if a != NOTHING {
                is_seen[a as usize] = true;
            }
        }
    }
    is_seen
}

/// Number of the particle nearest to the viewer in each pixel, row by row from the top; [`NOTHING`] where there is none.
fn nearest(positions: &[[f32; 3]], order: &[u32], spacing: f64, window: Window) -> Vec<u32> {
    let Window {
        min,
        max,
        width,
        height,
    } = window;
    let scale = [
        width as f64 / (max[0] - min[0]),
        height as f64 / (max[1] - min[1]),
    ];
    // Half a pixel at least, so that a particle is always visible, and a small overlap, without which there are lens-shaped
    // holes between discs and lines between rounded rows.
    let radius = scale.map(|scale| (OVERLAP * 0.5 * spacing * scale).max(0.5));
    let is_disc = 2.0 * radius[0].min(radius[1]) >= SMALLEST_DISC;

    let mut nearest = vec![NOTHING; width * height];
    for &a in order {
        let [x, _, z] = positions[a as usize].map(f64::from);
        let center = [(x - min[0]) * scale[0], (max[1] - z) * scale[1]];
        let columns = covered(center[0], radius[0], width);
        for row in covered(center[1], radius[1], height) {
            let dz = (row as f64 + 0.5 - center[1]) / radius[1];
            for column in columns.clone() {
                let dx = (column as f64 + 0.5 - center[0]) / radius[0];
                if !is_disc || dx * dx + dz * dz <= 1.0 {
                    nearest[row * width + column] = a;
                }
            }
        }
    }
    nearest
}

/// Particle numbers, those far from the viewer (large y) first; in the given order where equally far.
fn far_to_near(positions: &[[f32; 3]]) -> Vec<u32> {
    let mut order: Vec<u32> = (0..positions.len() as u32).collect();
    order.sort_by(|&a, &b| {
        let y = |a: u32| positions[a as usize][1];
        y(b).total_cmp(&y(a))
    });
    order
}

/// Pixels with centers within `radius` of `center`; empty if the center is NaN.
fn covered(center: f64, radius: f64, n: usize) -> std::ops::Range<usize> {
    let first = (center - radius - 0.5).ceil().clamp(0.0, n as f64);
    let end = (center + radius - 0.5).floor() + 1.0;
    // A cast takes NaN to 0, so that the range is empty.
    first as usize..end.clamp(0.0, n as f64) as usize
}

fn shade(speed: f32, top_speed: f64) -> u8 {
    if speed.is_nan() {
        return NOT_A_NUMBER;
    }
    let last = (N_SHADES - 1) as f64;
    1 + (last * f64::from(speed) / top_speed)
        .round()
        .clamp(0.0, last) as u8
}

/// The image as a PNG in a `data:` address; empty if the encoder fails, which is not expected.
pub(super) fn data_address(pixels: &[u8], window: Window) -> Option<String> {
    let mut palette = vec![[0xff; 3]];
    palette.extend(color::map(N_SHADES));
    palette.push(color::NOT_A_NUMBER);
    let mut opacity = vec![0xff; palette.len()];
    opacity[usize::from(CLEAR)] = 0;
    png_address(pixels, window, palette, opacity)
}

/// Indices of a palette with opacities as a PNG in a `data:` address.
pub(super) fn png_address(
    pixels: &[u8],
    window: Window,
    palette: Vec<[u8; 3]>,
    opacity: Vec<u8>,
) -> Option<String> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(
        &mut file,
        u32::try_from(window.width).ok()?,
        u32::try_from(window.height).ok()?,
    );
    encoder.set_color(png::ColorType::Indexed);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_palette(palette.into_flattened());
    encoder.set_trns(opacity);
    encoder.set_compression(png::Compression::High);
    // Differences of palette indices are meaningless.
    encoder.set_filter(png::Filter::NoFilter);
    let mut writer = encoder.write_header().ok()?;
    writer.write_image_data(pixels).ok()?;
    writer.finish().ok()?;
    Some(format!("data:image/png;base64,{}", STANDARD.encode(file)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const WINDOW: Window = Window {
        min: [0.0, 0.0],
        max: [4.0, 2.0],
        width: 8,
        height: 4,
    };

    fn drawn(positions: &[[f32; 3]], speeds: &[f32]) -> Vec<u8> {
        let water = Water {
            positions,
            speeds,
            spacing: 1.0,
            top_speed: 2.0,
        };
        pixels(water, WINDOW)
    }

    #[test]
    fn a_particle_covers_its_spacing() {
        // Spacing 1 m is 2 pixels; the particle in the lower left corner fills the lower left 2 x 2 pixels.
        let found = drawn(&[[0.5, 0.0, 0.5]], &[2.0]);
        let lit: Vec<usize> = (0..32).filter(|&i| found[i] != CLEAR).collect();
        assert_eq!(lit, [16, 17, 24, 25]);
        assert_eq!(found[16], N_SHADES as u8);
    }

    #[test]
    fn a_full_lattice_leaves_no_speck() {
        // At the sizes that are drawn as rectangles; discs show that they are discs.
        // 0.02 m is no round number in single precision: rows fall between pixels now and then.
        let spacing = 0.02;
        let positions: Vec<[f32; 3]> = (0..200 * 100)
            .map(|i| {
                [
                    ((i % 200) as f32 + 0.5) * spacing,
                    0.0,
                    ((i / 200) as f32 + 0.5) * spacing,
                ]
            })
            .collect();
        for width in [400, 500, 700, 1000, 2000] {
            let water = Water {
                positions: &positions,
                speeds: &[0.0; 200 * 100],
                spacing: f64::from(spacing),
                top_speed: 2.0,
            };
            let window = Window {
                width,
                height: width / 2,
                ..WINDOW
            };
            assert!(
                pixels(water, window).iter().all(|&pixel| pixel == 1),
                "width {width}"
            );
        }
    }

    #[test]
    fn near_particles_hide_far_ones_and_bad_numbers_show() {
        let found = drawn(&[[0.5, 0.0, 0.5], [0.5, 3.0, 0.5]], &[0.0, 2.0]);
        assert_eq!(found[16], 1);
        assert_eq!(drawn(&[[0.5, 0.0, 0.5]], &[f32::NAN])[16], NOT_A_NUMBER);
        let nowhere = [
            [f32::NAN, 0.0, 0.5],
            [f32::INFINITY, 0.0, 0.0],
            [-1e30, 0.0, 1e30],
        ];
        assert!(
            drawn(&nowhere, &[1.0; 3])
                .iter()
                .all(|&pixel| pixel == CLEAR)
        );
    }

    #[test]
    fn particles_that_are_not_seen_change_no_pixel() {
        // 20 layers behind each other, each a little off the one before it, so that some show between those in front
        let positions: Vec<[f32; 3]> = (0..20 * 32)
            .map(|i| {
                let (layer, k) = (i / 32, i % 32);
                let off = (layer * 7 % 11) as f32 / 20.0;
                let [x, z] = [(k % 8) as f32 / 2.0, (k / 8) as f32 / 2.0];
                [x + off, layer as f32, z + off * off]
            })
            .collect();
        let speeds: Vec<f32> = (0..positions.len()).map(|i| i as f32 / 320.0).collect();
        let windows = [8, 25, 90].map(|width| Window {
            width,
            height: width / 2,
            ..WINDOW
        });
        let is_seen = is_seen(&positions, 0.5, windows.into_iter());
        let n_seen = is_seen.iter().filter(|&&is_seen| is_seen).count();
        assert!(
            n_seen < positions.len() / 2,
            "{n_seen} of {}",
            positions.len()
        );
        let mut shown = is_seen.iter();
        let mut kept: Vec<_> = positions.iter().copied().zip(speeds.clone()).collect();
        kept.retain(|_| shown.next() == Some(&true));
        let (near, their_speeds): (Vec<_>, Vec<_>) = kept.into_iter().unzip();
        for window in windows {
            let of = |positions: &[[f32; 3]], speeds: &[f32]| {
                let water = Water {
                    positions,
                    speeds,
                    spacing: 0.5,
                    top_speed: 2.0,
                };
                pixels(water, window)
            };
            assert_eq!(of(&near, &their_speeds), of(&positions, &speeds));
        }
    }
}
