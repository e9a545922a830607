//! Path data of SVG (SVG 2, §9.3), as a person may give it for a glyph: read strictly, never passed on as it came.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::fmt::Write as _;

use glam::DVec2;
use thiserror::Error;

use super::svg::Px;

/// Most characters of path data.
pub const MAX_PATH_LENGTH: usize = 4000;
/// Most lines and curves of a path.
pub const MAX_PATH_SEGMENTS: usize = 500;
/// Largest coordinate.
const MAX_COORDINATE: f64 = 1e6;
/// The same of a drawing.
const MAX_DRAWING_COORDINATE: f64 = 1e12;
/// Points of a curve looked at for its extent.
const SAMPLES: u32 = 16;

/// Why path data can't be used. Positions count characters from 1.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum OutlineError {
    /// Longer than anything a glyph needs.
    #[error("the path has {length} characters; at most {MAX_PATH_LENGTH} are allowed")]
    TooLong {
        /// How many characters it has.
        length: usize,
    },
    /// Something else was needed.
    #[error("position {position} of the path: {found} where {wanted} is needed")]
    Unexpected {
        /// Which character.
        position: usize,
        /// What stands there.
        found: String,
        /// What should.
        wanted: &'static str,
    },
    /// A number too large, or too many lines and curves.
    #[error("position {position} of the path: {reason}")]
    Excess {
        /// Which character.
        position: usize,
        /// What is too much.
        reason: &'static str,
    },
    /// Nothing to fill.
    #[error("the path has hardly any width or height, so there is nothing to fill")]
    Flat,
}

/// A step of an outline; all coordinates are absolute.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Segment {
    Move(DVec2),
    Line(DVec2),
    /// Two control points and the end.
    Curve(DVec2, DVec2, DVec2),
    Close,
}

/// A shape to be filled, fitted into the square from −1 to 1, its middle in
/// the middle.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline(Vec<Segment>);

impl Outline {
    /// Reads path data: all commands of SVG, arcs included; y points down.
    ///
    /// # Errors
    /// At the first character that is not path data, with anything over the caps, and without an area.
    pub fn parse(text: &str) -> Result<Self, OutlineError> {
        let length = text.chars().count();
        if length > MAX_PATH_LENGTH {
            return Err(OutlineError::TooLong { length });
        }
        let mut reader = Reader::new(text, MAX_PATH_SEGMENTS, MAX_COORDINATE);
        reader.path()?;
        fitted(reader.segments)
    }

    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn segments(&self) -> &[Segment] {
        &self.0
    }

    /// Path data of this outline, made of absolute `M`, `L`, `C` and `Z` alone.
    #[must_use]
    pub fn path_data(&self) -> String {
        let mut data = String::new();
        // Writing to a String can't fail, so the results of `write!` are dropped.
        for segment in &self.0 {
            let _ = match *segment {
                Segment::Move(p) => write!(data, "M{}", Pair(p)),
                Segment::Line(p) => write!(data, "L{}", Pair(p)),
                Segment::Curve(a, b, p) => write!(data, "C{} {} {}", Pair(a), Pair(b), Pair(p)),
                Segment::Close => write!(data, "Z"),
            };
        }
        data
    }
}

/// The lines and curves of the path of a drawing, as far as they can be read: browsers draw them up to the first error too.
/// There are at most `max_segments`.
pub(super) fn read_segments(text: &str, max_segments: usize) -> Vec<Segment> {
    let mut reader = Reader::new(text, max_segments, MAX_DRAWING_COORDINATE);
    // What was read before an error stays.
    let _ = reader.path();
    reader.segments
}

/// An ellipse, from its rightmost point, as four curves; each is off by at most 0.03 % of the radius.
pub(super) fn ellipse_segments(center: DVec2, radii: DVec2) -> Vec<Segment> {
    // Where the curve's middle lies on the circle.
    const HANDLE: f64 = 0.552_284_749_830_793_4;
    let place = |p: DVec2| center + p * radii;
    let mut segments = vec![Segment::Move(place(DVec2::X))];
    let mut from = DVec2::X;
    for _ in 0..4 {
        let to = from.perp();
        segments.push(Segment::Curve(place(from + HANDLE * to), place(to + HANDLE * from), place(to)));
        from = to;
    }
    segments.push(Segment::Close);
    segments
}

