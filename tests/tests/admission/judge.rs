//! Admission of a move on any machine, with the types that it calls for.

use trirrr_core::limits::{LimitParameters, Limits};
use trirrr_core::machine::Parameters;
use trirrr_core::model::{Model, ModelKind, ModelVisitor};
use trirrr_core::setpoint::Quintics;
use trirrr_protocol::message::{AnyMove, Violation};
use trirrr_service::admission::{Admission, Enclose, Verdict};
use trirrr_service::paces::{MovePaces, Ramp};

/// A machine with what it has to keep.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setting {
    pub(crate) parameters: Parameters,
    pub(crate) limits: LimitParameters,
    pub(crate) ramp: Ramp,
    pub(crate) period_s: f64,
}

impl Setting {
    /// The leanest kind of model that has torques.
    pub(crate) fn kind(&self) -> ModelKind {
        ModelKind::of(&self.parameters, true)
    }
}

/// The verdict, the steps that it took, and the rates of a move that is admitted.
pub(crate) struct Judged<N: Enclose> {
    pub(crate) verdict: Result<(), Violation<N>>,
    pub(crate) steps: u32,
    pub(crate) paces: MovePaces,
}

pub(crate) fn judge<N: Enclose>(setting: &Setting, offered: impl Into<AnyMove<N>>) -> Judged<N> {
    let offered = offered.into();
    setting.kind().visit(Judge { setting, offered })
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
    let mut admission = admission::<N, M>(setting);
    assert!(admission.offer_any(offered));
    let mut steps = 0;
    let verdict = loop {
        steps += 1;
        match admission.step() {
            Verdict::Undecided => {}
            Verdict::Admitted => break Ok(()),
            Verdict::Refused(violation) => break Err(violation),
            Verdict::Nothing => panic!("a move was offered"),
        }
    };
    Judged {
        verdict,
        steps,
        paces: admission.paces(),
    }
}

fn admission<N: Enclose, M: Model<N = N>>(setting: &Setting) -> Admission<M, Quintics> {
    let limits = Limits::build(&setting.limits).expect("good limits");
    let machine = setting.kind().with(&setting.parameters);
    Admission::build(machine, limits, setting.ramp, setting.period_s).expect("a good machine")
}
