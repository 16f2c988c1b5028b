//! Way to a machine that is ready.

use super::{MachineDriver, place_of};
use trirrr_client::{Clears, Wake, WakeFailure, WakeStep};
use trirrr_protocol::message::{Recovery, State, Status, Transmit};
use trirrr_scene::offer;
use trirrr_toolpath::{Act, Element, ToolCurve, ToolMotion, ToolPlace};

/// Speed to the start of the scene's job, m/s, and shortest time of a way of the motors one by one, s.
const HOME_M_S: f64 = 0.05;
const RECOVER_S: f64 = 3.0;

/// Way to the machine being ready.
#[derive(Clone, Copy, Debug)]
pub(super) struct Waking<N: Transmit> {
    /// To the start, with the reference found.
    homes: bool,
    wake: Wake<N>,
    /// The machine is on its way to the start.
    on_way: bool,
}

impl<N: Transmit> MachineDriver<N> {
    /// Begins the way to a machine that is ready. `homes`: to the start, with the reference found.
    pub(super) fn begin_waking(&mut self, homes: bool) {
        let recovery = Recovery {
            to: offer::pose(&self.units.pose(&self.start)),
            ticks: (RECOVER_S * self.tick_rate_hz).round().max(1.0) as u32,
        };
        self.waking = Some(Waking {
            homes,
            wake: Wake::new(Clears::Hindrances, homes, homes.then_some(recovery)),
            on_way: false,
        });
    }

    /// The next step on the way to a machine that is ready.
    pub(super) fn wake(&mut self, status: &Status<N>) {
        let Some(mut waking) = self.waking else {
            return;
        };
        let is_held = waking.homes && self.is_held() && is_way(status.state);
        match waking.wake.next(status) {
            // It was stopped: it begins anew.
            _ if is_held => waking.wake.home_again(),
            _ if status.state == State::Idle && !self.is_empty() => {}
            _ if status.state == State::Idle => {
                self.feed.stand(&self.place);
                if !waking.homes || waking.on_way || self.is_at_start() {
                    self.waking = None;
                    return;
                }
                waking.on_way = true;
                self.feed.push(&way_to(place_of(&self.start)));
                self.feed.flush();
            }
            WakeStep::Order(command) => {
                waking.wake.ordered(&command);
                self.order(command);
            }
            WakeStep::Wait | WakeStep::Ready => {}
            WakeStep::Failed(failure) => {
                let why = failure.describe(&self.words);
                self.reason = Some(match failure {
                    WakeFailure::Unhomed => format!("{why}: $H homes it"),
                    WakeFailure::Cleared => {
                        format!("{why}: $H brings the machine to its start, slowly")
                    }
                    _ => why,
                });
                self.waking = None;
                return;
            }
        }
        self.waking = Some(waking);
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
