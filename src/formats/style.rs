//! How a pattern is drawn: the palette, sizes and the layout that SVG and PNG share, so that both look the same.

use glam::DVec2;

use super::glyph::Glyph;
use crate::pattern::{Boundary, PointPattern};
pub use crate::pattern::{DEPTH_ATTRIBUTE, ORIENTATION_ATTRIBUTE, RADIUS_ATTRIBUTE, SCALE_ATTRIBUTE};

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

/// Colours for the classes, which people with the common kinds of colour blindness can tell apart.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Palette {
    /// Okabe and Ito's (2008), its yellow darkened for white paper.
    #[default]
    OkabeIto,
    /// Paul Tol's (2021) bright scheme.
    Bright,
    /// The colour of ink alone: shapes tell the classes apart.
    Ink,
}

impl Palette {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::OkabeIto, Self::Bright, Self::Ink];

    /// The name used on the command line and by the page.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::OkabeIto => "okabe-ito",
            Self::Bright => "bright",
            Self::Ink => "ink",
        }
    }

    /// The palette of a name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|palette| palette.name() == name)
    }

    /// One of its eight colours: blue, vermilion, green, purple, orange, sky blue, grey, olive, or what comes nearest.
    #[must_use]
    pub fn color(self, index: usize) -> Color {
        let list = match self {
            Self::OkabeIto => &PALETTE,
            Self::Bright => &BRIGHT,
            Self::Ink => return PALETTE[6],
        };
        list[index % list.len()]
    }
}

/// The colours of [`Palette::OkabeIto`].
pub const PALETTE: [Color; 8] = [
    Color::new(0x00, 0x72, 0xb2),
    Color::new(0xd5, 0x5e, 0x00),
    Color::new(0x00, 0x9e, 0x73),
    Color::new(0xcc, 0x79, 0xa7),
    Color::new(0xe6, 0x9f, 0x00),
    Color::new(0x56, 0xb4, 0xe9),
    Color::new(0x22, 0x22, 0x22),
    Color::new(0x9c, 0x8b, 0x00),
];

const BRIGHT: [Color; 8] = [
    Color::new(0x44, 0x77, 0xaa),
    Color::new(0xee, 0x66, 0x77),
    Color::new(0x22, 0x88, 0x33),
    Color::new(0xaa, 0x33, 0x77),
    Color::new(0xcc, 0xbb, 0x44),
    Color::new(0x66, 0xcc, 0xee),
    Color::new(0x55, 0x55, 0x55),
    Color::new(0xbb, 0xbb, 0xbb),
];

/// How the points of one class look.
#[derive(Clone, Debug, PartialEq)]
pub struct ClassStyle {
    /// Which colour of the palette.
    pub color: usize,
    /// Which shape.
    pub glyph: Glyph,
}

/// Classes whose name says what they look like.
const KNOWN: [(&str, &str, usize); 9] = [
    ("tree", "tree", 2),
    ("house", "house", 1),
    ("flower", "star", 3),
    ("star", "star", 4),
    ("bee", "disk", 4),
    ("bush", "disk", 7),
    ("stone", "diamond", 6),
    ("arrow", "arrow", 0),
    ("boat", "arrow", 0),
];

/// Shapes of the classes whose name says nothing.
const SHAPES: [&str; 4] = ["disk", "square", "triangle", "diamond"];

