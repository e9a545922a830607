//! Which of the shapes that one sees are marks of a pattern, and what is said of the rest.
//!
//! Circles come first. Paths that are circles, and lines without a length but with round ends, are marks as well when they
//! are about as large. Other small areas are marks when there are no circles, or when there are many with straight sides
//! that are as large as the circles: a chart with disks, squares and triangles. What is large against the page, or long,
//! is no mark: frames, backgrounds, axes, bars.

use glam::DVec2;

use crate::formats::Note;
use crate::formats::note::counted;

/// Largest reach of a mark that is no circle, against the page's longer side.
const MAX_REACH: f64 = 0.1;
/// Reach from which a circle is a frame or a background, against the page's longer side, where it is also so many times as
/// large as the median of at least so many circles: a dish, the rim of a chart.
const FRAME_REACH: f64 = 0.25;
const FRAME_TIMES: f64 = 5.0;
const FRAME_CIRCLES: usize = 5;
/// How many times as large or small as the circles a circle in disguise may be.
const LIKE_CIRCLES: f64 = 3.0;
/// How many times as large or small as their median marks without circles may be.
const LIKE_MEDIAN: f64 = 5.0;
/// How many times as large or small as the circles other marks may be.
const BESIDE_CIRCLES: f64 = 2.0;
/// Fewest marks with the same corners beside circles, as one of so many circles: a key to the colours has fewer.
const FEW_BESIDE_CIRCLES: usize = 5;
const MIN_BESIDE_CIRCLES: usize = 3;
/// Most corners of a mark beside circles: a plus has twelve, letters have curves.
const MAX_CORNERS: usize = 12;
/// Most marks that are no areas of other kinds, for areas to be looked at as if they were alone.
const STRAY: usize = 2;

/// What a shape is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    /// A circle or ellipse, or a glyph of our own.
    Circle,
    /// Another shape in the form of an ellipse.
    Round,
    /// A line of no length with ends.
    Dot,
    /// Another area.
    Area {
        /// How many, where all sides are straight.
        corners: Option<usize>,
    },
    /// A place without a size: a circle of radius 0, or a line of no length that ends where it ends.
    Point,
}

/// A shape that one sees, on the page.
#[derive(Clone, Debug)]
pub(super) struct Found {
    /// First byte of the element.
    pub(super) at: usize,
    pub(super) position: DVec2,
    pub(super) radius: f64,
    /// Half its longer side.
    pub(super) reach: f64,
    pub(super) kind: Kind,
    /// The class, by its number.
    pub(super) class: usize,
}

/// How much was left out, and why.
#[derive(Debug, Default)]
pub(super) struct LeftOut {
    /// Outside a clip path or a nested drawing's box.
    pub(super) clipped: usize,
    pub(super) hidden: usize,
    pub(super) transparent: usize,
    pub(super) unpainted: usize,
    /// Made flat by a transform, or beyond what a double can tell.
    pub(super) flat: usize,
    pub(super) texts: usize,
    pub(super) images: usize,
    /// Of other files, or nowhere.
    pub(super) elsewhere: usize,
    pub(super) lines: usize,
    /// Shapes with signs on them.
    pub(super) markers: usize,
    /// Areas that are no marks.
    pub(super) areas: usize,
    pub(super) points: usize,
    /// Taken, although a mask may hide them.
    pub(super) masked: usize,
    pub(super) unclear_clips: usize,
    pub(super) unclear_origins: usize,
}

