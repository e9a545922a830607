//! What mail, chat and word processors do to links, undone where there is no doubt.

use std::borrow::Cow;

use super::{LinkError, percent_decoded};
use crate::formats::Note;

/// How often a program may have escaped what another one had escaped.
const MOST_ESCAPES: usize = 3;

/// The fragment of a link as it was written, with a note on what was done to it.
///
/// # Errors
/// [`LinkError::Shortened`] where a program put dots in place of a part.
pub(super) fn mend(link: &str) -> Result<(Cow<'_, str>, Vec<Note>), LinkError> {
    let mut done: Vec<&str> = Vec::new();
    let mut text = Cow::Borrowed(link);
    let mut change = |text: &mut Cow<'_, str>, mended: String, what: &'static str| {
        if mended != **text {
            *text = Cow::Owned(mended);
            if !done.contains(&what) {
                done.push(what);
            }
        }
    };

    // Mail in quoted-printable writes `=` as `=3D`, and ends lines with one.
    if text.contains("=3D") && !text.contains("=3D=3D") {
        let joined = text.replace("=\r\n", "").replace("=\n", "");
        change(&mut text, joined.replace("=3D", "=").replace("=26", "&").replace("=23", "#"), "mail's code was undone");
    }
    // Lines that are quoted in an answer begin with `>`.
    if text.contains('\n') {
        let unquoted: String = text.lines().map(|line| line.trim_start_matches(['>', ' ', '\t'])).collect();
        change(&mut text, unquoted, "its lines were joined");
    }
    let blanks = |c: char| {
        c.is_whitespace() || matches!(c, '\u{ad}' | '\u{200b}' | '\u{200c}' | '\u{200d}' | '\u{2060}' | '\u{feff}')
    };
    if text.contains(blanks) {
        let joined = text.replace(blanks, "");
        change(&mut text, joined, "blanks within it were taken out");
    }
    for _ in 0..MOST_ESCAPES {
        for sign in ["&amp;", "&#38;", "&#038;", "&#x26;"] {
            let plain = text.replace(sign, "&");
            change(&mut text, plain, "'&amp;' became '&'");
        }
        // Of a link as a whole: the signs between its parts are escaped, which no part of it ever is.
        let lower = text.to_ascii_lowercase();
        if ["v%3d", "v%253d", "%23v=", "%2523v"].iter().any(|sign| lower.contains(sign)) {
            let plain = percent_decoded(&text);
            change(&mut text, plain, "its percent signs were undone");
        }
    }
    if let Some((_, fragment)) = text.split_once('#') {
        // The address in front is nobody's damage.
        text = Cow::Owned(fragment.to_owned());
    }
    if text.ends_with('…') || text.ends_with("...") || text.ends_with("%E2%80%A6") {
        return Err(LinkError::Shortened);
    }
    let bare = text.trim_matches(|c: char| ".,;:!?<>()[]{}\"'`*|„“”‚‘’«»".contains(c) || c == '\\').to_owned();
    change(&mut text, bare, "signs around it were taken off");
    let notes = match done.as_slice() {
        [] => Vec::new(),
        done => vec![Note::changed(format!(
            "The link was changed on its way, as mail and chat do, and mended: {}.",
            done.join(", ")
        ))],
    };
    Ok((text, notes))
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may stop at the first surprise")]
    use super::*;

    #[test]
    fn what_has_no_damage_is_left_alone() {
        for link in
            ["v=1&preset=fast&seed=7&exemplar=rings", "v=1&domain=0,0,-1,4&points=-_8A_-", "v=1&names=a%26b", ""]
        {
            let (text, notes) = mend(link).unwrap();
            assert_eq!((&*text, notes.len()), (link, 0));
        }
    }

    #[test]
    fn one_link_in_many_states() {
        let whole = "v=1&preset=balanced&seed=7&exemplar=chevrons";
        for damaged in [
            "v=1&amp;preset=balanced&amp;seed=7&amp;exemplar=chevrons",
            "v=1&amp;amp;preset=balanced&amp;amp;seed=7&amp;amp;exemplar=chevrons",
            "v%3D1%26preset%3Dbalanced%26seed%3D7%26exemplar%3Dchevrons",
            "v%253D1%2526preset%253Dbalanced%2526seed%253D7%2526exemplar%253Dchevrons",
            "https://example.org/%23v=1&preset=balanced&seed=7&exemplar=chevrons",
            "v=1&preset=balanced&se\r\n ed=7&exemplar=chevrons",
            "> v=1&preset=balanced&se\n> ed=7&exemplar=chevrons",
            "v=3D1&preset=3Dbalanced&seed=3D7&exem=\nplar=3Dchevrons",
            "v=1&preset=balanced&seed=7&exemplar=chevrons.",
            "(v=1&preset=balanced&seed=7&exemplar=chevrons).",
            "<v=1&preset=balanced&seed=7&exemplar=chevrons>",
            "v=1&preset=balanced&seed=7&exem\u{200b}plar=chevrons",
        ] {
            let (text, notes) = mend(damaged).unwrap();
            assert_eq!((&*text, notes.len()), (whole, 1), "{damaged}");
        }
        let (text, notes) = mend("https://example.org/pw/#v=1&preset=balanced&seed=7&exemplar=chevrons").unwrap();
        assert_eq!((&*text, notes.len()), (whole, 0), "an address in front is no damage");
        assert_eq!(mend("v=1&points=7dW9CYNQ…"), Err(LinkError::Shortened));
    }
}
