//! NumPy's `.npz`: a ZIP archive of arrays. Other archives of this kind are called what they are.
//!
//! | arrays | read as |
//! |---|---|
//! | one | it |
//! | `x` and `y`, lists of one length | a table; other lists of this length are its further columns |
//! | `points`, `xy`, … (see [`PLACES`]) | it; where it has two columns, lists of its length are further columns |
//! | `arr_0` and `arr_1`, two lists of one length and nothing else | x and y |
//!
//! An archive tells everything twice; the directory at its end is believed, as every reader does.

use super::declaration::Declared;
use super::error::{FormatError, clip};
use super::note::counted;
use super::npy::{self, Array};
use super::table::{Row, RowPlace, Table};
use super::{FileFormat, MAX_BYTES, Note, ReadOptions, Reading, column_names};
use crate::pattern::MAX_POINTS;

/// Most arrays that are looked at.
const MAX_ARRAYS: usize = 64;
/// Most entries of an archive: beyond any that a person made of arrays.
const MAX_ENTRIES: usize = 10_000;
/// Names of arrays that hold the points, the likeliest first.
const PLACES: [&str; 8] = ["points", "pts", "xy", "coords", "coordinates", "positions", "arr_0", "data"];
/// How many arrays an error names.
const NAMED: usize = 8;
/// The longest header of an array and what stands before it.
const HEAD: usize = npy::MAX_HEADER + 12;

fn refuse<T>(reason: impl Into<String>) -> Result<T, FormatError> {
    Err(FormatError::Archive { reason: reason.into() })
}

/// Whether these are the first bytes of an archive, an empty one or one of several parts.
pub(super) fn is_zip(bytes: &[u8]) -> bool {
    [b"PK\x03\x04", b"PK\x05\x06", b"PK\x07\x08"].iter().any(|start| bytes.starts_with(*start))
}

fn short(bytes: &[u8], at: usize) -> Option<usize> {
    let two = bytes.get(at..)?.get(..2)?;
    Some(usize::from(u16::from_le_bytes(two.try_into().ok()?)))
}

fn long(bytes: &[u8], at: usize) -> Option<u32> {
    let four = bytes.get(at..)?.get(..4)?;
    Some(u32::from_le_bytes(four.try_into().ok()?))
}

/// A file of the archive, as the directory at the end tells (APPNOTE 6.3.10, 4.3.12).
#[derive(Debug)]
struct Entry<'a> {
    name: String,
    method: usize,
    is_encrypted: bool,
    crc: u32,
    packed: &'a [u8],
    size: usize,
}

impl<'a> Entry<'a> {
    /// All files; `None` where the archive is damaged.
    fn list(bytes: &'a [u8]) -> Result<Option<Vec<Self>>, FormatError> {
        // The end record has 22 bytes and a comment of at most 65 535.
        let from = bytes.len().saturating_sub(22 + 65_535);
        let tail = bytes.get(from..).unwrap_or_default();
        let Some(end) = tail.windows(4).rposition(|four| four == b"PK\x05\x06").map(|at| from + at) else {
            return Ok(None);
        };
        let (Some(count), Some(size), Some(start), Some(_)) =
            (short(bytes, end + 10), long(bytes, end + 12), long(bytes, end + 16), short(bytes, end + 20))
        else {
            return Ok(None);
        };
        if count == 0xffff || size == u32::MAX || start == u32::MAX {
            return refuse(
                "it is of the kind for more than 4 GB (ZIP64); save it with numpy.savez, or the array with numpy.save",
            );
        }
        if count > MAX_ENTRIES {
            return refuse(format!("it has {count} entries; at most {MAX_ENTRIES} are allowed"));
        }
        let Some(mut rest) = bytes.get(..end).and_then(|bytes| bytes.get(start as usize..)?.get(..size as usize))
        else {
            return Ok(None);
        };
        let mut entries = Vec::new();
        for _ in 0..count {
            let Some((entry, length)) = Self::parse(bytes, rest)? else { return Ok(None) };
            entries.push(entry);
            rest = rest.get(length..).unwrap_or_default();
        }
        Ok(Some(entries))
    }

