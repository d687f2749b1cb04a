//! Pictures of plots for where drawings cannot be shown.

use resvg::{tiny_skia, usvg};

/// Pixels for a unit of the drawing.
const SCALE: f32 = 2.0;

/// Error of rendering a plot.
#[derive(Debug, thiserror::Error)]
pub enum PictureError {
    /// The drawing is not one.
    #[error("the plot cannot be read: {0}")]
    Drawing(#[from] usvg::Error),
    /// It is too large.
    #[error("no memory for a picture of {width} by {height} pixels")]
    Size {
        /// Pixels.
        width: u32,
        /// Pixels.
        height: u32,
    },
    /// It cannot be packed.
    #[error("the picture cannot be encoded: {0}")]
    Png(String),
}

/// The bytes of a PNG file of a drawing, with the sans-serif letters of the system; without letters where it has none.
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
