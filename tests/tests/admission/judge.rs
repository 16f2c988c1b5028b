//! Admission of a move on any machine, with the types that it calls for.

use trirrr_core::limits::{LimitParameters, Limits};
use trirrr_core::machine::Parameters;
use trirrr_core::model::{Model, ModelKind, ModelVisitor};
use trirrr_core::setpoint::Quintics;
use trirrr_protocol::message::{AnyMove, Violation};
use trirrr_service::admission::{Admission, Enclose, Verdict};
use trirrr_service::{MovePaces, Ramp};

/// A machine with what it has to keep.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setting {
    pub(crate) parameters: Parameters,
    pub(crate) limits: LimitParameters,
    pub(crate) ramp: Ramp,
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
    let mut admission = admission::<N, M>(setting);
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

/// The rates of a move that is admitted.
pub(crate) fn paces(setting: &Setting, offered: &AnyMove<f64>) -> Option<MovePaces> {
    ModelKind::of(&setting.parameters, true).visit(Paces { setting, offered })
}

struct Paces<'a> {
    setting: &'a Setting,
    offered: &'a AnyMove<f64>,
}

impl ModelVisitor<f64> for Paces<'_> {
    type Output = Option<MovePaces>;

    fn visit<M: Model<N = f64>>(self) -> Option<MovePaces> {
        let mut admission = admission::<f64, M>(self.setting);
        assert!(admission.offer_any(self.offered));
        loop {
            match admission.step() {
                Verdict::Undecided => {}
                Verdict::Admitted => return Some(admission.paces()),
                _ => return None,
            }
        }
    }
}

fn admission<N: Enclose, M: Model<N = N>>(setting: &Setting) -> Admission<M, Quintics> {
    let limits = Limits::build(&setting.limits).expect("good limits");
    Admission::build(&setting.parameters, limits, setting.ramp, setting.period_s)
        .expect("a good machine")
}