    /// The first entry of the rest of the directory, and how long it is.
    fn parse(bytes: &'a [u8], rest: &[u8]) -> Result<Option<(Self, usize)>, FormatError> {
        if !rest.starts_with(b"PK\x01\x02") {
            return Ok(None);
        }
        let fields = || {
            let lengths = [short(rest, 28)?, short(rest, 30)?, short(rest, 32)?];
            let name = String::from_utf8_lossy(rest.get(46..46 + lengths[0])?).into_owned();
            let sizes = [long(rest, 20)?, long(rest, 24)?, long(rest, 42)?];
            Some((name, lengths.iter().sum::<usize>() + 46, sizes, short(rest, 8)?, short(rest, 10)?, long(rest, 16)?))
        };
        let Some((name, length, [packed, size, at], flags, method, crc)) = fields() else { return Ok(None) };
        if [packed, size, at].contains(&u32::MAX) {
            return refuse(format!("its entry '{}' is larger than 4 GB (ZIP64)", clip(&name)));
        }
        // The entry's own head: only its length counts.
        let data = || {
            let own = bytes.get(at as usize..)?;
            let head = 30 + short(own, 26)? + short(own, 28)?;
            own.starts_with(b"PK\x03\x04").then(|| own.get(head..)?.get(..packed as usize)).flatten()
        };
        let Some(packed) = data() else { return Ok(None) };
        let entry = Self { name, method, is_encrypted: flags & 1 == 1, crc, packed, size: size as usize };
        Ok(Some((entry, length)))
    }

    /// What a person calls the array.
    fn called(&self) -> &str {
        self.name.strip_suffix(".npy").unwrap_or(&self.name)
    }

    /// At most so many of its first bytes.
    fn start(&self, most: usize) -> Result<Vec<u8>, FormatError> {
        if self.is_encrypted {
            return refuse(format!("its entry '{}' is locked by a password", clip(&self.name)));
        }
        match self.method {
            0 => Ok(self.packed.get(..most).unwrap_or(self.packed).to_vec()),
            8 => match miniz_oxide::inflate::decompress_to_vec_with_limit(self.packed, most) {
                Ok(bytes) => Ok(bytes),
                Err(error) if error.status == miniz_oxide::inflate::TINFLStatus::HasMoreOutput => Ok(error.output),
                Err(_) => self.damaged(),
            },
            method => refuse(format!(
                "its entry '{}' is packed by method {method}; numpy.savez and numpy.savez_compressed use 0 and 8",
                clip(&self.name)
            )),
        }
    }

    /// The whole of it.
    fn bytes(&self) -> Result<Vec<u8>, FormatError> {
        if self.size > MAX_BYTES {
            return refuse(format!(
                "its array '{}' has {} bytes; at most {MAX_BYTES} are allowed",
                clip(self.called()),
                self.size
            ));
        }
        // One byte more than there should be shows that there are more.
        let bytes = self.start(self.size + 1)?;
        if bytes.len() != self.size || crc(&bytes) != self.crc {
            return self.damaged();
        }
        Ok(bytes)
    }

    fn damaged<T>(&self) -> Result<T, FormatError> {
        refuse(format!("its array '{}' is damaged; save it again", clip(self.called())))
    }

    /// The array's words of an error.
    fn within(&self, error: FormatError) -> FormatError {
        match error {
            FormatError::Array { reason, .. } => {
                FormatError::Archive { reason: format!("of its array '{}': {reason}", clip(self.called())) }
            }
            other => other,
        }
    }
}

/// The checksum of ZIP: CRC-32 as of IEEE 802.3.
fn crc(bytes: &[u8]) -> u32 {
    let table: [u32; 256] = std::array::from_fn(|byte| {
        // Below 256.
        (0..8).fold(byte as u32, |crc, _| crc >> 1 ^ if crc & 1 == 1 { 0xedb8_8320 } else { 0 })
    });
    !bytes.iter().fold(u32::MAX, |crc, &byte| crc >> 8 ^ table[usize::from(crc as u8 ^ byte)])
}

