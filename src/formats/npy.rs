//! NumPy's `.npy`, versions 1 to 3: arrays of shape N × 2 and more, lying or standing; of complex numbers, which are
//! x + iy; and of named fields. Columns without names are x, y, then a class or an attribute, then attributes, by the rule for
//! text without a header.

use super::column_names;
use super::declaration::Declared;
use super::error::FormatError;
use super::npy_header::{Descr, Field, Header, Kind};
use super::table::{Row, RowPlace, Table};
use super::{FileFormat, Note, ReadOptions, Reading};
use crate::pattern::{MAX_ATTRIBUTES, MAX_POINTS, PointPattern};

/// What every file begins with.
pub(super) const MAGIC: &[u8] = b"\x93NUMPY";
/// Most columns, skipped ones included.
const MAX_COLUMNS: usize = 64;
/// Most columns that [`write_npy`] makes: places, classes and attributes. An array with more columns and few rows lies on its
/// side.
const MOST_WRITTEN: usize = 3 + MAX_ATTRIBUTES;
/// A row of more than two numbers a point is one only where it is so many times as long as there are rows.
const SLENDER: usize = 4;

pub(super) fn refuse<T>(byte: usize, reason: impl Into<String>) -> Result<T, FormatError> {
    Err(FormatError::Array { reason: reason.into(), byte })
}

/// The numbers of one column: at byte `offset` of the first row.
#[derive(Debug)]
struct Cells {
    name: String,
    kind: Kind,
    offset: usize,
}

/// An array as rows and columns, wherever their numbers stand.
#[derive(Debug)]
pub(super) struct Array<'a> {
    data: &'a [u8],
    pub(super) rows: usize,
    /// Bytes from one row to the next.
    stride: usize,
    columns: Vec<Cells>,
    has_names: bool,
    /// The sides it has in the file, those of 1 left out.
    sides: usize,
    note: Option<Note>,
}

impl<'a> Array<'a> {
    /// Nothing is reserved for what the header claims before it is compared with the bytes there are.
    pub(super) fn parse(bytes: &'a [u8]) -> Result<Self, FormatError> {
        Self::parse_any(bytes, false)
    }

    fn parse_any(bytes: &'a [u8], may_be_text: bool) -> Result<Self, FormatError> {
        let Header { descr, is_fortran, shape, shape_at, end } = Header::parse(bytes)?;
        let data = bytes.get(end..).unwrap_or_default();
        let count = shape.iter().try_fold(1_usize, |count, &side| count.checked_mul(side));
        let words = shape.iter().map(usize::to_string).collect::<Vec<_>>().join(", ");
        if count == Some(0) {
            return Err(FormatError::NoPoints);
        }
        // Of a side of 1 the array is one thing thick.
        let mut sides = shape.clone();
        while sides.len() > 2
            && let Some(thin) = sides.iter().position(|&side| side == 1)
        {
            sides.remove(thin);
        }
        if may_be_text || matches!(descr, Descr::Fields(_)) {
            sides.retain(|&side| side != 1);
            if sides.is_empty() {
                sides.push(1);
            }
        }
        let (rows, across) = match *sides.as_slice() {
            [rows] => (rows, 1),
            [rows, columns] => (rows, columns),
            _ => {
                return refuse(shape_at, format!("its shape is ({words}); N rows of x, y and perhaps more are needed"));
            }
        };
        let largest = rows.max(across);
        if largest > MAX_POINTS {
            return refuse(shape_at, format!("it has {largest} rows; at most {MAX_POINTS} points are allowed"));
        }
        let size = descr.size();
        if count.and_then(|count| count.checked_mul(size)) != Some(data.len()) {
            let reason =
                format!("numbers in a shape of ({words}), {size} bytes each, do not take {} bytes", data.len());
            return refuse(end, reason);
        }
        let sides = sides.len();
        let mut array = Self { data, rows, stride: size, columns: Vec::new(), has_names: false, sides, note: None };
        match descr {
            Descr::Fields(fields) => {
                if sides > 1 {
                    return refuse(shape_at, format!("its shape is ({words}); records must be in one row"));
                }
                // The first field of two numbers is the place, where no other says that it is.
                let axes = ["x", "y", "z"];
                let is_axis = |field: &Field| axes.contains(&field.name.to_ascii_lowercase().as_str());
                let mut is_place =
                    !fields.iter().any(|field| field.count == 1 && !field.kind.is_complex() && is_axis(field));
                for field in fields.into_iter().filter(|field| !field.is_filling()) {
                    let is_pair = field.kind.is_complex() || (2..=3).contains(&field.count);
                    let name = if is_pair && std::mem::take(&mut is_place) { "" } else { &field.name };
                    array.push_field(name, field.kind, field.offset, field.count);
                }
                // NumPy's own names tell nothing.
                let is_numbered =
                    |cells: &Cells| cells.name.strip_prefix('f').is_some_and(|rest| rest.parse::<u8>().is_ok());
                array.has_names = !array.columns.iter().all(is_numbered);
            }
            Descr::Plain(kind) if kind.is_complex() && (rows == 1 || across == 1) => {
                array.rows = rows.max(across);
                let half = kind.half();
                array.columns = [0, half.size].map(|offset| Cells { name: String::new(), kind: half, offset }).into();
            }
            Descr::Plain(kind) if kind.is_complex() => {
                let reason = format!("its shape is ({words}); complex numbers must be in one row, x + iy each");
                return refuse(shape_at, reason);
            }
            Descr::Plain(kind) if kind.is_text() && !may_be_text => {
                return refuse(shape_at, "its entries are words, and no numbers");
            }
            Descr::Plain(kind) => {
                let is_lying = across > MOST_WRITTEN
                    && (rows == 2 || rows > 2 && rows <= MOST_WRITTEN && across >= SLENDER * rows);
                let step = |is_first: bool| match (is_first, is_fortran) {
                    (true, false) => size * across,
                    (true, true) | (false, false) => size,
                    (false, true) => size * rows,
                };
                let columns = if is_lying { rows } else { across };
                (array.rows, array.stride) = if is_lying { (across, step(false)) } else { (rows, step(true)) };
                let apart = step(is_lying);
                if columns <= MAX_COLUMNS {
                    array.columns =
                        (0..columns).map(|at| Cells { name: String::new(), kind, offset: at * apart }).collect();
                }
                if is_lying {
                    let all = if rows == 2 { "x and y" } else { "x, y and more" };
                    array.note = Some(Note::changed(format!(
                        "The array has {rows} rows and {across} columns, so its rows were taken for {all} of {across} points."
                    )));
                }
                if array.sides == 2 && !(2..=MAX_COLUMNS).contains(&columns) {
                    let most = MAX_COLUMNS - 2;
                    return refuse(
                        shape_at,
                        format!("it has {columns} columns; x, y and at most {most} more are needed"),
                    );
                }
            }
        }
        if array.columns.len() > MAX_COLUMNS {
            let count = array.columns.len();
            return refuse(
                shape_at,
                format!("it has {count} columns; x, y and at most {} more are needed", MAX_COLUMNS - 2),
            );
        }
        Ok(array)
    }

