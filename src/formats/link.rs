//! The share link: everything in the fragment of an address, so that no server ever sees it.
//!
//! ```text
//! #v=1&preset=fast&seed=7&exemplar=rings
//! #v=1&preset=balanced&expansion-x=3&domain=0,0,100,50&exemplar-boundary=periodic&points=AywAAAA…
//! ```
//! | key | what it holds |
//! |---|---|
//! | `v` | version of the layout: 1 |
//! | `preset` | `fast` when left out |
//! | a parameter's name | its value, where it differs from the preset's as it suits the exemplar |
//! | `exemplar` | name of a built-in exemplar; `rings` when there are no points either |
//! | `points` | the exemplar's points, see below |
//! | `domain` | their rectangle, `x0,y0,x1,y1`; the unit square when left out |
//! | `exemplar-boundary` | `open` when left out |
//!
//! Other keys belong to others, and are ignored. Values out of range are moved to the nearest allowed one.
//!
//! # Points
//! base64url (RFC 4648, without padding) of raw deflate (RFC 1951) of, one after the other:
//! 1. the number 1, then the number of points n;
//! 2. the number of classes, 0 when there is only the default class; for each its name and how many points it has;
//! 3. the number of attributes; for each its name, then 0 and a list of values, or 1, the smallest and the largest
//!    value;
//! 4. x of every point, class after class, in ascending order within each, as the difference from the one before: n high
//!    bytes, then n low bytes; y: n high bytes, then n low bytes;
//! 5. for every attribute n places in its list of values, a byte each; or n numbers of twelve bits that go from the
//!    smallest value to the largest: n high bytes, then n lower halves of a byte, two a byte, the first one lower.
//!
//! Numbers are LEB128, values little-endian doubles, names a number of bytes and UTF-8. Coordinates are 65535ths of the
//! domain's sides.
//!
//! A link that was ever made can be read for ever: what this layout can't say will be another version.

use glam::DVec2;
use miniz_oxide::deflate::core::{CompressorOxide, TDEFLFlush, compress_to_output, create_comp_flags_from_zip_params};
use miniz_oxide::inflate::decompress_to_vec_with_limit;
use serde_json::{Map, Value};
use thiserror::Error;

use super::declaration::number_text;
use super::error::clip;
use crate::domain::{Boundary, Domain};
use crate::gallery;
use crate::method::{Parameters, Preset};
use crate::pattern::{Attribute, MAX_ATTRIBUTES, MAX_CLASSES, MAX_POINTS, PatternError, PointPattern};

/// Longest fragment, in bytes.
pub const MAX_LENGTH: usize = 32_768;
/// Most bytes the points may inflate to: 16 bytes a point with eight attributes, and what names and lists take.
const MAX_INFLATED: usize = 20 * MAX_POINTS;
/// Longest name in bytes: 64 characters of UTF-8.
const MAX_NAME_BYTES: usize = 256;
/// An attribute with at most this many different values keeps them to the last digit.
const MAX_LISTED: usize = 16;
const VERSION: &str = "1";
const DEFAULT_EXEMPLAR: &str = "rings";
/// The parameters that are words.
const CHOICES: [&str; 5] = ["boundary", "start", "learning-rate-unit", "class-order", "class-maps"];

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
    #[error("the link is of version {0:?}; this program reads version 1")]
    Version(String),
    /// No built-in exemplar of that name.
    #[error("the link names the exemplar {0:?}, which is not in the gallery")]
    Exemplar(String),
    /// A word that is no preset.
    #[error("the link names the preset {0:?}; there are fast, balanced, best and paper")]
    Preset(String),
    /// The rectangle can't be read.
    #[error("the link's domain is {0:?}, but must be x0,y0,x1,y1")]
    Domain(String),
    /// The points can't be read.
    #[error("the link's points can't be read: {0}; perhaps a part of the link is missing")]
    Points(&'static str),
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
    /// What to learn from.
    pub exemplar: LinkExemplar,
    /// What the parameters start from.
    pub preset: Preset,
    /// Parameters that differ from the preset's as it suits the exemplar, under their names in files.
    pub overrides: Map<String, Value>,
    /// What was moved into its range, in sentences; nothing in a link that is yet to be written.
    pub notes: Vec<String>,
}