/// What an archive without arrays is.
fn kind(entries: &[Entry<'_>]) -> &'static str {
    let has = |name: &str| entries.iter().any(|entry| entry.name == name);
    let ends = |end: &str| entries.iter().any(|entry| entry.name.to_ascii_lowercase().ends_with(end));
    let mime = entries.iter().find(|entry| entry.name == "mimetype").and_then(|entry| entry.start(100).ok());
    let mime = String::from_utf8_lossy(mime.as_deref().unwrap_or_default()).into_owned();
    if entries.is_empty() {
        "an empty ZIP archive"
    } else if has("xl/workbook.xml") || has("xl/workbook.bin") {
        "an Excel workbook (save the sheet as CSV)"
    } else if mime.contains("opendocument.spreadsheet") || has("Index/Tables/DataList.iwa") {
        "a spreadsheet of LibreOffice, OpenOffice or Numbers (save the sheet as CSV)"
    } else if has("word/document.xml") || mime.contains("opendocument.text") {
        "a document of a word processor (save its table as CSV)"
    } else if has("ppt/presentation.xml") || mime.contains("opendocument") {
        "a presentation or a drawing of an office program (save the drawing as SVG or PNG)"
    } else if ends(".kml") {
        "a KMZ archive (convert it to GeoJSON or CSV)"
    } else if ends(".shp") {
        "a ZIP archive with a shapefile (convert it to GeoJSON or CSV)"
    } else if ends("data.pkl") {
        "a file of PyTorch (save the array with numpy.save)"
    } else {
        "a ZIP archive (unpack it, and open the file in it)"
    }
}

pub(super) fn read(bytes: &[u8], options: &ReadOptions) -> Result<Reading, FormatError> {
    let Some(entries) = Entry::list(bytes)? else {
        return Err(FormatError::Kind {
            kind: "a ZIP archive or a spreadsheet that is damaged or incomplete (save the sheet as CSV)",
        });
    };
    let (arrays, others): (Vec<Entry<'_>>, Vec<Entry<'_>>) =
        entries.into_iter().partition(|entry| entry.name.ends_with(".npy"));
    if arrays.is_empty() {
        return Err(FormatError::Kind { kind: kind(&others) });
    }
    if arrays.len() > MAX_ARRAYS {
        return refuse(format!("it has {} arrays; at most {MAX_ARRAYS} are allowed", arrays.len()));
    }
    let (mut table, used) = choose(&arrays)?;
    let left: Vec<&str> =
        (0..arrays.len()).filter(|index| !used.contains(index)).map(|index| arrays[index].called()).collect();
    if !left.is_empty() {
        let arrays = counted(left.len(), "One array of the archive was", "arrays of the archive were");
        table.notes.push(Note::left_out(format!(
            "{arrays} left out: {}. If it holds the points, save it alone.",
            list(left.iter().map(|name| format!("'{}'", clip(name))))
        )));
    }
    if !others.is_empty() {
        let files = counted(others.len(), "One file of the archive was", "files of the archive were");
        table.notes.push(Note::left_out(format!("{files} left out, for no array is in it.")));
    }
    table.into_reading(FileFormat::Npy, options)
}

/// The rows, and which arrays they are from.
fn choose(arrays: &[Entry<'_>]) -> Result<(Table, Vec<usize>), FormatError> {
    let whole = |index: usize| {
        let bytes = arrays[index].bytes()?;
        let table = Array::parse(&bytes).and_then(Array::into_table).map_err(|error| arrays[index].within(error))?;
        Ok((table, vec![index]))
    };
    if arrays.len() == 1 {
        return whole(0);
    }
    let starts = arrays.iter().map(|entry| entry.start(HEAD)).collect::<Result<Vec<_>, _>>()?;
    // An array that can't be read may be one that is not needed.
    let heads: Vec<Option<Array<'_>>> = starts.iter().map(|start| Array::parse(start).ok()).collect();
    let length = |index: usize| heads[index].as_ref().and_then(Array::list_length);
    let lists = |rows: usize| (0..arrays.len()).filter(move |&index| length(index) == Some(rows));

    let all: Vec<usize> = (0..arrays.len()).filter(|&index| length(index).is_some()).collect();
    let names: Vec<&str> = all.iter().map(|&index| arrays[index].called()).collect();
    if let Some(([x, y], _)) = column_names::place_columns(&names)
        && let [x, y] = [all[x], all[y]]
        && let Some(rows) = length(x)
        && length(y) == Some(rows)
    {
        let order: Vec<usize> = [x, y].into_iter().chain(lists(rows).filter(|index| ![x, y].contains(index))).collect();
        return Ok((columns(arrays, &order, None, rows)?, order));
    }
    let named = |name: &&str| {
        let is_it = |&index: &usize| {
            arrays[index].called().eq_ignore_ascii_case(name)
                && heads[index].as_ref().is_none_or(Array::may_hold_places)
        };
        (0..arrays.len()).find(is_it)
    };
    if let Some(place) = PLACES.iter().find_map(named) {
        if let Some(rows) = heads[place].as_ref().and_then(Array::is_pairs_of) {
            let order: Vec<usize> = [place].into_iter().chain(lists(rows)).collect();
            if order.len() > 1 {
                return Ok((columns(arrays, &order[1..], Some(place), rows)?, order));
            }
        }
        return whole(place);
    }
    if let [first, second] = arrays
        && [first.called(), second.called()] == ["arr_0", "arr_1"]
        && let Some(rows) = length(0)
        && length(1) == Some(rows)
    {
        let mut table = columns(arrays, &[0, 1], None, rows)?;
        table.header = None;
        table.notes.push(Note::changed(
            "The two arrays have no names of their own: the first was read as x, the second as y.",
        ));
        return Ok((table, vec![0, 1]));
    }
    let shape = |(entry, head): (&Entry<'_>, &Option<Array<'_>>)| match head {
        Some(head) => format!("'{}' ({})", clip(entry.called()), head.shape_text()),
        None => format!("'{}'", clip(entry.called())),
    };
    refuse(format!(
        "none of its {} arrays is called 'points', and no two are called 'x' and 'y': {}; save the points as one of these, \
         or alone",
        arrays.len(),
        list(arrays.iter().zip(&heads).map(shape)),
    ))
}

/// A table of lists of `rows` entries each, behind an array of pairs if there is one.
fn columns(arrays: &[Entry<'_>], lists: &[usize], pairs: Option<usize>, rows: usize) -> Result<Table, FormatError> {
    if rows > MAX_POINTS {
        return refuse(format!("its arrays have {rows} entries; at most {MAX_POINTS} points are allowed"));
    }
    let order: Vec<usize> = pairs.into_iter().chain(lists.iter().copied()).collect();
    let total = order.iter().fold(0_usize, |total, &index| total.saturating_add(arrays[index].size));
    if total > MAX_BYTES {
        return refuse(format!("its arrays have {total} bytes; at most {MAX_BYTES} are allowed"));
    }
    let mut header = Vec::new();
    let mut cells: Vec<Vec<String>> = vec![Vec::new(); rows];
    for index in order {
        let entry = &arrays[index];
        let bytes = entry.bytes()?;
        let array = Array::parse(&bytes).map_err(|error| entry.within(error))?;
        array.check_data(array.count()).map_err(|error| entry.within(error))?;
        let width = if pairs == Some(index) {
            header.extend(["x".to_owned(), "y".to_owned()]);
            2
        } else {
            header.push(entry.called().to_owned());
            1
        };
        for (row, cells) in cells.iter_mut().enumerate() {
            cells.extend((0..width).map(|column| array.cell_of(row, column, [rows, width])));
        }
    }
    let mut table = Table::new(Declared::default());
    for (row, cells) in cells.into_iter().enumerate() {
        table.push(Row::new(RowPlace::Entry(row + 1, None), cells))?;
    }
    table.header = Some(header);
    Ok(table)
}

/// Some of the names for a sentence.
fn list(names: impl ExactSizeIterator<Item = String>) -> String {
    let more = names.len().saturating_sub(NAMED);
    let shown = names.take(NAMED).collect::<Vec<_>>().join(", ");
    if more > 0 { format!("{shown} and {more} more") } else { shown }
}