    fn push_field(&mut self, name: &str, kind: Kind, offset: usize, count: usize) {
        if kind.is_complex() && count == 1 {
            let half = kind.half();
            return self.push_field(name, half, offset, 2);
        }
        for at in 0..count.min(MAX_COLUMNS + 1) {
            let name = match (count, ["x", "y", "z"].get(at)) {
                (1, _) => name.to_owned(),
                (2 | 3, Some(axis)) if name.is_empty() => (*axis).to_owned(),
                (2 | 3, Some(axis)) => format!("{name}.{axis}"),
                _ => format!("{name}.{at}"),
            };
            self.columns.push(Cells { name, kind, offset: offset + at * kind.size });
        }
    }

    /// Whether it is one row of plain numbers or words.
    pub(super) fn is_one_row(&self) -> bool {
        self.columns.len() == 1 && !self.has_names
    }

    /// Whether it holds places.
    pub(super) fn has_places(&self) -> bool {
        match self.has_names {
            true => column_names::place_columns(&self.names()).is_some(),
            false => self.columns.len() >= 2,
        }
    }

    pub(super) fn names(&self) -> Vec<String> {
        self.columns.iter().map(|cells| cells.name.clone()).collect()
    }

    pub(super) fn has_names(&self) -> bool {
        self.has_names
    }

    pub(super) fn into_note(self) -> Option<Note> {
        self.note
    }

    /// One number or word a row, nothing else.
    pub(super) fn parse_column(bytes: &'a [u8]) -> Option<Self> {
        let array = Self::parse_any(bytes, true).ok()?;
        array.is_one_row().then_some(array)
    }

    /// The cells of a row.
    pub(super) fn row(&self, row: usize) -> impl Iterator<Item = String> + '_ {
        self.columns.iter().map(move |Cells { kind, offset, .. }| {
            let start = row * self.stride + offset;
            kind.cell(self.data.get(start..start + kind.size).unwrap_or_default())
        })
    }

    pub(super) fn into_reading(self, options: &ReadOptions) -> Result<Reading, FormatError> {
        let mut table = Table::new(Declared::default());
        for row in 0..self.rows {
            table.push(Row::new(RowPlace::Entry(row + 1, None), self.row(row)))?;
        }
        if self.has_names {
            table.header = Some(self.names());
        }
        table.notes.extend(self.note);
        table.into_reading(FileFormat::Npy, options)
    }
}

pub(super) fn read(bytes: &[u8], options: &ReadOptions) -> Result<Reading, FormatError> {
    let array = Array::parse(bytes)?;
    if array.is_one_row() {
        let (rows, at) = (array.rows, Header::parse(bytes)?.shape_at);
        let reason = format!(
            "its shape is ({rows}), single numbers; N rows of x and y are needed, as numpy.column_stack((x, y)) makes them"
        );
        return refuse(at, reason);
    }
    array.into_reading(options)
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
