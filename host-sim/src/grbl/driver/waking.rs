//! Way to a machine that is ready.

use super::{MachineDriver, place_of};
use trirrr_client::describe;
use trirrr_protocol::message::{Command, Recovery, State, Status, Transmit};
use trirrr_scene::offer;
use trirrr_toolpath::{Act, Element, ToolCurve, ToolMotion, ToolPlace};

/// Speed to the start of the scene's job, m/s, and shortest time of a way of the motors one by one, s.
const HOME_M_S: f64 = 0.05;
const RECOVER_S: f64 = 3.0;

/// Way to the machine being ready.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Waking {
    pub(super) homes: bool,
    /// Orders that were given on the way, each once.
    cleared: bool,
    enabled: bool,
    homed: bool,
    on_way: bool,
}

impl Waking {
    /// `homes`: to the start, with the reference found.
    pub(super) fn new(homes: bool) -> Self {
        Self {
            homes,
            cleared: false,
            enabled: false,
            homed: false,
            on_way: false,
        }
    }
}

impl<N: Transmit> MachineDriver<N> {
    /// The next step on the way to a machine that is ready.
    pub(super) fn wake(&mut self, status: &Status<N>) {
        let Some(mut waking) = self.waking else {
            return;
        };
        if waking.homes && self.is_held() && is_way(status.state) {
            // It was stopped: it begins anew.
            self.waking = Some(Waking {
                homed: false,
                ..waking
            });
            return;
        }
        let fail = match status.state {
            State::Fault if !waking.cleared => {
                waking.cleared = true;
                self.order(Command::ClearFault);
                None
            }
            State::Fault => Some(match &status.fault {
                Some(fault) => describe::fault(fault, &self.words),
                None => "the fault does not go away".into(),
            }),
            State::Disabled
                if !waking.cleared
                    && !waking.enabled
                    && status
                        .not_enabled
                        .is_some_and(|why| why.wants_acknowledgement()) =>
            {
                waking.cleared = true;
                self.order(Command::ClearFault);
                None
            }
            State::Disabled if !waking.enabled => {
                waking.enabled = true;
                self.order(Command::Enable);
                None
            }
            State::Disabled => Some(match &status.not_enabled {
                Some(why) => format!("not enabled: {}", describe::not_enabled(why)),
                None => "the drives went off again".into(),
            }),
            State::Unhomed if waking.homes && !waking.homed => {
                waking.homed = true;
                self.order(Command::Home);
                None
            }
            State::Unhomed => Some("the machine does not know where its motors are: $H homes it".into()),
            State::Cleared if waking.homes && !waking.homed => {
                waking.homed = true;
                let ticks = (RECOVER_S * self.tick_rate_hz).round().max(1.0) as u32;
                self.order(Command::Recover(Recovery {
                    to: offer::pose(&self.units.pose(&self.start)),
                    ticks,
                }));
                None
            }
            State::Cleared => Some(
                "the platform's pose is not known after the fault: $H brings the machine to its start, slowly".into(),
            ),
            State::Idle if !self.is_empty() => None,
            State::Idle if waking.homes && !waking.on_way && !self.is_at_start() => {
                waking.on_way = true;
                self.feed.stand(&self.place);
                self.feed.push(&way_to(place_of(&self.start)));
                self.feed.flush();
                None
            }
            State::Idle => {
                self.feed.stand(&self.place);
                self.waking = None;
                return;
            }
            _ => None,
        };
        self.waking = match fail {
            Some(reason) => {
                self.reason = Some(reason);
                None
            }
            None => Some(waking),
        };
    }

    fn is_at_start(&self) -> bool {
        let start = place_of(&self.start);
        let off = (0..2).map(|axis| self.place.position_m[axis] - start.position_m[axis]);
        off.chain([self.place.alpha_rad - start.alpha_rad])
            .all(|off| off.abs() < 1e-6)
    }
}

/// The machine moves, or is to move, to its reference and its start: a hold stops that.
fn is_way(state: State) -> bool {
    matches!(
        state,
        State::Unhomed
            | State::Homing
            | State::Cleared
            | State::Recovering
            | State::Stopping
            | State::Idle
    )
}

/// Straight, slow motion with the tool off.
fn way_to(to: ToolPlace) -> Element {
    Element {
        line: 0,
        tool: None,
        act: Act::Motion(ToolMotion {
            curve: ToolCurve::Line,
            to,
            feed_m_s: Some(HOME_M_S),
            stops: true,
        }),
    }
}
