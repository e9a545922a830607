//! Python's literals, as far as the headers of NumPy's arrays hold them.

/// Deepest nesting: a list of fields, a field, its own fields.
const MAX_DEPTH: usize = 16;

/// A value as Python writes it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Literal {
    Text(String),
    /// Numbers beyond the largest are the largest.
    Whole(usize),
    Flag(bool),
    /// A list or a tuple.
    List(Vec<Literal>),
    /// Anything else: `None`, a negative number.
    Other,
}

/// An entry of a dictionary.
#[derive(Debug)]
pub(super) struct Member<'a> {
    pub(super) key: String,
    pub(super) value: Literal,
    /// The byte that the value begins at, and its text.
    pub(super) at: usize,
    pub(super) text: &'a str,
}

impl Literal {
    /// The entries of a dictionary; else the byte that it can't be understood at.
    pub(super) fn members(text: &str) -> Result<Vec<Member<'_>>, usize> {
        let mut cursor = Cursor { text, at: 0 };
        let mut members = Vec::new();
        cursor.expect('{')?;
        loop {
            if cursor.take('}') {
                return if cursor.rest().trim_matches(['\0', ' ', '\n', '\r', '\t']).is_empty() {
                    Ok(members)
                } else {
                    Err(cursor.at)
                };
            }
            let start = cursor.at;
            let Self::Text(key) = cursor.value(0)? else { return Err(start) };
            cursor.expect(':')?;
            cursor.blanks();
            let at = cursor.at;
            let value = cursor.value(0)?;
            members.push(Member { key, value, at, text: &text[at..cursor.at] });
            if !cursor.take(',') && !cursor.rest().starts_with('}') {
                return Err(cursor.at);
            }
        }
    }

    pub(super) fn text(&self) -> Option<&str> {
        match self {
            Self::Text(text) => Some(text),
            _ => None,
        }
    }

    /// The numbers of a tuple; one number is a tuple of it.
    pub(super) fn sizes(&self) -> Option<Vec<usize>> {
        let size = |value: &Self| match value {
            Self::Whole(size) => Some(*size),
            _ => None,
        };
        match self {
            Self::List(values) => values.iter().map(size).collect(),
            other => size(other).map(|size| vec![size]),
        }
    }

    /// The product of the numbers of a tuple.
    pub(super) fn product(&self) -> Option<usize> {
        self.sizes()?.into_iter().try_fold(1_usize, usize::checked_mul)
    }
}

struct Cursor<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Cursor<'a> {
    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn blanks(&mut self) {
        self.at = self.text.len() - self.rest().trim_start().len();
    }

    /// Goes on past a sign, if it comes next, and past the blanks around it.
    fn take(&mut self, sign: char) -> bool {
        self.blanks();
        let found = self.rest().starts_with(sign);
        if found {
            self.at += sign.len_utf8();
            self.blanks();
        }
        found
    }

    fn expect(&mut self, sign: char) -> Result<(), usize> {
        if self.take(sign) { Ok(()) } else { Err(self.at) }
    }

    fn value(&mut self, depth: usize) -> Result<Literal, usize> {
        self.blanks();
        let rest = self.rest();
        match rest.as_bytes() {
            [b'(' | b'[', ..] if depth < MAX_DEPTH => {
                let end = if rest.starts_with('(') { ')' } else { ']' };
                self.at += 1;
                let mut values = Vec::new();
                loop {
                    // Up to the bracket, and not beyond it: what follows does not belong to the text of the value.
                    self.blanks();
                    if self.rest().starts_with(end) {
                        self.at += 1;
                        return Ok(Literal::List(values));
                    }
                    values.push(self.value(depth + 1)?);
                    self.blanks();
                    if !self.rest().starts_with(end) {
                        self.expect(',')?;
                    }
                }
            }
            // Python 2 marks texts, too.
            [b'u' | b'b', b'\'' | b'"', ..] => {
                self.at += 1;
                self.quoted()
            }
            [b'\'' | b'"', ..] => self.quoted(),
            _ => self.word(),
        }
    }

    fn quoted(&mut self) -> Result<Literal, usize> {
        let start = self.at;
        let mut signs = self.rest().char_indices();
        let Some((_, quote)) = signs.next() else { return Err(start) };
        let mut text = String::new();
        while let Some((at, sign)) = signs.next() {
            match sign {
                sign if sign == quote => {
                    self.at = start + at + 1;
                    return Ok(Literal::Text(text));
                }
                '\\' => {
                    let (at, escaped) = signs.next().ok_or(start)?;
                    let digits = match escaped {
                        'x' => 2,
                        'u' => 4,
                        'U' => 8,
                        other => {
                            text.push(other);
                            continue;
                        }
                    };
                    let code = self.text.get(start + at + 1..start + at + 1 + digits).ok_or(start)?;
                    text.push(u32::from_str_radix(code, 16).ok().and_then(char::from_u32).ok_or(start)?);
                    signs.by_ref().take(digits).for_each(drop);
                }
                other => text.push(other),
            }
        }
        Err(start)
    }

    fn word(&mut self) -> Result<Literal, usize> {
        let start = self.at;
        let rest = self.rest();
        let length =
            rest.find(|sign: char| !(sign.is_ascii_alphanumeric() || "-+_.".contains(sign))).unwrap_or(rest.len());
        let word = &rest[..length];
        self.at += length;
        match word {
            "" => Err(start),
            "True" => Ok(Literal::Flag(true)),
            "False" => Ok(Literal::Flag(false)),
            word => {
                // Python 2 marks long numbers.
                let digits = word.strip_suffix(['L', 'l']).unwrap_or(word);
                if !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit()) {
                    return Ok(Literal::Whole(digits.parse().unwrap_or(usize::MAX)));
                }
                Ok(Literal::Other)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may stop at the first surprise")]
    use super::*;

    #[test]
    fn headers_as_python_writes_them() {
        let text =
            "{'descr': [(('a title', 'x'), '<f8'), (u'y\\u00e9', '<f8', (2,))], \"shape\": (40L, 2L), 'f': True, }  \n";
        let members = Literal::members(text).unwrap();
        let keys: Vec<&str> = members.iter().map(|member| member.key.as_str()).collect();
        assert_eq!(keys, ["descr", "shape", "f"]);
        assert_eq!((members[1].value.sizes(), members[1].text), (Some(vec![40, 2]), "(40L, 2L)"));
        let Literal::List(fields) = &members[0].value else { unreachable!() };
        let Literal::List(field) = &fields[1] else { unreachable!() };
        assert_eq!((field[0].text(), field[2].product()), (Some("yé"), Some(2)));
        assert_eq!(Literal::members("{'a': (-1, 2)}").unwrap()[0].value.sizes(), None);
        for broken in [
            "",
            "{",
            "{'a'",
            "{'a': }",
            "{'a': (1 2)}",
            "{'a': 'b",
            "{'a': 1} x",
            "{'a': '\\x9",
            "{1: 2}",
            "{'a': 1 'b': 2}",
        ] {
            assert!(Literal::members(broken).is_err(), "{broken}");
        }
        assert!(Literal::members(&format!("{{'a': {}", "(".repeat(5000))).is_err());
    }
}