/// The look of classes by their names, nothing else being said: what their name says, else eight colours and four
/// shapes by turns, no two of sixteen alike. Where points have a radius all are disks, which show it best, and rings
/// from the ninth class on.
#[must_use]
pub fn class_styles(names: &[String], radius: bool) -> Vec<ClassStyle> {
    let known = |name: &str| {
        let name = name.to_ascii_lowercase();
        KNOWN.iter().find(|(word, ..)| name.strip_prefix(word).is_some_and(|rest| ["", "s", "es"].contains(&rest)))
    };
    let taken: Vec<usize> = names.iter().filter_map(|name| known(name)).map(|known| known.2).collect();
    // The colours nobody asked for by name come first; with more than eight classes all go round again.
    let free: Vec<usize> = (0..PALETTE.len()).filter(|color| !taken.contains(color)).chain(0..PALETTE.len()).collect();
    let mut next = 0;
    let style = |name: &String| {
        let (color, shape) = match known(name) {
            Some(&(_, shape, color)) => (color, shape),
            None => {
                let number = next;
                next += 1;
                (free[number % free.len()], SHAPES[(number + number / PALETTE.len()) % SHAPES.len()])
            }
        };
        let shape = match (radius, next > PALETTE.len()) {
            (false, _) => shape,
            (true, false) => "disk",
            (true, true) => "ring",
        };
        ClassStyle { color, glyph: Glyph::built_in(shape).unwrap_or(Glyph::Disk) }
    };
    names.iter().map(style).collect()
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
    /// Colours of the classes.
    pub palette: Palette,
    /// Names of classes and the glyphs chosen for them; the others look as [`class_styles`] says.
    pub glyphs: Vec<(String, Glyph)>,
}

impl Default for Look {
    fn default() -> Self {
        Self {
            background: Some(Color::WHITE),
            frame: Some(Color::new(0xd4, 0xd8, 0xde)),
            margin: 0.03,
            disk: 0.28,
            palette: Palette::default(),
            glyphs: Vec::new(),
        }
    }
}

/// One glyph, in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Mark {
    pub(crate) center: DVec2,
    pub(crate) radius: f64,
    /// Degrees, counter-clockwise as one sees it.
    pub(crate) turn: f64,
    pub(crate) class: u16,
}

/// What the marks of a class have in common.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Painted {
    pub(crate) name: String,
    pub(crate) color: Color,
    pub(crate) glyph: Glyph,
}

/// A pattern laid out in pixels; y points down, as on the page.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Layout {
    /// Upper left corner of the domain.
    pub(crate) min: DVec2,
    /// Size of the domain.
    pub(crate) size: DVec2,
    /// In the order they are drawn: from behind to the front, and of one depth class after class.
    pub(crate) marks: Vec<Mark>,
    /// One a class.
    pub(crate) classes: Vec<Painted>,
    /// Whether glyphs end at the domain's border: a tile shows what comes in from the other side instead.
    pub(crate) clipped: bool,
    /// The colour around every glyph, where some stand before others.
    pub(crate) halo: Option<Color>,
    /// Width of the frame and the thinnest ring.
    pub(crate) line: f64,
}

/// What the attributes of a pattern say about its look; each list is empty or has one value a point.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct AttributeLook {
    /// Radii in exemplar units, from [`RADIUS_ATTRIBUTE`].
    pub radii: Vec<f64>,
    /// Sizes against the mean, from [`SCALE_ATTRIBUTE`].
    pub scales: Vec<f64>,
    /// Degrees, from [`ORIENTATION_ATTRIBUTE`].
    pub turns: Vec<f64>,
    /// From [`DEPTH_ATTRIBUTE`]: the greater, the farther behind.
    pub depths: Vec<f64>,
}

fn values<'a>(pattern: &'a PointPattern, name: &str) -> Option<&'a [f64]> {
    pattern.attributes().iter().find(|attribute| attribute.name == name).map(|attribute| &*attribute.values)
}

