//! NumPy's `.npy`, versions 1 to 3: one point a row.
//!
//! | array | read as |
//! |---|---|
//! | N × 2 and more | x, y, then a class or an attribute, then attributes, by the rule for text without a header |
//! | 2 × N, 3 × N | the same with rows and columns exchanged |
//! | complex, N | x is the real part, y the imaginary one |
//! | named fields, N | a table whose header is the names |
//!
//! Axes of length 1 do not count where there are three or more.

use super::declaration::{Declared, number_text};
use super::error::{FormatError, clip};
use super::literal::Literal;
use super::note::counted;
use super::table::{Row, RowPlace, Table};
use super::{FileFormat, Note, ReadOptions, Reading, column_names};
use crate::pattern::{MAX_ATTRIBUTES, MAX_POINTS, PointPattern};

/// What every file begins with.
pub(super) const MAGIC: &[u8] = b"\x93NUMPY";
/// Longest header: NumPy itself writes 118 bytes.
pub(super) const MAX_HEADER: usize = 10_000;
/// Most columns, skipped ones included.
const MAX_COLUMNS: usize = 64;
/// Most columns that a pattern has room for: x, y, a class and its attributes.
const MOST_USED: usize = 3 + MAX_ATTRIBUTES;

fn refuse<T>(byte: usize, reason: impl Into<String>) -> Result<T, FormatError> {
    Err(FormatError::Array { reason: reason.into(), byte })
}

/// The type of a value.
#[derive(Clone, Debug)]
struct Kind {
    /// `f`, `i`, `u`, `b`, `c` for numbers; `S` and `U` for words; `V` for what is skipped.
    letter: u8,
    /// Bytes of a value.
    size: usize,
    big_endian: bool,
}

impl Kind {
    /// `None` for types that hold neither numbers nor words.
    fn parse(descr: &str) -> Option<Self> {
        let (big_endian, rest) = match descr.as_bytes() {
            [b'>', rest @ ..] => (true, rest),
            [b'<' | b'=' | b'|', rest @ ..] => (false, rest),
            rest => (false, rest),
        };
        let (&letter, size) = rest.split_first()?;
        let letter = match letter {
            b'?' if size.is_empty() => return Some(Self { letter: b'b', size: 1, big_endian }),
            b'a' => b'S',
            letter => letter,
        };
        let size: usize = std::str::from_utf8(size).ok()?.parse().ok()?;
        match (letter, size) {
            (b'f', 2 | 4 | 8) | (b'i' | b'u', 1 | 2 | 4 | 8) | (b'b', 1) | (b'c', 8 | 16) => {}
            // A name has at most 100 characters; longer ones are refused where they are read.
            (b'S' | b'U', 0..=10_000) => {}
            _ => return None,
        }
        Some(Self { letter, size: if letter == b'U' { 4 * size } else { size }, big_endian })
    }

    /// How many bytes a value of a type takes that can't be read, where its description tells.
    fn skipped(descr: &str) -> Option<Self> {
        let digits = descr.trim_start_matches(['<', '>', '=', '|']).get(1..)?;
        let digits = digits.split('[').next()?;
        let size = match descr.contains('[') {
            // Dates: M8[ns].
            true => 8,
            false => digits.parse().ok()?,
        };
        Some(Self { letter: b'V', size, big_endian: false })
    }

    fn is_complex(&self) -> bool {
        self.letter == b'c'
    }

    /// The value as it stands in a cell of a table.
    fn cell(&self, bytes: &[u8]) -> String {
        match self.letter {
            b'S' => String::from_utf8_lossy(bytes).trim_end_matches('\0').to_owned(),
            b'U' => {
                let sign = |four: &[u8]| char::from_u32(self.bits(four) as u32).unwrap_or(char::REPLACEMENT_CHARACTER);
                bytes.chunks_exact(4).map(sign).collect::<String>().trim_end_matches('\0').to_owned()
            }
            b'f' => match self.size {
                2 => number_text(half(self.bits(bytes) as u16)),
                4 => number_text(f64::from(f32::from_bits(self.bits(bytes) as u32))),
                _ => number_text(f64::from_bits(self.bits(bytes))),
            },
            b'i' => {
                let unused = 64 - 8 * self.size as u32;
                ((self.bits(bytes) << unused) as i64 >> unused).to_string()
            }
            b'V' => String::new(),
            _ => self.bits(bytes).to_string(),
        }
    }

    /// Up to eight bytes as one whole number.
    fn bits(&self, bytes: &[u8]) -> u64 {
        let join = |bits: u64, &byte: &u8| bits << 8 | u64::from(byte);
        if self.big_endian { bytes.iter().fold(0, join) } else { bytes.iter().rev().fold(0, join) }
    }

