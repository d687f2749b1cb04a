//! Side views of the scene, with axes and a color bar.

use super::bar::{self, Bar};
use super::raster::{self, N_SHADES, Water, Window};
use super::{Outline, Snapshot};
use crate::picture::chart::axis::{self, Axis, Labels, Scale, nice_up, open_range};
use crate::picture::chart::page::{Anchor, Frame, INK, LABEL, LEFT, Page, RIGHT};
use crate::picture::color;

/// Scenes taller than this part of their width are shown side by side, others below each other.
const TALL: f64 = 0.6;
/// Panels below each other are not taller than this; px.
const MAX_HEIGHT: f64 = 300.0;
/// Panels side by side are not taller than this; px.
const MAX_HEIGHT_BESIDE: f64 = 420.0;
/// A long flat scene is exaggerated upward until its panels are this tall; px.
const MIN_HEIGHT: f64 = 90.0;
/// Room above a panel for its time, and below the last one for the axis; px.
const ABOVE: f64 = 22.0;
const BELOW: f64 = 44.0;
/// Size of a corner of an outline, and the least size of pictures for any number of outlines; bytes of text.
const BYTES_PER_CORNER: usize = 10;
const LEAST_BUDGET: usize = 60_000;
/// Image pixels per pixel of the page, finest first; the first within the budget is used.
pub(super) const RESOLUTIONS: [f64; 5] = [2.0, 1.5, 1.0, 0.7, 0.5];
/// Panels of a run that ends by itself: start, middle and end.
const USUAL: usize = 3;

/// Layout of the panels.
struct Layout {
    panels: Vec<Frame>,
    exaggeration: f64,
    is_beside: bool,
    min: [f64; 2],
    max: [f64; 2],
}

/// Particles as images.
#[derive(Clone, Copy, Debug)]
pub(super) struct Image {
    /// Particle spacing; m.
    pub spacing: f64,
    /// Size limit of images and outlines; bytes.
    pub budget: usize,
}

/// Drops the particles behind others, which no picture of the snapshot shows: in space that is most of them.
pub(in crate::picture) fn keep_seen(
    snapshot: &mut Snapshot,
    view: ([f64; 2], [f64; 2]),
    spacing: f64,
) {
    let layout = Layout::new(0.0, USUAL, view);
    let windows = (layout.panels.first().into_iter())
        .flat_map(|&frame| RESOLUTIONS.map(|resolution| layout.window(frame, resolution)));
    let is_seen = raster::is_seen(&snapshot.positions, spacing, windows);
    let mut shown = is_seen.iter();
    (snapshot.positions).retain(|_| shown.next() == Some(&true));
    let mut shown = is_seen.iter();
    snapshot.speeds.retain(|_| shown.next() == Some(&true));
    snapshot.positions.shrink_to_fit();
    snapshot.speeds.shrink_to_fit();
}

/// Draws all snapshots from `y` down, within the corners of a view and with a label of its horizontal axis; returns the next vertical
/// position.
pub(super) fn draw(
    page: &mut Page,
    y: f64,
    snapshots: &[Snapshot],
    (view, along): (([f64; 2], [f64; 2]), &str),
    image: Image,
) -> f64 {
    let layout = Layout::new(y, snapshots.len(), view);
    let top_speed = top_speed(snapshots);
    let pictures = pictures(&layout, snapshots, image, top_speed);
    let last = snapshots.len() - 1;
    for (i, (snapshot, &frame)) in snapshots.iter().zip(&layout.panels).enumerate() {
        layout.scene(
            page,
            frame,
            snapshot,
            pictures.get(i).and_then(Option::as_deref),
        );
        let time = format!("t = {:.3} s", snapshot.time);
        let style = format!("font-size=\"12\" font-weight=\"bold\" fill=\"{INK}\"");
        page.styled_text([frame.left, frame.top - 6.0], Anchor::Start, &style, &time);
        let shown = |is_shown| {
            if is_shown {
                Labels::Shown
            } else {
                Labels::Hidden
            }
        };
        layout.axes(
            page,
            frame,
            shown(layout.is_beside || i == last),
            shown(!layout.is_beside || i == 0),
        );
        if layout.is_beside || i == last {
            let middle = frame.left + frame.width / 2.0;
            page.text([middle, frame.bottom() + 32.0], Anchor::Middle, along);
        }
    }
    if let Some(&first) = layout.panels.first()
        && layout.exaggeration > 1.0
    {
        let note = format!("vertical exaggeration {} ×", layout.exaggeration);
        page.text([first.right(), first.top - 6.0], Anchor::End, &note);
    }
    if snapshots
        .iter()
        .any(|snapshot| !snapshot.positions.is_empty())
    {
        color_bar(page, &layout, top_speed, fastest(snapshots));
    }
    layout
        .panels
        .last()
        .map_or(y, |frame| frame.bottom() + BELOW)
}

