//! The share link: everything in the fragment of an address, so that no server ever sees it.
//!
//! ```text
//! #v=1&preset=fast&seed=7&exemplar=rings
//! #v=1&preset=balanced&expansion-x=3&domain=0,0,100,50&exemplar-boundary=periodic&points=AywAAAA…
//! #v=2&method=…&preset=fast&exemplar=rings
//! ```
//! | key | what it holds |
//! |---|---|
//! | `v` | version of the layout: 1 for the network, 2 for links that name a method |
//! | `method` | name of the method, in links of version 2 |
//! | `preset` | `fast` when left out |
//! | `presets` | edition of the presets' values, see [`crate::run::Definition::edition`]; 1 when left out |
//! | a parameter's name | its value, where it differs from the preset's as it suits the exemplar |
//! | `exemplar` | name of a built-in exemplar, where there are no points |
//! | `points` | the exemplar's points, see below |
//! | `domain` | their rectangle, `x0,y0,x1,y1`; the unit square when left out |
//! | `exemplar-boundary` | `open` when left out |
//!
//! Other keys belong to others, and are ignored. Values out of range are moved to the nearest allowed one. What mail and chat
//! do to links is undone where there is no doubt (`mend.rs`); a link that was cut short is refused.
//!
//! # Points
//! base64url (RFC 4648, without padding) of raw deflate (RFC 1951) of, one after the other:
//! 1. the number of the layout, 1 or 2, then the number of points n; in layout 2 the steps of places and of values, see
//!    there;
//! 2. the number of classes, 0 when there is only the default class; for each its name and how many points it has;
//! 3. the number of attributes; for each its name, then 0 and a list of values, or 1, the smallest and the largest
//!    value.
//!
//! The points stand class after class, within each in ascending order of x. Coordinates are 65535ths of the domain's
//! sides, values places in a list or 4095ths of the way from the smallest to the largest. *Layout 1* has them in bytes
//! that repeat themselves where a pattern does:
//!
//! 4. x of every point, as the difference from the one before in its class: n high bytes, then n low bytes; y: n high
//!    bytes, then n low bytes;
//! 5. for every attribute n places in its list of values, a byte each; or the n numbers of twelve bits: n high bytes, then
//!    n lower halves of a byte, two a byte, the first one lower.
//!
//! *Layout 2* has them in as few bits as random points can be told in (`bits.rs`). All places are multiples of the step of
//! places, or 65535, and all values of the step of values, or 4095; numbers here are these multiples:
//!
//! 4. for each class the differences of x as Rice codes; then y of every point in truncated binary;
//! 5. for every attribute n places or values in truncated binary.
//!
//! Numbers outside the bits are LEB128, values little-endian doubles, names a number of bytes and UTF-8.
//!
//! A link that would be longer than [`SHORT`] is rounded a little more, if that makes it short enough and moves no point
//! by more than a 400th of the mean spacing; the writer says so. What was rounded once goes through other links unchanged.
//!
//! A link that was ever made can be read for ever: what these layouts can't say will be another version.

mod bits;
mod mend;
mod points;

use glam::DVec2;
use serde_json::{Map, Value};
use thiserror::Error;

use self::points::{PLACES, Precision, Sheet, VALUES};
use super::Note;
use super::declaration::number_text;
use super::error::clip;
use crate::gallery;
use crate::methods::Method;
use crate::pattern::{Boundary, Domain, PatternError, PointPattern};

/// Longest fragment, in bytes.
pub const MAX_LENGTH: usize = 32_768;
/// Longest fragment that is short: an address in front leaves it under 2 kB, which no program cuts.
pub const SHORT: usize = 2000;
/// A short link may move a point by half a step, and this many steps make the mean spacing at least.
const STEPS_PER_SPACING: f64 = 200.0;
/// Version of links that name no method: they mean the network.
const FIRST_VERSION: &str = "1";
/// Version of links that name one.
const SECOND_VERSION: &str = "2";
/// What links that say nothing mean.
const FIRST_EDITION: u32 = 1;
const DEFAULT_PRESET: &str = "fast";

