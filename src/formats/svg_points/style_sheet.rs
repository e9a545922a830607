//! What style sheets, `style` and attributes say of an element. Selectors are those of CSS 2 (the `simplecss` library
//! reads and compares them): elements, ids, classes, attributes, `:first-child`, and what lies in, directly in or
//! directly behind what. Rules with anything else are left out, and counted.

use std::cell::Cell;
use std::collections::HashMap;

use roxmltree::Node;
use simplecss::{AttributeOperator, Element, PseudoClass, Selector, SelectorToken, SelectorTokenizer};

/// What matters to points.
const PROPERTIES: [&str; 36] = [
    "fill",
    "stroke",
    "display",
    "visibility",
    "cx",
    "cy",
    "r",
    "rx",
    "ry",
    "x",
    "y",
    "width",
    "height",
    "opacity",
    "fill-opacity",
    "stroke-opacity",
    "stroke-width",
    "stroke-linecap",
    "color",
    "stop-color",
    "stop-opacity",
    "clip-path",
    "clip-rule",
    "mask",
    "overflow",
    "marker",
    "marker-start",
    "marker-mid",
    "marker-end",
    "vector-effect",
    "transform-origin",
    "transform-box",
    // Attributes called so are no CSS, or something else.
    "transform",
    "translate",
    "rotate",
    "scale",
];
/// How many of them are attributes too.
const ATTRIBUTES: usize = PROPERTIES.len() - 4;
/// Most selectors, all sheets together.
const MAX_SELECTORS: usize = 5_000;
/// Longest selector, in bytes. It bounds how deep comparing goes.
const MAX_SELECTOR_LENGTH: usize = 300;
/// Most steps of comparing selectors with elements.
const MAX_WORK: usize = 20_000_000;
/// Rules within `@media` within `@media`.
const MAX_MEDIA_DEPTH: usize = 4;

/// One declaration: which of the properties, its value, whether it is `!important`.
#[derive(Clone, Copy, Debug)]
struct Declaration<'a> {
    property: &'static str,
    value: &'a str,
    is_important: bool,
}

#[derive(Debug)]
struct Rule<'a> {
    selector: Selector<'a>,
    /// Which of the blocks.
    block: usize,
}

