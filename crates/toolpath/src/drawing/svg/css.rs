//! Style sheets: the declarations that an element has.

use super::XmlNode;
use crate::PathFault;
use simplecss::{AttributeOperator, Element, PseudoClass, Selector};
use std::borrow::Cow;
use std::rc::Rc;

/// Attribute that stands for `:root`.
const ROOT: &str = "root-of-file";

/// Most steps from variable to variable.
const VARIABLES_MAX: u32 = 32;

/// Name, value, and true for `!important`.
#[derive(Clone, Debug)]
pub(super) struct Declaration<'t> {
    name: Cow<'t, str>,
    value: &'t str,
    important: bool,
}

/// Rules of all style sheets of a file, those that go before others last.
#[derive(Default)]
pub(super) struct Sheet<'t> {
    rules: Vec<(Selector<'t>, Rc<[Declaration<'t>]>)>,
}

/// Text of a style sheet without its comments, and the line at which it begins.
pub(super) struct SheetText {
    text: String,
    line: u32,
}

impl SheetText {
    pub(super) fn new(text: &str, line: u32) -> Self {
        let text = without_comments(text)
            .replace("<!--", "    ")
            .replace("-->", "   ")
            .replace(":root", &format!("[{ROOT}]"));
        Self { text, line }
    }
}

impl<'t> Sheet<'t> {
    /// Reads style sheets.
    ///
    /// # Errors
    /// A rule or a selector that is not known.
    pub(super) fn read(texts: &'t [SheetText]) -> Result<Self, PathFault> {
        let mut sheet = Self::default();
        for text in texts {
            sheet.add(text, &text.text)?;
        }
        sheet
            .rules
            .sort_by_key(|(selector, _)| selector.specificity());
        Ok(sheet)
    }

    fn add(&mut self, sheet: &'t SheetText, mut rest: &'t str) -> Result<(), PathFault> {
        let fault = |at: &str, word: &str, reason: &str| {
            let before = &sheet.text[..at.as_ptr() as usize - sheet.text.as_ptr() as usize];
            PathFault {
                line: sheet.line + before.matches('\n').count() as u32,
                word: word.trim().chars().take(40).collect(),
                reason: reason.to_owned(),
            }
        };
        loop {
            rest = rest.trim_start();
            let Some(end) = top_level(rest, &['{', ';']) else {
                return Ok(());
            };
            let (head, tail) = (&rest[..end], &rest[end..]);
            let body_end = match tail.starts_with('{') {
                true => top_level(&tail[1..], &['}']).map_or(tail.len(), |at| at + 1),
                false => 0,
            };
            let body = tail.get(1..body_end).unwrap_or_default();
            if let Some(rule) = head.strip_prefix('@') {
                let name = rule.split(|c: char| c.is_whitespace() || c == '(').next();
                let condition = rule[name.map_or(0, str::len)..].trim();
                match name.unwrap_or_default().trim_start_matches("-webkit-") {
                    "charset"
                    | "font-face"
                    | "keyframes"
                    | "namespace"
                    | "page"
                    | "property"
                    | "font-feature-values"
                    | "counter-style" => {}
                    "media" => match condition {
                        "" | "all" | "screen" | "only screen" => self.add(sheet, body)?,
                        "print" | "speech" => {}
                        _ => {
                            return Err(fault(
                                head,
                                head,
                                "the condition of a style is not known; write its rules without it",
                            ));
                        }
                    },
                    _ => {
                        return Err(fault(
                            head,
                            head,
                            "a rule of style sheets that is not read; write its styles without it",
                        ));
                    }
                }
            } else if tail.starts_with('{') {
                if top_level(body, &['{']).is_some() {
                    return Err(fault(
                        head,
                        head,
                        "nested rules are not read; write them one by one",
                    ));
                }
                let declarations: Rc<[_]> = declarations(body).collect();
                for one in split(head, ',')
                    .map(str::trim)
                    .filter(|one| !one.is_empty())
                {
                    // What stands before, behind or over an element is no part of a drawing.
                    if one.contains("::") || declarations.is_empty() {
                        continue;
                    }
                    let Some(selector) = Selector::parse(one).filter(|_| is_whole(one)) else {
                        return Err(fault(
                            one,
                            one,
                            "the selector of a style is not read; name elements by class, id or kind",
                        ));
                    };
                    self.rules.push((selector, Rc::clone(&declarations)));
                }
            }
            rest = &tail[(body_end + 1).min(tail.len())..];
        }
    }

    /// Declarations of an element.
    pub(super) fn of<'a>(&'a self, node: XmlNode<'a, 'a>) -> DeclaredStyle<'a>
    where
        't: 'a,
    {
        let mut css: Vec<Declaration<'a>> = Vec::new();
        for (selector, declarations) in &self.rules {
            if selector.matches(&Styled(node)) {
                css.extend(declarations.iter().cloned());
            }
        }
        let own = declarations(node.attribute("style").unwrap_or_default());
        css.extend(own);
        // Stable: of those that are important, the later goes before.
        css.sort_by_key(|declaration| declaration.important);
        DeclaredStyle { node, css }
    }
}

/// Declarations and attributes of an element.
pub(super) struct DeclaredStyle<'a> {
    pub(super) node: XmlNode<'a, 'a>,
    css: Vec<Declaration<'a>>,
}

