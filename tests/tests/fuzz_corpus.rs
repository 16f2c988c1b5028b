//! What fuzzing has found so far, again, and mutations of it: the fuzz targets of `fuzz/` without a
//! fuzzer.

use std::fs;
use std::path::PathBuf;
use trirrr_bench::faulty_link::Random;
use trirrr_bench::targets::{ALL, Target, play};
use trirrr_protocol::message::State;

/// Mutations of each target's corpus, in all.
const MUTATIONS: u64 = 2_000;

/// The longest mutation.
const LONGEST: usize = 512;

fn corpus(name: &str) -> Vec<Vec<u8>> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("fuzz/corpus")
        .join(name);
    let entries = fs::read_dir(&folder).unwrap_or_else(|error| panic!("{folder:?}: {error}"));
    let mut paths: Vec<_> = entries
        .map(|entry| entry.expect("readable").path())
        .collect();
    // The same order, and so the same mutations, on every machine.
    paths.sort();
    paths
        .iter()
        .map(|path| fs::read(path).expect("readable"))
        .collect()
}

/// Cuts, joins and changes of what is there.
fn mutation(corpus: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    let mut pick = || corpus[random.below(corpus.len() as u64) as usize].clone();
    let (mut bytes, other) = (pick(), pick());
    bytes.truncate(random.below(bytes.len() as u64 + 1) as usize);
    bytes.extend(&other[random.below(other.len() as u64 + 1) as usize..]);
    bytes.truncate(LONGEST);
    for _ in 0..random.below(4) {
        if let Some(at) = random.below(bytes.len() as u64 + 1).checked_sub(1) {
            bytes[at as usize] = random.bits() as u8;
        }
    }
    bytes
}

#[test]
fn the_targets_hold_on_their_corpora_and_on_mutations() {
    for (seed, (name, target)) in (1..).zip(ALL) {
        let target: Target = target;
        let corpus = corpus(name);
        assert!(corpus.len() >= 10, "{name}: {} files", corpus.len());
        corpus.iter().for_each(|bytes| target(bytes));
        let mut random = Random::new(seed);
        for _ in 0..MUTATIONS {
            target(&mutation(&corpus, &mut random));
        }
    }
}

/// The corpus gets the machine into every state, has moves played and the tool on: fuzzing that starts
/// from it does not stay at the door.
#[test]
fn the_corpus_gets_everywhere() {
    let reached: Vec<_> = corpus("commands").iter().map(|bytes| play(bytes)).collect();
    for state in [
        State::Idle,
        State::Running,
        State::Slowing,
        State::Stopping,
        State::Holding,
        State::Fault,
        State::Cleared,
        State::Recovering,
    ] {
        let met = reached.iter().any(|each| each.states.contains(&state));
        assert!(met, "{state:?}");
    }
    assert!(reached.iter().any(|each| each.tool));
    assert!(reached.iter().any(|each| each.moves >= 2));
}
