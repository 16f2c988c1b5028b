//! Inputs at which planners for independent axes are known to have failed, put to this machine: three axes are x, y and
//! alpha about a pose in the middle of the workspace, in the same times. The limits at the motors are those that the
//! axes' limits ask of them there.

use crate::drawn::{Setting, setpoint};
use crate::judge::largest_part;
use crate::session::{moves, outcome, path};
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::example;
use trirrr_core::model::{Model, ModelKind, ModelVisitor};
use trirrr_service::admission::{Retarget, Retargeted};
use trirrr_tests::instant::{Coordinates, Instant, State};

/// Start and target of three axes, each a position, a velocity and an acceleration, and the axes' limits of velocity and
/// acceleration.
struct Published {
    name: &'static str,
    start: [Coordinates; 3],
    target: [Coordinates; 3],
    limits: [f64; 2],
}

const REST: Coordinates = [0.0; 3];

const PUBLISHED: [Published; 7] = [
    Published {
        name: "github.com/pantor/ruckig/issues/160, first",
        start: [
            [
                -0.04895883258572608,
                0.1992637939208025,
                -0.2914660630142018,
            ],
            [
                1.425883388427091e-14,
                -9.520201039439915e-20,
                -9.656571194417352e-20,
            ],
            [-2.370282711878416e-12, 0.0, 3.469446951953614e-18],
        ],
        target: [
            [
                -0.04895883258572691,
                0.1992637939208025,
                -0.2914660630142018,
            ],
            REST,
            REST,
        ],
        limits: [5.0, 10.0],
    },
    Published {
        name: "github.com/pantor/ruckig/issues/160, second",
        start: [
            [0.03839900283757711, 0.2093483656756634, 0.03189466728432298],
            [
                1.466391486711824e-18,
                1.924174584908152e-18,
                -1.542564246001646e-20,
            ],
            [0.0, -3.608224830031759e-16, 0.0],
        ],
        target: [
            [0.0383990028375771, 0.2093483656756634, 0.03189466728432298],
            REST,
            REST,
        ],
        limits: [5.0, 10.0],
    },
    Published {
        name: "github.com/petrikosk/rsruckig/issues/14",
        start: [
            [1.1032599505208334, 0.0, 0.0],
            [0.36337812500000005, 0.0, 0.0],
            [0.8525, 0.0, 0.0],
        ],
        target: [
            [2.9033375720687795, 0.0, 0.0],
            [0.3477303818980908, 0.0, 0.0],
            [-0.833942902, 0.0, 0.0],
        ],
        limits: [1.0, 1.0],
    },
    Published {
        name: "github.com/pantor/ruckig/issues/141",
        start: [[0.0049921875, 0.0, 0.0], REST, REST],
        target: [[0.005, 0.0, 0.0], REST, REST],
        limits: [0.1, 2.5],
    },
    Published {
        name: "github.com/pantor/ruckig/issues/90",
        start: [
            [0.1586916078246517, 0.8198410238869502, -0.2681910390107047],
            [1.224365429569406, -0.8752573930094795, 0.6074060830631294],
            [12.36606404941746, 0.0, 0.0],
        ],
        target: [[0.35257, 0.7036, -0.20583], REST, REST],
        limits: [2.663652051520562, 49.44190521665187],
    },
    Published {
        name: "github.com/pantor/ruckig/issues/100",
        start: [
            [0.02853333333333339, 0.0, 0.0],
            [0.6800000000000006, 0.0, 0.0],
            [7.999999999999993, 0.0, 0.0],
        ],
        target: [REST, REST, REST],
        limits: [1.0, 10.0],
    },
    Published {
        name: "github.com/pantor/ruckig/issues/130",
        start: [
            [3.62255615705579, 1.675754445058354, 2.181127634157466],
            [
                -0.06422550797049381,
                -0.006910864193129071,
                0.1207111377965507,
            ],
            [0.0, 0.0, -0.3999999999978001],
        ],
        target: [
            [3.587689540855463, 1.671344092861895, 2.271916653384632],
            [
                -0.06423623454575711,
                -0.007006078877926925,
                0.1187909578397501,
            ],
            REST,
        ],
        limits: [0.1187909578397501, 0.4],
    },
];

struct Plan<'a>(&'a Setting, State, State);

impl ModelVisitor<f64> for Plan<'_> {
    type Output = ();

    fn visit<M: Model<N = f64>>(self) {
        let Self(setting, start, target) = self;
        let (start, target) = (setpoint(&start), setpoint(&target));
        let mut retarget = Retarget::over(path::<M>(setting), &start, &target);
        let (outcome, steps) = outcome(&mut retarget);
        let Retargeted::Planned(length) = outcome else {
            panic!("{outcome:?}");
        };
        let chain = moves(&retarget);
        let ticks: u32 = chain.iter().map(|each| each.common.ticks).sum();
        println!("  {length} moves, {ticks} ticks, {steps} steps");
        let part = largest_part(setting, [&start, &target], &chain, 2000);
        assert!(part <= 1.0, "{part}");
    }
}

#[test]
fn published_failures_of_other_planners_are_planned() {
    let middle = [0.25, 0.27, 0.3];
    for case in &PUBLISHED {
        println!("{}", case.name);
        // Ways of a tenth of a metre at most.
        let far = (0..3).map(|axis| (case.target[0][axis] - case.start[0][axis]).abs());
        let speeds = case.start[1].iter().chain(&case.target[1]).map(|v| v.abs());
        let scale = 0.08 / far.chain(speeds.map(|v| 0.5 * v)).fold(0.08, f64::max);
        let state = |given: &[Coordinates; 3]| {
            let scaled = |v: &Coordinates| v.map(|v| scale * v);
            let at = |axis: usize| middle[axis] + scale * (given[0][axis] - case.start[0][axis]);
            State {
                pose: [0, 1, 2].map(at),
                velocity: scaled(&given[1]),
                acceleration: scaled(&given[2]),
            }
        };
        let (start, target) = (state(&case.start), state(&case.target));
        let parameters = example();
        let [rate, acceleration] = case.limits.map(|limit| scale * limit);
        let asked = |velocity: Coordinates, acceleration: Coordinates| {
            Instant::of(
                &parameters,
                &State {
                    pose: middle,
                    velocity,
                    acceleration,
                },
            )
        };
        let most = |values: [f64; 3]| {
            values
                .into_iter()
                .fold(0.0, |most: f64, v| most.max(v.abs()))
        };
        let limits = LimitParameters {
            rate_rad_s: Some([1.5 * most(asked([rate; 3], REST).rate); 3]),
            acceleration_rad_s2: Some([2.0 * most(asked(REST, [acceleration; 3]).acceleration); 3]),
            ..LimitParameters::default()
        };
        let setting = Setting {
            parameters,
            limits,
            period_s: 1e-3,
            start: middle,
            turn: 0.0,
            reach: 0.4,
            side: asked(REST, REST).side,
        };
        ModelKind::of(&parameters, true).visit(Plan(&setting, start, target));
    }
}