/// The look of a pattern's points in the units of its exemplar, which may be the pattern itself: as long as classes
/// are missing from an output, its own mean scale would be another.
#[must_use]
pub fn attribute_look(pattern: &PointPattern, exemplar: &PointPattern) -> AttributeLook {
    let unit = exemplar.domain().exemplar_unit();
    let list = |name, change: &dyn Fn(f64) -> f64| -> Vec<f64> {
        values(pattern, name).map_or(Vec::new(), |values| values.iter().map(|&value| change(value)).collect())
    };
    let mean = values(exemplar, SCALE_ATTRIBUTE).map(|values| values.iter().sum::<f64>() / values.len() as f64);
    AttributeLook {
        // Nothing is wider than the domain.
        radii: list(RADIUS_ATTRIBUTE, &|value| (value / unit).clamp(0.0, 0.5)),
        scales: match mean {
            Some(mean) if mean > 0.0 => list(SCALE_ATTRIBUTE, &|value| (value / mean).clamp(0.05, 20.0)),
            _ => Vec::new(),
        },
        turns: list(ORIENTATION_ATTRIBUTE, &|value| value),
        depths: list(DEPTH_ATTRIBUTE, &|value| value),
    }
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

    let attributes = attribute_look(pattern, pattern);
    let names = pattern.class_names();
    let classes: Vec<Painted> = class_styles(names, !attributes.radii.is_empty())
        .into_iter()
        .zip(names)
        .map(|(style, name)| Painted {
            name: name.clone(),
            color: look.palette.color(style.color),
            glyph: look.glyphs.iter().find(|(class, _)| class == name).map_or(style.glyph, |(_, glyph)| glyph.clone()),
        })
        .collect();
    // A lone point gets a disk one can see; nothing is ever thinner than a third of a pixel.
    let common = pattern.mean_spacing().map_or(0.02, |spacing| (spacing * look.disk).min(0.04));
    let positions = pattern.positions_in_exemplar_units();
    // Class after class, and within that from behind to the front: two stable sorts, the more important one last.
    let by_class = crate::sorting::order(pattern.classes().iter().map(|&class| f64::from(class)));
    let by_depth = crate::sorting::order(by_class.iter().map(|&i| -attributes.depths.get(i).copied().unwrap_or(0.0)));
    let mut marks = Vec::with_capacity(pattern.len());
    for i in by_depth.into_iter().map(|place| by_class[place]) {
        let radius = match (attributes.radii.get(i), attributes.scales.get(i)) {
            (Some(&radius), _) => radius,
            (None, scale) => common * scale.copied().unwrap_or(1.0),
        };
        let mark = Mark {
            center: frame_min + positions[i] * scale,
            radius: (radius * scale).max(0.35),
            turn: attributes.turns.get(i).copied().unwrap_or(0.0),
            class: pattern.classes()[i],
        };
        marks.push(mark);
        if clipped {
            let reach = classes.get(usize::from(mark.class)).map_or(1.0, |class| class.glyph.reach());
            push_copies(&mut marks, mark, reach * mark.radius, frame_min, frame_size);
        }
    }
    let halo = look.background.filter(|_| !attributes.depths.is_empty());
    let line = (size.max_element() / 800.0).max(0.5);
    Layout { min: frame_min, size: frame_size, marks, classes, clipped, halo, line }
}

