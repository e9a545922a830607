//! From text to elements, within bounds: what a parser of XML would take too long or too much memory over is refused.

use std::borrow::Cow;

use roxmltree::{Document, Node, ParsingOptions};

use crate::formats::error::{FormatError, clip, place};

/// Most nodes of the document, text included.
const MAX_NODES: u32 = 400_000;
/// Most attributes of an element: names are compared with each other.
const MAX_ELEMENT_ATTRIBUTES: usize = 500;
/// Most declarations of namespaces on the way from the root to an element, times elements with a declaration.
const MAX_NAMESPACE_WORK: usize = 10_000_000;
/// Most entities of a DTD: each reference looks through them.
const MAX_ENTITIES: usize = 200;
/// Most bytes that all references to entities become together, if each were to the longest one.
const MAX_EXPANSION: usize = 1_000_000;

/// The document, with `svg` as its root.
pub(super) fn parse(text: &str) -> Result<Document<'_>, FormatError> {
    // Entities of a DTD are texts within the file; nothing outside it is ever fetched.
    let parsing = ParsingOptions { allow_dtd: true, nodes_limit: MAX_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, parsing).map_err(|error| located(&error))?;
    let root = document.root_element();
    if root.tag_name().name() != "svg" {
        return refuse_plainly(
            root,
            &format!("its outermost element is <{}>, not <svg>", clip(root.tag_name().name())),
        );
    }
    Ok(document)
}

/// An error at an element, in `message`'s words.
fn refuse_plainly<T>(node: Node, message: &str) -> Result<T, FormatError> {
    let position = node.document().text_pos_at(node.range().start);
    let (line, column) = (position.row as usize, position.col as usize);
    Err(FormatError::Syntax { line, column, message: message.to_owned() })
}

/// An error at an element: the SVG can't be used because of `message`.
pub(super) fn refuse<T>(node: Node, message: &str) -> Result<T, FormatError> {
    refuse_plainly(node, &format!("the SVG can't be used: {message}"))
}

/// The library's words, with the place in front as in every other format.
fn located(error: &roxmltree::Error) -> FormatError {
    let position = error.pos();
    let message = error.to_string();
    let place = format!(" at {}:{}", position.row, position.col);
    let message = message.strip_suffix(&place).unwrap_or(&message);
    FormatError::Syntax {
        line: position.row as usize,
        column: position.col as usize,
        message: format!("the SVG can't be used: {message}"),
    }
}

/// Blanks in place of a DOCTYPE that only names SVG, as many programs write it: what declares nothing does no harm.
pub(super) fn without_doctype(text: &str) -> Cow<'_, str> {
    let found = text.find("<!DOCTYPE").and_then(|start| Some((start, start + text[start..].find('>')?)));
    match found {
        Some((start, end)) if !text[start..end].contains('[') => {
            let blanks = text[start..=end].chars().map(|c| if c == '\n' { '\n' } else { ' ' }).collect::<String>();
            Cow::Owned([&text[..start], &blanks, &text[end + 1..]].concat())
        }
        _ => Cow::Borrowed(text),
    }
}

/// Refuses what the parser would take too long over.
pub(super) fn check_size(text: &str) -> Result<(), FormatError> {
    let refuse = |byte: usize, message: &str| {
        let (line, column) = place(text, byte);
        let message = format!("the SVG can't be used: {message}");
        Err(FormatError::Syntax { line, column, message })
    };
    let mut at = 0;
    for (index, element) in text.split('<').enumerate() {
        // An element begins with one such sign and ends with at most another one.
        if index > 2 * MAX_NODES as usize {
            return refuse(at, "it has too many elements");
        }
        if element.bytes().filter(|&byte| byte == b'=').count() > MAX_ELEMENT_ATTRIBUTES {
            return refuse(at, "an element has too many attributes");
        }
        at += element.len() + usize::from(index > 0);
    }
    let (named, all) = (text.matches("xmlns:").count(), text.matches("xmlns").count());
    if (named + 1).saturating_mul(all) > MAX_NAMESPACE_WORK {
        return refuse(text.rfind("xmlns").unwrap_or(0), "it declares too many namespaces");
    }
    match check_entities(text) {
        Ok(()) => Ok(()),
        Err((byte, message)) => refuse(byte, message),
    }
}

/// Illustrator declares its namespaces as entities, which is fine. Entities that refer to each other or make much of
/// little are refused, with the byte where they stand.
fn check_entities(text: &str) -> Result<(), (usize, &'static str)> {
    const DECLARATION: &str = "<!ENTITY";
    let mut longest = 0;
    for (index, (start, _)) in text.match_indices(DECLARATION).enumerate() {
        if index >= MAX_ENTITIES {
            return Err((start, "its DTD declares too many entities"));
        }
        // The first quoted text: the value, or the address of something outside, which is not looked at.
        let rest = &text[start + DECLARATION.len()..];
        let Some(open) = rest.find(['"', '\'']) else { continue };
        let quote = if rest[open..].starts_with('"') { '"' } else { '\'' };
        let value = rest[open + 1..].split(quote).next().unwrap_or_default();
        if references(value) > 0 {
            return Err((start, "entities of its DTD refer to each other; save it as plain SVG"));
        }
        longest = longest.max(value.len());
    }
    if longest > 0 && references(text).saturating_mul(longest) > MAX_EXPANSION {
        return Err((text.find(DECLARATION).unwrap_or(0), "the entities of its DTD make it too long"));
    }
    Ok(())
}

/// How many references to entities of the file's own there are, at most.
fn references(text: &str) -> usize {
    let plain = ["#", "amp;", "lt;", "gt;", "quot;", "apos;"];
    text.split('&').skip(1).filter(|rest| !plain.iter().any(|name| rest.starts_with(name))).count()
}