/// `x y`.
pub(super) struct Pair(pub(super) DVec2);

impl std::fmt::Display for Pair {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} {}", Px(self.0.x), Px(self.0.y))
    }
}

fn fitted(mut segments: Vec<Segment>) -> Result<Outline, OutlineError> {
    let (mut low, mut high, mut from) = (DVec2::INFINITY, DVec2::NEG_INFINITY, DVec2::ZERO);
    let mut see = |p: DVec2| (low, high) = (low.min(p), high.max(p));
    for segment in &segments {
        match *segment {
            Segment::Move(p) | Segment::Line(p) => {
                see(p);
                from = p;
            }
            Segment::Curve(a, b, p) => {
                for step in 1..=SAMPLES {
                    let t = f64::from(step) / f64::from(SAMPLES);
                    let s = 1.0 - t;
                    see(s * s * s * from + 3.0 * s * s * t * a + 3.0 * s * t * t * b + t * t * t * p);
                }
                from = p;
            }
            Segment::Close => {}
        }
    }
    let (middle, size) = (0.5 * (low + high), high - low);
    // An empty path has a size that is not a number. Thinner shapes vanish in drawing.
    if !size.is_finite() || size.min_element() <= 0.01 * size.max_element() {
        return Err(OutlineError::Flat);
    }
    let place = |p: &mut DVec2| *p = (*p - middle) * (2.0 / size.max_element());
    for segment in &mut segments {
        match segment {
            Segment::Move(p) | Segment::Line(p) => place(p),
            Segment::Curve(a, b, p) => [a, b, p].into_iter().for_each(place),
            Segment::Close => {}
        }
    }
    Ok(Outline(segments))
}

struct Reader<'a> {
    text: &'a [u8],
    at: usize,
    segments: Vec<Segment>,
    max_segments: usize,
    max_coordinate: f64,
}

impl<'a> Reader<'a> {
    fn new(text: &'a str, max_segments: usize, max_coordinate: f64) -> Self {
        Self { text: text.as_bytes(), at: 0, segments: Vec::new(), max_segments, max_coordinate }
    }

    fn unexpected(&self, wanted: &'static str) -> OutlineError {
        // What is before was read, hence ASCII: bytes are characters up to here.
        let rest = std::str::from_utf8(&self.text[self.at..]).unwrap_or_default();
        let found = rest.chars().next().map_or("the end".to_owned(), |found| format!("{found:?}"));
        OutlineError::Unexpected { position: self.at + 1, found, wanted }
    }

    fn excess(&self, at: usize, reason: &'static str) -> OutlineError {
        OutlineError::Excess { position: at + 1, reason }
    }

    fn peek(&self) -> Option<u8> {
        self.text.get(self.at).copied()
    }

    fn blanks(&mut self) {
        while matches!(self.peek(), Some(b' ' | b'\t' | b'\n' | b'\r' | b'\x0c')) {
            self.at += 1;
        }
    }

    /// Blanks with at most one comma among them.
    fn separator(&mut self) {
        self.blanks();
        if self.peek() == Some(b',') {
            self.at += 1;
            self.blanks();
        }
    }

    fn digits(&mut self) -> bool {
        let from = self.at;
        while matches!(self.peek(), Some(b'0'..=b'9')) {
            self.at += 1;
        }
        self.at > from
    }

    fn number(&mut self) -> Result<f64, OutlineError> {
        let from = self.at;
        if matches!(self.peek(), Some(b'+' | b'-')) {
            self.at += 1;
        }
        let mut any = self.digits();
        if self.peek() == Some(b'.') {
            self.at += 1;
            any |= self.digits();
        }
        if !any {
            return Err(self.unexpected("a number"));
        }
        if matches!(self.peek(), Some(b'e' | b'E')) {
            self.at += 1;
            if matches!(self.peek(), Some(b'+' | b'-')) {
                self.at += 1;
            }
            if !self.digits() {
                return Err(self.unexpected("an exponent"));
            }
        }
        let value: f64 = std::str::from_utf8(&self.text[from..self.at]).unwrap_or_default().parse().unwrap_or(f64::NAN);
        if value.is_nan() || value.abs() > self.max_coordinate {
            return Err(self.excess(from, "a number beyond a million"));
        }
        Ok(value)
    }

