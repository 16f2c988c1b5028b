//! Texts for people, from the matches of Rust that give them.
//!
//! An arm is taken over if it ends in a literal, or in a `format!` of one literal whose places are names: Python fills the same places.
//! Other arms compute: the Python client has them by hand.

use super::python::TEXTS;
use crate::repository::root;
use anyhow::{Context, Result, ensure};
use quote::ToTokens;
use std::fs;
use syn::visit::{self, Visit};
use syn::{Arm, Expr, ExprMatch, ImplItemFn, ItemFn, Lit, Pat, Stmt};

const HEAD: &str = r#""""Texts for what a machine reports, by the names of variants.

Written by ``cargo xtask wire`` from the matches of crates/client/src/describe and its like. ``words`` fills their places.
"""
"#;

/// Tables of the Python client, and the function that each is the first match of.
const TABLES: [(&str, &str, &str); 12] = [
    ("STATE", "crates/client/src/describe/mod.rs", "state"),
    (
        "DRIVE_STATE",
        "crates/client/src/describe/drive.rs",
        "drive_state",
    ),
    (
        "NOT_ENABLED",
        "crates/client/src/describe/drive.rs",
        "not_enabled",
    ),
    ("FAULT", "crates/client/src/describe/fault.rs", "fault"),
    (
        "DRIVE_FAULT",
        "crates/client/src/describe/fault.rs",
        "drive",
    ),
    (
        "REFUSAL",
        "crates/client/src/describe/refusal.rs",
        "refusal",
    ),
    ("UPDATE", "crates/client/src/describe/refusal.rs", "update"),
    (
        "SCENE_NEED",
        "crates/client/src/describe/refusal.rs",
        "scene_need",
    ),
    ("QUANTITY", "core/src/machine/error.rs", "fmt"),
    ("SUBJECT", "crates/scene/src/words.rs", "subject"),
    ("UNIT", "crates/scene/src/words.rs", "unit"),
    (
        "DIMENSION",
        "crates/protocol/src/message/violation.rs",
        "dimension",
    ),
];

pub(super) fn written() -> Result<String> {
    let mut text = String::from(HEAD);
    for (name, file, function) in TABLES {
        let at = || format!("{file}: {function}");
        let source = fs::read_to_string(root().join(file)).with_context(at)?;
        let mut found = FirstMatch {
            function,
            is_inside: false,
            rows: Vec::new(),
        };
        found.visit_file(&syn::parse_file(&source).with_context(at)?);
        ensure!(
            !found.rows.is_empty(),
            "{}: no arm of a match is a text",
            at()
        );
        text += &format!("\n{name} = {{\n");
        for (variant, value) in found.rows {
            text += &format!("    \"{variant}\": {value},\n");
        }
        text += "}\n";
    }
    ensure!(text.is_ascii(), "{TEXTS}: a text is not ASCII");
    Ok(text)
}

/// Name of a variant, and its value in Python.
type TextRow = (String, String);

/// The first match of the first function of a name.
struct FirstMatch<'a> {
    function: &'a str,
    is_inside: bool,
    rows: Vec<TextRow>,
}

impl FirstMatch<'_> {
    fn look_into(&mut self, name: &syn::Ident, body: &syn::Block) {
        self.is_inside = name == self.function;
        visit::visit_block(self, body);
        self.is_inside = false;
    }
}

impl<'ast> Visit<'ast> for FirstMatch<'_> {
    fn visit_item_fn(&mut self, function: &'ast ItemFn) {
        self.look_into(&function.sig.ident, &function.block);
    }

    fn visit_impl_item_fn(&mut self, function: &'ast ImplItemFn) {
        self.look_into(&function.sig.ident, &function.block);
    }

    fn visit_expr_match(&mut self, each: &'ast ExprMatch) {
        if self.is_inside && self.rows.is_empty() {
            self.rows.extend(each.arms.iter().flat_map(rows));
        }
    }
}

/// Names of the variants of an arm, each with its text.
fn rows(arm: &Arm) -> Vec<TextRow> {
    let Some(value) = value(&arm.body) else {
        return Vec::new();
    };
    let patterns = match &arm.pat {
        Pat::Or(any) => any.cases.iter().collect(),
        one => vec![one],
    };
    let names = patterns.into_iter().filter_map(variant);
    names.map(|name| (name, value.clone())).collect()
}

/// The variant of a pattern; with a field and its value where the arm is for that value alone: `NoOutput, outputs 0`.
fn variant(pattern: &Pat) -> Option<String> {
    let name = |path: &syn::Path| Some(path.segments.last()?.ident.to_string());
    match pattern {
        Pat::Path(pattern) => name(&pattern.path),
        Pat::TupleStruct(pattern) => name(&pattern.path),
        Pat::Struct(pattern) => {
            let mut name = name(&pattern.path)?;
            for field in &pattern.fields {
                let (member, value) = (field.member.to_token_stream(), &field.pat);
                match **value {
                    Pat::Ident(_) | Pat::Wild(_) => {}
                    Pat::Lit(_) => name += &format!(", {member} {}", value.to_token_stream()),
                    _ => return None,
                }
            }
            Some(name)
        }
        _ => None,
    }
}

/// A literal, a list of such, or a text with places, as Python writes it.
fn value(expression: &Expr) -> Option<String> {
    let list = |parts: Vec<&Expr>| {
        let parts: Option<Vec<String>> = parts.into_iter().map(value).collect();
        Some(format!("({})", parts?.join(", ")))
    };
    match expression {
        Expr::Lit(literal) => match &literal.lit {
            // Braces are places in Python.
            Lit::Str(text) => Some(quoted(&text.value().replace('{', "{{").replace('}', "}}"))),
            Lit::Int(number) => Some(number.base10_digits().into()),
            _ => None,
        },
        Expr::Unary(negative) => Some(negative.to_token_stream().to_string().replace(' ', "")),
        Expr::Tuple(tuple) => list(tuple.elems.iter().collect()),
        Expr::Array(array) => list(array.elems.iter().collect()),
        Expr::MethodCall(call) if call.method == "into" => value(&call.receiver),
        Expr::Block(block) => match block.block.stmts.last()? {
            Stmt::Expr(last, None) => value(last),
            Stmt::Macro(last) if last.semi_token.is_none() => template(&last.mac),
            _ => None,
        },
        Expr::Macro(call) => template(&call.mac),
        _ => None,
    }
}

/// The text of a `format!` without arguments behind it.
fn template(call: &syn::Macro) -> Option<String> {
    let text = call
        .path
        .is_ident("format")
        .then(|| call.parse_body::<syn::LitStr>().ok())??;
    Some(quoted(&text.value()))
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arms_that_are_texts_are_taken_and_others_left() {
        let found: ExprMatch = syn::parse_quote! {
            match found {
                Kind::Plain => "a {b} \"c\"".into(),
                Kind::One(_) | TypeKind::Other { .. } => { let x = x + 1; format!("place {x:#010x}") }
                Kind::Of { count: 0 } => "none".into(),
                Kind::Of { count } => format!("{count}"),
                Kind::If if it => "guarded",
                Kind::Numbers => [1, -2],
                Kind::Computed => format!("{}", 1),
                Kind::Called => of(1),
            }
        };
        let rows: Vec<TextRow> = found.arms.iter().flat_map(rows).collect();
        let row = |name: &str, value: &str| (name.to_owned(), value.to_owned());
        let expected = [
            row("Plain", r#""a {{b}} \"c\"""#),
            row("One", r#""place {x:#010x}""#),
            row("Other", r#""place {x:#010x}""#),
            row("Of, count 0", r#""none""#),
            row("Of", r#""{count}""#),
            row("Numbers", "(1, -2)"),
        ];
        assert_eq!(rows, expected);
    }
}