/// Why a link was refused.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum LinkError {
    /// Over the cap.
    #[error("the link would have {length} characters; at most {max} are allowed: share a file instead")]
    TooLong {
        /// How many it has.
        length: usize,
        /// How many are allowed.
        max: usize,
    },
    /// Made by a later version, or not by us.
    #[error("the link is of version {0:?}; this program reads versions 1 and 2")]
    Version(String),
    /// A word that is no method.
    #[error("the link names the method {name:?}; there is {known}")]
    Method {
        /// The offending word.
        name: String,
        /// What there is.
        known: String,
    },
    /// No built-in exemplar of that name.
    #[error("the link names the exemplar {0:?}, which is not in the gallery")]
    Exemplar(String),
    /// A word that is no preset.
    #[error("the link names the preset {name:?}; there are {known}")]
    Preset {
        /// The offending word.
        name: String,
        /// What there is.
        known: String,
    },
    /// The rectangle can't be read.
    #[error("the link's domain is {0:?}, but must be x0,y0,x1,y1")]
    Domain(String),
    /// The points can't be read.
    #[error("the link's points can't be read: {0}; perhaps a part of the link is missing")]
    Points(&'static str),
    /// Neither an exemplar nor points.
    #[error(
        "the link names no exemplar and holds no points, so its end is missing: ask for the whole link, or for a file"
    )]
    Nothing,
    /// Dots in place of a part.
    #[error("the link ends in dots: it was shortened for show. Copy the link itself instead of the words that show it")]
    Shortened,
    /// They can be read, but are no pattern.
    #[error("the link's points can't be used: {0}")]
    Pattern(#[from] PatternError),
}

/// What a link carries an exemplar as.
#[derive(Clone, Debug, PartialEq)]
pub enum LinkExemplar {
    /// The name of a built-in one.
    Gallery(&'static str),
    /// Its points.
    Points(PointPattern),
}

impl LinkExemplar {
    /// The built-in exemplar of this name.
    ///
    /// # Errors
    /// [`LinkError::Exemplar`] when there is none.
    pub fn named(name: &str) -> Result<Self, LinkError> {
        gallery::find(name).map(|entry| Self::Gallery(entry.name)).ok_or_else(|| LinkError::Exemplar(clip(name)))
    }

    /// Its points.
    #[must_use]
    pub fn pattern(&self) -> Option<PointPattern> {
        match self {
            Self::Gallery(name) => gallery::find(name).map(gallery::Entry::exemplar),
            Self::Points(pattern) => Some(pattern.clone()),
        }
    }
}

/// What a link says.
#[derive(Clone, Debug, PartialEq)]
pub struct Link {
    /// What runs.
    pub method: Method,
    /// What to learn from.
    pub exemplar: LinkExemplar,
    /// Name of the preset that the parameters start from.
    pub preset: String,
    /// Parameters that differ from the preset's as it suits the exemplar, under their names in files.
    pub overrides: Map<String, Value>,
    /// What was moved into its range, in sentences; nothing in a link that is yet to be written.
    pub notes: Vec<Note>,
}

impl Link {
    /// All parameters, in their ranges and in order.
    ///
    /// # Errors
    /// [`LinkError::Exemplar`] when the exemplar is not in the gallery, [`LinkError::Preset`] when there is no such preset.
    pub fn parameters(&self) -> Result<Map<String, Value>, LinkError> {
        self.with_overrides(&self.overrides)
    }

    /// The preset's parameters as they suit the exemplar, with these replaced.
    fn with_overrides(&self, overrides: &Map<String, Value>) -> Result<Map<String, Value>, LinkError> {
        let exemplar = self.exemplar.pattern().ok_or(LinkError::Points("there is no exemplar"))?;
        let parameters = self.method.definition().nearest_parameters(&self.preset, &exemplar, overrides);
        parameters.map_err(|_| no_preset(self.method, &self.preset))
    }