    fn next_number(&mut self) -> Result<f64, OutlineError> {
        self.separator();
        self.number()
    }

    fn pair(&mut self) -> Result<DVec2, OutlineError> {
        Ok(DVec2::new(self.next_number()?, self.next_number()?))
    }

    /// The flags of an arc need no separator behind them.
    fn flag(&mut self) -> Result<bool, OutlineError> {
        self.separator();
        let flag = self.peek();
        if !matches!(flag, Some(b'0' | b'1')) {
            return Err(self.unexpected("a flag, 0 or 1,"));
        }
        self.at += 1;
        Ok(flag == Some(b'1'))
    }

    fn push(&mut self, segment: Segment) -> Result<(), OutlineError> {
        if self.segments.len() >= self.max_segments {
            return Err(self.excess(self.at - 1, "more than 500 lines and curves"));
        }
        self.segments.push(segment);
        Ok(())
    }

    fn path(&mut self) -> Result<(), OutlineError> {
        let (mut here, mut start) = (DVec2::ZERO, DVec2::ZERO);
        // Of the command before, where it was a curve of that kind: what S and T mirror.
        let (mut cubic, mut quadratic) = (None, None);
        self.blanks();
        while let Some(letter) = self.peek() {
            let first = self.segments.is_empty();
            if first && !matches!(letter, b'M' | b'm') {
                return Err(self.unexpected("M or m, which begin a path,"));
            }
            let mut command = letter.to_ascii_uppercase();
            if !b"MLHVCSQTAZ".contains(&command) {
                return Err(self.unexpected("a command (one of M L H V C S Q T A Z)"));
            }
            self.at += 1;
            if command == b'Z' {
                self.push(Segment::Close)?;
                here = start;
                (cubic, quadratic) = (None, None);
                self.blanks();
                continue;
            }
            loop {
                let origin = if letter.is_ascii_lowercase() { here } else { DVec2::ZERO };
                let (mut next_cubic, mut next_quadratic) = (None, None);
                let end = match command {
                    b'M' | b'L' => origin + self.pair()?,
                    b'H' => DVec2::new(origin.x + self.next_number()?, here.y),
                    b'V' => DVec2::new(here.x, origin.y + self.next_number()?),
                    b'C' | b'S' => {
                        let a = match cubic {
                            _ if command == b'C' => origin + self.pair()?,
                            Some(before) => 2.0 * here - before,
                            None => here,
                        };
                        let b = origin + self.pair()?;
                        let end = origin + self.pair()?;
                        self.push(Segment::Curve(a, b, end))?;
                        next_cubic = Some(b);
                        end
                    }
                    b'Q' | b'T' => {
                        let control = match quadratic {
                            _ if command == b'Q' => origin + self.pair()?,
                            Some(before) => 2.0 * here - before,
                            None => here,
                        };
                        let end = origin + self.pair()?;
                        // The same curve as a cubic one.
                        self.push(Segment::Curve(here.lerp(control, 2.0 / 3.0), end.lerp(control, 2.0 / 3.0), end))?;
                        next_quadratic = Some(control);
                        end
                    }
                    _ => {
                        let radii = self.pair()?;
                        let turn = self.next_number()?.to_radians();
                        let (large, sweep) = (self.flag()?, self.flag()?);
                        let end = origin + self.pair()?;
                        self.arc(here, radii.abs(), turn, large, sweep, end)?;
                        end
                    }
                };
                match command {
                    b'M' => {
                        self.push(Segment::Move(end))?;
                        start = end;
                        // Further pairs are lines.
                        command = b'L';
                    }
                    b'L' | b'H' | b'V' => self.push(Segment::Line(end))?,
                    _ => {}
                }
                (here, cubic, quadratic) = (end, next_cubic, next_quadratic);
                self.blanks();
                match self.peek() {
                    Some(b',' | b'+' | b'-' | b'.' | b'0'..=b'9') => {}
                    _ => break,
                }
            }
        }
        Ok(())
    }

