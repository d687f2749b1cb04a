//! PNG pictures of plots.

use resvg::{tiny_skia, usvg};

/// Pixels per unit of the drawing.
const SCALE: f32 = 2.0;

/// Error of rendering a plot.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// Invalid SVG.
    #[error("the plot cannot be read: {0}")]
    Drawing(#[from] usvg::Error),
    /// Excessive size.
    #[error("no memory for a picture of {width} by {height} pixels")]
    Size {
        /// Pixels.
        width: u32,
        /// Pixels.
        height: u32,
    },
    /// Failed compression.
    #[error("the picture cannot be encoded: {0}")]
    Png(String),
}

/// PNG file of an SVG drawing, with the sans-serif font of the system; without text if there is none.
///
/// # Errors
///
/// [`PictureError`].
pub fn png(svg: &str) -> Result<Vec<u8>, PictureError> {
    let mut options = usvg::Options::default();
    options.fontdb_mut().load_system_fonts();
    let tree = usvg::Tree::from_str(svg, &options)?;
    let size = tree.size();
    let [width, height] = [size.width(), size.height()].map(|x| (SCALE * x).ceil() as u32);
    let mut pixels =
        tiny_skia::Pixmap::new(width, height).ok_or(PictureError::Size { width, height })?;
    pixels.fill(tiny_skia::Color::WHITE);
    let scale = tiny_skia::Transform::from_scale(SCALE, SCALE);
    resvg::render(&tree, scale, &mut pixels.as_mut());
    pixels
        .encode_png()
        .map_err(|error| PictureError::Png(error.to_string()))
}
