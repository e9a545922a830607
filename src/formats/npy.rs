//! NumPy's `.npy`, versions 1 to 3: arrays of shape N × 2 and more. The columns are x, y, then a class or an attribute,
//! then attributes, by the rule for text without a header.

use super::declaration::{Declared, number_text};
use super::error::FormatError;
use super::table::{Row, RowPlace, Table};
use super::{FileFormat, ReadOptions, Reading};
use crate::pattern::{MAX_POINTS, PointPattern};

/// What every file begins with.
pub(super) const MAGIC: &[u8] = b"\x93NUMPY";
/// Longest header: NumPy itself writes 118 bytes.
const MAX_HEADER: usize = 10_000;
/// Most columns, skipped ones included.
const MAX_COLUMNS: usize = 64;

fn refuse<T>(byte: usize, reason: impl Into<String>) -> Result<T, FormatError> {
    Err(FormatError::Array { reason: reason.into(), byte })
}

/// The type of the numbers.
struct Kind {
    /// `f`, `i`, `u` or `b`.
    letter: u8,
    /// Bytes of a number.
    size: usize,
    big_endian: bool,
}

impl Kind {
    fn parse(descr: &str, at: usize) -> Result<Self, FormatError> {
        let bytes = descr.as_bytes();
        let (big_endian, rest) = match bytes {
            [b'>', rest @ ..] => (true, rest),
            [b'<' | b'=' | b'|', rest @ ..] => (false, rest),
            rest => (false, rest),
        };
        match *rest {
            [letter @ b'f', size @ (b'4' | b'8')]
            | [letter @ (b'i' | b'u'), size @ (b'1' | b'2' | b'4' | b'8')]
            | [letter @ b'b', size @ b'1'] => Ok(Self { letter, size: usize::from(size - b'0'), big_endian }),
            _ => refuse(
                at,
                format!(
                    "its numbers are of type {:?}; real numbers (f4, f8) and whole ones (i1 to u8) can be read",
                    super::error::clip(descr)
                ),
            ),
        }
    }

    /// The number as it stands in a cell of a table.
    fn cell(&self, bytes: &[u8]) -> String {
        let mut little = [0_u8; 8];
        for (i, &byte) in bytes.iter().enumerate() {
            little[if self.big_endian { bytes.len() - 1 - i } else { i }] = byte;
        }
        let bits = u64::from_le_bytes(little);
        match (self.letter, self.size) {
            (b'f', 4) => number_text(f64::from(f32::from_bits(bits as u32))),
            (b'f', _) => number_text(f64::from_bits(bits)),
            (b'i', size) => {
                let unused = 64 - 8 * size as u32;
                ((bits << unused) as i64 >> unused).to_string()
            }
            _ => bits.to_string(),
        }
    }
}

/// What follows `'key':` in the header, which begins at byte `start` of the file, up to the header's end; and where.
fn member<'a>(header: &'a str, start: usize, key: &str) -> Result<(&'a str, usize), FormatError> {
    let missing = || FormatError::Array { reason: format!("its header has no '{key}'"), byte: start };
    let at = [format!("'{key}':"), format!("\"{key}\":")].iter().find_map(|k| header.find(k.as_str()));
    let rest = header.get(at.ok_or_else(missing)? + key.len() + 3..).ok_or_else(missing)?;
    let rest = rest.trim_start();
    Ok((rest, start + header.len() - rest.len()))
}

pub(super) fn read(bytes: &[u8], options: &ReadOptions) -> Result<Reading, FormatError> {
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

    let (descr, at) = member(header, start, "descr")?;
    let quoted = descr.strip_prefix(['\'', '"']).and_then(|text| text.split(['\'', '"']).next());
    let Some(descr) = quoted else { return refuse(at, "it has named fields; save its columns as one plain array") };
    let kind = Kind::parse(descr, at)?;
    let fortran = member(header, start, "fortran_order")?.0.starts_with("True");
    let (text, at) = member(header, start, "shape")?;
    let [rows, columns] = shape(text, at)?;

    let needed = rows.checked_mul(columns).and_then(|count| count.checked_mul(kind.size));
    if needed != Some(data.len()) {
        return refuse(start + length, format!("{rows} × {columns} numbers do not take {} bytes", data.len()));
    }
    let mut table = Table::new(Declared::default());
    for row in 0..rows {
        let number = |column: usize| {
            let index = if fortran { column * rows + row } else { row * columns + column };
            kind.cell(&data[index * kind.size..(index + 1) * kind.size])
        };
        table.push(Row::new(RowPlace::Entry(row + 1, None), (0..columns).map(number)))?;
    }
    table.into_reading(FileFormat::Npy, options)
}

/// `(300, 2)`.
fn shape(text: &str, at: usize) -> Result<[usize; 2], FormatError> {
    let inner = text.strip_prefix('(').and_then(|text| text.split_once(')')).map_or("", |(inner, _)| inner);
    let sides: Vec<&str> = inner.split(',').map(str::trim).filter(|side| !side.is_empty()).collect();
    let [rows, columns] = sides.as_slice() else {
        let found = super::error::clip(&sides.join(", "));
        return refuse(at, format!("its shape is ({found}); N rows of x, y and perhaps more are needed"));
    };
    let (Ok(rows), Ok(columns)) = (rows.parse(), columns.parse()) else {
        return refuse(at, format!("its shape is ({}), which are no sizes", super::error::clip(inner)));
    };
    if rows == 0 {
        return Err(FormatError::NoPoints);
    }
    if !(2..=MAX_COLUMNS).contains(&columns) {
        return refuse(at, format!("it has {columns} columns; x, y and at most {} more are needed", MAX_COLUMNS - 2));
    }
    if rows > MAX_POINTS {
        return refuse(at, format!("it has {rows} rows; at most {MAX_POINTS} points are allowed"));
    }
    Ok([rows, columns])
}

/// Writes a pattern as an array of doubles, one row a point: x, y, the class's number when there is more than one class,
/// then the attributes.
#[must_use]
pub fn write_npy(pattern: &PointPattern) -> Vec<u8> {
    let classes = pattern.class_names().len() > 1;
    let columns = 2 + usize::from(classes) + pattern.attributes().len();
    let mut header = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({}, {columns}), }}", pattern.len());
    // The numbers begin at a multiple of 64 bytes; the header ends with a line feed.
    let start = MAGIC.len() + 4;
    while !(start + header.len() + 1).is_multiple_of(64) {
        header.push(' ');
    }
    header.push('\n');
    let mut bytes = Vec::with_capacity(start + header.len() + 8 * columns * pattern.len());
    bytes.extend_from_slice(MAGIC);
    bytes.extend_from_slice(&[1, 0]);
    // A few dozen bytes, far below u16::MAX.
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
