//! The header of a NumPy array: types and shape, written as Python writes a dictionary.

use super::MAX_BYTES;
use super::declaration::number_text;
use super::error::{FormatError, clip};
use super::npy::{MAGIC, refuse};

/// Longest header: NumPy itself writes 118 bytes for plain numbers.
const MAX_HEADER: usize = 10_000;
/// Longest text of a field, in bytes.
const MAX_TEXT: usize = 4096;

/// The type of a number or a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Kind {
    /// `f`, `i`, `u`, `b`, `c` for complex; `S` and `U` for text, `V` for bytes that mean nothing.
    letter: u8,
    /// Bytes of it.
    pub(super) size: usize,
    big_endian: bool,
}

impl Kind {
    fn parse(descr: &str, at: usize) -> Result<Self, FormatError> {
        let (big_endian, rest) = match descr.as_bytes() {
            [b'>', rest @ ..] => (true, rest),
            [b'<' | b'=' | b'|', rest @ ..] => (false, rest),
            rest => (false, rest),
        };
        let (letter, size) = match *rest {
            [b'?'] => (b'b', Some(1)),
            [letter, ref size @ ..] => (letter, std::str::from_utf8(size).ok().and_then(|size| size.parse().ok())),
            [] => (0, None),
        };
        let known = match (letter, size) {
            (b'f', Some(2 | 4 | 8)) | (b'i' | b'u', Some(1 | 2 | 4 | 8)) | (b'b', Some(1)) | (b'c', Some(8 | 16)) => {
                size
            }
            (b'S' | b'V', Some(size)) if size <= MAX_TEXT => Some(size),
            (b'U', Some(size)) if size <= MAX_TEXT / 4 => Some(4 * size),
            _ => None,
        };
        match known {
            Some(size) => Ok(Self { letter, size, big_endian }),
            None => {
                let hint = if letter == b'O' { "; Python's objects are not read, so save plain numbers" } else { "" };
                refuse(
                    at,
                    format!(
                        "its numbers are of type {:?}; real numbers (f2, f4, f8), complex ones (c8, c16) and whole ones (i1 to \
                         u8) can be read{hint}",
                        clip(descr)
                    ),
                )
            }
        }
    }

    pub(super) fn is_text(self) -> bool {
        matches!(self.letter, b'S' | b'U' | b'V')
    }

    pub(super) fn is_complex(self) -> bool {
        self.letter == b'c'
    }

    /// The real or the imaginary part.
    pub(super) fn half(self) -> Self {
        Self { letter: b'f', size: self.size / 2, ..self }
    }

    /// It as it stands in a cell of a table.
    pub(super) fn cell(self, bytes: &[u8]) -> String {
        if self.letter == b'S' {
            return String::from_utf8_lossy(bytes).trim_end_matches('\0').to_owned();
        }
        if self.letter == b'U' {
            let letters = bytes.chunks_exact(4).map(|four| self.bits(four) as u32).take_while(|&letter| letter != 0);
            return letters.map(|letter| char::from_u32(letter).unwrap_or(char::REPLACEMENT_CHARACTER)).collect();
        }
        let bits = self.bits(bytes);
        match (self.letter, self.size) {
            (b'f', 2) => number_text(half(bits as u16)),
            (b'f', 4) => number_text(f64::from(f32::from_bits(bits as u32))),
            (b'f', _) => number_text(f64::from_bits(bits)),
            (b'i', size) => {
                let unused = 64 - 8 * size as u32;
                ((bits << unused) as i64 >> unused).to_string()
            }
            _ => bits.to_string(),
        }
    }

    /// At most eight bytes as a number.
    fn bits(self, bytes: &[u8]) -> u64 {
        let mut little = [0_u8; 8];
        for (i, &byte) in bytes.iter().take(8).enumerate() {
            little[if self.big_endian { bytes.len().min(8) - 1 - i } else { i }] = byte;
        }
        u64::from_le_bytes(little)
    }
}

/// A number of 16 bits (IEEE 754 binary16).
fn half(bits: u16) -> f64 {
    let (exponent, fraction) = (i32::from(bits >> 10 & 31), f64::from(bits & 1023));
    let magnitude = match exponent {
        0 => fraction * 2_f64.powi(-24),
        31 if fraction == 0.0 => f64::INFINITY,
        31 => f64::NAN,
        _ => (1024.0 + fraction) * 2_f64.powi(exponent - 25),
    };
    if bits >> 15 == 1 { -magnitude } else { magnitude }
}

/// A named field of every entry.
#[derive(Debug)]
pub(super) struct Field {
    pub(super) name: String,
    pub(super) kind: Kind,
    /// In bytes from where the entry begins.
    pub(super) offset: usize,
    /// How many there are of it.
    pub(super) count: usize,
}

/// What the entries of an array are.
#[derive(Debug)]
pub(super) enum Descr {
    Plain(Kind),
    Fields(Vec<Field>),
}

impl Descr {
    /// Bytes of an entry.
    pub(super) fn size(&self) -> usize {
        match self {
            Self::Plain(kind) => kind.size,
            Self::Fields(fields) => fields.last().map_or(0, |last| last.offset + last.count * last.kind.size),
        }
    }
}

/// What stands in front of the data.
#[derive(Debug)]
pub(super) struct Header {
    pub(super) descr: Descr,
    pub(super) is_fortran: bool,
    pub(super) shape: Vec<usize>,
    /// The byte of the file that the shape begins at, and the one after the header.
    pub(super) shape_at: usize,
    pub(super) end: usize,
}

