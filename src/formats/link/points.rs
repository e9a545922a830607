//! The points of a link: [`Sheet`] is what a link can say of a pattern, and there are two layouts of its bytes.

use glam::DVec2;
use miniz_oxide::deflate::core::{CompressorOxide, TDEFLFlush, compress_to_output, create_comp_flags_from_zip_params};
use miniz_oxide::inflate::decompress_to_vec_with_limit;

use super::LinkError;
use super::bits::{BitReader, BitWriter};
use crate::pattern::{Attribute, Domain, MAX_ATTRIBUTES, MAX_CLASSES, MAX_POINTS, PointPattern};
use crate::sorting;

/// Most bytes the points may inflate to: 16 bytes a point with eight attributes, and what names and lists take.
const MAX_INFLATED: usize = 20 * MAX_POINTS;
/// Longest name in bytes: 64 characters of UTF-8.
const MAX_NAME_BYTES: usize = 256;
/// An attribute with at most this many different values keeps them to the last digit.
const MAX_LISTED: usize = 16;
/// The domain's far sides, in steps from the near ones.
pub(super) const PLACES: u16 = 65_535;
/// The largest value of an attribute, in steps from the smallest.
pub(super) const VALUES: u16 = 4095;

/// How finely a link tells what it holds: every number is a multiple of so many steps, or the last step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Precision {
    /// Of 65535 steps along each side.
    pub(super) place: u16,
    /// Of 4095 steps between an attribute's smallest and largest value.
    pub(super) value: u16,
}

const fn precision(place: u16, value: u16) -> Precision {
    Precision { place, value }
}

impl Precision {
    /// Everything a sheet can tell.
    pub(super) const FULL: Self = precision(1, 1);
    /// What may be given up for a short link, the least first. Values go before places, since neighbours are told by
    /// their distance; a 256th of a range is no more to be seen than a shade of grey.
    pub(super) const LADDER: [Self; 15] = [
        Self::FULL,
        precision(1, 2),
        precision(1, 4),
        precision(2, 4),
        precision(3, 4),
        precision(3, 8),
        precision(4, 8),
        precision(5, 8),
        precision(5, 16),
        precision(6, 16),
        precision(7, 16),
        precision(8, 16),
        precision(9, 16),
        precision(10, 16),
        precision(12, 16),
    ];

    /// A number of steps, rounded.
    fn of(steps: f64, step: u16, last: u16) -> u16 {
        // Saturates; a point of a pattern lies in its domain.
        Self::steps((steps / f64::from(step)).round() as u16, step, last)
    }

    fn steps(multiple: u16, step: u16, last: u16) -> u16 {
        multiple.saturating_mul(step).min(last)
    }

    /// How many multiples there are.
    fn count(step: u16, last: u16) -> u32 {
        1 + Self::multiple(last, step)
    }

    fn multiple(steps: u16, step: u16) -> u32 {
        (f64::from(steps) / f64::from(step)).round() as u32
    }
}

/// How an attribute's values are written.
#[derive(Clone, Debug, PartialEq)]
enum Scale {
    Listed(Vec<f64>),
    Between(f64, f64),
}

/// An attribute's name, and for every point its place in the list or its steps from the smallest value.
#[derive(Clone, Debug, PartialEq)]
struct Column {
    name: String,
    scale: Scale,
    numbers: Vec<u16>,
}

/// What a link says of a pattern but for its domain and boundary: points class after class, in ascending order of x and
/// then y within each.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Sheet {
    /// Empty when there is only the default class.
    names: Vec<String>,
    /// Points of each class.
    counts: Vec<usize>,
    /// In 65535ths of the domain's sides.
    places: Vec<[u16; 2]>,
    columns: Vec<Column>,
}

impl Sheet {
    pub(super) fn of(pattern: &PointPattern, precision: Precision) -> Self {
        let domain = pattern.domain();
        let step = |share: f64| Precision::of(share * f64::from(PLACES), precision.place, PLACES);
        let places: Vec<[u16; 2]> = pattern
            .positions()
            .iter()
            .map(|&point| ((point - domain.min()) / domain.size()).to_array().map(step))
            .collect();
        let classes = pattern.classes();
        // Class, x, y as one number of 36 bits.
        let order =
            sorting::order(places.iter().zip(classes).map(|(&at, &class)| f64::from(class) * 4.3e9 + joined(at)));

        let names = pattern.class_names();
        let members = |class| classes.iter().filter(|&&other| usize::from(other) == class).count();
        let columns = pattern
            .attributes()
            .iter()
            .map(|attribute| Column::of(attribute, order.iter().map(|&point| attribute.values[point]), precision.value))
            .collect();
        Self {
            names: if names == ["points"] { Vec::new() } else { names.to_vec() },
            counts: (0..names.len()).map(members).collect(),
            places: order.iter().map(|&point| places[point]).collect(),
            columns,
        }
    }