/// Keeps the marks; `side` is the page's longer one. What is not kept is counted.
pub(super) fn choose(found: &mut Vec<Found>, side: f64, left: &mut LeftOut, notes: &mut Vec<Note>) {
    let all = found.len();
    if let Some(median) = median(found, |kind| kind == Kind::Circle, FRAME_CIRCLES) {
        let is_frame = |mark: &Found| mark.reach > FRAME_REACH * side && mark.radius > FRAME_TIMES * median;
        found.retain(|mark| !(mark.kind == Kind::Circle && is_frame(mark)));
    }
    left.areas += all - found.len();
    let is_small = |mark: &Found| mark.kind == Kind::Circle || mark.reach <= MAX_REACH * side;
    let circles = range(found, |kind| kind == Kind::Circle).map(|range| widened(range, LIKE_CIRCLES));
    let disguised = |kind| matches!(kind, Kind::Round | Kind::Dot);
    let small: Vec<Found> = found.iter().filter(|mark| is_small(mark)).cloned().collect();
    let like_circles = circles.or_else(|| median_range(&small, disguised));
    let is_primary = |mark: &Found| match mark.kind {
        Kind::Circle => true,
        kind => disguised(kind) && is_small(mark) && like_circles.is_some_and(|range| is_in(mark, range)),
    };
    let primary: Vec<Found> = found.iter().filter(|mark| is_primary(mark)).cloned().collect();
    let is_area = |kind| matches!(kind, Kind::Area { .. });
    let areas = if primary.len() <= STRAY {
        let range = median_range(&small, is_area);
        let alike = small.iter().filter(|mark| is_area(mark.kind) && range.is_some_and(|range| is_in(mark, range)));
        // One square beside one circle is no pattern of squares.
        range.filter(|_| primary.is_empty() || alike.count() > FEW_BESIDE_CIRCLES * primary.len())
    } else {
        None
    };
    let beside = range(&primary, |_| true).map(|range| widened(range, BESIDE_CIRCLES));
    let corners_of = |mark: &Found| match mark.kind {
        Kind::Area { corners: Some(corners) } if corners <= MAX_CORNERS => {
            (is_small(mark) && beside.is_some_and(|range| is_in(mark, range))).then_some(corners)
        }
        _ => None,
    };
    let mut counts = [0_usize; MAX_CORNERS + 1];
    found.iter().filter_map(corners_of).for_each(|corners| counts[corners] += 1);
    let enough = MIN_BESIDE_CIRCLES.max(primary.len().div_ceil(FEW_BESIDE_CIRCLES));
    let is_mark = |mark: &Found| {
        is_primary(mark)
            || is_area(mark.kind)
                && (is_small(mark) && areas.is_some_and(|range| is_in(mark, range))
                    || corners_of(mark).is_some_and(|corners| counts[corners] >= enough))
    };
    let mut marks: Vec<Found> = found.iter().filter(|mark| is_mark(mark)).cloned().collect();
    let points = found.iter().filter(|mark| mark.kind == Kind::Point);
    if marks.is_empty() {
        marks = points.cloned().collect();
        if !marks.is_empty() {
            let text = counted(
                marks.len(),
                "One circle or line without a size was taken as a point.",
                "circles or lines without a size were taken as points. They have no radii.",
            );
            notes.push(Note::changed(text));
        }
    } else {
        left.points = points.count();
    }
    left.areas += found.iter().filter(|mark| mark.kind != Kind::Point).count()
        - marks.iter().filter(|mark| mark.kind != Kind::Point).count();
    let count = |is: &dyn Fn(Kind) -> bool| marks.iter().filter(|mark| is(mark.kind)).count();
    let mut say = |count: usize, one: &str, many: &str| {
        if count > 0 {
            notes.push(Note::changed(counted(count, one, many)));
        }
    };
    say(
        count(&|kind| kind == Kind::Round),
        "One path in the form of a circle was taken as a circle.",
        "paths in the form of circles were taken as circles.",
    );
    say(
        count(&|kind| kind == Kind::Dot),
        "One line without a length was taken as a dot, as wide as the line.",
        "lines without a length were taken as dots, as wide as the lines.",
    );
    say(
        count(&is_area),
        "One small shape was taken as a point at its centroid, with the radius of a disk of the same area.",
        "small shapes were taken as points at their centroids, with the radii of disks of the same areas.",
    );
    *found = marks;
}

type Range = (f64, f64);

fn is_in(mark: &Found, (low, high): Range) -> bool {
    (low..=high).contains(&mark.radius)
}

