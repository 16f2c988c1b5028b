//! What fuzzing has found so far, again, and mutations of it: the fuzz targets of `fuzz/` without a
//! fuzzer.

use std::fs;
use trirrr_bench::faulty_link::Random;
use trirrr_bench::targets::{ALL, Target, play};
use trirrr_protocol::message::State;

/// Mutations of each target's corpus, in all.
const MUTATIONS: u64 = 2_000;

/// The longest mutation.
const LONGEST: usize = 512;

/// Inputs of a target: one a line, in hexadecimal digits.
fn corpus(name: &str) -> Vec<Vec<u8>> {
    let file = format!("{}/fuzz/corpus/{name}.hex", env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(&file).unwrap_or_else(|error| panic!("{file}: {error}"));
    let byte = |digits: &[u8]| {
        let digits = std::str::from_utf8(digits).expect("digits");
        u8::from_str_radix(digits, 16).expect("two digits a byte")
    };
    let input = |line: &str| line.as_bytes().chunks(2).map(byte).collect();
    text.lines().map(input).collect()
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
        assert!(corpus.len() >= 10, "{name}: {} inputs", corpus.len());
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