impl Link {
    /// All parameters, in their ranges.
    ///
    /// # Errors
    /// [`LinkError::Exemplar`] when the exemplar is not in the gallery.
    pub fn parameters(&self) -> Result<Parameters, LinkError> {
        let mut parameters = self.merged()?;
        parameters.put_in_order();
        Ok(parameters)
    }

    /// The same before those that depend on each other are put in order.
    fn merged(&self) -> Result<Parameters, LinkError> {
        let exemplar = self.exemplar.pattern().ok_or(LinkError::Points("there is no exemplar"))?;
        let allowed: Map<String, Value> = self
            .overrides
            .iter()
            .filter_map(|(name, value)| Some((name.clone(), Parameters::nearest(name, value)?)))
            .collect();
        Ok(Parameters::with_overrides(self.preset, &exemplar, allowed)
            .unwrap_or_else(|_| Parameters::suited_to(self.preset, &exemplar)))
    }
}

/// Writes the fragment, without its `#`, and returns it with the exemplar as the receiver will have it: points rounded to
/// 65535ths of the domain, in another order.
///
/// # Errors
/// When it would be longer than [`MAX_LENGTH`].
pub fn write_link(link: &Link) -> Result<(String, LinkExemplar), LinkError> {
    let exemplar = match &link.exemplar {
        LinkExemplar::Gallery(name) => LinkExemplar::named(name)?,
        LinkExemplar::Points(pattern) => LinkExemplar::Points(rounded(pattern)?),
    };
    let mut text = format!("v={VERSION}&preset={}", link.preset.name());
    let received = Link { exemplar: exemplar.clone(), ..link.clone() };
    let plain = Link { overrides: Map::new(), ..received.clone() };
    let (wanted, plain) = (fields(&received.parameters()?), fields(&plain.parameters()?));
    for name in Parameters::RANGES.iter().map(|range| range.name).chain(CHOICES) {
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
    match &exemplar {
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
            text.push_str(&format!("&points={}", base64(&deflated(&packed(pattern)))));
        }
    }
    if text.len() > MAX_LENGTH {
        return Err(LinkError::TooLong { length: text.len(), max: MAX_LENGTH });
    }
    Ok((text, exemplar))
}

/// The parameters under their names in files.
fn fields(parameters: &Parameters) -> Map<String, Value> {
    match serde_json::to_value(parameters) {
        Ok(Value::Object(fields)) => fields,
        _ => Map::new(),
    }
}