impl<'a> DeclaredStyle<'a> {
    /// Value of a property as style alone.
    pub(super) fn style(&self, name: &str) -> Option<&'a str> {
        let found = self.css.iter().rev().find(|each| each.name == name);
        found.map(|each| each.value)
    }

    /// Value of a property: as style, or as attribute.
    pub(super) fn get(&self, name: &str) -> Option<&'a str> {
        self.style(name)
            .or_else(|| self.node.attribute(name).map(str::trim))
    }

    /// Variables that are declared here, in their order.
    pub(super) fn variables(&self) -> impl Iterator<Item = (&str, &'a str)> {
        let own = self.css.iter().filter(|each| each.name.starts_with("--"));
        own.map(|each| (each.name.as_ref(), each.value))
    }
}

/// Puts the values of variables into a value. None: a variable without a value.
pub(super) fn with_variables<'v>(
    value: &'v str,
    variable: &dyn Fn(&str) -> Option<String>,
) -> Option<Cow<'v, str>> {
    let mut text = Cow::Borrowed(value);
    for _ in 0..VARIABLES_MAX {
        let Some(start) = text.find("var(") else {
            return Some(text);
        };
        let inner = &text[start + 4..];
        let end = top_level(inner, &[')'])?;
        let (name, fallback) = match split_once(&inner[..end], ',') {
            Some((name, fallback)) => (name, Some(fallback)),
            None => (&inner[..end], None),
        };
        let found =
            variable(name.trim()).or_else(|| fallback.map(|text| text.trim().to_owned()))?;
        let replaced = format!("{}{found}{}", &text[..start], &inner[end + 1..]);
        // A variable that holds itself grows.
        if replaced.len() > 10_000 {
            return None;
        }
        text = Cow::Owned(replaced);
    }
    None
}

fn without_comments(text: &str) -> String {
    let mut parts = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, comment)) = rest.split_once("/*") {
        parts.push_str(before);
        let end = comment.find("*/").unwrap_or(comment.len());
        // Lines stay lines.
        parts.extend(comment[..end].chars().filter(|c| *c == '\n'));
        rest = comment.get(end + 2..).unwrap_or_default();
    }
    parts + rest
}

fn declarations(text: &str) -> impl Iterator<Item = Declaration<'_>> {
    split(text, ';').filter_map(|part| {
        let (name, value) = part.split_once(':')?;
        let mut name = name.trim();
        if let Some(at) = name.rfind("*/") {
            name = name[at + 2..].trim();
        }
        let name = match name.starts_with("--") || !name.contains(|c: char| c.is_ascii_uppercase())
        {
            true => Cow::Borrowed(name),
            false => Cow::Owned(name.to_ascii_lowercase()),
        };
        let value = value.trim();
        let (value, important) = match value.rsplit_once('!') {
            Some((value, word)) if word.trim().eq_ignore_ascii_case("important") => {
                (value.trim_end(), true)
            }
            _ => (value, false),
        };
        (!value.is_empty()).then_some(Declaration {
            name,
            value,
            important,
        })
    })
}

/// First place of one of `ends` outside of brackets and quotes.
pub(super) fn top_level(text: &str, ends: &[char]) -> Option<usize> {
    let mut depth = 0_u32;
    let mut quote = None;
    for (at, letter) in text.char_indices() {
        if let Some(open) = quote {
            if letter == open {
                quote = None;
            }
            continue;
        }
        if depth == 0 && ends.contains(&letter) {
            return Some(at);
        }
        match letter {
            '"' | '\'' => quote = Some(letter),
            '(' | '[' | '{' => depth += 1,
            ')' | ']' | '}' => depth = depth.saturating_sub(1),
            _ => {}
        }
    }
    None
}

fn split_once(text: &str, at: char) -> Option<(&str, &str)> {
    let end = top_level(text, &[at])?;
    Some((&text[..end], &text[end + 1..]))
}

/// Parts between letters outside of brackets and quotes.
pub(super) fn split(text: &str, at: char) -> impl Iterator<Item = &str> {
    let mut rest = Some(text);
    std::iter::from_fn(move || {
        let text = rest?;
        match split_once(text, at) {
            Some((part, behind)) => {
                rest = Some(behind);
                Some(part)
            }
            None => rest.take(),
        }
    })
}

/// Returns true if the reader of selectors takes all of a text: some that it does not know, it ends at.
fn is_whole(selector: &str) -> bool {
    !selector.contains(['~', '|', '&', '\\', '{'])
}

/// An element under selectors.
struct Styled<'a>(XmlNode<'a, 'a>);

impl Element for Styled<'_> {
    fn parent_element(&self) -> Option<Self> {
        self.0.parent_element().map(Styled)
    }

    fn prev_sibling_element(&self) -> Option<Self> {
        self.0.prev_sibling_element().map(Styled)
    }

    fn has_local_name(&self, name: &str) -> bool {
        self.0.tag_name().name() == name
    }

    fn attribute_matches(&self, name: &str, operator: AttributeOperator<'_>) -> bool {
        if name == ROOT {
            return self.0.parent_element().is_none();
        }
        self.0
            .attribute(name)
            .is_some_and(|value| operator.matches(value))
    }

    fn pseudo_class_matches(&self, class: PseudoClass<'_>) -> bool {
        // Nothing points at, has opened or chosen an element of a drawing.
        matches!(class, PseudoClass::FirstChild) && self.0.prev_sibling_element().is_none()
    }
}