    /// What the receiver will have.
    pub(super) fn pattern(&self, domain: Domain) -> Result<PointPattern, LinkError> {
        let position = |&[x, y]: &[u16; 2]| {
            let share = DVec2::new(f64::from(x), f64::from(y)) / f64::from(PLACES);
            // Rounding must not leave the last one outside.
            (domain.min() + share * domain.size()).clamp(domain.min(), domain.max())
        };
        let mut pattern = PointPattern::new(domain, self.places.iter().map(position).collect())?;
        if !self.names.is_empty() {
            let members = |(class, &count): (usize, &usize)| std::iter::repeat_n(class as u16, count);
            let classes = self.counts.iter().enumerate().flat_map(members).collect();
            pattern = pattern.with_classes(classes, self.names.clone())?;
        }
        for column in &self.columns {
            pattern = pattern.with_attribute(Attribute { name: column.name.clone(), values: column.values()? })?;
        }
        Ok(pattern)
    }

    /// Whether an attribute is told in steps, and so rounded.
    pub(super) fn has_steps(&self) -> bool {
        self.columns.iter().any(|column| matches!(column.scale, Scale::Between(..)))
    }

    /// How many places are taken.
    pub(super) fn distinct_places(&self) -> usize {
        let mut places: Vec<f64> = self.places.iter().copied().map(joined).collect();
        sorting::ascending(&mut places);
        places.dedup();
        places.len()
    }

    /// The points as they stand in a link: of the two layouts the one that is shorter here. The numbers of the sheet
    /// must have no more than this precision.
    pub(super) fn deflated(&self, precision: Precision) -> Vec<u8> {
        let planes = self.planes();
        // In one go, or with codes of their own for the first two, or for each: regular patterns repeat themselves from
        // one section to the next, random ones do not, and of them only the high bytes of steps can be made smaller.
        let planes = [2, planes.len()]
            .into_iter()
            .map(|apart| deflated(&planes, apart))
            .fold(deflated(&planes, 0), |best, next| if next.len() < best.len() { next } else { best });
        let packed = deflated(&self.packed(precision), 0);
        if packed.len() < planes.len() { packed } else { planes }
    }

    /// Reads what [`Self::deflated`] gives.
    pub(super) fn inflated(bytes: &[u8]) -> Result<Self, LinkError> {
        let bytes = decompress_to_vec_with_limit(bytes, MAX_INFLATED)
            .map_err(|_| LinkError::Points("they can't be inflated"))?;
        let mut cursor = Cursor(&bytes);
        let layout = cursor.number(2, "their layout is not known")?;
        let count = cursor.number(MAX_POINTS, "there are too many")?;
        if layout < 2 {
            let mut sheet = Self::read_head(&mut cursor, count)?;
            sheet.read_planes(&mut cursor, count)?;
            return Ok(sheet);
        }
        let mut step = |last: u16| match cursor.number(last.into(), "they are rounded beyond recognition")? {
            0 => Err(LinkError::Points("they are rounded to nothing")),
            step => Ok(step as u16),
        };
        let precision = precision(step(PLACES)?, step(VALUES)?);
        let mut sheet = Self::read_head(&mut cursor, count)?;
        sheet.read_packed(cursor.0, precision)?;
        Ok(sheet)
    }

    /// The layout's number, what belongs to it, then names, numbers and ranges.
    fn head(&self, first: &[usize]) -> Vec<u8> {
        let mut head = Vec::new();
        first.iter().for_each(|&number| push_number(&mut head, number));
        push_number(&mut head, self.names.len());
        for (name, &count) in self.names.iter().zip(&self.counts) {
            push_name(&mut head, name);
            push_number(&mut head, count);
        }
        push_number(&mut head, self.columns.len());
        for column in &self.columns {
            push_name(&mut head, &column.name);
            match &column.scale {
                Scale::Listed(list) => {
                    head.push(0);
                    push_number(&mut head, list.len());
                    list.iter().for_each(|value| head.extend_from_slice(&value.to_le_bytes()));
                }
                Scale::Between(low, high) => {
                    head.push(1);
                    head.extend_from_slice(&low.to_le_bytes());
                    head.extend_from_slice(&high.to_le_bytes());
                }
            }
        }
        head
    }

