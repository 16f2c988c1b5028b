//! The copies of a report's parts in the repository's documents: between
//! `<!-- report NAME -->` and `<!-- end NAME -->`, each on a line of its own.

use super::page::Block;

/// `text` with the copies of `blocks` in it replaced. Blocks that the text has no place for are
/// left out.
///
/// # Errors
/// The name of a block whose end is missing.
pub fn refreshed(text: &str, blocks: &[Block]) -> Result<String, String> {
    let mut text = text.to_owned();
    for block in blocks {
        let Some((start, end)) = place(&text, &block.name)? else {
            continue;
        };
        text.replace_range(start..end, &block.text);
    }
    Ok(text)
}

/// The blocks that stand otherwise in `text` than `blocks` have them, reproducible ones only.
///
/// # Errors
/// The name of a block whose end is missing, or that the text has no place for.
pub fn outdated(text: &str, blocks: &[Block]) -> Result<Vec<String>, String> {
    let mut found = Vec::new();
    for block in blocks.iter().filter(|block| block.reproducible) {
        let (start, end) =
            place(text, &block.name)?.ok_or_else(|| format!("no place for `{}`", block.name))?;
        if text.get(start..end) != Some(block.text.as_str()) {
            found.push(block.name.clone());
        }
    }
    Ok(found)
}

/// From where to where the copy of the block called `name` goes.
fn place(text: &str, name: &str) -> Result<Option<(usize, usize)>, String> {
    let (begin, end) = (
        format!("<!-- report {name} -->\n"),
        format!("<!-- end {name} -->\n"),
    );
    let Some(start) = text.find(&begin).map(|at| at + begin.len()) else {
        return Ok(None);
    };
    let length = text[start..]
        .find(&end)
        .ok_or_else(|| format!("`{name}` has no end"))?;
    Ok(Some((start, start + length)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const DOCUMENT: &str = "a\n<!-- report one -->\nold\n<!-- end one -->\nb\n";

    fn block(name: &str, text: &str, reproducible: bool) -> Block {
        Block {
            name: name.into(),
            text: text.into(),
            reproducible,
        }
    }

    #[test]
    fn a_copy_is_replaced_and_then_up_to_date() {
        let blocks = [block("one", "new\nlines\n", true)];
        assert_eq!(outdated(DOCUMENT, &blocks), Ok(vec!["one".into()]));
        let text = refreshed(DOCUMENT, &blocks).unwrap();
        assert_eq!(
            text,
            "a\n<!-- report one -->\nnew\nlines\n<!-- end one -->\nb\n"
        );
        assert_eq!(outdated(&text, &blocks), Ok(vec![]));
    }

    #[test]
    fn times_may_differ_and_must_not_be_missing_an_end() {
        assert_eq!(
            outdated(DOCUMENT, &[block("one", "x\n", false)]),
            Ok(vec![])
        );
        assert_eq!(
            outdated(DOCUMENT, &[block("two", "x\n", true)]),
            Err("no place for `two`".into())
        );
        assert_eq!(
            refreshed("<!-- report one -->\n", &[block("one", "x\n", false)]),
            Err("`one` has no end".into())
        );
    }
}
