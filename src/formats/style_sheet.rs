//! Style sheets of drawings, as drawing programs write them: rules for an element, an id and classes. What else CSS knows
//! is left out, and counted.

use std::cell::Cell;
use std::rc::Rc;

use roxmltree::Node;

use crate::sorting;

/// What matters to points.
const PROPERTIES: [&str; 9] = ["fill", "stroke", "display", "visibility", "cx", "cy", "r", "rx", "ry"];
/// Most selectors, all sheets together.
const MAX_SELECTORS: usize = 5_000;
/// Most classes of a selector.
const MAX_SELECTOR_CLASSES: usize = 8;
/// Most comparisons of selectors with elements and their classes.
const MAX_WORK: usize = 20_000_000;

/// One declaration: which of the properties, its value, whether it is `!important`.
type Declaration = (usize, String, bool);

#[derive(Debug)]
struct Rule {
    /// Any when there is none.
    element: Option<String>,
    id: Option<String>,
    classes: Vec<String>,
    declarations: Rc<[Declaration]>,
}

impl Rule {
    /// `circle.oak#first`; nothing else is understood.
    fn parse(selector: &str, declarations: &Rc<[Declaration]>) -> Option<Self> {
        let mut rule = Self { element: None, id: None, classes: Vec::new(), declarations: Rc::clone(declarations) };
        let is_name = |c: char| c.is_alphanumeric() || matches!(c, '-' | '_');
        let end = selector.find(['.', '#']).unwrap_or(selector.len());
        let (element, mut rest) = selector.split_at(end);
        if element.chars().all(is_name) && !element.is_empty() {
            rule.element = Some(element.to_owned());
        } else if !(element == "*" || element.is_empty() && !rest.is_empty()) {
            return None;
        }
        while let Some(sign) = rest.chars().next() {
            let after = &rest[1..];
            let end = after.find(['.', '#']).unwrap_or(after.len());
            let (name, next) = after.split_at(end);
            if name.is_empty() || !name.chars().all(is_name) || rule.classes.len() >= MAX_SELECTOR_CLASSES {
                return None;
            }
            match (sign, &rule.id) {
                ('#', None) => rule.id = Some(name.to_owned()),
                ('#', Some(_)) => return None,
                _ => rule.classes.push(name.to_owned()),
            }
            rest = next;
        }
        Some(rule)
    }

    /// CSS's specificity: ids, classes, elements. There are fewer than ten classes.
    fn weight(&self) -> f64 {
        let is = |part: &Option<String>| f64::from(u8::from(part.is_some()));
        100.0 * is(&self.id) + 10.0 * self.classes.len() as f64 + is(&self.element)
    }

    fn matches(&self, name: &str, id: Option<&str>, classes: &[&str]) -> bool {
        self.element.as_deref().is_none_or(|wanted| wanted == name)
            && self.id.as_deref().is_none_or(|wanted| Some(wanted) == id)
            && self.classes.iter().all(|wanted| classes.contains(&wanted.as_str()))
    }
}

/// All style sheets of a document.
#[derive(Debug, Default)]
pub(super) struct StyleSheet {
    rules: Vec<Rule>,
    /// From the least weighty to the one that wins.
    order: Vec<usize>,
    /// Rules that are not understood.
    pub(super) left_out: usize,
    work: Cell<usize>,
}

/// What the sheets and the element's own attributes say.
pub(super) struct Styles<'s> {
    sheet: [Option<(&'s str, bool)>; PROPERTIES.len()],
}

impl StyleSheet {
    /// The sheets in the `style` elements of a document.
    pub(super) fn of(root: Node) -> Self {
        let mut sheet = Self::default();
        let is_screen = |node: &Node| node.attribute("media").is_none_or(|media| matches!(media, "all" | "screen"));
        let is_css = |node: &Node| node.attribute("type").is_none_or(|kind| matches!(kind, "" | "text/css"));
        for node in root.descendants().filter(|node| node.tag_name().name() == "style") {
            if is_screen(&node) && is_css(&node) {
                let text: String = node.children().filter_map(|child| child.is_text().then(|| child.text())?).collect();
                sheet.read(&text);
            }
        }
        // Of two equally weighty rules the later one wins.
        sheet.order = sorting::order(sheet.rules.iter().map(Rule::weight));
        sheet
    }

    fn read(&mut self, css: &str) {
        let text = without_comments(css);
        let mut rest = text.trim_start();
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
            if selectors.starts_with('@') || body.contains('{') {
                self.left_out += usize::from(!selectors.starts_with("@font-face"));
                continue;
            }
            let declarations: Rc<[Declaration]> = declarations(body).collect();
            if declarations.is_empty() {
                continue;
            }
            for selector in selectors.split(',') {
                match Rule::parse(selector.trim(), &declarations) {
                    Some(rule) if self.rules.len() < MAX_SELECTORS => self.rules.push(rule),
                    _ => self.left_out += 1,
                }
            }
        }
    }

    /// What holds for an element; `None` when that was asked too often.
    pub(super) fn styles(&self, node: Node) -> Option<Styles<'_>> {
        let mut sheet = [None; PROPERTIES.len()];
        if self.rules.is_empty() {
            return Some(Styles { sheet });
        }
        let classes: Vec<&str> = node.attribute("class").unwrap_or_default().split_ascii_whitespace().collect();
        self.work.set(self.work.get() + self.rules.len() * (1 + classes.len()));
        if self.work.get() > MAX_WORK {
            return None;
        }
        let (name, id) = (node.tag_name().name(), node.attribute("id"));
        for rule in self.order.iter().map(|&rule| &self.rules[rule]).filter(|rule| rule.matches(name, id, &classes)) {
            for (property, value, important) in rule.declarations.iter() {
                let slot = &mut sheet[*property];
                if *important || slot.is_none_or(|(_, important)| !important) {
                    *slot = Some((value.as_str(), *important));
                }
            }
        }
        Some(Styles { sheet })
    }
}