/// What an element must have, for a rule to be looked at: the last part of its selector.
#[derive(Debug, PartialEq, Eq, Hash)]
enum Key<'a> {
    Id(&'a str),
    Class(&'a str),
    Name(&'a str),
    Any,
}

/// All style sheets of a document.
#[derive(Debug, Default)]
pub(super) struct StyleSheet<'a> {
    /// From the least weighty to the one that wins.
    rules: Vec<Rule<'a>>,
    blocks: Vec<Vec<Declaration<'a>>>,
    by_key: HashMap<Key<'a>, Vec<usize>>,
    /// Rules that are not understood.
    pub(super) left_out: usize,
    work: Cell<usize>,
}

/// The texts of all `style` elements of a document, comments taken out.
pub(super) fn css_of(root: Node) -> String {
    let is_screen = |node: &Node| node.attribute("media").is_none_or(is_for_screens);
    let is_css = |node: &Node| node.attribute("type").is_none_or(|kind| matches!(kind, "" | "text/css"));
    let mut css = String::new();
    for node in root.descendants().filter(|node| node.tag_name().name() == "style") {
        if is_screen(&node) && is_css(&node) {
            let text: String = node.children().filter_map(|child| child.is_text().then(|| child.text())?).collect();
            css.push_str(&without_comments(&text));
            css.push('\n');
        }
    }
    css
}

fn is_for_screens(media: &str) -> bool {
    let media = media.trim();
    media.is_empty() || media.split(',').any(|one| matches!(one.trim(), "all" | "screen" | "only screen"))
}

impl<'a> StyleSheet<'a> {
    pub(super) fn parse(css: &'a str) -> Self {
        let mut sheet = Self::default();
        let mut rules = Vec::new();
        sheet.read(css, &mut rules, 0);
        // Of two equally weighty rules the later one wins.
        rules.sort_by_key(|(_, rule): &(Key, Rule)| rule.selector.specificity());
        for (number, (key, rule)) in rules.into_iter().enumerate() {
            sheet.by_key.entry(key).or_default().push(number);
            sheet.rules.push(rule);
        }
        sheet
    }

    fn read(&mut self, css: &'a str, rules: &mut Vec<(Key<'a>, Rule<'a>)>, depth: usize) {
        let mut rest = css.trim_start();
        while !rest.is_empty() {
            let open = rest.find('{').unwrap_or(rest.len());
            if rest.starts_with('@')
                && let Some(end) = rest[..open].find(';')
            {
                self.left_out += usize::from(rest.starts_with("@import"));
                rest = rest[end + 1..].trim_start();
                continue;
            }
            let (selectors, block) = rest.split_at(open);
            let end = block_end(block);
            let body = block.get(1..end).unwrap_or_default();
            rest = block.get(end + 1..).unwrap_or_default().trim_start();
            if let Some(media) = selectors.strip_prefix("@media") {
                if is_for_screens(media) && depth < MAX_MEDIA_DEPTH {
                    self.read(body, rules, depth + 1);
                } else if media.trim() != "print" {
                    self.left_out += 1;
                }
                continue;
            }
            if selectors.starts_with('@') || body.contains('{') {
                let is_harmless = ["@font-face", "@keyframes", "@-webkit-keyframes", "@page"];
                self.left_out += usize::from(!is_harmless.iter().any(|name| selectors.starts_with(name)));
                continue;
            }
            let declarations: Vec<Declaration> = declarations(body).collect();
            if rules.len() >= MAX_SELECTORS {
                self.left_out += 1;
                continue;
            }
            if declarations.is_empty() {
                continue;
            }
            self.blocks.push(declarations);
            for selector in selectors.split(',').map(str::trim) {
                match rule(selector, self.blocks.len() - 1) {
                    Some(rule) if rules.len() < MAX_SELECTORS => rules.push(rule),
                    _ => self.left_out += 1,
                }
            }
        }
    }

    /// What holds for an element; `None` when that was asked too often.
    pub(super) fn styles<'n>(&'n self, node: Node<'n, '_>) -> Option<Styles<'n>> {
        let mut styles = Styles(Vec::new());
        for attribute in node.attributes() {
            if let Some(property) = PROPERTIES[..ATTRIBUTES].iter().find(|known| **known == attribute.name()) {
                styles.set(property, attribute.value().trim(), Rank::Attribute);
            }
        }
        for rule in self.candidates(node) {
            let Rule { selector, block } = &self.rules[rule];
            if selector.matches(&Compared { node, work: &self.work }) {
                for declaration in &self.blocks[*block] {
                    let rank = if declaration.is_important { Rank::ImportantRule } else { Rank::Rule };
                    styles.set(declaration.property, declaration.value, rank);
                }
            }
        }
        if self.work.get() > MAX_WORK {
            return None;
        }
        for declaration in declarations(node.attribute("style").unwrap_or_default()) {
            let rank = if declaration.is_important { Rank::ImportantStyle } else { Rank::Style };
            styles.set(declaration.property, declaration.value, rank);
        }
        Some(styles)
    }

    /// The rules whose last part an element may be, in their order.
    fn candidates(&self, node: Node) -> Vec<usize> {
        if self.rules.is_empty() {
            return Vec::new();
        }
        let mut found = Vec::new();
        let mut take = |key: Key| found.extend(self.by_key.get(&key).into_iter().flatten().copied());
        take(Key::Any);
        take(Key::Name(node.tag_name().name()));
        node.attribute("id").into_iter().for_each(|id| take(Key::Id(id)));
        node.attribute("class").unwrap_or_default().split_ascii_whitespace().for_each(|class| take(Key::Class(class)));
        self.work.set(self.work.get() + found.len());
        if self.work.get() > MAX_WORK {
            return Vec::new();
        }
        found.sort_unstable();
        found.dedup();
        found
    }
}

/// A selector with what its last part asks for.
fn rule(selector: &str, block: usize) -> Option<(Key<'_>, Rule<'_>)> {
    if selector.len() > MAX_SELECTOR_LENGTH {
        return None;
    }
    let parsed = Selector::parse(selector)?;
    let mut key = Key::Any;
    for token in SelectorTokenizer::from(selector) {
        key = match (token.ok()?, key) {
            // What was before is asked of other elements.
            (
                SelectorToken::DescendantCombinator
                | SelectorToken::ChildCombinator
                | SelectorToken::AdjacentCombinator,
                _,
            ) => Key::Any,
            (SelectorToken::IdSelector(id), _) => Key::Id(id),
            (_, key @ Key::Id(_)) => key,
            (SelectorToken::ClassSelector(class), _) => Key::Class(class),
            (_, key @ Key::Class(_)) => key,
            (SelectorToken::TypeSelector(name), _) => Key::Name(name),
            (_, key) => key,
        };
    }
    Some((key, Rule { selector: parsed, block }))
}