    /// Real and imaginary part of a complex number.
    fn parts(&self, bytes: &[u8]) -> [String; 2] {
        let part = Self { letter: b'f', size: self.size / 2, big_endian: self.big_endian };
        let (real, imaginary) = bytes.split_at(part.size.min(bytes.len()));
        [part.cell(real), part.cell(imaginary)]
    }
}

/// IEEE 754 binary16.
fn half(bits: u16) -> f64 {
    let (exponent, fraction) = (u64::from(bits >> 10 & 31), f64::from(bits & 1023));
    let size = match exponent {
        0 => fraction / f64::from(1 << 24),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        // A power of two by its exponent's bits; binary16's are off by 15, binary64's by 1023.
        _ => (1.0 + fraction / 1024.0) * f64::from_bits((exponent + 1023 - 15) << 52),
    };
    if bits >> 15 == 0 { size } else { -size }
}

/// A value within a record.
#[derive(Debug)]
struct Field {
    name: String,
    kind: Kind,
    /// Bytes from the beginning of the record.
    at: usize,
}

/// What one entry of an array is.
#[derive(Debug)]
enum Entry {
    Value(Kind),
    Record {
        fields: Vec<Field>,
        size: usize,
        /// Fields of types that can't be read.
        left_out: Vec<String>,
    },
}

impl Entry {
    fn of(descr: &Literal, at: usize) -> Result<Self, FormatError> {
        match descr {
            Literal::Text(descr) => match Kind::parse(descr) {
                Some(kind) => Ok(Self::Value(kind)),
                None => refuse(
                    at,
                    format!(
                        "its numbers are of type {:?}; real numbers (f2, f4, f8), whole ones (i1 to u8) and complex ones \
                         (c8, c16) can be read",
                        clip(descr)
                    ),
                ),
            },
            Literal::List(entries) => Self::record(entries, at),
            _ => refuse(at, "its header does not say of which type the numbers are"),
        }
    }

    /// `[('x', '<f8'), ('pos', '<f4', (2,)), …]`.
    fn record(entries: &[Literal], at: usize) -> Result<Self, FormatError> {
        let (mut fields, mut left_out, mut size) = (Vec::new(), Vec::new(), 0_usize);
        for entry in entries {
            let Literal::List(entry) = entry else { return refuse(at, "its named fields can't be understood") };
            let name = match entry.first() {
                Some(Literal::Text(name)) => name.clone(),
                // A title, then the name.
                Some(Literal::List(names)) => names.last().and_then(Literal::text).unwrap_or_default().to_owned(),
                _ => String::new(),
            };
            let values = entry.get(2).map_or(Some(1), Literal::product).filter(|&values| values <= MAX_HEADER);
            let Some(values) = values else {
                return refuse(at, format!("its field '{}' has a shape that is too large", clip(&name)));
            };
            let (kind, can_read) = match entry.get(1) {
                Some(Literal::Text(descr)) => match Kind::parse(descr) {
                    Some(kind) => (Some(kind), true),
                    None => (Kind::skipped(descr), false),
                },
                Some(Literal::List(inner)) => match Self::record(inner, at)? {
                    Self::Record { size, .. } => (Some(Kind { letter: b'V', size, big_endian: false }), false),
                    Self::Value(kind) => (Some(kind), true),
                },
                _ => (None, false),
            };
            let Some(kind) = kind else {
                return refuse(at, format!("its field '{}' is of a type that can't be read", clip(&name)));
            };
            let width = kind.size.checked_mul(values);
            let Some(end) = width.and_then(|width| size.checked_add(width)).filter(|&end| end <= super::MAX_BYTES)
            else {
                return refuse(at, format!("its field '{}' is too large", clip(&name)));
            };
            if name.is_empty() {
                // What aligns the next field.
            } else if !can_read || kind.is_complex() || fields.len() + values > MAX_COLUMNS {
                left_out.push(name);
            } else {
                for value in 0..values {
                    let name = if values == 1 { name.clone() } else { format!("{name}-{}", value + 1) };
                    fields.push(Field { name, kind: kind.clone(), at: size + value * kind.size });
                }
            }
            size = end;
        }
        // One field of two or three numbers is the place, when nothing else is called x and y.
        let names: Vec<&str> = fields.iter().map(|field| field.name.as_str()).collect();
        if column_names::place_columns(&names).is_none() {
            let places = entries.iter().find_map(|entry| match entry {
                Literal::List(entry) if matches!(entry.get(2).and_then(Literal::product), Some(2 | 3)) => {
                    entry.first().and_then(Literal::text)
                }
                _ => None,
            });
            if let Some(place) = places {
                for (number, name) in ["x", "y", "z"].iter().enumerate() {
                    let called = format!("{place}-{}", number + 1);
                    fields
                        .iter_mut()
                        .filter(|field| field.name == called)
                        .for_each(|field| field.name = (*name).to_owned());
                }
            }
        }
        if fields.len() < 2 {
            return refuse(at, "it has named fields, and less than two of them hold numbers; x and y are needed");
        }
        Ok(Self::Record { fields, size, left_out })
    }