    fn read_head(cursor: &mut Cursor<'_>, count: usize) -> Result<Self, LinkError> {
        let (mut names, mut counts) = (Vec::new(), Vec::new());
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
        let mut columns = Vec::new();
        for _ in 0..cursor.number(MAX_ATTRIBUTES, "they have too many attributes")? {
            let name = cursor.name()?;
            let scale = match cursor.number(1, "an attribute is written in a way that is not known")? {
                0 => {
                    let listed = cursor.number(MAX_LISTED, "an attribute lists too many values")?;
                    Scale::Listed((0..listed).map(|_| cursor.double()).collect::<Result<_, _>>()?)
                }
                _ => Scale::Between(cursor.double()?, cursor.double()?),
            };
            columns.push(Column { name, scale, numbers: Vec::new() });
        }
        Ok(Self { names, counts, places: Vec::new(), columns })
    }

    /// Layout 1, in sections to be deflated each by itself: their bytes have little in common.
    fn planes(&self) -> Vec<Vec<u8>> {
        let (mut x_high, mut x_low, mut y_high, mut y_low) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        for class in self.classes() {
            let mut last = 0;
            for &[x, y] in class {
                let ([high, low], [y1, y0]) = ((x - last).to_be_bytes(), y.to_be_bytes());
                last = x;
                x_high.push(high);
                x_low.push(low);
                y_high.push(y1);
                y_low.push(y0);
            }
        }
        let mut sections = vec![self.head(&[1, self.places.len()]), x_high, x_low, y_high, y_low];
        for Column { scale, numbers, .. } in &self.columns {
            if matches!(scale, Scale::Listed(_)) {
                sections.push(numbers.iter().map(|&place| place as u8).collect());
                continue;
            }
            sections.push(numbers.iter().map(|step| (step >> 4) as u8).collect());
            let half = |step: &u16| (step & 15) as u8;
            sections.push(numbers.chunks(2).map(|two| half(&two[0]) | two.get(1).map_or(0, half) << 4).collect());
        }
        sections
    }

    fn read_planes(&mut self, cursor: &mut Cursor<'_>, count: usize) -> Result<(), LinkError> {
        let [x_high, x_low, y_high, y_low] =
            [cursor.take(count)?, cursor.take(count)?, cursor.take(count)?, cursor.take(count)?];
        for &members in &self.counts {
            let mut x = 0_u16;
            for _ in 0..members {
                let point = self.places.len();
                x = x.checked_add(u16::from_be_bytes([x_high[point], x_low[point]])).ok_or(OUTSIDE)?;
                self.places.push([x, u16::from_be_bytes([y_high[point], y_low[point]])]);
            }
        }
        for Column { scale, numbers, .. } in &mut self.columns {
            let tops = cursor.take(count)?.iter().map(|&top| u16::from(top));
            if matches!(scale, Scale::Listed(_)) {
                *numbers = tops.collect();
                continue;
            }
            let halves = cursor.take(count.div_ceil(2))?;
            let half = |point: usize| u16::from((halves[point / 2] >> (4 * (point % 2))) & 15);
            *numbers = tops.enumerate().map(|(point, top)| top << 4 | half(point)).collect();
        }
        Ok(())
    }

    /// Layout 2: as few bits as random points can be told in.
    fn packed(&self, precision: Precision) -> Vec<Vec<u8>> {
        let Precision { place, value } = precision;
        let mut bits = BitWriter::default();
        for class in self.classes() {
            let mut last = 0;
            let steps: Vec<u32> = class
                .iter()
                .map(|&[x, _]| {
                    let x = Precision::multiple(x, place);
                    std::mem::replace(&mut last, x).abs_diff(x)
                })
                .collect();
            bits.rice(&steps);
        }
        for &[_, y] in &self.places {
            bits.below(Precision::multiple(y, place), Precision::count(place, PLACES));
        }
        for Column { scale, numbers, .. } in &self.columns {
            for &number in numbers {
                match scale {
                    Scale::Listed(list) => bits.below(number.into(), list.len() as u32),
                    Scale::Between(..) => {
                        bits.below(Precision::multiple(number, value), Precision::count(value, VALUES))
                    }
                }
            }
        }
        vec![self.head(&[2, self.places.len(), place.into(), value.into()]), bits.bytes()]
    }