fn widened((low, high): Range, times: f64) -> Range {
    (low / times, high * times)
}

/// Smallest and largest radius.
fn range(found: &[Found], is: impl Fn(Kind) -> bool) -> Option<Range> {
    let radii = || found.iter().filter(|mark| is(mark.kind)).map(|mark| mark.radius);
    let (low, high) = (radii().fold(f64::INFINITY, f64::min), radii().fold(0.0, f64::max));
    (low <= high).then_some((low, high))
}

/// The median of the radii, where there are at least so many.
fn median(found: &[Found], is: impl Fn(Kind) -> bool, at_least: usize) -> Option<f64> {
    let mut radii: Vec<f64> = found.iter().filter(|mark| is(mark.kind)).map(|mark| mark.radius).collect();
    radii.sort_by(f64::total_cmp);
    radii.get(radii.len() / 2).copied().filter(|_| radii.len() >= at_least)
}

/// Around the median of the radii.
fn median_range(found: &[Found], is: impl Fn(Kind) -> bool) -> Option<Range> {
    median(found, is, 1).map(|median| widened((median, median), LIKE_MEDIAN))
}

impl LeftOut {
    /// What is said of it, with what one can do.
    pub(super) fn notes(&self, notes: &mut Vec<Note>) {
        let mut say = |count: usize, one: &str, many: &str, advice: &str| {
            if count > 0 {
                notes.push(Note::left_out(format!("{}{advice}", counted(count, one, many))));
            }
        };
        say(
            self.clipped,
            "One mark outside a clip path or the box of a nested drawing is not seen, and was left out.",
            "marks outside clip paths or the boxes of nested drawings are not seen, and were left out.",
            " To keep them, release the clip in the drawing program.",
        );
        say(
            self.transparent,
            "One shape is transparent, and was left out.",
            "shapes are transparent, and were left out.",
            "",
        );
        say(
            self.hidden,
            "One hidden shape was left out.",
            "hidden shapes were left out.",
            " To keep them, show their layer.",
        );
        say(
            self.unpainted,
            "One shape without fill and stroke was left out.",
            "shapes without fill and stroke were left out.",
            "",
        );
        say(
            self.points + self.flat,
            "One circle or line without a size was left out.",
            "circles or lines without a size were left out.",
            "",
        );
        say(
            self.areas,
            "One shape that is too large or unlike the marks was left out.",
            "shapes that are too large or unlike the marks were left out.",
            " To keep them, make circles of them.",
        );
        say(self.lines, "One line was left out.", "lines were left out.", "");
        say(
            self.markers,
            "One line has markers, which were left out.",
            "lines have markers, which were left out.",
            " To keep them, make circles of them.",
        );
        say(self.texts, "One text was left out.", "texts were left out.", "");
        say(self.images, "One picture in it was left out.", "pictures in it were left out.", "");
        say(
            self.elsewhere,
            "One reference to another file, or to nothing, was left out.",
            "references to other files, or to nothing, were left out.",
            "",
        );
        let mut odd = |count: usize, one: &str, many: &str| {
            if count > 0 {
                notes.push(Note::odd(counted(count, one, many)));
            }
        };
        odd(
            self.masked,
            "One mark lies under a mask, which may hide it. Masks are not looked at.",
            "marks lie under masks, which may hide them. Masks are not looked at.",
        );
        odd(
            self.unclear_clips,
            "One clip (by a function, a text or the box around a group) was passed over: there may be more points than one sees.",
            "clips (by functions, texts or the boxes around groups) were passed over: there may be more points than one sees.",
        );
        odd(
            self.unclear_origins,
            "One group turns about its own box, and was taken to turn about the origin: check where its points are.",
            "groups turn about their own boxes, and were taken to turn about the origin: check where their points are.",
        );
    }

    /// Shapes that one sees and that are no marks.
    pub(super) fn others(&self) -> usize {
        self.areas + self.lines + self.images + self.elsewhere
    }
}