/// An element as selectors see it. When too much was compared, nothing matches any more.
struct Compared<'n, 'i, 'w> {
    node: Node<'n, 'i>,
    work: &'w Cell<usize>,
}

impl Compared<'_, '_, '_> {
    fn may_work(&self, steps: usize) -> bool {
        self.work.set(self.work.get() + steps);
        self.work.get() <= MAX_WORK
    }

    fn at(&self, node: Option<Self>) -> Option<Self> {
        node.filter(|_| self.may_work(1))
    }
}

impl Element for Compared<'_, '_, '_> {
    fn parent_element(&self) -> Option<Self> {
        self.at(self.node.parent_element().map(|node| Self { node, work: self.work }))
    }

    fn prev_sibling_element(&self) -> Option<Self> {
        self.at(self.node.prev_sibling_element().map(|node| Self { node, work: self.work }))
    }

    fn has_local_name(&self, name: &str) -> bool {
        self.may_work(1) && self.node.tag_name().name() == name
    }

    fn attribute_matches(&self, local_name: &str, operator: AttributeOperator<'_>) -> bool {
        let Some(value) = self.node.attribute(local_name) else { return false };
        let is_met = || match operator {
            AttributeOperator::Contains(word) => value.split_ascii_whitespace().any(|one| one == word),
            _ => operator.matches(value),
        };
        self.may_work(1 + value.len() / 16 + self.node.attributes().len() / 4) && is_met()
    }

    fn pseudo_class_matches(&self, class: PseudoClass<'_>) -> bool {
        self.may_work(1) && class == PseudoClass::FirstChild && self.node.prev_sibling_element().is_none()
    }
}

/// Where a declaration stands, from the least weighty to the one that wins.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Rank {
    Attribute,
    Rule,
    Style,
    ImportantRule,
    ImportantStyle,
}

/// What holds for an element: its own style, else the sheets', else its attributes.
#[derive(Debug)]
pub(super) struct Styles<'n>(Vec<(&'static str, &'n str, Rank)>);

impl<'n> Styles<'n> {
    fn set(&mut self, property: &'static str, value: &'n str, rank: Rank) {
        match self.0.iter_mut().find(|(known, _, _)| *known == property) {
            Some(entry) if entry.2 <= rank => *entry = (property, value, rank),
            Some(_) => {}
            None => self.0.push((property, value, rank)),
        }
    }

    /// The value of a property; `inherit` is none of its own.
    pub(super) fn get(&self, property: &str) -> Option<&'n str> {
        self.0.iter().find(|(known, value, _)| *known == property && *value != "inherit").map(|(_, value, _)| *value)
    }
}

/// `fill: red !important; …`, as far as it matters to points.
fn declarations(body: &str) -> impl Iterator<Item = Declaration<'_>> {
    body.split(';').filter_map(|text| {
        let (name, value) = text.split_once(':')?;
        let (value, mark) = value.split_once('!').unwrap_or((value, ""));
        let property = PROPERTIES.iter().find(|known| name.trim().eq_ignore_ascii_case(known))?;
        Some(Declaration { property, value: value.trim(), is_important: mark.trim() == "important" })
    })
}

/// Where the bracket that opens `text` is closed, or the end.
fn block_end(text: &str) -> usize {
    let mut depth = 0_usize;
    for (at, byte) in text.bytes().enumerate() {
        match byte {
            b'{' => depth += 1,
            b'}' if depth <= 1 => return at,
            b'}' => depth -= 1,
            _ => {}
        }
    }
    text.len()
}

