//! Doc comments of the types, from their source.

use crate::repository::root;
use anyhow::{Context, Result};
use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use syn::{Attribute, Expr, ExprLit, Fields, Item, Lit, Meta};

/// Folder of the messages, and the file of the one type that comes from elsewhere.
const MESSAGES: &str = "crates/protocol/src/message";
const QUANTITY: &str = "core/src/machine/error.rs";

/// Doc comments by the path of their item: `Move`, `Move.ticks`, `Start.Panic`, `Start.Panic.line`.
pub(super) struct Docs(BTreeMap<String, String>);

impl Docs {
    pub(super) fn read() -> Result<Self> {
        let folder = root().join(MESSAGES);
        let mut files = vec![root().join(QUANTITY)];
        for entry in fs::read_dir(&folder).context(MESSAGES)? {
            files.push(entry?.path());
        }
        let mut docs = Self(BTreeMap::new());
        for file in files
            .into_iter()
            .filter(|file| file.extension().is_some_and(|ending| ending == "rs"))
        {
            docs.take(&file)?;
        }
        Ok(docs)
    }

    fn take(&mut self, file: &PathBuf) -> Result<()> {
        let at = || file.display().to_string();
        let text = fs::read_to_string(file).with_context(at)?;
        for item in syn::parse_file(&text).with_context(at)?.items {
            match item {
                Item::Struct(item) => {
                    let name = item.ident.to_string();
                    self.put(name.clone(), &item.attrs);
                    self.put_fields(&name, &item.fields);
                }
                Item::Enum(item) => {
                    let name = item.ident.to_string();
                    self.put(name.clone(), &item.attrs);
                    for variant in &item.variants {
                        let variant_name = format!("{name}.{}", variant.ident);
                        self.put(variant_name.clone(), &variant.attrs);
                        self.put_fields(&variant_name, &variant.fields);
                    }
                }
                _ => {}
            }
        }
        Ok(())
    }

    fn put_fields(&mut self, owner: &str, fields: &Fields) {
        for field in fields {
            if let Some(name) = &field.ident {
                self.put(format!("{owner}.{name}"), &field.attrs);
            }
        }
    }

    fn put(&mut self, path: String, attributes: &[Attribute]) {
        let lines = attributes
            .iter()
            .filter_map(|attribute| match &attribute.meta {
                Meta::NameValue(doc) if doc.path.is_ident("doc") => match &doc.value {
                    Expr::Lit(ExprLit {
                        lit: Lit::Str(text),
                        ..
                    }) => Some(text.value().trim().to_owned()),
                    _ => None,
                },
                _ => None,
            });
        let text = lines.collect::<Vec<_>>().join("\n");
        // Sections are for readers of the code.
        let text = text
            .split("\n# ")
            .next()
            .unwrap_or_default()
            .trim()
            .to_owned();
        self.0.insert(path, text);
    }

    /// The doc comment at `path`; empty where there is none.
    pub(super) fn of(&self, path: &str) -> &str {
        self.0.get(path).map_or("", String::as_str)
    }
}
