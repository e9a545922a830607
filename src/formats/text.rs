//! Bytes of a text file to text with `\n` at the ends of its lines, whatever program wrote them.

use std::borrow::Cow;

use super::Note;
use super::error::{FormatError, place};

/// How many bytes are looked at to tell UTF-16 and binary data.
const LOOKED_AT: usize = 1000;

/// Text of UTF-8 or UTF-16, each with or without a byte order mark; of Windows-1252 (Latin-1 with printable signs in place
/// of control characters) where a byte is no UTF-8. Whatever was guessed is noted.
pub(super) fn decode<'a>(bytes: &'a [u8], notes: &mut Vec<Note>) -> Result<Cow<'a, str>, FormatError> {
    if let Some((big_endian, bytes)) = utf_16(bytes) {
        let text = decode_utf_16(bytes, big_endian)?;
        return Ok(Cow::Owned(with_line_feeds(Cow::Owned(text)).into_owned()));
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    if bytes.iter().take(LOOKED_AT).any(|&byte| byte == 0) {
        return Err(FormatError::Kind { kind: "binary data" });
    }
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => Cow::Borrowed(text),
        Err(error) => {
            let (valid, rest) = bytes.split_at(error.valid_up_to());
            let (line, column) = place(&String::from_utf8_lossy(valid), valid.len());
            let byte = rest.first().copied().unwrap_or_default();
            // Text in one byte a character has no control characters but those that part columns and lines.
            let is_text = bytes.iter().all(|&byte| byte >= b' ' || matches!(byte, b'\t' | b'\n' | b'\r' | b'\x0c'));
            if !is_text {
                return Err(FormatError::NotUtf8 { line, column, byte });
            }
            notes.push(Note::changed(format!(
                "Byte {byte:#04x} in line {line} is no UTF-8, so the text was read as Windows-1252 (Latin-1), as Excel saves \
                 it. If letters look wrong, save the file as UTF-8."
            )));
            Cow::Owned(bytes.iter().map(|&byte| windows_1252(byte)).collect())
        }
    };
    Ok(with_line_feeds(text))
}

/// Whether the bytes are UTF-16, its byte order, and the bytes behind the mark.
fn utf_16(bytes: &[u8]) -> Option<(bool, &[u8])> {
    if let Some(rest) = bytes.strip_prefix(b"\xff\xfe") {
        return Some((false, rest));
    }
    if let Some(rest) = bytes.strip_prefix(b"\xfe\xff") {
        return Some((true, rest));
    }
    // Without a mark: numbers and separators have a zero in every other byte, and in no other one.
    let start = &bytes[..bytes.len().min(LOOKED_AT) / 2 * 2];
    let zeros = |first: usize| start.iter().skip(first).step_by(2).filter(|&&byte| byte == 0).count();
    let (even, odd) = (zeros(0), zeros(1));
    let most = start.len() / 2 - start.len() / 8;
    match (even, odd) {
        (0, odd) if odd > most => Some((false, bytes)),
        (even, 0) if even > most => Some((true, bytes)),
        _ => None,
    }
}

fn decode_utf_16(bytes: &[u8], big_endian: bool) -> Result<String, FormatError> {
    let units = bytes.chunks_exact(2).map(|pair| {
        let pair = [pair[0], pair[1]];
        if big_endian { u16::from_be_bytes(pair) } else { u16::from_le_bytes(pair) }
    });
    let mut text = String::with_capacity(bytes.len() / 2);
    for unit in char::decode_utf16(units) {
        match unit {
            // A mark of its own within two files that were put together.
            Ok('\u{feff}') => {}
            Ok('\0') => return Err(FormatError::Kind { kind: "binary data" }),
            Ok(c) => text.push(c),
            Err(_) => {
                let (line, column) = place(&text, text.len());
                let message = "half a character of UTF-16; save the file as UTF-8 text".to_owned();
                return Err(FormatError::Syntax { line, column, message });
            }
        }
    }
    Ok(text)
}

/// `\n` for `\r\n` and for `\r`, also where a file mixes them.
fn with_line_feeds(text: Cow<'_, str>) -> Cow<'_, str> {
    if text.contains('\r') { Cow::Owned(text.replace("\r\n", "\n").replace('\r', "\n")) } else { text }
}

/// The character of a byte of Windows-1252; the five bytes it leaves free are those of Latin-1.
fn windows_1252(byte: u8) -> char {
    /// Of bytes 0x80 to 0x9f.
    const SIGNS: [char; 32] = [
        '€', '\u{81}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{8d}', 'Ž', '\u{8f}', '\u{90}', '‘',
        '’', '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{9d}', 'ž', 'Ÿ',
    ];
    match byte {
        0x80..=0x9f => SIGNS[usize::from(byte - 0x80)],
        _ => char::from(byte),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may stop at the first surprise")]
    use super::*;

    fn decoded(bytes: &[u8]) -> (String, usize) {
        let mut notes = Vec::new();
        let text = decode(bytes, &mut notes).unwrap().into_owned();
        (text, notes.len())
    }

    #[test]
    fn one_text_in_many_codes() {
        let text = "x;y;class\n1,5;2;Érable €\n";
        let little: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
        let big: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
        let ends = text.replace('\n', "\r\n");
        for bytes in [
            text.as_bytes(),
            &[b"\xef\xbb\xbf", text.as_bytes()].concat(),
            &[b"\xff\xfe", &little[..]].concat(),
            &[b"\xfe\xff", &big[..]].concat(),
            &little,
            &big,
            ends.as_bytes(),
            text.replacen('\n', "\r", 1).as_bytes(),
        ] {
            assert_eq!(decoded(bytes), (text.to_owned(), 0));
        }
        assert_eq!(decoded(b"1,5;2;\xc9rable \x80\n"), ("1,5;2;Érable €\n".to_owned(), 1));
    }

    #[test]
    fn what_is_no_text_is_refused() {
        let refused = |bytes: &[u8]| decode(bytes, &mut Vec::new()).unwrap_err().to_string();
        assert!(refused(b"0.5 0.5\x00").contains("binary"));
        assert!(refused(b"0 0\n1 1 \xe9\x01").contains("line 2, column 5: byte 0xe9 is not UTF-8"));
        assert!(refused(b"\xff\xfe1\x00\x00\xd8").contains("line 1, column 2: half a character"));
    }
}
