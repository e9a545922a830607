//! How a pattern is drawn: the palette, sizes and the layout that SVG and PNG share, so that both look the same.

use glam::DVec2;

use crate::domain::Boundary;
use crate::pattern::PointPattern;

/// The attribute that, when a pattern has it, gives every disk its radius in the pattern's own unit.
pub const RADIUS_ATTRIBUTE: &str = "radius";
/// The attribute that, when a pattern has it, turns every glyph: degrees, counter-clockwise as one sees it, 0 to the
/// right. 90 points up, towards smaller y, for y points down.
pub const ORIENTATION_ATTRIBUTE: &str = "orientation";

/// An opaque colour, 8 bits a channel, sRGB.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Color {
    /// Red.
    pub red: u8,
    /// Green.
    pub green: u8,
    /// Blue.
    pub blue: u8,
}

impl Color {
    /// White.
    pub const WHITE: Self = Self::new(255, 255, 255);

    /// A colour from its channels.
    #[must_use]
    pub const fn new(red: u8, green: u8, blue: u8) -> Self {
        Self { red, green, blue }
    }

    /// `#rrggbb`.
    #[must_use]
    pub fn hex(self) -> String {
        format!("#{:02x}{:02x}{:02x}", self.red, self.green, self.blue)
    }
}

/// Okabe and Ito's palette, which people with the common kinds of colour blindness can tell apart, ordered for white
/// paper: the strong hues first, the pale yellow last.
pub const PALETTE: [Color; 8] = [
    Color::new(0x00, 0x72, 0xb2),
    Color::new(0xd5, 0x5e, 0x00),
    Color::new(0x00, 0x9e, 0x73),
    Color::new(0xcc, 0x79, 0xa7),
    Color::new(0xe6, 0x9f, 0x00),
    Color::new(0x56, 0xb4, 0xe9),
    Color::new(0x22, 0x22, 0x22),
    Color::new(0xf0, 0xe4, 0x42),
];

/// How the points of one class look.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClassStyle {
    /// Fill or line colour.
    pub color: Color,
    /// A ring instead of a disk: the second round through the palette.
    pub hollow: bool,
}

/// The look of a class by its index: eight colours as disks, then the same eight as rings.
#[must_use]
pub fn class_style(class: u16) -> ClassStyle {
    let class = usize::from(class);
    ClassStyle { color: PALETTE[class % PALETTE.len()], hollow: (class / PALETTE.len()) % 2 == 1 }
}

/// What SVG and PNG have in common.
#[derive(Clone, Debug, PartialEq)]
pub struct Look {
    /// Colour behind everything; `None` is transparent.
    pub background: Option<Color>,
    /// Colour of the line around the domain; `None` draws no line.
    pub frame: Option<Color>,
    /// Empty space around the domain, as a share of its longer side.
    pub margin: f64,
    /// Radius of a disk as a share of the mean spacing, where the pattern has no `radius` attribute.
    pub disk: f64,
}

impl Default for Look {
    fn default() -> Self {
        Self { background: Some(Color::WHITE), frame: Some(Color::new(0xd4, 0xd8, 0xde)), margin: 0.03, disk: 0.28 }
    }
}

/// One disk or ring, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Disk {
    pub(crate) center: DVec2,
    pub(crate) radius: f64,
    pub(crate) class: u16,
}

/// A pattern laid out in pixels; y points down, as on the page.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Layout {
    /// Upper left corner of the domain.
    pub(crate) min: DVec2,
    /// Size of the domain.
    pub(crate) size: DVec2,
    /// In the order of the classes, so that each can be one group.
    pub(crate) disks: Vec<Disk>,
    /// Whether disks end at the domain's border: a tile shows what comes in from the other side instead.
    pub(crate) clipped: bool,
    /// Width of the frame and the thinnest ring.
    pub(crate) line: f64,
}

/// Width and height in pixels of a picture whose longer side is `longer`, margins included.
pub(crate) fn picture_size(pattern: &PointPattern, longer: f64, look: &Look) -> DVec2 {
    let size = pattern.domain().size_in_exemplar_units() + 2.0 * look.margin;
    size * (longer / size.max_element())
}

/// Fits the pattern, margins included, into the rectangle from `min` with size `size`, centred.
pub(crate) fn lay_out(pattern: &PointPattern, min: DVec2, size: DVec2, look: &Look) -> Layout {
    let extent = pattern.domain().size_in_exemplar_units();
    let scale = (size / (extent + 2.0 * look.margin)).min_element();
    let frame_size = extent * scale;
    let frame_min = min + (size - frame_size) / 2.0;
    let clipped = pattern.boundary() == Boundary::Periodic;

    let unit = pattern.domain().exemplar_unit();
    let radii = pattern.attributes().iter().find(|attribute| attribute.name == RADIUS_ATTRIBUTE);
    // A lone point gets a disk one can see; nothing is ever thinner than a third of a pixel or wider than the domain.
    let common = pattern.mean_spacing().map_or(0.02, |spacing| (spacing * look.disk).min(0.04));
    let mut disks = Vec::with_capacity(pattern.len());
    for (i, position) in pattern.positions_in_exemplar_units().into_iter().enumerate() {
        let radius = radii.map_or(common, |attribute| (attribute.values[i] / unit).clamp(0.0, 0.5));
        let disk = Disk {
            center: frame_min + position * scale,
            radius: (radius * scale).max(0.35),
            class: pattern.classes()[i],
        };
        disks.push(disk);
        if clipped {
            push_copies(&mut disks, disk, frame_min, frame_size);
        }
    }
    let order = crate::sorting::order(disks.iter().map(|disk| f64::from(disk.class)));
    let disks = order.into_iter().map(|place| disks[place]).collect();
    Layout { min: frame_min, size: frame_size, disks, clipped, line: (size.max_element() / 800.0).max(0.5) }
}

/// What of a tile's disk comes in from the other sides.
fn push_copies(disks: &mut Vec<Disk>, disk: Disk, min: DVec2, size: DVec2) {
    let max = min + size;
    for column in [-1.0, 0.0, 1.0] {
        for row in [-1.0, 0.0, 1.0] {
            let center = disk.center + DVec2::new(column, row) * size;
            let touches = (center + disk.radius).cmpgt(min).all() && (center - disk.radius).cmplt(max).all();
            if (column != 0.0 || row != 0.0) && touches {
                disks.push(Disk { center, ..disk });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::Domain;

    #[test]
    fn sixteen_classes_look_different() {
        let styles: Vec<_> = (0..16).map(class_style).collect();
        for (i, style) in styles.iter().enumerate() {
            assert!(!styles[..i].contains(style), "class {i} looks like an earlier one");
        }
    }

    #[test]
    fn a_tile_shows_what_comes_in_from_the_other_side() -> Result<(), crate::PatternError> {
        let corner = PointPattern::new(Domain::UNIT, vec![DVec2::ZERO, DVec2::splat(0.5)])?;
        let look = Look::default();
        assert_eq!(lay_out(&corner, DVec2::ZERO, DVec2::splat(100.0), &look).disks.len(), 2);
        let tile = lay_out(&corner.with_boundary(Boundary::Periodic), DVec2::ZERO, DVec2::splat(100.0), &look);
        assert_eq!(tile.disks.len(), 5);
        assert!(tile.clipped);
        Ok(())
    }
}