/// Reads a fragment, with or without its `#`. Nothing in it is believed: lengths are capped before anything is unpacked,
/// and values are moved into their ranges.
///
/// # Errors
/// What is wrong with it, for a person.
pub fn read_link(fragment: &str) -> Result<Link, LinkError> {
    let fragment = fragment.strip_prefix('#').unwrap_or(fragment);
    if fragment.len() > MAX_LENGTH {
        return Err(LinkError::TooLong { length: fragment.len(), max: MAX_LENGTH });
    }
    let pairs: Vec<(&str, String)> = fragment
        .split('&')
        .filter_map(|pair| pair.split_once('='))
        .map(|(key, value)| (key, percent_decoded(value)))
        .collect();
    // The last one of a kind holds.
    let get = |wanted: &str| pairs.iter().rev().find(|(key, _)| *key == wanted).map(|(_, value)| value.as_str());
    match get("v") {
        Some(VERSION) => {}
        other => return Err(LinkError::Version(clip(other.unwrap_or("")))),
    }
    let preset = match get("preset") {
        None => Preset::Fast,
        Some(name) => Preset::from_name(name).map_err(|_| LinkError::Preset(clip(name)))?,
    };
    let exemplar = match get("points") {
        Some(points) => {
            let domain = get("domain").map_or(Ok(Domain::UNIT), parse_domain)?;
            let boundary = match get("exemplar-boundary") {
                Some("periodic") => Boundary::Periodic,
                _ => Boundary::Open,
            };
            LinkExemplar::Points(read_points(points, domain)?.with_boundary(boundary))
        }
        None => LinkExemplar::named(get("exemplar").unwrap_or(DEFAULT_EXEMPLAR))?,
    };

    let (mut overrides, mut notes) = (Map::new(), Vec::new());
    for name in Parameters::RANGES.iter().map(|range| range.name).chain(CHOICES) {
        let Some(text) = get(name) else { continue };
        // JSON has no infinity.
        let number = text.parse::<f64>().map(|number| number.clamp(f64::MIN, f64::MAX));
        let value = number.map_or_else(|_| Value::from(text), Value::from);
        match Parameters::nearest(name, &value) {
            Some(allowed) => {
                if allowed.as_f64() != value.as_f64() {
                    notes.push(format!("'{name}' was {}, which is out of its range; it is {allowed} now.", clip(text)));
                }
                overrides.insert(name.to_owned(), allowed);
            }
            None => {
                notes.push(format!("'{name}' was {:?}, which it can't be; the preset's value is used.", clip(text)))
            }
        }
    }
    let mut link = Link { exemplar, preset, overrides, notes };
    // Numbers that depend on each other: what had to be raised is a difference from the preset too.
    let (before, after) = (fields(&link.merged()?), fields(&link.parameters()?));
    for (name, value) in after {
        if let Some(old) = before.get(&name).filter(|&old| *old != value) {
            link.notes.push(format!("'{name}' was {old}, which is too small for the others; it is {value} now."));
            link.overrides.insert(name, value);
        }
    }
    Ok(link)
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

// ------------------------------------------------------------------------------------------------------- points

/// Share of a side in 65535ths.
fn quantised(share: f64) -> u16 {
    // Saturates; a point of a pattern lies in its domain.
    (share * 65_535.0).round() as u16
}

/// What the receiver will have.
fn rounded(pattern: &PointPattern) -> Result<PointPattern, LinkError> {
    let bytes = packed(pattern);
    Ok(unpacked(&bytes, corners(pattern.domain())?)?.with_boundary(pattern.boundary()))
}

/// The domain as its corners tell it: a link holds no sizes.
fn corners(domain: Domain) -> Result<Domain, LinkError> {
    let max = domain.max();
    Ok(Domain::new(domain.min(), max - domain.min())?)
}

/// An attribute's list of values, when there are few.
fn listed(values: &[f64]) -> Option<Vec<f64>> {
    let mut list: Vec<f64> = Vec::new();
    for value in values {
        if !list.iter().any(|known| known.to_bits() == value.to_bits()) {
            list.push(*value);
        }
        if list.len() > MAX_LISTED {
            return None;
        }
    }
    // In order, so that the order of the points does not show.
    list.sort_unstable_by(f64::total_cmp);
    Some(list)
}

/// Sections 1 to 3 and those after, each to be deflated by itself: their bytes have little in common.
fn packed(pattern: &PointPattern) -> Vec<Vec<u8>> {
    let domain = pattern.domain();
    let places: Vec<[u16; 2]> = pattern
        .positions()
        .iter()
        .map(|&point| ((point - domain.min()) / domain.size()).to_array().map(quantised))
        .collect();
    let mut order: Vec<usize> = (0..pattern.len()).collect();
    order.sort_by_key(|&point| (pattern.classes()[point], places[point]));

    let mut head = Vec::new();
    push_number(&mut head, 1);
    push_number(&mut head, pattern.len());
    let names = pattern.class_names();
    if names == ["points"] {
        push_number(&mut head, 0);
    } else {
        push_number(&mut head, names.len());
        for (class, name) in names.iter().enumerate() {
            push_name(&mut head, name);
            push_number(&mut head, pattern.classes().iter().filter(|&&other| usize::from(other) == class).count());
        }
    }
    push_number(&mut head, pattern.attributes().len());

    let (mut x_high, mut x_low, mut y_high, mut y_low) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let mut before = None;
    for &point in &order {
        let [x, y] = places[point];
        let class = pattern.classes()[point];
        // A class begins at 0 again.
        let step = match before {
            Some((same, last)) if same == class => x - last,
            _ => x,
        };
        before = Some((class, x));
        let ([high, low], [y1, y0]) = (step.to_be_bytes(), y.to_be_bytes());
        x_high.push(high);
        x_low.push(low);
        y_high.push(y1);
        y_low.push(y0);
    }
    let mut rest = vec![x_high, x_low, y_high, y_low];
    for attribute in pattern.attributes() {
        push_name(&mut head, &attribute.name);
        let values: Vec<f64> = order.iter().map(|&point| attribute.values[point]).collect();
        if let Some(list) = listed(&values) {
            head.push(0);
            push_number(&mut head, list.len());
            list.iter().for_each(|value| head.extend_from_slice(&value.to_le_bytes()));
            let place = |value: &f64| list.iter().position(|known| known.to_bits() == value.to_bits()).unwrap_or(0);
            rest.push(values.iter().map(|value| place(value) as u8).collect());
            continue;
        }
        let (low, high) = attribute.range();
        head.push(1);
        head.extend_from_slice(&low.to_le_bytes());
        head.extend_from_slice(&high.to_le_bytes());
        // Halved first: the difference of two doubles need not be one.
        let steps: Vec<u16> = values
            .iter()
            .map(|&value| ((value / 2.0 - low / 2.0) / (high / 2.0 - low / 2.0) * 4095.0).round() as u16)
            .collect();
        rest.push(steps.iter().map(|step| (step >> 4) as u8).collect());
        let half = |step: &u16| (step & 15) as u8;
        rest.push(steps.chunks(2).map(|two| half(&two[0]) | two.get(1).map_or(0, half) << 4).collect());
    }
    let mut sections = vec![head];
    sections.append(&mut rest);
    sections
}

fn push_number(bytes: &mut Vec<u8>, mut number: usize) {
    while number >= 128 {
        bytes.push(number as u8 | 128);
        number >>= 7;
    }
    bytes.push(number as u8);
}

fn push_name(bytes: &mut Vec<u8>, name: &str) {
    push_number(bytes, name.len());
    bytes.extend_from_slice(name.as_bytes());
}

/// Deflates all sections in one go, or with codes of their own for the first two, or for each, and takes what is
/// shortest: regular patterns repeat themselves from one section to the next, random ones do not, and of them only the
/// high bytes of steps can be made smaller.
fn deflated(sections: &[Vec<u8>]) -> Vec<u8> {
    let run = |apart: usize| {
        // The best level; a negative window means no zlib header.
        let mut compressor = CompressorOxide::new(create_comp_flags_from_zip_params(10, -15, 0));
        let mut bytes = Vec::new();
        for (index, section) in sections.iter().enumerate() {
            let flush = if index + 1 == sections.len() {
                TDEFLFlush::Finish
            } else if index < apart {
                TDEFLFlush::Sync
            } else {
                TDEFLFlush::None
            };
            compress_to_output(&mut compressor, section, flush, |piece| {
                bytes.extend_from_slice(piece);
                true
            });
        }
        bytes
    };
    [2, sections.len()]
        .map(run)
        .into_iter()
        .fold(run(0), |best, next| if next.len() < best.len() { next } else { best })
}

/// Reads the points of a link.
fn read_points(text: &str, domain: Domain) -> Result<PointPattern, LinkError> {
    let deflated = unbase64(text).ok_or(LinkError::Points("a character is none of base64url's"))?;
    let bytes = decompress_to_vec_with_limit(&deflated, MAX_INFLATED)
        .map_err(|_| LinkError::Points("they can't be inflated"))?;
    unpacked(&[bytes], domain)
}

/// Walks through bytes that may end too soon.
struct Cursor<'a>(&'a [u8]);