/// What of a tile's glyph comes in from the other sides.
fn push_copies(marks: &mut Vec<Mark>, mark: Mark, reach: f64, min: DVec2, size: DVec2) {
    let max = min + size;
    for column in [-1.0, 0.0, 1.0] {
        for row in [-1.0, 0.0, 1.0] {
            let center = mark.center + DVec2::new(column, row) * size;
            let touches = (center + reach).cmpgt(min).all() && (center - reach).cmplt(max).all();
            if (column != 0.0 || row != 0.0) && touches {
                marks.push(Mark { center, ..mark });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pattern::Domain;

    #[test]
    fn sixteen_classes_look_different() {
        let names: Vec<String> = (0..16).map(|class| format!("class {class}")).collect();
        for radius in [false, true] {
            let styles = class_styles(&names, radius);
            for (i, style) in styles.iter().enumerate() {
                assert!(!styles[..i].contains(style), "class {i} looks like an earlier one");
                assert!(!radius || ["disk", "ring"].contains(&style.glyph.name()));
            }
        }
    }

    #[test]
    fn names_say_what_classes_look_like() {
        let names = ["Houses", "anything", "tree", "treeline", "bushes"].map(str::to_owned);
        let styles = class_styles(&names, false);
        let look: Vec<(&str, usize)> = styles.iter().map(|style| (style.glyph.name(), style.color)).collect();
        assert_eq!(look, [("house", 1), ("disk", 0), ("tree", 2), ("square", 3), ("disk", 7)]);
        for (_, shape, _) in KNOWN {
            assert!(Glyph::from_name(shape).is_ok(), "{shape}");
        }
        assert!(Glyph::names().iter().all(|name| Glyph::from_name(name).is_ok()));
        let message = Glyph::from_name("hut").err().map(|error| error.to_string()).unwrap_or_default();
        assert!(message.contains("\"hut\"") && message.contains("disk, ring, square"), "{message}");
        for palette in Palette::ALL {
            assert_eq!(Palette::from_name(palette.name()), Some(palette));
        }
    }

    #[test]
    fn glyphs_weigh_the_same() {
        for glyph in Glyph::all() {
            if let Glyph::Polygon(polygon) = glyph {
                let corners = polygon.corners;
                let cross = |i: usize| {
                    let ([x0, y0], [x1, y1]) = (corners[i], corners[(i + 1) % corners.len()]);
                    x0 * y1 - x1 * y0
                };
                let area = 0.5 * (0..corners.len()).map(cross).sum::<f32>().abs();
                assert!((2.4..3.6).contains(&area), "{} has an area of {area}", polygon.name);
                let farthest = corners.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f32::max);
                assert!(f64::from(farthest) <= glyph.reach(), "{} reaches {farthest}", polygon.name);
            }
        }
    }

    #[test]
    fn what_is_deep_is_drawn_first() -> Result<(), crate::PatternError> {
        use crate::pattern::Attribute;
        let places = vec![DVec2::splat(0.1), DVec2::splat(0.5), DVec2::splat(0.9)];
        let pattern = PointPattern::new(Domain::UNIT, places)?
            .with_classes(vec![1, 0, 1], vec!["a".to_owned(), "b".to_owned()])?
            .with_attribute(Attribute { name: "scale".to_owned(), values: vec![1.0, 2.0, 6.0] })?
            .with_attribute(Attribute { name: "orientation".to_owned(), values: vec![90.0, 0.0, 45.0] })?;
        let lay_out = |pattern: &PointPattern| lay_out(pattern, DVec2::ZERO, DVec2::splat(106.0), &Look::default());
        let flat = lay_out(&pattern);
        let places = |layout: &Layout| layout.marks.iter().map(|mark| mark.center.x.round()).collect::<Vec<_>>();
        assert_eq!((places(&flat), flat.halo), (vec![53.0, 13.0, 93.0], None));
        let radii: Vec<f64> = flat.marks.iter().map(|mark| mark.radius).collect();
        assert!((radii[1] * 2.0 - radii[0]).abs() < 1e-9 && (radii[1] * 6.0 - radii[2]).abs() < 1e-9, "{radii:?}");
        assert_eq!(flat.marks.iter().map(|mark| mark.turn).collect::<Vec<_>>(), [0.0, 90.0, 45.0]);
        let depths = Attribute { name: "depth".to_owned(), values: vec![0.5, 0.1, 0.9] };
        let deep = lay_out(&pattern.with_attribute(depths)?);
        assert_eq!((places(&deep), deep.halo), (vec![93.0, 13.0, 53.0], Some(Color::WHITE)));
        Ok(())
    }

    #[test]
    fn a_tile_shows_what_comes_in_from_the_other_side() -> Result<(), crate::PatternError> {
        let corner = PointPattern::new(Domain::UNIT, vec![DVec2::ZERO, DVec2::splat(0.5)])?;
        let look = Look::default();
        assert_eq!(lay_out(&corner, DVec2::ZERO, DVec2::splat(100.0), &look).marks.len(), 2);
        let tile = lay_out(&corner.with_boundary(Boundary::Periodic), DVec2::ZERO, DVec2::splat(100.0), &look);
        assert_eq!(tile.marks.len(), 5);
        assert!(tile.clipped);
        Ok(())
    }
}
