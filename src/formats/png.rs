//! PNG, and drawing into any pixmap. Native only: the page decodes by itself and draws on its own canvas.

use std::io::Cursor;

use glam::DVec2;
use thiserror::Error;
use tiny_skia::{FillRule, Mask, Paint, Path, PathBuilder, Pixmap, Rect, Stroke, Transform};

use super::error::FormatError;
use super::glyph::Glyph;
use super::outline::Segment;
use super::picture::{MAX_PIXELS, Picture};
use super::style::{self, Color, Layout, Look};
use super::svg::{HALO, Ring};
use crate::pattern::PointPattern;

/// What every PNG begins with.
pub(super) const MAGIC: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Decodes a PNG of any kind.
pub(super) fn decode(bytes: &[u8]) -> Result<Picture, FormatError> {
    let refuse = |reason: String| FormatError::Pixels { reason };
    let broken = |error: png::DecodingError| refuse(format!("it is no proper PNG: {error}"));
    let limits = png::Limits { bytes: 8 * MAX_PIXELS };
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    decoder.set_transformations(png::Transformations::normalize_to_color8() | png::Transformations::ALPHA);
    let mut reader = decoder.read_info().map_err(broken)?;
    let (width, height) = (reader.info().width, reader.info().height);
    let count = width as usize * height as usize;
    if count > MAX_PIXELS {
        return Err(refuse(format!("it has {width} × {height} pixels; at most {MAX_PIXELS} are allowed")));
    }
    let size = reader.output_buffer_size().ok_or_else(|| refuse("it is too large".to_owned()))?;
    let mut decoded = vec![0; size];
    let frame = reader.next_frame(&mut decoded).map_err(broken)?;
    decoded.truncate(frame.buffer_size());
    let pixels = match frame.color_type {
        png::ColorType::Rgba => decoded,
        // With an alpha channel added there is nothing else left.
        _ => decoded.chunks_exact(2).flat_map(|gray| [gray[0], gray[0], gray[0], gray[1]]).collect(),
    };
    Picture::new(width as usize, height as usize, pixels)
}

/// How a PNG is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct PngStyle {
    /// Longer side in pixels, margins included.
    pub size_px: u32,
    /// Colours and sizes.
    pub look: Look,
}

impl PngStyle {
    /// Smallest longer side.
    pub const MIN_SIZE_PX: u32 = 16;
    /// Largest longer side: 8192² pixels take 268 MB while they are drawn.
    pub const MAX_SIZE_PX: u32 = 8192;
}

impl Default for PngStyle {
    fn default() -> Self {
        Self { size_px: 1024, look: Look::default() }
    }
}

/// Why a picture could not be made.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum PngError {
    /// Too small to see or too large to hold.
    #[error("a picture of {size_px} pixels can't be drawn; the longer side must have {min} to {max}")]
    Size {
        /// The longer side asked for.
        size_px: u32,
        /// Smallest allowed.
        min: u32,
        /// Largest allowed.
        max: u32,
    },
    /// The encoder refused.
    #[error("the picture can't be encoded: {0}")]
    Encode(#[from] png::EncodingError),
}

/// Draws a pattern as PNG, with the look of [`write_svg`](super::write_svg).
///
/// # Errors
/// When the size is out of range, or the encoder refuses.
pub fn write_png(pattern: &PointPattern, style: &PngStyle) -> Result<Vec<u8>, PngError> {
    let size = || PngError::Size { size_px: style.size_px, min: PngStyle::MIN_SIZE_PX, max: PngStyle::MAX_SIZE_PX };
    if !(PngStyle::MIN_SIZE_PX..=PngStyle::MAX_SIZE_PX).contains(&style.size_px) {
        return Err(size());
    }
    let picture = style::picture_size(pattern, style.size_px.into(), &style.look);
    let mut pixmap = Pixmap::new(pixels(picture.x), pixels(picture.y)).ok_or_else(size)?;
    let (width, height) = (f64::from(pixmap.width()), f64::from(pixmap.height()));
    draw(pattern, &mut pixmap, 0.0, 0.0, width, height, &style.look);
    encode_png(pixmap)
}

/// Encodes a drawn pixmap as PNG.
///
/// # Errors
/// When the encoder refuses.
pub fn encode_png(pixmap: Pixmap) -> Result<Vec<u8>, PngError> {
    let (width, height) = (pixmap.width(), pixmap.height());
    encode_rgba(width, height, &pixmap.take_demultiplied())
}

/// Encodes pixels, `[height, width, 4]` with alpha not multiplied in, as PNG.
pub(crate) fn encode_rgba(width: u32, height: u32, pixels: &[u8]) -> Result<Vec<u8>, PngError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, width, height);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(pixels)?;
    writer.finish()?;
    Ok(bytes)
}

