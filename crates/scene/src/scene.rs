//! A scene as a whole.

use crate::contact::Contact;
use crate::controller::Controller;
use crate::drive::Drive;
use crate::feedback::Feedback;
use crate::homing::Homing;
use crate::inputs::InputPorts;
use crate::io::SparePins;
use crate::job::Job;
use crate::number_type::NumberType;
use crate::plant::Plant;
use crate::power::Power;
use crate::service::Service;
use crate::tolerances::Tolerances;
use crate::tool::ToolPort;
use crate::tools::ToolRack;
use std::path::PathBuf;
use trirrr_core::limits::LimitParameters as Limits;
use trirrr_core::machine::Parameters;
use trirrr_core::model::ModelKind;
use trirrr_service::Reactions;
use trirrr_service::paces::Ramp;

/// A move of fewer ticks is a short one.
const SHORT_TICKS: u32 = 10;

/// A checked scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// [Key](trirrr_service::key) of the file's text, followed by that of the machine's file and of settings: by it a board and a host
    /// know that they have the same scene.
    pub key: u32,
    /// File of the machine, if it is another than that of the scene.
    pub machine_file: Option<PathBuf>,
    /// Name of the scene: letters, digits, `-` and `_`, fit to name a folder.
    pub name: String,
    /// Description of the scene in the author's words; may be empty.
    pub description: String,
    /// Board that the image of the scene is for, if the scene names one: a shipped board file, or the path of one beside the scene.
    pub board: Option<String>,
    /// Ticks per second, from 1 to 100,000.
    pub tick_rate_hz: f64,
    /// The number type that the scene is meant to run in.
    pub number: NumberType,
    /// True if the tick computes torques; otherwise it computes position, rate and acceleration alone.
    pub torque: bool,
    /// The machine with its loads; rotor inertias are those of `drives` behind their gears. The reference point D of the platform is the
    /// tool point.
    pub parameters: Parameters,
    /// Tools that a client may mount, if the scene names any. The machine carries the mounted one.
    pub tools: Option<ToolRack>,
    /// The drive of each motor, if the scene names any.
    pub drives: Option<[Drive; 3]>,
    /// Limits that the job must keep.
    pub limits: Limits,
    /// Settings with which the service runs the job.
    pub service: Service,
    /// Times that drives and brake take to go on and off.
    pub power: Power,
    /// Stops at faults.
    pub reactions: Reactions,
    /// Watch over the drives, if they tell where they are.
    pub feedback: Option<Feedback>,
    /// Detection of forces at the tool, if the scene asks for it.
    pub contact: Option<Contact>,
    /// Output of a board to the tool, if the tool has one.
    pub tool: Option<ToolPort>,
    /// Emergency stop and door, if the scene names them.
    pub inputs: InputPorts,
    /// The machine has a status lamp.
    pub has_lamp: bool,
    /// Spare outputs and inputs of its board.
    pub spare_pins: SparePins,
    /// Homing by which the machine finds its motors' positions, if it does not know them.
    pub homing: Option<Homing>,
    /// Job that the machine is to do.
    pub job: Job,
    /// Loops around motors that are driven by torque, if the scene describes them.
    pub controller: Option<Controller>,
    /// Simulation of the real machine, if the scene describes one.
    pub plant: Option<Plant>,
    /// Tolerances of the machine, if the scene gives any.
    pub tolerances: Option<Tolerances>,
}

impl Scene {
    /// Returns the kind of model that the scene needs, with any of its tools.
    pub fn model(&self) -> ModelKind {
        let own = ModelKind::of(&self.parameters, self.torque);
        let rack = self.tools.iter();
        let kinds = rack.flat_map(|rack| {
            let each = 0..rack.tools().len();
            each.map(|tool| ModelKind::of(&rack.put_into(&self.parameters, tool), self.torque))
        });
        kinds.fold(own, |widest, kind| match kind.has_room_for(widest) {
            true => kind,
            false => widest,
        })
    }

    /// Seconds per tick.
    pub fn period_s(&self) -> f64 {
        1.0 / self.tick_rate_hz
    }

    /// Ramp of a hold, a stop and a resume: its times to the nearest tick, at least one.
    pub fn ramp(&self) -> Ramp {
        // Cannot overflow: a longer ramp is refused when it is read.
        let ticks = |seconds: f64| (seconds * self.tick_rate_hz).round().max(1.0);
        let most = self.service.stop_time_max_s.map(|most| ticks(most) as u32);
        Ramp::within(ticks(self.service.hold_ramp_s) as u16, most)
    }

    /// Returns true if the job has quintics, or the machine plans paths, which are of quintics.
    pub fn plays_quintics(&self) -> bool {
        self.job.has_quintics() || self.service.plans_paths
    }

    /// Returns true if the machine takes moves in batches: as `batches` in `[service]` says, or where the job has planned
    /// moves, or one so short that single moves come too late over a line with a delay.
    pub fn takes_batches(&self) -> bool {
        let is_short = |ticks| ticks < SHORT_TICKS;
        let needed = self.plays_quintics() || self.job.shortest_ticks().is_some_and(is_short);
        self.service.batches.unwrap_or(needed)
    }

    /// Duration of the job in ticks; it has one setpoint more.
    pub fn ticks(&self) -> u32 {
        self.job.ticks()
    }

    /// Duration of the job, s: the binary64 number that is nearest.
    pub fn duration_s(&self) -> f64 {
        f64::from(self.ticks()) / self.tick_rate_hz
    }
}
