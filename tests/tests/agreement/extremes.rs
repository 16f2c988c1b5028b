//! The machines and poses of `extreme.csv`.

use crate::bounds::Stages;
use crate::format::Format;
use trirrr_core::number::Coarse;
use trirrr_core::status::Status;
use trirrr_tests::machines;
use trirrr_tests::motors::motors;
use trirrr_tests::table::Table;

/// What became of the rows.
#[derive(Default)]
struct Found {
    worst: Stages,
    /// Rows that f64 has a motion for and this type has not.
    refused: Vec<(String, Status)>,
    /// Rows without a bound: the type's errors are larger than what is left to the singularity.
    without_bound: usize,
}

fn compare<F: Format>() -> Found {
    let mut found = Found::default();
    for row in Table::read("extreme.csv").rows() {
        let label = row.text("case");
        let parameters = machines::of_row(row);
        let state = machines::state_of_row::<f64>(row, ["acx", "acy", "acalpha"]);
        let (results, setpoint) = F::motors(&parameters, &state);
        // The setpoint as the type holds it may be out of reach.
        let reference = motors::<f64>(&parameters, &setpoint);
        match (results, reference) {
            (Err(status), _) => found.refused.push((label.to_owned(), status)),
            (Ok(_), Err(status)) => panic!("{}: {label}: f64 ends in {status}", F::NAME),
            (Ok(results), Ok(reference)) => match F::bounds(&parameters, &setpoint, |_| 0.0) {
                Some(bounds) => {
                    let place = || label.to_owned();
                    found.worst.compare(place, &results, &reference, &bounds);
                }
                None => found.without_bound += 1,
            },
        }
    }
    found
}

impl Found {
    fn assert_refused(&self, expected: &[(&str, Status)]) {
        let expected: Vec<_> = expected
            .iter()
            .map(|(case, status)| ((*case).to_owned(), *status))
            .collect();
        assert_eq!(self.refused, expected);
    }
}

/// What is nearer to a singularity than f32 can tell is refused, and nothing else.
#[test]
fn f32_agrees() {
    let found = compare::<f32>();
    let serial = Status::SerialSingular { leg: 0 };
    found.assert_refused(&[
        ("stretch1_eps1e-09_rest", serial),
        ("stretch1_eps1e-09_radial_slow", serial),
        ("stretch1_eps1e-09_massless", serial),
        ("stretch1_eps1e-12_rest", serial),
        ("stretch1_eps1e-12_radial_slow", serial),
        ("stretch1_eps1e-12_massless", serial),
        ("folded1_eps1e-09_rest", serial),
        ("folded1_eps1e-09_moving", serial),
        ("type2_root0_d1e-09", Status::ParallelSingular),
        ("type2_root0_d1e-09_gravity_rest", Status::ParallelSingular),
        ("type2_root1_d1e-09", Status::ParallelSingular),
        ("type2_root1_d1e-09_gravity_rest", Status::ParallelSingular),
    ]);
    assert_eq!(found.without_bound, 0);
    let brackets = [(0.3, 0.5), (0.25, 0.45), (0.22, 0.4), (0.1, 0.2)];
    found.worst.assert_within("f32, extremes", brackets);
}

/// A pose at the edge of the reach lies beyond it for a sine that is off by 1e-3; beside a
/// parallel singularity there is no bound, and no refusal either: what comes out is wrong.
#[test]
fn micromath_agrees() {
    let found = compare::<Coarse>();
    let unreachable = Status::Unreachable { leg: 0 };
    found.assert_refused(&[
        ("folded1_eps1e-06_rest", unreachable),
        ("folded1_eps1e-06_moving", unreachable),
        ("folded1_eps1e-09_rest", unreachable),
        ("folded1_eps1e-09_moving", unreachable),
    ]);
    assert_eq!(found.without_bound, 25);
    let brackets = [(0.9, 1.0), (0.9, 1.0), (0.9, 1.0), (0.7, 1.0)];
    found.worst.assert_within("micromath, extremes", brackets);
}
