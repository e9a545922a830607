//! ZIP archives: NumPy's `.npz`, and the names of other files that are archives.
//!
//! An archive is read that holds one array; or places, as one array with a name like `points` or as two like `x` and `y`. Its
//! other arrays of one number or word a point are columns.

use miniz_oxide::inflate::decompress_to_vec_with_limit;
use rawzip::{CompressionMethod, ZipSliceArchive};

use super::declaration::Declared;
use super::error::{FormatError, clip};
use super::npy::Array;
use super::table::{Row, RowPlace, Table};
use super::{FileFormat, MAX_BYTES, Note, ReadOptions, Reading, column_names};

/// Most entries of an archive that are looked at.
const MAX_ENTRIES: usize = 1000;
/// Most arrays beside the places.
const MAX_OTHERS: usize = 32;
/// Arrays that hold places, the likeliest first.
const PLACES: [&str; 16] = [
    "points",
    "point",
    "pts",
    "xy",
    "xys",
    "positions",
    "position",
    "pos",
    "coords",
    "coordinates",
    "locations",
    "locs",
    "centroids",
    "centers",
    "centres",
    "spatial",
];

/// A file within an archive, as it is stored.
struct Entry<'a> {
    /// Without `.npy`.
    name: String,
    data: &'a [u8],
    is_deflated: bool,
    crc: u32,
}

pub(super) fn read(bytes: &[u8], options: &ReadOptions) -> Result<Reading, FormatError> {
    let Ok(archive) = rawzip::ZipArchive::from_slice(bytes) else {
        return Err(FormatError::Kind { kind: "a ZIP archive or a spreadsheet that is cut short" });
    };
    let mut names = Vec::new();
    let mut entries = Vec::new();
    for record in archive.entries().take(MAX_ENTRIES) {
        let Ok(record) = record else { return refuse("its list of files is damaged") };
        let name = String::from_utf8_lossy(record.file_path().as_bytes()).into_owned();
        if let Some(bare) = name.strip_suffix(".npy") {
            entries.push(entry(&archive, &record, bare)?);
        }
        names.push(name);
    }
    if entries.is_empty() {
        return Err(FormatError::Kind { kind: kind_of(&names) });
    }
    let inflated = Inflated::default();
    pattern(&entries, &inflated, options)
}

fn refuse<T>(reason: impl Into<String>) -> Result<T, FormatError> {
    Err(FormatError::Archive { reason: reason.into() })
}

/// What an archive without arrays is.
fn kind_of(names: &[String]) -> &'static str {
    let has = |part: &str| names.iter().any(|name| name.to_ascii_lowercase().ends_with(part));
    match () {
        () if has("xl/workbook.xml") || has("xl/workbook.bin") => "an Excel workbook (save the sheet as CSV)",
        () if has("word/document.xml") => "a Word document (save the table as text)",
        () if has("content.xml") => "an OpenDocument file (save the sheet as CSV)",
        () if has(".kml") => "a KMZ file (save it as GeoJSON)",
        () if has(".shp") => "a zipped shapefile (save it as GeoJSON)",
        () if has("index/tables.numbers") || has(".iwa") => "a Numbers document (export the sheet as CSV)",
        () => "a ZIP archive (take the files out first)",
    }
}

fn entry<'a>(
    archive: &'a ZipSliceArchive<&'a [u8]>,
    record: &rawzip::ZipFileHeaderRecord<'_>,
    name: &str,
) -> Result<Entry<'a>, FormatError> {
    let is_deflated = match record.compression_method() {
        CompressionMethod::STORE => false,
        CompressionMethod::DEFLATE => true,
        _ => {
            return refuse(format!(
                "'{}' is packed in a way that is not read; numpy.savez makes none such",
                clip(name)
            ));
        }
    };
    if record.flags().is_encrypted() {
        return refuse(format!("'{}' needs a password", clip(name)));
    }
    match archive.get_entry(record.wayfinder()) {
        Ok(stored) => Ok(Entry { name: name.to_owned(), data: stored.data(), is_deflated, crc: record.crc32() }),
        Err(_) => refuse(format!("'{}' is damaged or cut short", clip(name))),
    }
}

/// Bytes of entries, together no more than a file may have.
#[derive(Default)]
struct Inflated {
    used: std::cell::Cell<usize>,
}