    fn size(&self) -> usize {
        match self {
            Self::Value(kind) => kind.size,
            Self::Record { size, .. } => *size,
        }
    }
}

/// An array whose header is understood; its numbers may be incomplete.
#[derive(Debug)]
pub(super) struct Array<'a> {
    entry: Entry,
    /// The type as it was written.
    descr: String,
    descr_at: usize,
    is_fortran: bool,
    /// Lengths of its axes.
    shape: Vec<usize>,
    shape_at: usize,
    data: &'a [u8],
    data_at: usize,
}

impl<'a> Array<'a> {
    pub(super) fn parse(bytes: &'a [u8]) -> Result<Self, FormatError> {
        let short = || FormatError::Array { reason: "it ends within its header".to_owned(), byte: bytes.len() };
        let rest = bytes.get(MAGIC.len()..).ok_or_else(short)?;
        let (length, start) = match *rest {
            [1, _, a, b, ..] => (usize::from(u16::from_le_bytes([a, b])), 4),
            [2 | 3, _, a, b, c, d, ..] => (u32::from_le_bytes([a, b, c, d]) as usize, 6),
            [version, ..] if !(1..=3).contains(&version) => {
                return refuse(MAGIC.len(), format!("its version is {version}; 1 to 3 can be read"));
            }
            _ => return Err(short()),
        };
        if length > MAX_HEADER {
            return refuse(MAGIC.len() + 2, format!("its header has {length} bytes; at most {MAX_HEADER} are allowed"));
        }
        let header = rest.get(start..start + length).ok_or_else(short)?;
        let data = &rest[start + length..];
        let start = MAGIC.len() + start;
        let header = match std::str::from_utf8(header) {
            Ok(header) => header,
            Err(error) => return refuse(start + error.valid_up_to(), "its header is not text"),
        };
        let members = match Literal::members(header) {
            Ok(members) => members,
            Err(at) => return refuse(start + at, "its header is no list of 'descr', 'fortran_order' and 'shape'"),
        };
        let member = |key: &str| {
            let found = members.iter().find(|member| member.key == key);
            let missing = || FormatError::Array { reason: format!("its header has no '{key}'"), byte: start };
            found.map(|member| (&member.value, start + member.at, member.text)).ok_or_else(missing)
        };
        let (descr, descr_at, descr_text) = member("descr")?;
        let (fortran, ..) = member("fortran_order")?;
        let (shape, shape_at, shape_text) = member("shape")?;
        let Some(shape) = shape.sizes() else {
            let inner = shape_text.trim_start_matches('(').trim_end_matches(')');
            return refuse(shape_at, format!("its shape is ({}), which are no sizes", clip(inner)));
        };
        Ok(Self {
            entry: Entry::of(descr, descr_at)?,
            descr: descr_text.trim_matches(['\'', '"']).to_owned(),
            descr_at,
            is_fortran: *fortran == Literal::Flag(true),
            shape,
            shape_at,
            data,
            data_at: start + length,
        })
    }

    /// As NumPy writes it, without the brackets.
    pub(super) fn shape_text(&self) -> String {
        clip(&self.shape.iter().map(usize::to_string).collect::<Vec<_>>().join(", "))
    }

    /// How many entries there are, when it is a plain list of them.
    pub(super) fn list_length(&self) -> Option<usize> {
        let [length] = self.shape[..] else { return None };
        match &self.entry {
            Entry::Value(kind) if !kind.is_complex() => Some(length),
            _ => None,
        }
    }

    /// Whether it may hold places by itself.
    pub(super) fn may_hold_places(&self) -> bool {
        self.list_length().is_none() && !self.shape.is_empty()
    }

    /// How many columns of how many rows there are, when each is a value.
    pub(super) fn is_pairs_of(&self) -> Option<usize> {
        match (&self.entry, &self.shape[..]) {
            (Entry::Value(kind), &[rows, 2]) if !kind.is_complex() => Some(rows),
            _ => None,
        }
    }