    /// What was raised because another number asks for more, with its value before.
    fn raised(&self) -> Result<Vec<(String, Value, Value)>, LinkError> {
        let mut before = self.with_overrides(&Map::new())?;
        before.extend(self.overrides.clone());
        let after = self.parameters()?.into_iter();
        Ok(after
            .filter_map(|(name, value)| Some((before.get(&name)?.clone(), name, value)))
            .filter(|(old, _, value)| old.as_f64() != value.as_f64())
            .map(|(old, name, value)| (name, old, value))
            .collect())
    }
}

/// Says that the method has no preset of that name.
fn no_preset(method: Method, name: &str) -> LinkError {
    let presets = method.definition().describe().presets;
    let known: Vec<&str> = presets.iter().map(|preset| preset.name).collect();
    LinkError::Preset { name: clip(name), known: known.join(", ") }
}

/// A link as it was written.
#[derive(Clone, Debug, PartialEq)]
pub struct Written {
    /// Without its `#`.
    pub fragment: String,
    /// The exemplar as the receiver will have it: points rounded to 65535ths of the domain, in another order.
    pub exemplar: LinkExemplar,
    /// What was rounded more than that to keep the link short, in a sentence.
    pub note: Option<String>,
}

/// Writes a link.
///
/// # Errors
/// When it would be longer than [`MAX_LENGTH`].
pub fn write_link(link: &Link) -> Result<Written, LinkError> {
    let LinkExemplar::Points(pattern) = &link.exemplar else {
        let fragment = link_text(link)?;
        return Ok(Written { fragment, exemplar: link.exemplar.clone(), note: None });
    };
    let full = Sheet::of(pattern, Precision::FULL);
    let received = |sheet: &Sheet| -> Result<Link, LinkError> {
        let pattern = sheet.pattern(corners(pattern.domain())?)?.with_boundary(pattern.boundary());
        Ok(Link { exemplar: LinkExemplar::Points(pattern), ..link.clone() })
    };
    let mut written = received(&full)?;
    let mut text = link_text(&written)? + "&points=";
    let points = |sheet: &Sheet, precision: Precision| base64(&sheet.deflated(precision));
    let is_short = |points: &str| text.len() + points.len() <= SHORT;

    let mut shortest = points(&full, Precision::FULL);
    let mut lossy = Vec::new();
    for precision in Precision::LADDER {
        let sheet = Sheet::of(pattern, precision);
        if sheet != full {
            lossy.push((sheet, precision));
        } else if precision.place > 1 || precision.value > 1 && full.has_steps() {
            // What a link has rounded already is told in its few bits again.
            let next = points(&full, precision);
            if next.len() < shortest.len() {
                shortest = next;
            }
        }
    }
    let mut note = None;
    if !is_short(&shortest) {
        let spacing = pattern.mean_spacing().unwrap_or(0.0);
        lossy.retain(|(sheet, precision)| {
            let steps = spacing * f64::from(PLACES) / f64::from(precision.place);
            // Points that are told apart stay apart.
            precision.place == 1 || steps >= STEPS_PER_SPACING && sheet.distinct_places() == full.distinct_places()
        });
        // Most that are too long are far too long.
        let fits = lossy.last().is_some_and(|(sheet, precision)| is_short(&points(sheet, *precision)));
        let first = lossy.into_iter().filter(|_| fits).find_map(|(sheet, precision)| {
            Some(points(&sheet, precision)).filter(|points| is_short(points)).map(|points| (sheet, precision, points))
        });
        if let Some((sheet, precision, points)) = first {
            note = Some(rounding(&sheet, precision, spacing));
            written = received(&sheet)?;
            text = link_text(&written)? + "&points=";
            shortest = points;
        }
    }
    let fragment = text + &shortest;
    if fragment.len() > MAX_LENGTH {
        return Err(LinkError::TooLong { length: fragment.len(), max: MAX_LENGTH });
    }
    Ok(Written { fragment, exemplar: written.exemplar, note })
}

/// What was given up for a short link, for a person.
fn rounding(sheet: &Sheet, precision: Precision, spacing: f64) -> String {
    let parts = |step: u16, last: u16| (f64::from(last) / f64::from(step)).round();
    let places = parts(precision.place, PLACES);
    let mut rounded = Vec::new();
    if precision.place > 1 {
        let share = (2.0 * places * spacing).floor();
        rounded.push(format!("points to 1/{places} of the pattern (no more than 1/{share} of their mean spacing)"));
    }
    if precision.value > 1 && sheet.has_steps() {
        rounded.push(format!("values to 1/{} of their range", parts(precision.value, VALUES)));
    }
    format!("To keep the link under {SHORT} characters it rounds {}; a file keeps every digit.", rounded.join(" and "))
}

/// The fragment but for the points. The exemplar must be as the receiver will have it.
fn link_text(link: &Link) -> Result<String, LinkError> {
    let definition = link.method.definition();
    let mut text = match link.method {
        Method::Network => format!("v={FIRST_VERSION}"),
        #[allow(unreachable_patterns, reason = "other methods are optional")]
        other => format!("v={SECOND_VERSION}&method={}", other.name()),
    };
    text.push_str(&format!("&preset={}", link.preset));
    let edition = definition.edition();
    if edition > FIRST_EDITION {
        text.push_str(&format!("&presets={edition}"));
    }
    let (wanted, plain) = (link.parameters()?, link.with_overrides(&Map::new())?);
    for name in definition.describe().parameters.iter().map(|parameter| parameter.name) {
        match wanted.get(name) {
            Some(value) if plain.get(name) != Some(value) => {
                let value = match (value, value.as_f64()) {
                    (Value::String(word), _) => word.clone(),
                    (_, Some(number)) => number_text(number),
                    _ => continue,
                };
                text.push_str(&format!("&{name}={value}"));
            }
            _ => {}
        }
    }
    match &link.exemplar {
        LinkExemplar::Gallery(name) => text.push_str(&format!("&exemplar={name}")),
        LinkExemplar::Points(pattern) => {
            let (min, max) = (pattern.domain().min(), pattern.domain().max());
            if pattern.domain() != Domain::UNIT {
                let corners = [min.x, min.y, max.x, max.y].map(number_text).join(",");
                text.push_str(&format!("&domain={corners}"));
            }
            if pattern.boundary() != Boundary::Open {
                text.push_str(&format!("&exemplar-boundary={}", pattern.boundary().name()));
            }
        }
    }
    Ok(text)
}

/// Reads a fragment, with or without its `#`. Nothing in it is believed: lengths are capped before anything is unpacked,
/// and values are moved into their ranges.
///
/// # Errors
/// What is wrong with it, for a person.
pub fn read_link(fragment: &str) -> Result<Link, LinkError> {
    let too_long = |text: &str, max: usize| Err(LinkError::TooLong { length: text.len(), max });
    // Escapes make a link longer before they are undone.
    if fragment.len() > 4 * MAX_LENGTH {
        return too_long(fragment, MAX_LENGTH);
    }
    let (mended, mut notes) = mend::mend(fragment)?;
    let fragment = mended.strip_prefix('#').unwrap_or(&mended);
    if fragment.len() > MAX_LENGTH {
        return too_long(fragment, MAX_LENGTH);
    }
    let pairs: Vec<(&str, String)> = fragment
        .split('&')
        .filter_map(|pair| pair.split_once('='))
        .map(|(key, value)| (key, percent_decoded(value)))
        .collect();
    // The last one of a kind holds.
    let get = |wanted: &str| pairs.iter().rev().find(|(key, _)| *key == wanted).map(|(_, value)| value.as_str());
    let method = match get("v") {
        // Whatever else it says: it was written when there was one method.
        Some(FIRST_VERSION) => Method::Network,
        Some(SECOND_VERSION) => named_method(get("method").unwrap_or(""))?,
        other => return Err(LinkError::Version(clip(other.unwrap_or("")))),
    };
    let description = method.definition().describe();
    let preset = get("preset").unwrap_or(DEFAULT_PRESET);
    if description.presets.iter().all(|known| known.name != preset) {
        return Err(no_preset(method, preset));
    }
    let preset = preset.to_owned();
    let exemplar = match get("points") {
        Some(points) => {
            let domain = get("domain").map_or(Ok(Domain::UNIT), parse_domain)?;
            let boundary = match get("exemplar-boundary") {
                Some("periodic") => Boundary::Periodic,
                _ => Boundary::Open,
            };
            // base64 as most programs write it differs in two signs.
            let points = &points.replace('+', "-").replace('/', "_");
            let deflated = unbase64(points).ok_or(LinkError::Points("a character is none of base64url's"))?;
            LinkExemplar::Points(Sheet::inflated(&deflated)?.pattern(domain)?.with_boundary(boundary))
        }
        None => LinkExemplar::named(get("exemplar").ok_or(LinkError::Nothing)?)?,
    };

    let mut overrides = Map::new();
    for parameter in description.parameters {
        let name = parameter.name;
        let Some(text) = get(name) else { continue };
        // JSON has no infinity.
        let number = text.parse::<f64>().map(|number| number.clamp(f64::MIN, f64::MAX));
        let value = number.map_or_else(|_| Value::from(text), Value::from);
        match parameter.nearest(&value) {
            Some(allowed) => {
                if allowed.as_f64() != value.as_f64() {
                    notes.push(Note::changed(format!(
                        "'{name}' was {}, which is out of its range; it is {allowed} now.",
                        clip(text)
                    )));
                }
                overrides.insert(name.to_owned(), allowed);
            }
            None => {
                notes.push(Note::left_out(format!(
                    "'{name}' was {:?}, which it can't be; the preset's value is used.",
                    clip(text)
                )));
            }
        }
    }
    let edition = get("presets").map_or(FIRST_EDITION, |text| text.parse().unwrap_or(u32::MAX));
    let present = method.definition().edition();
    if edition > present {
        notes.push(Note::changed("The link was made with later presets; those of this program are used."));
    } else if edition < present {
        let pattern = exemplar.pattern().ok_or(LinkError::Points("there is no exemplar"))?;
        for (name, value) in method.definition().values_before(edition, &preset, &pattern) {
            overrides.entry(name).or_insert(value);
        }
    }
    let mut link = Link { method, exemplar, preset, overrides, notes };
    // Numbers that depend on each other: what had to be raised is a difference from the preset too.
    for (name, old, value) in link.raised()? {
        link.notes
            .push(Note::changed(format!("'{name}' was {old}, which is too small for the others; it is {value} now.")));
        link.overrides.insert(name, value);
    }
    Ok(link)
}

fn named_method(name: &str) -> Result<Method, LinkError> {
    Method::from_name(name).map_err(|_| {
        let known: Vec<&str> = Method::ALL.iter().map(|method| method.name()).collect();
        LinkError::Method { name: clip(name), known: known.join(", ") }
    })
}

fn parse_domain(text: &str) -> Result<Domain, LinkError> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|word| word.parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x0, y0, x1, y1]) => Ok(Domain::new(DVec2::new(x0, y0), DVec2::new(x1 - x0, y1 - y0))?),
        _ => Err(LinkError::Domain(clip(text))),
    }
}

