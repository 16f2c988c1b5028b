//! Words of a server for its log.

/// Returns `"; COUNT what"`, and nothing where there is none.
pub(super) fn counted(count: u64, what: &str) -> String {
    match count {
        0 => String::new(),
        _ => format!("; {count} {what}"),
    }
}