    /// The entry in a row and column of the array, whose shape is given, as text.
    pub(super) fn cell_of(&self, row: usize, column: usize, [rows, columns]: [usize; 2]) -> String {
        match &self.entry {
            Entry::Value(kind) => {
                let index = if self.is_fortran { column * rows + row } else { row * columns + column };
                kind.cell(self.bytes(index))
            }
            Entry::Record { .. } => String::new(),
        }
    }

    fn bytes(&self, index: usize) -> &'a [u8] {
        let size = self.entry.size();
        self.data.get(index * size..(index + 1) * size).unwrap_or_default()
    }

    /// Refuses more points than a pattern may have.
    fn check_rows(&self, rows: usize) -> Result<(), FormatError> {
        match rows {
            0 => Err(FormatError::NoPoints),
            1..=MAX_POINTS => Ok(()),
            _ => refuse(self.shape_at, format!("it has {rows} rows; at most {MAX_POINTS} points are allowed")),
        }
    }

    /// Refuses an array of `count` entries whose numbers are not all there.
    pub(super) fn check_data(&self, count: Option<usize>) -> Result<(), FormatError> {
        if count.and_then(|count| count.checked_mul(self.entry.size())) == Some(self.data.len()) {
            return Ok(());
        }
        let sides = self.shape.iter().map(usize::to_string).collect::<Vec<_>>().join(" × ");
        refuse(self.data_at, format!("{sides} numbers do not take {} bytes", self.data.len()))
    }

    pub(super) fn count(&self) -> Option<usize> {
        self.shape.iter().try_fold(1_usize, |count, &side| count.checked_mul(side))
    }

    /// Its rows.
    pub(super) fn into_table(self) -> Result<Table, FormatError> {
        match &self.entry {
            Entry::Record { fields, left_out, .. } => self.records(fields, left_out),
            Entry::Value(kind) if kind.is_complex() => self.complex(kind),
            Entry::Value(_) => self.grid(),
        }
    }

    fn records(&self, fields: &[Field], left_out: &[String]) -> Result<Table, FormatError> {
        let rows = self.count().unwrap_or(usize::MAX);
        self.check_rows(rows)?;
        self.check_data(self.count())?;
        let mut table = Table::new(Declared::default());
        for row in 0..rows {
            let record = self.bytes(row);
            let cell =
                |field: &Field| field.kind.cell(record.get(field.at..field.at + field.kind.size).unwrap_or_default());
            table.push(Row::new(RowPlace::Entry(row + 1, None), fields.iter().map(cell)))?;
        }
        table.header = Some(fields.iter().map(|field| field.name.clone()).collect());
        if !left_out.is_empty() {
            let names: Vec<String> = left_out.iter().take(8).map(|name| format!("'{}'", clip(name))).collect();
            table.notes.push(Note::left_out(format!(
                "{} left out, of types that no column can have: {}. Real and whole numbers and words can be read.",
                counted(left_out.len(), "One named field was", "named fields were"),
                names.join(", "),
            )));
        }
        Ok(table)
    }

    fn complex(&self, kind: &Kind) -> Result<Table, FormatError> {
        let long: Vec<usize> = self.shape.iter().copied().filter(|&side| side != 1).collect();
        if long.len() > 1 || self.shape.is_empty() {
            return refuse(
                self.descr_at,
                format!(
                    "its numbers are of type {:?}, complex, and its shape is ({}); complex numbers, x + iy, are read from \
                     a list of them",
                    clip(&self.descr),
                    self.shape_text()
                ),
            );
        }
        let rows = self.count().unwrap_or(usize::MAX);
        self.check_rows(rows)?;
        self.check_data(self.count())?;
        let mut table = Table::new(Declared::default());
        for row in 0..rows {
            table.push(Row::new(RowPlace::Entry(row + 1, None), kind.parts(self.bytes(row))))?;
        }
        table.notes.push(Note::changed("The numbers are complex: x is their real part, y their imaginary part."));
        Ok(table)
    }

    fn grid(&self) -> Result<Table, FormatError> {
        let mut table = Table::new(Declared::default());
        let long: Vec<usize> = self.shape.iter().copied().filter(|&side| side != 1).collect();
        let [rows, columns] = match self.shape[..] {
            [rows, columns] => [rows, columns],
            // Axes of one entry change nothing of the order of the numbers.
            [_, _, _, ..] if long.len() == 2 => {
                table.notes.push(Note::changed(format!(
                    "The shape ({}) was read as {} rows of {} numbers.",
                    self.shape_text(),
                    long[0],
                    long[1]
                )));
                [long[0], long[1]]
            }
            _ => return self.no_rows(),
        };
        if rows == 0 || columns == 0 {
            return Err(FormatError::NoPoints);
        }
        // As many columns as no pattern has, or as few rows as no exemplar has.
        let is_turned = rows == 2 && columns > 2 || rows == 3 && columns > MOST_USED;
        let is_list = columns == 1 && rows > 1 || rows == 1 && columns > MOST_USED;
        let [points, values] = if is_turned { [columns, rows] } else { [rows, columns] };
        if is_list || !(2..=MAX_COLUMNS).contains(&values) {
            let hint = match (is_list, values > MAX_COLUMNS && columns > rows) {
                (true, _) => reshape_hint(rows.max(columns)),
                (_, true) => "; if rows and columns are exchanged, save array.T",
                _ => "",
            };
            let more = MAX_COLUMNS - 2;
            return refuse(
                self.shape_at,
                format!("it has {columns} columns; x, y and at most {more} more are needed{hint}"),
            );
        }
        self.check_rows(points)?;
        self.check_data(rows.checked_mul(columns))?;
        if is_turned {
            let third = if rows == 3 { " and a third value" } else { "" };
            table.notes.push(Note::changed(format!(
                "The array has {rows} rows of {columns} numbers: they were read as {columns} points, the rows as x, y{third}. \
                 Save array.T if that was not meant."
            )));
        }
        for point in 0..points {
            let number = |value: usize| {
                let [row, column] = if is_turned { [value, point] } else { [point, value] };
                self.cell_of(row, column, [rows, columns])
            };
            table.push(Row::new(RowPlace::Entry(point + 1, None), (0..values).map(number)))?;
        }
        Ok(table)
    }

    /// Refuses a shape that has no rows of values.
    fn no_rows<T>(&self) -> Result<T, FormatError> {
        let hint = match self.shape[..] {
            [length] => reshape_hint(length),
            [] => "",
            _ => "; save one plane of it, as in array[0]",
        };
        refuse(
            self.shape_at,
            format!("its shape is ({}); N rows of x, y and perhaps more are needed{hint}", self.shape_text()),
        )
    }
}