    fn read_packed(&mut self, bytes: &[u8], precision: Precision) -> Result<(), LinkError> {
        let Precision { place, value } = precision;
        let count = Precision::count(place, PLACES);
        let mut bits = BitReader::new(bytes);
        for &members in &self.counts {
            let mut x = 0_u32;
            for step in bits.rice(members).ok_or(TOO_SOON)? {
                x = x.checked_add(step).filter(|&x| x < count).ok_or(OUTSIDE)?;
                self.places.push([Precision::steps(x as u16, place, PLACES), 0]);
            }
        }
        for [_, y] in &mut self.places {
            *y = Precision::steps(bits.below(count).ok_or(TOO_SOON)? as u16, place, PLACES);
        }
        for Column { scale, numbers, .. } in &mut self.columns {
            for _ in 0..self.places.len() {
                let number = match scale {
                    Scale::Listed(list) => bits.below(list.len() as u32).ok_or(TOO_SOON)? as u16,
                    Scale::Between(..) => {
                        let multiple = bits.below(Precision::count(value, VALUES)).ok_or(TOO_SOON)?;
                        Precision::steps(multiple as u16, value, VALUES)
                    }
                };
                numbers.push(number);
            }
        }
        Ok(())
    }

    /// The places of each class.
    fn classes(&self) -> impl Iterator<Item = &[[u16; 2]]> {
        let mut rest = self.places.as_slice();
        self.counts.iter().map(move |&count| {
            let (class, others) = rest.split_at(count);
            rest = others;
            class
        })
    }
}

impl Column {
    fn of(attribute: &Attribute, values: impl Iterator<Item = f64>, step: u16) -> Self {
        let (name, values) = (attribute.name.clone(), values.collect::<Vec<f64>>());
        if let Some(list) = listed(&values) {
            let place = |value: &f64| list.iter().position(|known| known.to_bits() == value.to_bits()).unwrap_or(0);
            let numbers = values.iter().map(|value| place(value) as u16).collect();
            return Self { name, scale: Scale::Listed(list), numbers };
        }
        let (low, high) = attribute.range();
        // Halved first: the difference of two doubles need not be one.
        let share = |value: f64| (value / 2.0 - low / 2.0) / (high / 2.0 - low / 2.0);
        let numbers =
            values.iter().map(|&value| Precision::of(share(value) * f64::from(VALUES), step, VALUES)).collect();
        Self { name, scale: Scale::Between(low, high), numbers }
    }

    fn values(&self) -> Result<Vec<f64>, LinkError> {
        match &self.scale {
            Scale::Listed(list) => {
                let places = self.numbers.iter();
                let found: Option<Vec<f64>> = places.map(|&place| list.get(usize::from(place)).copied()).collect();
                found.ok_or(LinkError::Points("an attribute has a value that is not in its list"))
            }
            Scale::Between(low, high) => {
                let share = |&steps: &u16| f64::from(steps) / f64::from(VALUES);
                Ok(self.numbers.iter().map(share).map(|share| low * (1.0 - share) + high * share).collect())
            }
        }
    }
}

/// Both coordinates as one number, x before y.
fn joined([x, y]: [u16; 2]) -> f64 {
    f64::from(u32::from(x) << 16 | u32::from(y))
}

const OUTSIDE: LinkError = LinkError::Points("one lies outside the domain");
const TOO_SOON: LinkError = LinkError::Points("they end too soon");

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
    sorting::ascending(&mut list);
    Some(list)
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

/// Deflates sections, so many of the first with codes of their own.
fn deflated(sections: &[Vec<u8>], apart: usize) -> Vec<u8> {
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
}

/// Walks through bytes that may end too soon.
struct Cursor<'a>(&'a [u8]);

impl<'a> Cursor<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8], LinkError> {
        let (taken, rest) = self.0.split_at_checked(count).ok_or(TOO_SOON)?;
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