fn without_comments(css: &str) -> String {
    let mut parts = css.split("/*");
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        // An open comment reaches to the end.
        text.push_str(part.split_once("*/").map_or("", |(_, after)| after));
    }
    text
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test may stop at the first surprise")]
    use super::*;

    fn sheet<T>(css: &str, elements: &str, ask: impl Fn(&StyleSheet, Node) -> T) -> T {
        let text = format!("<svg><style><![CDATA[{css}]]></style>{elements}</svg>");
        let document = roxmltree::Document::parse(&text).unwrap();
        let css = css_of(document.root_element());
        let last = document.descendants().rfind(Node::is_element).unwrap();
        ask(&StyleSheet::parse(&css), last)
    }

    /// Of the last element.
    fn fill(css: &str, elements: &str) -> Option<String> {
        sheet(css, elements, |sheet, node| sheet.styles(node).unwrap().get("fill").map(str::to_owned))
    }

    #[test]
    fn rules_win_as_in_css() {
        let is = |css: &str, element: &str, wanted: Option<&str>| assert_eq!(fill(css, element).as_deref(), wanted);
        is(".a{fill:#f00}", r#"<circle class="b a"/>"#, Some("#f00"));
        is(".a{fill:#f00}", r#"<circle class="aa" fill="blue"/>"#, Some("blue"));
        is("circle { FILL : red }", r#"<circle fill="blue"/>"#, Some("red"));
        is("circle{fill:red}", r#"<circle style="fill:blue"/>"#, Some("blue"));
        is("circle{fill:red !important}", r#"<circle style="fill:blue"/>"#, Some("red"));
        is("circle{fill:red!important}", r#"<circle style="fill:blue ! important"/>"#, Some("blue"));
        is("circle{fill:red!important}.a{fill:blue}", r#"<circle class="a"/>"#, Some("red"));
        is("#x{fill:green}.a.b{fill:blue}.a{fill:red}", r#"<circle id="x" class="a b"/>"#, Some("green"));
        is(".a.b{fill:blue}.a{fill:red}", r#"<circle class="a b"/>"#, Some("blue"));
        is(".a{fill:blue}.b{fill:red}", r#"<circle class="b a"/>"#, Some("red"));
        is("*{fill:blue}circle{fill:red}", r#"<circle class="b a"/>"#, Some("red"));
        is(".x, ellipse , circle.a{fill:red}", r#"<circle class="a"/>"#, Some("red"));
        is("/* .a{} */.a/*x*/{/* fill:blue; */fill:red", r#"<circle class="a"/>"#, Some("red"));
        is(".a{stroke:red;;fill}", r#"<circle class="a"/>"#, None);
    }

    #[test]
    fn selectors_say_where_an_element_stands() {
        let tree = r#"<g class="a" id="x"><g class="b"><circle/><circle data-k="1" class="c d"/></g></g>"#;
        for (selector, is_met) in [
            (".a circle", true),
            (".a > circle", false),
            (".a>.b>circle", true),
            ("#x .b .c", true),
            ("svg g g .d.c", true),
            (".c .a circle", false),
            ("circle + circle", true),
            ("g + circle", false),
            ("circle:first-child", false),
            ("g:first-child circle.c", true),
            ("[data-k]", true),
            ("[data-k='1'].c", true),
            ("circle[data-k=\"2\"]", false),
            ("[class~=d]", true),
            ("[class~='d']", true),
            (".a\n.b\t.c", true),
        ] {
            let found = fill(&format!("{selector}{{fill:red}}"), tree);
            assert_eq!(found.as_deref(), is_met.then_some("red"), "{selector}");
        }
        // The more is asked, the more it weighs.
        assert_eq!(fill(".a .c{fill:red} .c{fill:blue}", tree).as_deref(), Some("red"));
        assert_eq!(fill("@media screen{.c{fill:red}} @media print{.c{fill:blue}}", tree).as_deref(), Some("red"));
    }

    #[test]
    fn what_is_not_understood_is_counted_and_does_no_harm() {
        for (css, left_out) in [
            ("g ~ .a{fill:blue}", 1),
            (".a:nth-child(2),.a:not(.b),.a::before{fill:blue}", 3),
            ("@media print{.a{fill:blue}}", 0),
            ("@media (min-width: 3px){.a{fill:blue}}", 1),
            ("@import url(x.css);", 1),
            ("@charset \"utf-8\";@font-face{src:url(data:;x)}", 0),
            (".a{.b{fill:blue}}", 1),
            (".{fill:blue} ..a{fill:blue} a>{fill:blue} {fill:blue}", 4),
        ] {
            assert_eq!(sheet(css, "", |sheet, _| sheet.left_out), left_out, "{css}");
            let found = fill(&format!("{css}.a{{fill:red}}"), r#"<circle class="a"/>"#);
            assert_eq!(found.as_deref(), Some("red"), "{css}");
        }
    }

    /// Each part of the selector can be any of the elements around: more ways than one can try.
    #[test]
    fn comparing_ends() {
        let css = format!("x {} y{{fill:red}}", "g ".repeat(40));
        let tree = format!("{}<y/>{}", "<g>".repeat(60), "</g>".repeat(60));
        assert!(sheet(&css, &tree, |sheet, node| node.tag_name().name() == "y" && sheet.styles(node).is_none()));
    }
}