impl Header {
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, FormatError> {
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
        let start = MAGIC.len() + start;
        let latin;
        let header = match std::str::from_utf8(header) {
            Ok(header) => header,
            // Before version 3 it is Latin-1.
            Err(_) if rest.first() != Some(&3) => {
                latin = header.iter().map(|&byte| char::from(byte)).collect::<String>();
                &latin
            }
            Err(error) => return refuse(start + error.valid_up_to(), "its header is not text"),
        };
        let (descr, at) = member(header, start, "descr")?;
        let descr = Parser { text: descr, at }.descr()?;
        let is_fortran = member(header, start, "fortran_order")?.0.starts_with("True");
        let (text, shape_at) = member(header, start, "shape")?;
        Ok(Self { descr, is_fortran, shape: shape(text, shape_at)?, shape_at, end: start + length })
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

/// `(300, 2)`, `(300L, 2L)`, `(300,)`.
fn shape(text: &str, at: usize) -> Result<Vec<usize>, FormatError> {
    let inner = text.strip_prefix('(').and_then(|text| text.split_once(')')).map_or("", |(inner, _)| inner);
    let sides = inner.split(',').map(str::trim).filter(|side| !side.is_empty());
    // Python 2 on Windows marks long numbers.
    let sides: Option<Vec<usize>> = sides.map(|side| side.trim_end_matches('L').parse().ok()).collect();
    match sides {
        Some(sides) if !sides.is_empty() => Ok(sides),
        Some(_) => refuse(at, "its shape is (), one number; N rows of x, y and perhaps more are needed"),
        None => refuse(at, format!("its shape is ({}), which are no sizes", clip(inner))),
    }
}

/// Reads `'<f8'`, and `[('x', '<f8'), ('y', '<f8', (2,))]`.
struct Parser<'a> {
    text: &'a str,
    /// The byte of the file that the text begins at.
    at: usize,
}

impl<'a> Parser<'a> {
    fn take(&mut self, sign: char) -> bool {
        self.skip(self.text.len() - self.text.trim_start().len());
        let found = self.text.starts_with(sign);
        if found {
            self.skip(sign.len_utf8());
        }
        found
    }

    fn skip(&mut self, bytes: usize) {
        self.text = self.text.get(bytes..).unwrap_or_default();
        self.at += bytes;
    }

    fn quoted(&mut self) -> Option<&'a str> {
        let quote = ['\'', '"'].into_iter().find(|&quote| self.take(quote))?;
        let (word, _) = self.text.split_once(quote)?;
        self.skip(word.len() + 1);
        Some(word)
    }

    fn descr(mut self) -> Result<Descr, FormatError> {
        let at = self.at;
        if let Some(word) = self.quoted() {
            return Kind::parse(word, at).map(Descr::Plain);
        }
        let wrong =
            |at: usize| refuse(at, "its fields are nested or not understood; save its columns as one plain array");
        if !self.take('[') {
            return wrong(self.at);
        }
        let (mut fields, mut offset): (Vec<Field>, usize) = (Vec::new(), 0);
        while !self.take(']') {
            if !self.take('(') {
                return wrong(self.at);
            }
            let Some(name) = self.quoted() else { return wrong(self.at) };
            let (comma, at) = (self.take(','), self.at);
            let Some(word) = self.quoted().filter(|_| comma) else { return wrong(self.at) };
            let kind = Kind::parse(word, at)?;
            let mut count = 1_usize;
            if self.take(',') && !self.text.trim_start().starts_with(')') {
                let digits = |c: char| c.is_ascii_digit();
                let is_list = self.take('(');
                loop {
                    self.take(' ');
                    let word = &self.text[..self.text.len() - self.text.trim_start_matches(digits).len()];
                    let side: Option<usize> = word.parse().ok();
                    self.skip(word.len());
                    self.take('L');
                    match side.and_then(|side| count.checked_mul(side)).filter(|&count| count <= MAX_TEXT) {
                        Some(product) => count = product,
                        None => return wrong(self.at),
                    }
                    if !is_list || {
                        self.take(',');
                        self.take(')')
                    } {
                        break;
                    }
                }
            }
            if !self.take(')') {
                return wrong(self.at);
            }
            self.take(',');
            let field = Field { name: name.to_owned(), kind, offset, count };
            offset += count * kind.size;
            if offset > MAX_BYTES {
                return refuse(at, format!("its entries have more than {MAX_BYTES} bytes each"));
            }
            fields.push(field);
        }
        if offset == 0 {
            return refuse(at, "it has no fields");
        }
        // The last one tells the size, so what fills up entries is taken out later.
        Ok(Descr::Fields(fields))
    }
}

impl Field {
    /// Whether it only fills up the entry.
    pub(super) fn is_filling(&self) -> bool {
        self.kind.letter == b'V'
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_sixteen_bits() {
        for (bits, number) in [
            (0x0000, 0.0),
            (0x3c00, 1.0),
            (0xc000, -2.0),
            (0x3555, 0.333_251_953_125),
            (0x7bff, 65_504.0),
            (0x0400, 6.103_515_625e-5),
            (0x0001, 5.960_464_477_539_063e-8),
            (0x7c00, f64::INFINITY),
        ] {
            assert_eq!(half(bits), number, "{bits:#06x}");
        }
        assert!(half(0x7e00).is_nan() && half(0x8000).is_sign_negative());
    }
}