/// Kind of the blocks that are drawn together.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Fixed,
    Movable,
}

impl Layout {
    fn new(y: f64, n: usize, view: ([f64; 2], [f64; 2])) -> Self {
        let (min_x, max_x) = open_range(view.0[0], view.1[0], 1e-9);
        let (min_z, max_z) = open_range(view.0[1], view.1[1], 1e-9);
        let aspect = (max_z - min_z) / (max_x - min_x);
        let is_beside = aspect > TALL && n > 1;
        let room = RIGHT - LEFT;
        let mut exaggeration = 1.0;
        let panel = |left, top, width, height| Frame {
            left,
            top,
            width,
            height,
        };
        let panels = if is_beside {
            let gap = 28.0;
            let width = ((room - gap * (n - 1) as f64) / n as f64).min(MAX_HEIGHT_BESIDE / aspect);
            (0..n)
                .map(|i| {
                    panel(
                        LEFT + i as f64 * (width + gap),
                        y + ABOVE,
                        width,
                        width * aspect,
                    )
                })
                .collect()
        } else {
            let width = room.min(MAX_HEIGHT / aspect);
            if width * aspect < MIN_HEIGHT {
                exaggeration = nice_up(MIN_HEIGHT / (width * aspect));
            }
            let height = width * aspect * exaggeration;
            (0..n)
                .map(|i| {
                    panel(
                        LEFT,
                        y + ABOVE + i as f64 * (height + ABOVE + 10.0),
                        width,
                        height,
                    )
                })
                .collect()
        };
        Self {
            panels,
            exaggeration,
            is_beside,
            min: [min_x, min_z],
            max: [max_x, max_z],
        }
    }

    fn x_axis(&self, frame: Frame) -> Axis {
        Axis {
            min: self.min[0],
            max: self.max[0],
            scale: Scale::Linear,
            from: frame.left,
            to: frame.right(),
        }
    }

    fn z_axis(&self, frame: Frame) -> Axis {
        Axis {
            min: self.min[1],
            max: self.max[1],
            scale: Scale::Linear,
            from: frame.bottom(),
            to: frame.top,
        }
    }

    fn window(&self, frame: Frame, resolution: f64) -> Window {
        let size = |pixels: f64| (pixels * resolution).round().max(1.0) as usize;
        Window {
            min: self.min,
            max: self.max,
            width: size(frame.width),
            height: size(frame.height),
        }
    }

    /// Fixed blocks, then the water, then the blocks that move.
    fn scene(&self, page: &mut Page, frame: Frame, snapshot: &Snapshot, picture: Option<&str>) {
        page.rectangle(frame, "fill=\"#fafafa\"");
        page.open_clipped_group(frame);
        self.outlines(page, frame, &snapshot.outlines, Kind::Fixed);
        if let Some(address) = picture {
            let Frame {
                left,
                top,
                width,
                height,
            } = frame;
            // `xlink:href` too: programs from before SVG 2 know no other.
            page.push(&format!(
                "<image x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" \
                 preserveAspectRatio=\"none\" xlink:href=\"{address}\"/>"
            ));
        }
        self.outlines(page, frame, &snapshot.outlines, Kind::Movable);
        page.close_group();
        page.rectangle(frame, &format!("fill=\"none\" stroke=\"{INK}\""));
    }