impl Styles<'_> {
    /// The element's own style, else the sheets', else the attribute of that name.
    pub(super) fn property<'n>(&'n self, node: Node<'n, '_>, name: &str) -> Option<&'n str> {
        let sheet = PROPERTIES.iter().position(|known| *known == name).and_then(|property| self.sheet[property]);
        let own = node.attribute("style").and_then(|style| {
            style.rsplit(';').filter_map(declaration).find(|(key, _, _)| *key == name).map(|(_, value, is)| (value, is))
        });
        let styled = match (own, sheet) {
            (Some((_, false)) | None, Some((value, true))) => Some(value),
            (Some((value, _)), _) | (None, Some((value, _))) => Some(value),
            (None, None) => None,
        };
        styled.or_else(|| node.attribute(name).map(str::trim))
    }
}

/// `fill: red !important` as name, value and whether it is important.
fn declaration(text: &str) -> Option<(&str, &str, bool)> {
    let (name, value) = text.split_once(':')?;
    let (value, mark) = value.split_once('!').unwrap_or((value, ""));
    Some((name.trim(), value.trim(), mark.trim() == "important"))
}

fn declarations(body: &str) -> impl Iterator<Item = Declaration> {
    body.split(';').filter_map(declaration).filter_map(|(name, value, important)| {
        let property = PROPERTIES.iter().position(|known| name.eq_ignore_ascii_case(known))?;
        Some((property, value.to_owned(), important))
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

    fn fill(css: &str, element: &str) -> Option<String> {
        let text = format!("<svg><style><![CDATA[{css}]]></style>{element}</svg>");
        let document = roxmltree::Document::parse(&text).unwrap();
        let sheet = StyleSheet::of(document.root_element());
        let node = document.root_element().last_element_child().unwrap();
        sheet.styles(node).unwrap().property(node, "fill").map(str::to_owned)
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
        is("#x{fill:green}.a.b{fill:blue}.a{fill:red}", r#"<circle id="x" class="a b"/>"#, Some("green"));
        is(".a.b{fill:blue}.a{fill:red}", r#"<circle class="a b"/>"#, Some("blue"));
        is(".a{fill:blue}.b{fill:red}", r#"<circle class="b a"/>"#, Some("red"));
        is("*{fill:blue}circle{fill:red}", r#"<circle class="b a"/>"#, Some("red"));
        is(".x, ellipse , circle.a{fill:red}", r#"<circle class="a"/>"#, Some("red"));
        is("/* .a{} */.a/*x*/{/* fill:blue; */fill:red", r#"<circle class="a"/>"#, Some("red"));
        is(".a{stroke:red;;fill}", r#"<circle class="a"/>"#, None);
    }

    #[test]
    fn what_is_not_understood_is_counted_and_does_no_harm() {
        for (css, left_out) in [
            ("g .a{fill:blue}", 1),
            (".a:hover,.a[x],g>circle{fill:blue}", 3),
            ("@media print{.a{fill:blue}}", 1),
            ("@import url(x.css);", 1),
            ("@charset \"utf-8\";@font-face{src:url(data:;x)}", 0),
            (".a{.b{fill:blue}}", 1),
            (".{fill:blue} ..a{fill:blue} #a#b{fill:blue} {fill:blue}", 4),
        ] {
            let text = format!("<svg><style>{}</style></svg>", css.replace('>', "&gt;"));
            let document = roxmltree::Document::parse(&text).unwrap();
            assert_eq!(StyleSheet::of(document.root_element()).left_out, left_out, "{css}");
            assert_eq!(
                fill(&format!("{css}.a{{fill:red}}"), r#"<circle class="a"/>"#).as_deref(),
                Some("red"),
                "{css}"
            );
        }
    }
}