impl<'a> Cursor<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], LinkError> {
        let (taken, rest) = self.0.split_at_checked(count).ok_or(LinkError::Points("they end too soon"))?;
        self.0 = rest;
        Ok(taken)
    }

    fn number(&mut self, max: usize, message: &'static str) -> Result<usize, LinkError> {
        let mut number = 0;
        // 21 bits are more than any number here needs.
        for shift in [0, 7, 14] {
            let byte = usize::from(self.take(1)?[0]);
            number |= (byte & 127) << shift;
            if byte < 128 {
                return if number <= max { Ok(number) } else { Err(LinkError::Points(message)) };
            }
        }
        Err(LinkError::Points(message))
    }

    fn name(&mut self) -> Result<String, LinkError> {
        let length = self.number(MAX_NAME_BYTES, "a name is too long")?;
        let bytes = self.take(length)?;
        std::str::from_utf8(bytes).map(str::to_owned).map_err(|_| LinkError::Points("a name is not text"))
    }

    fn double(&mut self) -> Result<f64, LinkError> {
        let mut bytes = [0; 8];
        bytes.copy_from_slice(self.take(8)?);
        Ok(f64::from_le_bytes(bytes))
    }
}

/// How an attribute's values are written.
enum Scale {
    Listed(Vec<f64>),
    Between(f64, f64),
}

