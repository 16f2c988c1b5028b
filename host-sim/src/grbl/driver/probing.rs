//! End of a motion with the probe.

use super::{MachineDriver, Probing};
use trirrr_grbl::ProbeEnd;
use trirrr_protocol::message::{ProbeRun, State, Status, Transmit};
use trirrr_toolpath::ToolPlace;

impl<N: Transmit> MachineDriver<N> {
    /// Takes the end of a motion with the probe.
    pub(super) fn end_probing(&mut self, status: &Status<N>) {
        if status.fault.is_some() {
            self.probing = None;
        }
        let is_over = status.state == State::Idle && status.next == status.done && !status.planning;
        if self.probing != Some(Probing::Runs) || !is_over || !self.is_fresh() {
            return;
        }
        let end = match status.probe {
            Some(ProbeRun::Armed) => return,
            Some(ProbeRun::Touched(contact)) => {
                let metres = self.units.length_m();
                // Where the drives tell more, they tell where the probe truly was.
                let pose = contact.measured.unwrap_or(contact.pose);
                ProbeEnd::Touched(ToolPlace {
                    position_m: [pose.position.x, pose.position.y]
                        .map(|each| each.to_f64() * metres),
                    alpha_rad: N::angle_to_f64(pose.angle),
                })
            }
            Some(ProbeRun::NotTouched) | None => ProbeEnd::NotTouched,
        };
        self.probing = Some(Probing::Ended(end));
        self.feed.clear();
        self.piece = None;
    }
}
