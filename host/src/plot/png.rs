//! SVG to PNG, with the font in the program: no font need be installed.

use resvg::{tiny_skia, usvg};

use super::PlotError;

pub(super) fn encode(svg: &str, scale: f32) -> Result<Vec<u8>, PlotError> {
    let failed = |what: &dyn std::fmt::Display| PlotError::Png(what.to_string());
    let mut options = usvg::Options { font_family: "DejaVu Sans".into(), ..usvg::Options::default() };
    options.fontdb_mut().load_font_data(dejavu::sans::regular().to_vec());
    let tree = usvg::Tree::from_str(svg, &options).map_err(|e| failed(&e))?;
    let size = tree.size();
    let (width, height) = ((size.width() * scale).ceil() as u32, (size.height() * scale).ceil() as u32);
    let mut pixels =
        tiny_skia::Pixmap::new(width, height).ok_or_else(|| failed(&"it has no size, or too large a one"))?;
    resvg::render(&tree, tiny_skia::Transform::from_scale(scale, scale), &mut pixels.as_mut());
    pixels.encode_png().map_err(|e| failed(&e))
}