fn unpacked<B: AsRef<[u8]>>(sections: &[B], domain: Domain) -> Result<PointPattern, LinkError> {
    let bytes: Vec<u8> = sections.iter().flat_map(|section| section.as_ref()).copied().collect();
    let mut cursor = Cursor(&bytes);
    cursor.number(1, "their layout is not known")?;
    let count = cursor.number(MAX_POINTS, "there are too many")?;
    let mut names = Vec::new();
    let mut counts = Vec::new();
    for _ in 0..cursor.number(MAX_CLASSES, "they are of too many classes")? {
        names.push(cursor.name()?);
        counts.push(cursor.number(count, "a class has more points than there are")?);
    }
    if names.is_empty() {
        counts.push(count);
    }
    if counts.iter().sum::<usize>() != count {
        return Err(LinkError::Points("the classes do not have as many points as there are"));
    }
    let mut scales = Vec::new();
    for _ in 0..cursor.number(MAX_ATTRIBUTES, "they have too many attributes")? {
        let name = cursor.name()?;
        let scale = match cursor.number(1, "an attribute is written in a way that is not known")? {
            0 => {
                let listed = cursor.number(MAX_LISTED, "an attribute lists too many values")?;
                Scale::Listed((0..listed).map(|_| cursor.double()).collect::<Result<_, _>>()?)
            }
            _ => Scale::Between(cursor.double()?, cursor.double()?),
        };
        scales.push((name, scale));
    }

    let [x_high, x_low, y_high, y_low] =
        [cursor.take(count)?, cursor.take(count)?, cursor.take(count)?, cursor.take(count)?];
    let mut positions = Vec::with_capacity(count);
    let mut classes = Vec::with_capacity(count);
    for (class, &members) in counts.iter().enumerate() {
        let mut x = 0_u16;
        for _ in 0..members {
            let point = positions.len();
            let step = u16::from_be_bytes([x_high[point], x_low[point]]);
            x = x.checked_add(step).ok_or(LinkError::Points("one lies outside the domain"))?;
            let y = u16::from_be_bytes([y_high[point], y_low[point]]);
            let share = DVec2::new(f64::from(x), f64::from(y)) / 65_535.0;
            // Rounding must not leave the last one outside.
            positions.push((domain.min() + share * domain.size()).clamp(domain.min(), domain.max()));
            classes.push(class as u16);
        }
    }
    let mut pattern = PointPattern::new(domain, positions)?;
    if !names.is_empty() {
        pattern = pattern.with_classes(classes, names)?;
    }
    for (name, scale) in scales {
        let values: Vec<f64> = match scale {
            Scale::Listed(list) => {
                let places = cursor.take(count)?.iter();
                let found: Option<Vec<f64>> = places.map(|&place| list.get(usize::from(place)).copied()).collect();
                found.ok_or(LinkError::Points("an attribute has a value that is not in its list"))?
            }
            Scale::Between(low, high) => {
                let (tops, halves) = (cursor.take(count)?, cursor.take(count.div_ceil(2))?);
                let value = |(point, &top): (usize, &u8)| {
                    let half = (halves[point / 2] >> (4 * (point % 2))) & 15;
                    let share = f64::from(u16::from(top) << 4 | u16::from(half)) / 4095.0;
                    low * (1.0 - share) + high * share
                };
                tops.iter().enumerate().map(value).collect()
            }
        };
        pattern = pattern.with_attribute(Attribute { name, values })?;
    }
    Ok(pattern)
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