/// Mail programs write `%2C` for a comma. What is no proper escape stays as it is.
fn percent_decoded(text: &str) -> String {
    let mut parts = text.split('%');
    let mut decoded = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let byte = part.get(..2).and_then(|digits| u8::from_str_radix(digits, 16).ok()).filter(u8::is_ascii);
        match byte {
            Some(byte) => {
                decoded.push(char::from(byte));
                decoded.push_str(&part[2..]);
            }
            None => {
                decoded.push('%');
                decoded.push_str(part);
            }
        }
    }
    decoded
}

/// The domain as its corners tell it: a link holds no sizes.
fn corners(domain: Domain) -> Result<Domain, LinkError> {
    let max = domain.max();
    Ok(Domain::new(domain.min(), max - domain.min())?)
}

const ALPHABET: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789-_";

fn base64(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let bits = three.iter().enumerate().fold(0_u32, |bits, (i, &byte)| bits | u32::from(byte) << (16 - 8 * i));
        for i in 0..=three.len() {
            text.push(char::from(ALPHABET[(bits >> (18 - 6 * i)) as usize & 63]));
        }
    }
    text
}

fn unbase64(text: &str) -> Option<Vec<u8>> {
    let text = text.trim_end_matches('=').as_bytes();
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 2);
    for four in text.chunks(4) {
        let mut bits = 0_u32;
        for (i, letter) in four.iter().enumerate() {
            let value = ALPHABET.iter().position(|known| known == letter)?;
            bits |= (value as u32) << (18 - 6 * i);
        }
        // One letter alone holds no byte.
        let count = four.len().checked_sub(1).filter(|&count| count > 0)?;
        bytes.extend_from_slice(&bits.to_be_bytes()[1..=count]);
    }
    Some(bytes)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may stop at the first surprise")]
    use super::*;

    #[test]
    fn base64url_as_in_rfc_4648() {
        for (plain, coded) in
            [("", ""), ("f", "Zg"), ("fo", "Zm8"), ("foo", "Zm9v"), ("foob", "Zm9vYg"), ("fooba", "Zm9vYmE")]
        {
            assert_eq!(base64(plain.as_bytes()), coded);
            assert_eq!(unbase64(coded).unwrap(), plain.as_bytes());
        }
        assert_eq!(base64(&[0xfb, 0xff]), "-_8");
        assert_eq!(unbase64("Zm8=").unwrap(), b"fo", "padding does no harm");
        assert!(unbase64("Zm8!").is_none() && unbase64("Z").is_none() && unbase64("+/8").is_none());
    }

    #[test]
    fn escapes_of_mail_programs() {
        assert_eq!(percent_decoded("0%2C0%2c1,1"), "0,0,1,1");
        assert_eq!(percent_decoded("100%"), "100%");
        assert_eq!(percent_decoded("%zz%é%ff"), "%zz%é%ff");
    }
}
