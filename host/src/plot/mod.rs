//! Figures: a scene with its streamlines, its hard and soft regions, and where robots went; SVG, and PNG from the same SVG.
//!
//! ```no_run
//! use pliant::{plot, scene::Scene};
//! # fn main() -> Result<(), pliant::error::Error> {
//! let scene = Scene::load("scenes/sbend-pair.toml")?;
//! plot::scene_figure(&scene, &[], &plot::Options::default())?.save("pair.png".as_ref())?;
//! # Ok(())
//! # }
//! ```

pub mod figure;
mod legend;
mod outline;
mod panel;
mod png;
mod seen;
mod streamlines;
mod style;
mod trajectory;
mod view;

use std::io;
use std::path::Path;

use nalgebra::{Point2, Vector2};

use crate::scene::{ConvertError, Scene};
use figure::{Axes, Svg};
use panel::Panel;
pub use streamlines::streamlines;
pub use trajectory::{Trajectory, TrajectoryPoint, trajectories};
use view::View;

/// What a scene's figure is to look like.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Scene time the obstacles and the field are drawn at, s.
    pub time: f64,
    /// Width, px; text has a fixed size, so a smaller figure has larger text when both are shown equally wide.
    pub width: f64,
    /// Draw the streamlines?
    pub streamlines: bool,
    /// Colour trajectories by their speed?
    pub speed: bool,
}

impl Default for Options {
    /// At time 0, 560 pixels wide, with everything.
    fn default() -> Self {
        Self { time: 0.0, width: 560.0, streamlines: true, speed: true }
    }
}

/// Why there is no figure.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
pub enum PlotError {
    /// Neither .svg nor .png.
    #[error("{0}: a figure's name ends in .svg or .png")]
    Format(String),
    /// The file cannot be written.
    #[error("{path}: cannot be written: {source}")]
    Unwritable {
        /// As it was given.
        path: String,
        /// What the system says.
        source: io::Error,
    },
    /// The scene cannot be evaluated at the time asked for.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Scene(#[from] ConvertError),
    /// The pixels could not be made.
    #[error("the figure cannot be made a PNG: {0}")]
    Png(String),
}

/// A finished figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Figure {
    svg: String,
}

/// Pixels of a PNG for one of the SVG.
const PNG_SCALE: f32 = 2.0;

impl Figure {
    /// A figure from SVG made elsewhere, such as with [`figure`].
    pub fn from_svg(svg: String) -> Self {
        Self { svg }
    }

    /// The SVG document.
    pub fn svg(&self) -> &str {
        &self.svg
    }

    /// The same as a PNG file, twice as many pixels each way.
    ///
    /// # Errors
    /// The SVG is none, or too large.
    pub fn png(&self) -> Result<Vec<u8>, PlotError> {
        png::encode(&self.svg, PNG_SCALE)
    }

    /// Writes the figure, .svg or .png by its name, and the folder it is in if need be.
    ///
    /// # Errors
    /// Another ending, or a file that cannot be written.
    pub fn save(&self, path: &Path) -> Result<(), PlotError> {
        let bytes = match format(path)? {
            Format::Svg => self.svg.clone().into_bytes(),
            Format::Png => self.png()?,
        };
        let unwritable = |source| PlotError::Unwritable { path: path.display().to_string(), source };
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder).map_err(unwritable)?;
        }
        std::fs::write(path, bytes).map_err(unwritable)
    }
}

enum Format {
    Svg,
    Png,
}

fn format(path: &Path) -> Result<Format, PlotError> {
    match path.extension().and_then(|e| e.to_str()).map(str::to_lowercase).as_deref() {
        Some("svg") => Ok(Format::Svg),
        Some("png") => Ok(Format::Png),
        _ => Err(PlotError::Format(path.display().to_string())),
    }
}

/// Is this a name a figure can be saved under? To be asked before long work.
///
/// # Errors
/// Another ending than .svg and .png.
pub fn check_format(path: &Path) -> Result<(), PlotError> {
    format(path).map(|_| ())
}

/// Room above and to the right of everything, px.
const EDGE: f64 = 12.0;
/// Room for the colour scale, px.
const SCALE_ROOM: f64 = 62.0;
/// Room under a panel for ticks, and for a name as well, px.
const BELOW: [f64; 2] = [16.0, 42.0];

/// A scene with streamlines, obstacles and trajectories. In 3-D: from above (x-y) and from the side (x-z), with the obstacles' shadows and
/// their sections through the attractor's plane, in which the streamlines are.
///
/// # Errors
/// A time at which an obstacle has left the range.
pub fn scene_figure(scene: &Scene, trajectories: &[Trajectory], options: &Options) -> Result<Figure, PlotError> {
    let speeds = trajectory::speeds(trajectories).filter(|_| options.speed);
    let views = View::of(scene);
    let panels: Vec<Panel<'_>> =
        views.iter().map(|view| Panel::new(scene, view, trajectories, speeds, options)).collect::<Result<_, _>>()?;
    let extents = panel::shared(&panels);
    let right = EDGE + if speeds.is_some() { SCALE_ROOM } else { 0.0 };
    let left =
        extents.iter().map(|e| Axes::left_room(e, e.size().y / e.size().x * options.width * 0.8)).fold(0.0, f64::max);
    let mut svg = Svg::default();
    let mut corner = Point2::new(left, EDGE);
    let mut axes = Vec::new();
    for (i, (panel, extent)) in panels.iter().zip(extents).enumerate() {
        let last = i + 1 == panels.len();
        let here = Axes::equal(corner, options.width - left - right, extent);
        panel.draw(&mut svg, &here, last, i)?;
        corner.y = here.end().y + BELOW[usize::from(last)];
        axes.push(here);
    }
    if let (Some(speeds), [first, ..]) = (speeds, &axes[..]) {
        legend::speed_scale(&mut svg, first, axes.last().unwrap_or(first), speeds);
    }
    let bottom = legend::draw(&mut svg, &panels, Point2::new(left, corner.y + 6.0), options.width - EDGE);
    Ok(Figure { svg: svg.finish(Vector2::new(options.width, bottom + EDGE)) })
}

#[cfg(test)]
mod tests;
