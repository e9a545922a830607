//! Numbers as people and their programs write them.

/// Ways to write that no value is there, in small letters.
const MISSING: [&str; 13] = ["", "na", "n/a", "nan", "null", "none", "nil", "-", "--", "?", "#n/a", "#na", "missing"];

/// What spreadsheets write for a formula without a value, behind the sign `#`.
const ERRORS: [&str; 7] = ["N/A", "REF!", "VALUE!", "DIV/0!", "NAME?", "NULL!", "NUM!"];

/// Whether a cell says that there is no value.
pub(super) fn is_missing(cell: &str) -> bool {
    let cell = cell.trim();
    // Longer ones are not in the list, and need not be written in small letters first.
    cell.len() <= 7 && MISSING.contains(&cell.to_ascii_lowercase().as_str())
        || cell.strip_prefix('#').is_some_and(|rest| ERRORS.contains(&rest))
}

/// Whether what follows a `#` is a spreadsheet's error, and not a comment.
pub(super) fn begins_with_error(rest: &str) -> bool {
    ERRORS.iter().any(|error| rest.strip_prefix(error).is_some_and(|after| !after.starts_with(char::is_alphanumeric)))
}

/// How the commas of a table are to be read.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Comma {
    /// In no number.
    #[default]
    None,
    /// `0,5` is one half.
    Decimal,
    /// `1,234.5` is more than a thousand.
    Thousands,
}

/// A finite number, or none. Minus may be U+2212, as typesetting programs write it, an exponent Fortran's, and thousands may be parted
/// by blanks or apostrophes.
pub(super) fn parse(cell: &str, comma: Comma) -> Option<f64> {
    let cell = cell.trim();
    // Rust reads the words for infinity and NaN as numbers.
    if !cell.bytes().any(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let with_comma = match comma {
        Comma::Decimal if cell.contains(',') && !cell.contains('.') => cell.replacen(',', ".", 1).parse().ok(),
        Comma::Thousands if cell.contains(',') && is_grouped(cell) => cell.replace(',', "").parse().ok(),
        _ => None,
    };
    let number: f64 = match with_comma {
        Some(number) => number,
        None => match cell.parse() {
            Ok(number) => number,
            // Seldom, and what it costs is not paid by every number.
            Err(_) => {
                let plain = cell.replace(['\u{2212}', '\u{fe63}', '\u{ff0d}'], "-");
                // Fortran's exponents of doubles.
                let plain = plain.replace("D+", "e+").replace("D-", "e-");
                let plain =
                    without_groups(plain.strip_prefix('\'').and_then(|rest| rest.strip_suffix('\'')).unwrap_or(&plain));
                if plain == cell {
                    return None;
                }
                return parse(&plain, comma);
            }
        },
    };
    number.is_finite().then_some(number)
}

/// Signs between thousands that part nothing else: blanks of several widths, and apostrophes.
const GROUP_SIGNS: [char; 6] = [' ', '\u{a0}', '\u{2009}', '\u{202f}', '\'', '’'];

/// `1 234,5` without the blank; anything else as it is.
fn without_groups(cell: &str) -> String {
    let (whole, rest) = cell.split_at(cell.find(['.', ',', 'e', 'E']).unwrap_or(cell.len()));
    let sign = GROUP_SIGNS.into_iter().find(|&sign| whole.contains(sign));
    match sign {
        Some(sign) if is_grouped(&whole.replace(sign, ",")) => whole.replace(sign, "") + rest,
        _ => cell.to_owned(),
    }
}

/// Whether commas stand before groups of three digits, and nowhere behind a decimal point.
pub(super) fn is_grouped(cell: &str) -> bool {
    let whole = cell.split('.').next().unwrap_or_default();
    let digits = whole.trim_start_matches(['+', '-', '\u{2212}']);
    let mut groups = digits.split(',');
    let first = groups.next().unwrap_or_default();
    let is_group = |group: &str| group.len() == 3 && group.bytes().all(|byte| byte.is_ascii_digit());
    (1..=3).contains(&first.len())
        && first.bytes().all(|byte| byte.is_ascii_digit())
        && groups.all(is_group)
        && !cell.get(whole.len()..).unwrap_or_default().contains(',')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_many_spellings() {
        for (cell, comma, number) in [
            ("0.5", Comma::None, Some(0.5)),
            (" -1e3 ", Comma::None, Some(-1000.0)),
            ("\u{2212}43.14", Comma::None, Some(-43.14)),
            ("1e\u{2212}3", Comma::None, Some(0.001)),
            ("0.25D+02", Comma::None, Some(25.0)),
            ("'5.47'", Comma::None, Some(5.47)),
            ("1 234.5", Comma::None, Some(1234.5)),
            ("1\u{a0}234\u{a0}567,5", Comma::Decimal, Some(1_234_567.5)),
            ("-1'234", Comma::None, Some(-1234.0)),
            ("1 23", Comma::None, None),
            ("12 345 6", Comma::None, None),
            ("0,5", Comma::Decimal, Some(0.5)),
            ("\u{2212}0,5", Comma::Decimal, Some(-0.5)),
            ("0,5", Comma::None, None),
            ("1.000,5", Comma::Decimal, None),
            ("1,234,567.5", Comma::Thousands, Some(1_234_567.5)),
            ("-1,234", Comma::Thousands, Some(-1234.0)),
            ("1,23", Comma::Thousands, None),
            ("1,2,3", Comma::Decimal, None),
            ("nan", Comma::None, None),
            ("inf", Comma::None, None),
            ("1e999", Comma::None, None),
            ("", Comma::None, None),
            ("12 m", Comma::None, None),
        ] {
            assert_eq!(parse(cell, comma), number, "{cell:?} {comma:?}");
        }
    }

    #[test]
    fn words_for_nothing() {
        assert!(["", " ", "NA", "NaN", "null", "-", "#N/A"].iter().all(|cell| is_missing(cell)));
        assert!(["0", "oak", "naan", "-1"].iter().all(|cell| !is_missing(cell)));
    }
}
