//! Texts of identity, state and events.

use super::{Worker, since_1970};
use crate::command::session_text;
use crate::records;
use serde_json::{Value, json};
use std::ops::Range;
use trirrr_client::describe::{self, board};
use trirrr_protocol::message::State;
use trirrr_service::ServiceNumber;

impl<N: ServiceNumber> Worker<'_, N> {
    /// Identity of the machine.
    pub(super) fn identity_text(&self) -> String {
        let scene = self.setup.scene;
        let identity = self.identity.as_ref();
        let found = identity.map(|identity| {
            json!({
                "scene": board::name(&identity.name),
                "scene_key": format!("{:08x}", identity.scene),
                "queue_moves": identity.queue,
                "host_timeout_s": f64::from(identity.silence_ticks) / identity.tick_rate_hz,
                "clock": board::clock(identity.board.clock),
                "motors": board::reference(identity.reference),
                "firmware": board::firmware(&identity.firmware),
            })
        });
        json!({
            "session": session_text(self.setup.session),
            "name": self.setup.name,
            "description": scene.description,
            "simulated": self.setup.is_simulated,
            "takes_commands": self.setup.takes_commands,
            "number": scene.number.name(),
            "tick_rate_hz": scene.tick_rate_hz,
            "telemetry_ticks": self.setup.telemetry,
            "record_bytes": records::RECORD_BYTES,
            "machine": found,
        })
        .to_string()
    }

    /// State, but for what changes with each tick.
    pub(super) fn state_text(&self) -> String {
        self.state_value().to_string()
    }

    /// State at this moment.
    pub(super) fn state_now(&self) -> String {
        let mut state = self.state_value();
        state["tick"] = self.last_tick.into();
        state["next_sample"] = self.samples.next().into();
        state["pose"] = self.pose.map_or(
            Value::Null,
            |[x, y, alpha]| json!({ "x_m": x, "y_m": y, "alpha_rad": alpha }),
        );
        state.to_string()
    }

    fn state_value(&self) -> Value {
        let now = self.now();
        let status = self.status.as_ref();
        let known = self.state.filter(|_| self.is_connected);
        let name = known
            .map(|(state, _)| describe::state(state, trirrr_protocol::message::Acting::Nothing));
        let faults = status.and_then(|status| status.fault.as_ref());
        let fault = faults.map(|fault| describe::fault(fault, &self.units));
        let off = status.filter(|status| status.state == State::Disabled);
        let not_enabled = off.and_then(|status| status.not_enabled.as_ref());
        let refused = status.and_then(|status| status.refused.as_ref()?.violation);
        json!({
            "session": session_text(self.setup.session),
            "connected": self.is_connected && self.status.is_some(),
            "line": self.lost,
            "state": name,
            "text": known.map(|(state, acting)| describe::state(state, acting)),
            "moving": known.is_some_and(|(state, _)| records::may_move(state)),
            "motion": self.task.as_ref().map(|task| task.word()),
            "moves_done": status.map(|status| status.done),
            "feed_percent": status.map(|status| status.feed_percent),
            "fault": fault,
            "not_enabled": not_enabled.map(describe::not_enabled),
            "refused": refused.map(|violation| describe::violation(&violation, 0, &self.units)),
            "inputs": status.and_then(|status| describe::inputs(&status.inputs)),
            "controller": self.control.present(now),
            "executed": self.executed,
            "next_event": self.events.next(),
            "lost_samples": status.map(|status| status.lost),
            "late_ticks": status.map(|status| status.late_ticks),
        })
    }

    /// Publishes an event.
    pub(super) fn event(&mut self, kind: &str, text: &str) {
        let event = json!({
            "session": session_text(self.setup.session),
            "number": self.events.next(),
            "unix_s": since_1970().as_secs_f64(),
            "tick": self.last_tick,
            "kind": kind,
            "text": text,
        })
        .to_string();
        self.outlet.event(&event);
        self.events.push(event);
    }

    /// Events of a range that is kept, as a JSON list.
    pub(super) fn events_text(&self, range: Range<u64>) -> String {
        let events: Vec<&str> = self.events.items(range).map(String::as_str).collect();
        format!("[{}]", events.join(","))
    }
}