/// What to do with a list of numbers.
fn reshape_hint(length: usize) -> &'static str {
    if length > 2 && length.is_multiple_of(2) {
        "; when x and y take turns save array.reshape(-1, 2), when all x come first save array.reshape(2, -1).T"
    } else {
        ""
    }
}

pub(super) fn read(bytes: &[u8], options: &ReadOptions) -> Result<Reading, FormatError> {
    Array::parse(bytes)?.into_table()?.into_reading(FileFormat::Npy, options)
}

/// Writes a pattern as an array of doubles, one row a point: x, y, the class's number when there is more than one class,
/// then the attributes. Two points of more than two values have named fields: two rows would be taken for x and y.
#[must_use]
pub fn write_npy(pattern: &PointPattern) -> Vec<u8> {
    let classes = pattern.class_names().len() > 1;
    let columns = 2 + usize::from(classes) + pattern.attributes().len();
    let mut header = if pattern.len() == 2 && columns > 2 {
        let class = classes.then(|| "class".to_owned());
        let attributes = (1..=pattern.attributes().len()).map(|number| format!("attribute-{number}"));
        let names = ["x", "y"].map(str::to_owned).into_iter().chain(class).chain(attributes);
        let fields: String = names.map(|name| format!("('{name}', '<f8'), ")).collect();
        format!("{{'descr': [{}], 'fortran_order': False, 'shape': (2,), }}", fields.trim_end_matches(", "))
    } else {
        format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({}, {columns}), }}", pattern.len())
    };
    // The numbers begin at a multiple of 64 bytes; the header ends with a line feed.
    let start = MAGIC.len() + 4;
    while !(start + header.len() + 1).is_multiple_of(64) {
        header.push(' ');
    }
    header.push('\n');
    let mut bytes = Vec::with_capacity(start + header.len() + 8 * columns * pattern.len());
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(&[1, 0]);
    // A few hundred bytes, far below u16::MAX.
    bytes.extend_from_slice(&(header.len() as u16).to_le_bytes());
    bytes.extend_from_slice(header.as_bytes());
    for (i, position) in pattern.positions().iter().enumerate() {
        let class = classes.then(|| f64::from(pattern.classes()[i]));
        let attributes = pattern.attributes().iter().map(|attribute| attribute.values[i]);
        for number in [position.x, position.y].into_iter().chain(class).chain(attributes) {
            bytes.extend_from_slice(&number.to_le_bytes());
        }
    }
    bytes
}
