//! Layout of the plans in the page, and labels at their edges.

use crate::picture::chart::axis::{self, Axis, Labels, Scale, nice_up, open_range};
use crate::picture::chart::page::{Anchor, Frame, INK, LEFT, Page, RIGHT, WIDTH, shortened};

/// Plans with a larger ratio of width to height are shown below each other, others side by side.
const WIDE: f64 = 2.2;
/// Plans side by side are not taller than this; px.
const MAX_HEIGHT: f64 = 480.0;
/// A long strip is widened until its plans are this tall; px.
const MIN_HEIGHT: f64 = 60.0;
/// Room above a plan for its title, beside it for its color bar and below it for its axis; px.
const ABOVE: f64 = 24.0;
const BESIDE: f64 = 76.0;
const BELOW: f64 = 26.0;
/// Room below the last plan for the name of its axis too; px.
const BELOW_LAST: f64 = 44.0;

/// Middle of the label of the vertical axis, beside coordinates of seven digits; px.
const LABEL_OF_Y: f64 = 12.0;

/// Mapping from plan view to page.
#[derive(Clone, Copy, Debug)]
pub(super) struct Chart {
    pub frame: Frame,
    /// m.
    pub min: [f64; 2],
    /// m.
    pub max: [f64; 2],
}

impl Chart {
    fn axes(self) -> [Axis; 2] {
        let Self { frame, min, max } = self;
        let axis = |k: usize, from, to| Axis {
            min: min[k],
            max: max[k],
            scale: Scale::Linear,
            from,
            to,
        };
        [
            axis(0, frame.left, frame.right()),
            axis(1, frame.bottom(), frame.top),
        ]
    }

    /// Position of a point in plan view; px.
    pub fn pixel(self, place: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.axes();
        [x.at(place[0]), y.at(place[1])]
    }

    /// Along x; px/m.
    pub fn scale(self) -> f64 {
        self.frame.width / (self.max[0] - self.min[0])
    }
}

/// Positions of the plans.
pub(super) struct Layout {
    pub frames: Vec<Frame>,
    columns: usize,
    /// Vertical exaggeration of the drawing, y over x.
    pub widening: f64,
    pub min: [f64; 2],
    pub max: [f64; 2],
}

impl Layout {
    /// Of `n` plans of a rectangle (m), from `y` down.
    pub fn new(y: f64, n: usize, view: ([f64; 2], [f64; 2])) -> Self {
        let ranges = [0, 1].map(|axis| open_range(view.0[axis], view.1[axis], 1e-9));
        let [(min_x, max_x), (min_y, max_y)] = ranges;
        let aspect = (max_y - min_y) / (max_x - min_x);
        let columns = if aspect * WIDE < 1.0 || n < 2 { 1 } else { 2 };
        let room = match columns {
            1 => RIGHT - LEFT,
            _ => 0.5 * (WIDTH - 24.0 - LEFT) - BESIDE,
        };
        let width = room.min(MAX_HEIGHT / aspect);
        let widening = match width * aspect < MIN_HEIGHT {
            true => nice_up(MIN_HEIGHT / (width * aspect)),
            false => 1.0,
        };
        let height = width * aspect * widening;
        let frame = |i: usize| Frame {
            left: LEFT + (i % columns) as f64 * (width + BESIDE),
            top: y + ABOVE + (i / columns) as f64 * (height + ABOVE + BELOW),
            width,
            height,
        };
        Self {
            frames: (0..n).map(frame).collect(),
            columns,
            widening,
            min: [min_x, min_y],
            max: [max_x, max_y],
        }
    }

    /// Next vertical position, with the title of the first plan at `y`.
    pub fn bottom(&self, y: f64) -> f64 {
        let last = self.frames.last();
        last.map_or(y, |frame| frame.bottom() + BELOW_LAST)
    }

    /// Ticks and numbers in map coordinates, omitted where the previous plan has them.
    pub fn decorate(&self, page: &mut Page, i: usize, origin: [f64; 3]) {
        let frame = self.frames[i];
        let on_map = Chart {
            frame,
            min: [0, 1].map(|k| self.min[k] + origin[k]),
            max: [0, 1].map(|k| self.max[k] + origin[k]),
        };
        let [x, y] = on_map.axes();
        axis::draw_horizontal(page, frame, &x.ticks(70.0, 1.0), x, Labels::Shown);
        let is_first = i.is_multiple_of(self.columns);
        let y_labels = if is_first {
            Labels::Shown
        } else {
            Labels::Hidden
        };
        axis::draw_vertical(page, frame, &y.ticks(34.0, 1.0), y, y_labels);
        if is_first {
            page.upright_text([LABEL_OF_Y, frame.top + frame.height / 2.0], "y [m]");
        }
        if self.frames.len() <= i + self.columns {
            let below = [frame.left + frame.width / 2.0, frame.bottom() + 32.0];
            page.text(below, Anchor::Middle, "x [m]");
        }
    }
}

/// Writes the title above a plan.
pub(super) fn title(page: &mut Page, frame: Frame, title: &str) {
    // approximate width of bold letters of 12 px
    let title = shortened(title, ((frame.width + 12.0) / 6.6) as usize);
    let style = format!("font-size=\"12\" font-weight=\"bold\" fill=\"{INK}\"");
    page.styled_text([frame.left, frame.top - 6.0], Anchor::Start, &style, &title);
}