    fn outlines(&self, page: &mut Page, frame: Frame, outlines: &[Outline], kind: Kind) {
        let style = if kind == Kind::Fixed {
            "fill=\"#d4d4d4\" stroke=\"#9a9a9a\" stroke-width=\"0.7\""
        } else {
            "fill=\"#a98a6b\" stroke=\"#4d3a28\" stroke-width=\"0.8\" stroke-linejoin=\"round\""
        };
        let (x, z) = (self.x_axis(frame), self.z_axis(frame));
        let mut path = String::new();
        for outline in outlines
            .iter()
            .filter(|outline| outline.is_fixed == (kind == Kind::Fixed))
        {
            // A block far away must not produce numbers beyond the range of renderers.
            let near = |pixel: f64| (10.0 * pixel.clamp(-1e4, 1e4)).round() as i32;
            let tenths = |n: i32| f64::from(n) / 10.0;
            let mut before: Option<[i32; 2]> = None;
            for &[x_m, z_m] in outline
                .points
                .iter()
                .filter(|point| point.iter().all(|c| c.is_finite()))
            {
                let corner @ [px, pz] = [near(x.at(f64::from(x_m))), near(z.at(f64::from(z_m)))];
                // In whole tenths of a pixel, and relative to the corner before: half the text.
                path += &match before {
                    None => format!("M{} {}", tenths(px), tenths(pz)),
                    Some([bx, bz]) => format!("l{} {}", tenths(px - bx), tenths(pz - bz)),
                };
                before = Some(corner);
            }
            if before.is_some() {
                path.push('z');
            }
        }
        // With the default fill rule a single path would have holes where blocks overlap.
        if !path.is_empty() {
            page.push(&format!(
                "<path d=\"{path}\" fill-rule=\"nonzero\" {style}/>"
            ));
        }
    }

    fn axes(&self, page: &mut Page, frame: Frame, x_labels: Labels, z_labels: Labels) {
        let (x, z) = (self.x_axis(frame), self.z_axis(frame));
        axis::draw_horizontal(page, frame, &x.ticks(70.0, 1.0), x, x_labels);
        axis::draw_vertical(page, frame, &z.ticks(26.0, 1.0), z, z_labels);
        if z_labels == Labels::Shown {
            page.upright_text([LABEL, frame.top + frame.height / 2.0], "z [m]");
        }
    }
}

/// One picture per snapshot, as fine as the budget allows.
fn pictures(
    layout: &Layout,
    snapshots: &[Snapshot],
    Image { spacing, budget }: Image,
    top_speed: f64,
) -> Vec<Option<String>> {
    let outlines = snapshots.iter().flat_map(|snapshot| &snapshot.outlines);
    let n_corners: usize = outlines.map(|outline| outline.points.len()).sum();
    let budget = budget
        .saturating_sub(BYTES_PER_CORNER * n_corners)
        .max(LEAST_BUDGET);
    let mut pictures = Vec::new();
    for resolution in RESOLUTIONS {
        pictures = snapshots
            .iter()
            .zip(&layout.panels)
            .map(|(snapshot, &frame)| {
                if snapshot.positions.is_empty() {
                    return None;
                }
                let window = layout.window(frame, resolution);
                let water = Water {
                    positions: &snapshot.positions,
                    speeds: &snapshot.speeds,
                    spacing,
                    top_speed,
                };
                raster::data_address(&raster::pixels(water, window), window)
            })
            .collect();
        if pictures.iter().flatten().map(String::len).sum::<usize>() <= budget {
            break;
        }
    }
    pictures
}

fn finite_speeds(snapshots: &[Snapshot]) -> impl Iterator<Item = f64> + '_ {
    let speeds = snapshots.iter().flat_map(|snapshot| &snapshot.speeds);
    speeds
        .map(|&speed| f64::from(speed))
        .filter(|speed| speed.is_finite())
}

fn fastest(snapshots: &[Snapshot]) -> f64 {
    finite_speeds(snapshots).fold(0.0, f64::max)
}

/// Speed at the top of the color bar: round, and above nearly all particles.
fn top_speed(snapshots: &[Snapshot]) -> f64 {
    bar::round_top(finite_speeds(snapshots).collect())
}

fn color_bar(page: &mut Page, layout: &Layout, top_speed: f64, fastest: f64) {
    let Some((first, last)) = layout.panels.first().zip(layout.panels.last()) else {
        return;
    };
    let frame = Frame {
        left: last.right() + 26.0,
        top: first.top + 4.0,
        width: 13.0,
        height: (first.height - 4.0).clamp(80.0, 200.0),
    };
    let speed = Bar {
        label: "speed [m/s]",
        shades: &color::map(N_SHADES),
        range: (0.0, top_speed),
        is_exceeded: (false, fastest > top_speed),
    };
    speed.draw(page, frame);
}