    /// An elliptical arc as cubic curves of a quarter each at most (SVG 2, §B.2.4: from end points to a centre).
    fn arc(
        &mut self,
        from: DVec2,
        radii: DVec2,
        turn: f64,
        large: bool,
        sweep: bool,
        to: DVec2,
    ) -> Result<(), OutlineError> {
        if radii.min_element() == 0.0 || from == to {
            return self.push(Segment::Line(to));
        }
        let along = DVec2::new(libm::cos(turn), libm::sin(turn));
        let half = DVec2::new(along.x, -along.y).rotate(0.5 * (from - to)) / radii;
        // Radii too small to reach grow until they do.
        let reach = half.length().max(1.0);
        let radii = radii * reach;
        let half = half / reach;
        let side = if large == sweep { -1.0 } else { 1.0 };
        let centre = side * ((1.0 / half.length_squared() - 1.0).max(0.0)).sqrt() * DVec2::new(half.y, -half.x);
        let angle = |p: DVec2| libm::atan2(p.y, p.x);
        let begin = angle(half - centre);
        let mut sweep_angle = angle(-half - centre) - begin;
        if sweep && sweep_angle < 0.0 {
            sweep_angle += TAU;
        } else if !sweep && sweep_angle > 0.0 {
            sweep_angle -= TAU;
        }
        let middle = 0.5 * (from + to) + along.rotate(centre * radii);
        let pieces = libm::ceil(sweep_angle.abs() / FRAC_PI_2 - 1e-9).clamp(1.0, 4.0);
        let step = sweep_angle / pieces;
        let handle = 4.0 / 3.0 * libm::tan(step / 4.0);
        let place = |p: DVec2| middle + along.rotate(p * radii);
        for piece in 0..pieces as u32 {
            let unit = |angle: f64| DVec2::new(libm::cos(angle), libm::sin(angle));
            let (a, b) = (unit(begin + step * f64::from(piece)), unit(begin + step * f64::from(piece + 1)));
            let end = if f64::from(piece + 1) == pieces { to } else { place(b) };
            self.push(Segment::Curve(place(a + handle * a.perp()), place(b - handle * b.perp()), end))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may stop at the first surprise")]

    use super::*;

    fn data(text: &str) -> String {
        Outline::parse(text).unwrap().path_data()
    }

    #[test]
    fn commands_mean_the_same_in_every_spelling() {
        let square = "M-1 -1L1 -1L1 1L-1 1Z";
        for text in [
            "M0 0H10V10H0Z",
            "m5,5 10,0 0,10 -10,0z",
            " M 0 0 L10 0 L10,10 L 0 10 Z ",
            "M.5.5h1v1h-1z",
            "M0 0l1e1 0 0 10-10 0z",
            "M-5-5H5V5H-5Z",
        ] {
            assert_eq!(data(text), square, "{text}");
        }
        // A quadratic curve is the cubic one with the same end points and control points two thirds of the way.
        assert_eq!(data("M0 0Q10 20 20 0Z"), data("M0 0C6.6666666667 13.3333333333 13.3333333333 13.3333333333 20 0Z"));
        assert_eq!(data("M0 0Q5 9 10 0T20 0Z"), data("M0 0Q5 9 10 0Q15 -9 20 0Z"));
        assert_eq!(data("M0 0C0 5 5 9 10 0S20 -9 20 0Z"), data("M0 0C0 5 5 9 10 0C15 -9 20 -9 20 0Z"));
        assert_ne!(data("M0 0C0 5 5 9 10 0S20 -9 20 0Z"), data("M0 0C0 5 5 9 10 0C10 0 20 -9 20 0Z"));
        // The longer side fills the square, the other keeps its proportion.
        assert_eq!(data("M0 0H40V10H0Z"), "M-1 -0.25L1 -0.25L1 0.25L-1 0.25Z");
    }

    /// Points along an outline.
    fn walk(outline: &Outline) -> Vec<DVec2> {
        let (mut from, mut places) = (DVec2::ZERO, Vec::new());
        for segment in outline.segments() {
            if let Segment::Curve(a, b, p) = *segment {
                for step in 0..=8 {
                    let t = f64::from(step) / 8.0;
                    let (ab, bc, cd) = (from.lerp(a, t), a.lerp(b, t), b.lerp(p, t));
                    places.push(ab.lerp(bc, t).lerp(bc.lerp(cd, t), t));
                }
            }
            if let Segment::Move(p) | Segment::Line(p) | Segment::Curve(_, _, p) = *segment {
                from = p;
            }
        }
        places
    }

    #[test]
    fn arcs_are_round() {
        for text in [
            "M0 5A5 5 0 0 1 10 5A5 5 0 0 1 0 5Z",
            "M10 5a5 5 0 1 0-10 0a5 5 0 10 10 0z",
            "M0 5A1 1 0 0110 5A1 1 0 010 5",
        ] {
            let places = walk(&Outline::parse(text).unwrap());
            assert!(places.len() >= 36, "{text}: {}", places.len());
            assert!(places.iter().all(|p| (p.length() - 1.0).abs() < 1e-3), "{text}: {places:?}");
        }
        // Three quarters one way round, a quarter the other.
        let bend = |flags| walk(&Outline::parse(&format!("M10 0A10 10 0 {flags} 0 10L0 0Z")).unwrap());
        assert_eq!((bend("0 1").len(), bend("1 0").len()), (9, 27));
        // Turned by a quarter, the radii change places.
        let turned = Outline::parse("M0 4A4 8 90 0 1 16 4A4 8 90 0 1 0 4Z").unwrap();
        let plain = Outline::parse("M0 4A8 4 0 0 1 16 4A8 4 0 0 1 0 4Z").unwrap();
        for (a, b) in walk(&turned).iter().zip(walk(&plain)) {
            assert!(a.distance(b) < 1e-9);
        }
    }

    #[test]
    fn what_is_no_path_is_refused_where_it_goes_wrong() {
        let long = "M0 0".repeat(1001);
        let many = format!("M0 0{}", "l1 1 ".repeat(500));
        for (text, words) in [
            ("", "nothing to fill"),
            ("M0 0L5 0", "nothing to fill"),
            ("L0 0", "position 1 of the path: 'L' where M or m"),
            ("M0 0X5 5", "position 5 of the path: 'X' where a command"),
            ("M0 0L5", "position 7 of the path: the end where a number"),
            ("M0 0,,5", "position 6 of the path: ',' where a number"),
            ("M0 0L1 1e", "the end where an exponent"),
            ("M0 0A5 5 0 2 0 1 1", "position 12 of the path: '2' where a flag"),
            ("M0 0L1e9 5", "position 6 of the path: a number beyond"),
            ("M0 0L5 5\"/><script>", "position 9 of the path: '\"' where a command"),
            ("M0 0Lü 5", "position 6 of the path: 'ü' where a number"),
            ("M0 0L5 5;", "';' where a command"),
            (&long, "has 4004 characters"),
            (&many, "more than 500"),
        ] {
            let outcome = Outline::parse(text).map_err(|error| error.to_string());
            let message = outcome.err().unwrap_or_default();
            assert!(message.contains(words), "{text:.40} says {message:?}");
        }
        assert!(Outline::parse(&format!("M0 0{}", "l1 2 ".repeat(400))).is_ok());
    }

    #[test]
    fn any_text_is_read_or_refused() {
        let mut rng = crate::sampling::Rng::new(1, crate::sampling::Purpose::Gallery);
        let letters: Vec<char> = "MLHVCSQTAZmlhvcsqtaz0123456789.,-+eE \n\"<ü".chars().collect();
        let mut read = 0;
        for _ in 0..20_000 {
            let mut text = "M1 2L3 4 5 0".to_owned();
            for _ in 0..rng.index(12) {
                text.push(letters[rng.index(letters.len())]);
            }
            if let Ok(outline) = Outline::parse(&text) {
                read += 1;
                let data = outline.path_data();
                assert!(data.chars().all(|letter| "MLCZ0123456789.- ".contains(letter)), "{text} became {data}");
                // Rounding may make the thinnest shapes too thin.
                let again = Outline::parse(&data);
                assert!(matches!(again, Ok(_) | Err(OutlineError::Flat)), "{text} became {data}");
            }
        }
        assert!(read > 1000, "{read}");
    }
}