/// Draws a pattern into the rectangle (`x`, `y`, `width`, `height`) of a pixmap, in pixels, centred and with its
/// proportions kept; the background fills the whole rectangle. Nothing is drawn when the rectangle is empty.
pub fn draw(pattern: &PointPattern, pixmap: &mut Pixmap, x: f64, y: f64, width: f64, height: f64, look: &Look) {
    let (min, size) = (DVec2::new(x, y), DVec2::new(width, height));
    // Written so that NaN is refused too.
    if !(min.is_finite() && size.is_finite() && size.min_element() > 0.0) {
        return;
    }
    let layout = style::lay_out(pattern, min, size, look);
    if let (Some(color), Some(area)) = (look.background, rectangle(min, size)) {
        pixmap.fill_rect(area, &paint(color), Transform::identity(), None);
    }
    let domain = rectangle(layout.min, layout.size);
    // Below the disks: points on the border stay whole.
    if let (Some(color), Some(domain)) = (look.frame, domain) {
        let stroke = Stroke { width: layout.line as f32, ..Stroke::default() };
        pixmap.stroke_path(&PathBuilder::from_rect(domain), &paint(color), &stroke, Transform::identity(), None);
    }
    let clip = domain.filter(|_| layout.clipped).and_then(|domain| {
        let mut mask = Mask::new(pixmap.width(), pixmap.height())?;
        mask.fill_path(&PathBuilder::from_rect(domain), FillRule::Winding, true, Transform::identity());
        Some(mask)
    });
    draw_marks(&layout, pixmap, clip.as_ref());
}

fn draw_marks(layout: &Layout, pixmap: &mut Pixmap, clip: Option<&Mask>) {
    let stroke = |width: f64| Stroke { width: width as f32, ..Stroke::default() };
    let shapes: Vec<Option<Path>> = layout.classes.iter().map(|class| path(&class.glyph)).collect();
    for mark in &layout.marks {
        let number = usize::from(mark.class);
        let (Some(class), Some(shape)) = (layout.classes.get(number), shapes.get(number)) else { continue };
        let ring = Ring::of(mark.radius, layout.line);
        let hollow = class.glyph == Glyph::Ring;
        let radius = if hollow { ring.radius } else { mark.radius };
        let (x, y) = (mark.center.x as f32, mark.center.y as f32);
        let outline = match shape {
            // y points down, so turning back is counter-clockwise.
            Some(shape) => shape.clone().transform(
                Transform::from_rotate(-mark.turn as f32).post_scale(radius as f32, radius as f32).post_translate(x, y),
            ),
            None => PathBuilder::from_circle(x, y, radius as f32),
        };
        let Some(outline) = outline else { continue };
        if hollow {
            pixmap.stroke_path(&outline, &paint(class.color), &stroke(ring.width), Transform::identity(), clip);
            continue;
        }
        if let Some(halo) = layout.halo {
            let around = stroke(HALO * layout.line);
            pixmap.stroke_path(&outline, &paint(halo), &around, Transform::identity(), clip);
        }
        pixmap.fill_path(&outline, &paint(class.color), FillRule::Winding, Transform::identity(), clip);
    }
}

/// The outline of a glyph of radius 1 that is no circle.
fn path(glyph: &Glyph) -> Option<Path> {
    let mut path = PathBuilder::new();
    match glyph {
        Glyph::Disk | Glyph::Ring => return None,
        Glyph::Polygon(polygon) => {
            for (i, [x, y]) in polygon.corners.iter().enumerate() {
                if i == 0 { path.move_to(*x, *y) } else { path.line_to(*x, *y) }
            }
            path.close();
        }
        Glyph::Path(outline) => {
            for segment in outline.segments() {
                match *segment {
                    Segment::Move(p) => path.move_to(p.x as f32, p.y as f32),
                    Segment::Line(p) => path.line_to(p.x as f32, p.y as f32),
                    Segment::Curve(a, b, p) => {
                        path.cubic_to(a.x as f32, a.y as f32, b.x as f32, b.y as f32, p.x as f32, p.y as f32);
                    }
                    Segment::Close => path.close(),
                }
            }
        }
    }
    path.finish()
}

fn pixels(length: f64) -> u32 {
    // Saturates, and at most MAX_SIZE_PX by then.
    (length.round() as u32).max(1)
}

fn rectangle(min: DVec2, size: DVec2) -> Option<Rect> {
    Rect::from_xywh(min.x as f32, min.y as f32, size.x as f32, size.y as f32)
}

fn paint(color: Color) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color_rgba8(color.red, color.green, color.blue, 255);
    paint.anti_alias = true;
    paint
}
