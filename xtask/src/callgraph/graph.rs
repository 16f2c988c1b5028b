//! Graph of the calls, depth of the stack below each function, and the way to what must not be called.

use super::program::Program;
use super::walk::{Body, Call, walk};
use anyhow::{Result, bail};
use std::collections::{BTreeMap, BTreeSet, VecDeque};

/// The functions that are called from somewhere.
#[derive(Clone, Debug)]
pub(super) struct Graph {
    /// Body of each function.
    pub(super) bodies: BTreeMap<u32, Body>,
    /// Depth of the stack in each function, with all that it calls.
    depths: BTreeMap<u32, Depth>,
}

/// Depth of the stack in a function.
#[derive(Clone, Copy, Debug)]
struct Depth {
    bytes: i32,
    /// By which call.
    by: Option<Call>,
}

impl Graph {
    /// Walks through all that is called from `entries`.
    ///
    /// # Errors
    /// What is not understood; recursion, for nothing bounds it.
    pub(super) fn from(program: &Program, entries: &BTreeSet<u32>) -> Result<Self> {
        let mut known = entries.clone();
        let mut returning = BTreeSet::new();
        // At first none is taken to return. Each round finds more that do, and what lies behind calls of those.
        let bodies = loop {
            let before = (known.len(), returning.len());
            let mut bodies = BTreeMap::new();
            for entry in known.clone() {
                let body = walk(program, &returning, entry)?;
                known.extend(body.calls.iter().map(|call| call.to));
                if body.returns {
                    returning.insert(entry);
                }
                bodies.insert(entry, body);
            }
            if before == (known.len(), returning.len()) {
                break bodies;
            }
        };
        let mut graph = Self {
            bodies,
            depths: BTreeMap::new(),
        };
        for entry in entries {
            graph.descend(program, &mut vec![*entry])?;
        }
        Ok(graph)
    }

    /// Returns the depth of the stack in the last function on `path`.
    fn descend(&mut self, program: &Program, path: &mut Vec<u32>) -> Result<i32> {
        let Some(entry) = path.last().copied() else {
            return Ok(0);
        };
        if let Some(depth) = self.depths.get(&entry) {
            return Ok(depth.bytes);
        }
        if let Some(first) = path.iter().position(|on_path| *on_path == entry)
            && first + 1 < path.len()
        {
            bail!("recursion: {}", names(program, &path[first..]));
        }
        let body = self.bodies[&entry].clone();
        let mut deepest = Depth {
            bytes: body.depth,
            by: None,
        };
        for call in body.calls {
            path.push(call.to);
            let bytes = call.depth + self.descend(program, path)?;
            path.pop();
            if bytes > deepest.bytes {
                let by = Some(call);
                deepest = Depth { bytes, by };
            }
        }
        self.depths.insert(entry, deepest);
        Ok(deepest.bytes)
    }

    /// The bytes of stack that `entry` takes at most, with all that it calls.
    pub(super) fn depth(&self, entry: u32) -> i32 {
        self.depths[&entry].bytes
    }

    /// The way down to where it is as deep: functions, and the bytes that each takes until it calls the next.
    pub(super) fn deepest(&self, entry: u32) -> Vec<(u32, i32)> {
        let mut way = Vec::new();
        let mut function = entry;
        loop {
            let Depth { bytes, by } = self.depths[&function];
            match by {
                None => {
                    way.push((function, bytes));
                    return way;
                }
                Some(call) => {
                    way.push((function, call.depth));
                    function = call.to;
                }
            }
        }
    }

    /// A shortest way from `entry` to a function that `is_wanted`.
    pub(super) fn way(
        &self,
        entry: u32,
        is_wanted: impl Fn(u32, &Body) -> bool,
    ) -> Option<Vec<u32>> {
        let mut ways = VecDeque::from([vec![entry]]);
        let mut seen = BTreeSet::from([entry]);
        while let Some(way) = ways.pop_front() {
            let function = *way.last()?;
            let body = &self.bodies[&function];
            if is_wanted(function, body) {
                return Some(way);
            }
            for call in &body.calls {
                if seen.insert(call.to) {
                    ways.push_back([way.as_slice(), &[call.to]].concat());
                }
            }
        }
        None
    }
}

/// A way from function to function, in words.
pub(super) fn names(program: &Program, way: &[u32]) -> String {
    let names: Vec<String> = way.iter().map(|entry| program.place(*entry)).collect();
    names.join(" > ")
}
