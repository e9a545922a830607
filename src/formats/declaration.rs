//! What text files say about themselves in comment lines.
//!
//! ```text
//! # domain 0 0 100 50 periodic        lower corner, upper corner, boundary (open when left out)
//! # domain 0 0 size 100 50            lower corner, width and height
//! # classes: oak,"silver birch"       the order of the classes, quoted as in CSV
//! ```
//! A comment counts as a declaration only when a number follows `domain`, or a colon follows `classes`.

use glam::DVec2;

use super::error::{FormatError, Place, clip};
use super::table::unfit_name;
use crate::pattern::{Boundary, Domain, MAX_CLASSES, check_name};

/// What the comments and the format declare.
#[derive(Clone, Debug, Default)]
pub(super) struct Declared {
    pub(super) domain: Option<Domain>,
    pub(super) boundary: Option<Boundary>,
    /// In their order; classes that the rows add come after them.
    pub(super) classes: Vec<String>,
}

impl Declared {
    /// Takes in one comment line, without its `#`, and says whether it declares anything. The last declaration of a kind holds.
    pub(super) fn comment(&mut self, line: usize, comment: &str) -> Result<bool, FormatError> {
        let text = comment.trim();
        if let Some(rest) = strip_word(text, "domain") {
            let words: Vec<&str> = rest.split([',', ' ', '\t']).filter(|word| !word.is_empty()).collect();
            if words.first().is_some_and(|word| word.parse::<f64>().is_ok()) {
                let refuse = |reason: String| FormatError::Declaration { line, value: clip(rest.trim()), reason };
                let (domain, boundary) = parse_domain(&words).map_err(refuse)?;
                self.domain = Some(domain);
                self.boundary = boundary.or(self.boundary);
                return Ok(true);
            }
        } else if let Some(rest) = strip_word(text, "classes").and_then(|_| comment.split_once(':')) {
            // Names may begin or end with blanks: only the one after the colon belongs to the syntax.
            let list = rest.1.strip_prefix(' ').unwrap_or(rest.1);
            let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(list.as_bytes());
            if let Some(Ok(record)) = reader.records().next() {
                if record.len() > MAX_CLASSES {
                    let place = Place::Line { line, column: MAX_CLASSES + 1 };
                    return Err(FormatError::TooMany { place, what: "classes", max: MAX_CLASSES });
                }
                self.classes.clear();
                for (index, name) in record.iter().enumerate() {
                    let place = Place::Line { line, column: index + 1 };
                    if check_name(name).is_err() {
                        return Err(unfit_name(place, "class", name));
                    }
                    if self.classes.iter().any(|known| known == name) {
                        return Err(FormatError::DuplicateClass { place, name: clip(name) });
                    }
                    self.classes.push(name.to_owned());
                }
            }
            return Ok(true);
        }
        Ok(false)
    }
}

/// The rest of `text` after `word` and a blank or colon, whatever the case.
fn strip_word<'a>(text: &'a str, word: &str) -> Option<&'a str> {
    let head = text.get(..word.len())?;
    let rest = &text[word.len()..];
    (head.eq_ignore_ascii_case(word) && rest.starts_with([' ', '\t', ':'])).then(|| &rest[1..])
}

/// `x0 y0 x1 y1 [boundary]` or `x0 y0 size w h [boundary]`.
pub(super) fn parse_domain(words: &[&str]) -> Result<(Domain, Option<Boundary>), String> {
    let number = |word: &&str| {
        word.parse::<f64>().map_err(|_| format!("{word:?} is not a number; x0 y0 x1 y1 are needed, as in '0 0 100 50'"))
    };
    let sized = words.get(2).is_some_and(|word| word.eq_ignore_ascii_case("size"));
    let numbers: Vec<&str> = words.iter().copied().filter(|word| !word.eq_ignore_ascii_case("size")).collect();
    let [x0, y0, x1, y1, rest @ ..] = numbers.as_slice() else {
        return Err("four numbers are needed, as in '0 0 100 50'".to_owned());
    };
    let min = DVec2::new(number(x0)?, number(y0)?);
    let second = DVec2::new(number(x1)?, number(y1)?);
    let domain = Domain::new(min, if sized { second } else { second - min }).map_err(|error| error.to_string())?;
    let boundary = match rest {
        [] => None,
        ["open"] => Some(Boundary::Open),
        ["periodic"] => Some(Boundary::Periodic),
        other => return Err(format!("{:?} is not a boundary; 'open' and 'periodic' are", other.join(" "))),
    };
    Ok((domain, boundary))
}

/// The line that declares a domain without losing a digit: by its corners where their difference is exactly the
/// size, by the size itself otherwise.
pub(super) fn domain_line(domain: Domain, boundary: Boundary) -> String {
    let (min, size, max) = (domain.min(), domain.size(), domain.max());
    let (word, second) = if max - min == size { ("", max) } else { ("size ", size) };
    let [x0, y0, x1, y1] = [min.x, min.y, second.x, second.y].map(number_text);
    format!("# domain {x0} {y0} {word}{x1} {y1} {}", boundary.name())
}

/// The shortest text that reads back as the same number.
pub(super) fn number_text(value: f64) -> String {
    let mut text = format!("{value:?}");
    if text.ends_with(".0") {
        text.truncate(text.len() - 2);
    }
    text
}
