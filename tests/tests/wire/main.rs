//! The line: its specification in `docs/wire.md` against the code.

mod document;
mod examples;
mod guide;
