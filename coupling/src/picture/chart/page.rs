//! SVG page on which the parts draw; all lengths in pixels, y down.

use crate::files::vtk::escape;

/// Width of the page.
pub(crate) const WIDTH: f64 = 1000.0;
/// Left edge of every plot; labels of the vertical axis are left of it.
pub(crate) const LEFT: f64 = 76.0;
/// Right edge of every plot; legends and the color bar are right of it.
pub(crate) const RIGHT: f64 = 848.0;

/// Middle of the labels of vertical axes.
pub(crate) const LABEL: f64 = 18.0;

pub(crate) const INK: &str = "#333";
const FAINT: &str = "#e6e6e6";

/// Rectangle in the page.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
}

impl Frame {
    pub fn right(self) -> f64 {
        self.left + self.width
    }

    pub fn bottom(self) -> f64 {
        self.top + self.height
    }
}

/// Anchor of a text at its point.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// SVG elements so far.
#[derive(Debug, Default)]
pub(crate) struct Page {
    body: String,
    n_clips: usize,
}

impl Page {
    /// The file; `height` is the end of the last part.
    pub fn finish(self, title: &str, height: f64) -> String {
        let height = (height + 12.0).ceil();
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" xmlns:xlink=\"http://www.w3.org/1999/xlink\" \
             width=\"{WIDTH}\" height=\"{height}\" viewBox=\"0 0 {WIDTH} {height}\" \
             font-family=\"Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif\">\n\
             <title>{}</title>\n<rect width=\"{WIDTH}\" height=\"{height}\" fill=\"#fff\"/>\n{}</svg>\n",
            plain(title),
            self.body
        )
    }

    /// Raw SVG.
    pub fn push(&mut self, element: &str) {
        self.body += element;
        self.body.push('\n');
    }

    /// An element with a tooltip.
    pub fn titled(&mut self, element: &str, title: &str) {
        self.push(&format!("<g><title>{}</title>{element}</g>", plain(title)));
    }

    /// Text of an axis or legend.
    pub fn text(&mut self, at: [f64; 2], anchor: Anchor, text: &str) {
        self.styled_text(at, anchor, "font-size=\"11\" fill=\"#333\"", text);
    }

    /// Text with attributes of its own.
    pub fn styled_text(&mut self, [x, y]: [f64; 2], anchor: Anchor, style: &str, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let text = plain(text);
        self.push(&format!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" {style}>{text}</text>"
        ));
    }

    /// Label of a vertical axis, read from below.
    pub fn upright_text(&mut self, [x, y]: [f64; 2], text: &str) {
        let style =
            format!("font-size=\"11\" fill=\"#333\" transform=\"rotate(-90 {x:.1} {y:.1})\"");
        self.styled_text([x, y], Anchor::Middle, &style, text);
    }

    /// Thin gray line of the grid.
    pub fn grid_line(&mut self, from: [f64; 2], to: [f64; 2]) {
        self.line(from, to, &format!("stroke=\"{FAINT}\""));
    }

    /// Line with attributes of its own.
    pub fn line(&mut self, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2], style: &str) {
        self.push(&format!(
            "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" {style}/>"
        ));
    }

    /// Rectangle with attributes of its own.
    pub fn rectangle(&mut self, frame: Frame, style: &str) {
        self.push(&format!("<rect {} {style}/>", corners(frame)));
    }

    /// Opens a group clipped to `frame`; to be closed with [`Self::close_group`].
    pub fn open_clipped_group(&mut self, frame: Frame) {
        let id = self.n_clips;
        self.n_clips += 1;
        self.push(&format!(
            "<clipPath id=\"clip{id}\"><rect {}/></clipPath>",
            corners(frame)
        ));
        self.push(&format!("<g clip-path=\"url(#clip{id})\">"));
    }

    pub fn close_group(&mut self) {
        self.push("</g>");
    }
}

fn corners(frame: Frame) -> String {
    let Frame {
        left,
        top,
        width,
        height,
    } = frame;
    format!("x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height:.1}\"")
}

/// Text valid in XML, without control characters, which XML forbids even escaped.
pub(crate) fn plain(text: &str) -> String {
    escape(&text.replace(
        |c: char| c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}'),
        " ",
    ))
}

/// At most `n` characters, the last one an ellipsis if some are left out.
pub(crate) fn shortened(text: &str, n: usize) -> String {
    if text.chars().count() <= n {
        return text.to_owned();
    }
    text.chars()
        .take(n.saturating_sub(1))
        .chain(['…'])
        .collect()
}
