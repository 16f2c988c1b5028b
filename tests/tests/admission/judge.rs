//! Admission of a move on any machine, with the types that it calls for.

use trirrr_core::limits::{LimitParameters, Limits};
use trirrr_core::machine::Parameters;
use trirrr_core::model::{Model, ModelKind, ModelVisitor};
use trirrr_core::setpoint::Quintics;
use trirrr_protocol::message::{AnyMove, Violation};
use trirrr_service::admission::{Admission, Enclose, Verdict};

/// A machine with what it has to keep.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setting {
    pub(crate) parameters: Parameters,
    pub(crate) limits: LimitParameters,
    pub(crate) ramp_ticks: u16,
    pub(crate) period_s: f64,
}

/// The verdict, and the steps that it took.
pub(crate) struct Judged<N: Enclose> {
    pub(crate) verdict: Result<(), Violation<N>>,
    pub(crate) steps: u32,
}

pub(crate) fn judge<N: Enclose>(setting: &Setting, offered: impl Into<AnyMove<N>>) -> Judged<N> {
    let offered = offered.into();
    ModelKind::of(&setting.parameters, true).visit(Judge { setting, offered })
}

struct Judge<'a, N: Enclose> {
    setting: &'a Setting,
    offered: AnyMove<N>,
}

impl<N: Enclose> ModelVisitor<N> for Judge<'_, N> {
    type Output = Judged<N>;

    fn visit<M: Model<N = N>>(self) -> Judged<N> {
        with::<N, M>(self.setting, &self.offered)
    }
}

fn with<N: Enclose, M: Model<N = N>>(setting: &Setting, offered: &AnyMove<N>) -> Judged<N> {
    let limits = Limits::build(&setting.limits).expect("good limits");
    let mut admission = Admission::<M, Quintics>::build(
        &setting.parameters,
        limits,
        setting.ramp_ticks,
        setting.period_s,
    )
    .expect("a good machine");
    assert!(admission.offer_any(offered));
    let mut steps = 0;
    loop {
        steps += 1;
        match admission.step() {
            Verdict::Undecided => {}
            Verdict::Admitted => {
                let verdict = Ok(());
                return Judged { verdict, steps };
            }
            Verdict::Refused(violation) => {
                let verdict = Err(violation);
                return Judged { verdict, steps };
            }
            Verdict::Nothing => panic!("a move was offered"),
        }
    }
}
