//! What a reader has to say about a file that it could read.

use std::fmt;

use serde::{Deserialize, Serialize};

/// What a note is about.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NoteKind {
    /// Something of the file is not in the pattern.
    LeftOut,
    /// Something was read as something else than it stands there, or had to be chosen.
    Changed,
    /// Everything was read as it stands there, and looks as if it were not meant.
    Odd,
}

/// One or two sentences for a person: what was left out, changed or looks odd, how many, why, and what can be done.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Note {
    /// What it is about.
    pub kind: NoteKind,
    /// The sentences.
    pub text: String,
}

impl Note {
    /// Something of the file is not in the pattern.
    pub fn left_out(text: impl Into<String>) -> Self {
        Self { kind: NoteKind::LeftOut, text: text.into() }
    }

    /// Something was read as something else than it stands there, or had to be chosen.
    pub fn changed(text: impl Into<String>) -> Self {
        Self { kind: NoteKind::Changed, text: text.into() }
    }

    /// Everything was read as it stands there, and looks as if it were not meant.
    pub fn odd(text: impl Into<String>) -> Self {
        Self { kind: NoteKind::Odd, text: text.into() }
    }
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// `one` for 1, else `many` with the number in front: `counted(2, "One row was", "rows were")` is "2 rows were".
pub(super) fn counted(count: usize, one: &str, many: &str) -> String {
    if count == 1 { one.to_owned() } else { format!("{count} {many}") }
}
