//! Replaced parts of the scene: another geometry, other loads, other limits.

use super::super::built::Coefficients;
use super::super::handoff::Order;
use super::{Background, at_rest};
use crate::admission::Judgement;
use crate::feature::{Feature, Optional};
use crate::number::ServiceNumber;
use crate::scene::{ChangesOf, Machine, ModelOf, Scene, Setup, refusal};
use nalgebra::Vector2;
use trirrr_core::forward::Forward;
use trirrr_core::model::OfKind;
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::scene::Section;
use trirrr_protocol::message::{Content, Refusal, State};

/// Newton steps after which a pose is not found. From the pose before a calibration it takes three
/// or four.
const MOST_STEPS: u32 = 32;

impl<N: ServiceNumber, S: Scene<N = N>> Background<'_, S> {
    /// Replaces a part of the scene. The motors stay where they are; a changed encoder offset is another angle of theirs. Forward kinematics
    /// finds where the platform then is, from where it was. Another tool point is another pose of the same platform. A part with which the machine could not stand there is refused.
    pub(super) fn change(
        &mut self,
        part: &<ChangesOf<S> as Feature>::Read<Section>,
    ) -> Result<(), Refusal<N>> {
        let section = part.content().ok_or(Refusal::NotAdjustable)?;
        let units = self.settings.scene.units();
        let changed = self.machine.changed(section, &units)?;
        self.require_idle()?;
        let end = self.status.end.ok_or(Refusal::State(self.status.state))?;
        let period = N::factor_to_f64(self.settings.period);
        let ramp = self.settings.ramp;
        let machine = OfKind {
            parameters: &changed.parameters,
            kind: changed.kind,
        };
        let built = Coefficients::<ModelOf<S>>::build(machine, &changed.limits, ramp, period);
        let built = built.map_err(refusal)?;
        let geometry = *built.tick.geometry();
        let shift = changed.shift_rad.map(N::angle_from_f64);
        let (pose, angles) = match section {
            Section::Leg { .. } => {
                let forward = Forward::build(&changed.parameters, &geometry);
                let angles = [0, 1, 2].map(|motor| self.view.angles[motor] + shift[motor]);
                let found = forward.solve(&angles, end.pose, MOST_STEPS);
                (found.map_err(|_| Refusal::NoPose)?.pose, angles)
            }
            // The platform stays where it is: its new tool point is elsewhere.
            Section::Platform(_) => (moved_along(end.pose, changed.tool_way), self.view.angles),
            Section::Limits(_) => (end.pose, self.view.angles),
        };

        // What the tick would find in its next look is found here: a part that it cannot stand with would be a fault without a way out.
        Self::can_stand(&built.tick, &built.limits, pose)?;

        let setup = Setup {
            tick: built.tick,
            limits: built.limits,
            pose,
            shift: (changed.shift_rad != [0.0; 3]).then_some(shift),
        };
        let setups = self.features.setups.get_mut();
        if !self.ends.orders.has_room() || !setups.is_some_and(|setups| setups.send(setup)) {
            return Err(Refusal::Busy);
        }
        self.order(Order::Adopt, State::Idle)?;
        self.machine.adopt(&changed, built, &mut self.coefficients);
        self.view.adopting = Some(self.view.orders_sent);
        self.view.angles = angles;
        self.admission.judgement = Judgement::new();
        self.status.end = Some(at_rest(pose));
        Ok(())
    }
}

/// `pose` of the point that lies `by` farther in the frame of the platform.
fn moved_along<N: ServiceNumber>(pose: Pose<N>, by: Vector2<f64>) -> Pose<N> {
    if by == Vector2::new(0.0, 0.0) {
        return pose;
    }
    // In binary64, as the coefficients of a changed scene.
    let (sin, cos) = <f64 as Arithmetic>::sin_cos(N::angle_to_f64(pose.angle));
    let moved = Vector2::new(by.x * cos - by.y * sin, by.x * sin + by.y * cos);
    let before = pose.position.map(|value| value.to_f64());
    Pose {
        position: (before + moved).map(N::from_f64),
        angle: pose.angle,
    }
}