impl Inflated {
    fn of(&self, entry: &Entry<'_>) -> Result<Vec<u8>, FormatError> {
        let left = MAX_BYTES - self.used.get();
        let bytes = if entry.is_deflated {
            decompress_to_vec_with_limit(entry.data, left).map_err(|error| FormatError::Archive {
                reason: if error.status == miniz_oxide::inflate::TINFLStatus::HasMoreOutput {
                    format!("it inflates to more than {MAX_BYTES} bytes; save fewer arrays")
                } else {
                    format!("'{}' is damaged", clip(&entry.name))
                },
            })?
        } else {
            entry.data.get(..left.min(entry.data.len())).unwrap_or_default().to_vec()
        };
        self.used.set(self.used.get() + bytes.len());
        if rawzip::crc32(&bytes) != entry.crc {
            return refuse(format!("'{}' is damaged: its checksum is wrong", clip(&entry.name)));
        }
        Ok(bytes)
    }
}

/// An error of one array with its name.
fn of_array(name: &str, error: FormatError) -> FormatError {
    match error {
        FormatError::Array { reason, .. } => {
            FormatError::Archive { reason: format!("of its array '{}': {reason}", clip(name)) }
        }
        error => error,
    }
}

fn pattern(entries: &[Entry<'_>], inflated: &Inflated, options: &ReadOptions) -> Result<Reading, FormatError> {
    let all = || clip(&entries.iter().map(|entry| entry.name.as_str()).collect::<Vec<_>>().join(", "));
    let names: Vec<&str> = entries.iter().map(|entry| entry.name.as_str()).collect();
    let chosen: Vec<usize> = if entries.len() == 1 {
        vec![0]
    } else if let Some(place) =
        PLACES.iter().find_map(|place| names.iter().position(|name| name.eq_ignore_ascii_case(place)))
    {
        vec![place]
    } else if let Some((columns, _)) = column_names::place_columns(&names) {
        columns.into()
    } else {
        return refuse(format!(
            "it holds {} arrays, and none of their names tells the places: {}. Call them x and y, or points; or save one alone",
            entries.len(),
            all()
        ));
    };

    let bytes: Vec<Vec<u8>> = chosen.iter().map(|&at| inflated.of(&entries[at])).collect::<Result<_, _>>()?;
    let parse = |bytes, at: usize| Array::parse(bytes).map_err(|error| of_array(names[at], error));
    let arrays: Vec<Array<'_>> =
        bytes.iter().zip(&chosen).map(|(bytes, &at)| parse(bytes, at)).collect::<Result<_, _>>()?;
    let mut header: Vec<String> = Vec::new();
    match arrays.as_slice() {
        [places] if !places.has_places() => {
            return refuse(format!("its array '{}' has no x and y; it holds {}", clip(names[chosen[0]]), all()));
        }
        [_] if entries.len() == 1 => {
            return arrays.into_iter().next().map_or(Err(FormatError::NoPoints), |array| array.into_reading(options));
        }
        [places] => header = if places.has_names() { places.names() } else { unnamed(places.names().len()) },
        [x, y] if x.is_one_row() && y.is_one_row() && x.rows == y.rows => {
            header.extend(chosen.iter().map(|&at| names[at].to_owned()));
        }
        _ => {
            return refuse(format!(
                "its arrays '{}' and '{}' are no two rows of as many numbers",
                names[chosen[0]], names[chosen[1]]
            ));
        }
    }
    let rows = arrays[0].rows;
    let mut others: Vec<Vec<u8>> = Vec::new();
    let mut left_out: Vec<&str> = Vec::new();
    for (at, entry) in entries.iter().enumerate().filter(|(at, _)| !chosen.contains(at)) {
        let bytes = if others.len() < MAX_OTHERS { Some(inflated.of(entry)?) } else { None };
        let fits = |bytes: &Vec<u8>| Array::parse_column(bytes).is_some_and(|array| array.rows == rows);
        match bytes.filter(fits) {
            Some(bytes) => {
                header.push(names[at].to_owned());
                others.push(bytes);
            }
            None => left_out.push(names[at]),
        }
    }
    let others: Vec<Array<'_>> = others.iter().filter_map(|bytes| Array::parse_column(bytes)).collect();
    let mut table = Table::new(Declared::default());
    for row in 0..rows {
        let cells = arrays.iter().chain(&others).flat_map(|array| array.row(row));
        table.push(Row::new(RowPlace::Entry(row + 1, None), cells))?;
    }
    table.header = Some(header);
    table.notes.extend(arrays.into_iter().filter_map(Array::into_note));
    if !left_out.is_empty() {
        let were = super::note::counted(left_out.len(), "One array was", "arrays were");
        table.notes.push(Note::left_out(format!(
            "{were} left out, as they are not one number or word a point: {}.",
            clip(&left_out.join(", "))
        )));
    }
    table.into_reading(FileFormat::Npy, options)
}

/// Names for the columns of an array of places beside others.
fn unnamed(columns: usize) -> Vec<String> {
    let name = |at: usize| match at {
        0 => "x".to_owned(),
        1 => "y".to_owned(),
        at => format!("column-{}", at + 1),
    };
    (0..columns).map(name).collect()
}
