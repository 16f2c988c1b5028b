//! Admission of a move on any machine, with the types that it calls for.

use trirrr_core::limits::{LimitParameters, Limits};
use trirrr_core::machine::{LinksKind, Parameters, PayloadKind};
use trirrr_core::torque::links::{Horizontal, InPlane, Links, Massive, Massless, Rotors};
use trirrr_core::torque::payload::{Centred, Offset, Payload};
use trirrr_protocol::message::{Move, Violation};
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

pub(crate) fn judge<N: Enclose>(setting: &Setting, offered: &Move<N>) -> Judged<N> {
    match PayloadKind::of(&setting.parameters) {
        PayloadKind::Centred => with_payload::<N, Centred<N>>(setting, offered),
        PayloadKind::Offset => with_payload::<N, Offset<N>>(setting, offered),
    }
}

fn with_payload<N: Enclose, P: Payload<N>>(setting: &Setting, offered: &Move<N>) -> Judged<N> {
    match LinksKind::of(&setting.parameters) {
        LinksKind::Massless => with::<N, P, Massless>(setting, offered),
        LinksKind::Rotors => with::<N, P, Rotors<N>>(setting, offered),
        LinksKind::MassiveHorizontal => with::<N, P, Massive<N, Horizontal>>(setting, offered),
        LinksKind::MassiveInPlane => with::<N, P, Massive<N, InPlane<N>>>(setting, offered),
    }
}

fn with<N: Enclose, P: Payload<N>, L: Links<N>>(setting: &Setting, offered: &Move<N>) -> Judged<N> {
    let limits = Limits::build(&setting.limits).expect("good limits");
    let mut admission = Admission::<N, P, L>::build(
        &setting.parameters,
        limits,
        setting.ramp_ticks,
        setting.period_s,
    )
    .expect("a good machine");
    admission.offer(offered);
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
