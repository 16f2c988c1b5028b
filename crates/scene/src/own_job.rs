//! The job of a board without a host: what its scene may have, and its moves as a tick plays them.

use crate::Scene;
use crate::drive::Drive;
use crate::judge::{Objection, judge_in_type};
use crate::offer;
use crate::read::{Place, Section};
use crate::settings::settings;
use trirrr_core::setpoint::Quintics;
use trirrr_service::board::QueuedMove;
use trirrr_service::features::JobStart;
use trirrr_service::{ServiceNumber, StopCategory};

/// Most moves of a job with all its passes.
const MOST_UNROLLED: usize = 100_000;

/// Refuses tables that need a host, in a scene without one; the button in any other.
pub(crate) fn check_tables(root: &Section, scene: &Scene) {
    let Some(autonomous) = scene.service.autonomous else {
        if scene.inputs.button.is_some() {
            let reason = "names a button, which begins the job of a board without a host: \
                          put autonomous = true into [service], or leave [inputs.button] out";
            refuse_table(root, "inputs", reason);
        }
        return;
    };
    if autonomous.begins == JobStart::Button && scene.inputs.button.is_none() {
        let reason = "starts by a button, of which there is none: add [inputs.button], \
                      or start = \"power\" for a job that begins when the board is switched on";
        refuse_table(root, "service", reason);
    }
    if scene.drives.is_some() && scene.inputs.interlocks.emergency_stop.is_none() {
        let reason = "lets a board play its job by itself, and nothing would stop its drives: add [inputs.estop]";
        refuse_table(root, "service", reason);
    }
    if scene.drives.is_some() && scene.homing.is_none() && autonomous.begins == JobStart::Power {
        let reason = "begins whenever the supply returns, and the machine may stand anywhere then: \
                      add [homing], or start = \"button\"";
        refuse_table(root, "service", reason);
    }
    if scene
        .drives
        .as_ref()
        .is_some_and(|all| all.iter().any(Drive::measures))
    {
        let reason = "a board with autonomous = true has steppers or no drives: where a drive tells the angle of its joint, \
                      a host finds the pose";
        root.refuse_list("drive", reason);
    }
    if scene.inputs.interlocks.probe.is_some() {
        let reason = "names a probe, which a host reads: leave [inputs.probe] out, or autonomous in [service]";
        refuse_table(root, "inputs", reason);
    }
    if scene.spare_pins.are_named() {
        let reason = "names spare outputs or inputs, which a host switches and reads: \
                      leave all but lamp out, or autonomous in [service]";
        refuse_table(root, "io", reason);
    }
}

fn refuse_table(root: &Section, key: &str, reason: &str) {
    let place = Place {
        value: None,
        ..root.place_of(key)
    };
    root.refuse_at(&place, reason);
}

impl Scene {
    /// Reason why the job cannot begin again where it ends, on a board without a host that has to begin it again.
    pub(crate) fn open_end(&self) -> Option<&'static str> {
        let autonomous = self.service.autonomous?;
        let begins_again = autonomous.passes > 1 || self.inputs.button.is_some();
        let last = self.job.moves.last().filter(|_| begins_again)?;
        (last.to != self.job.start).then_some(
            "ends elsewhere than it starts, and the board begins it again: add a move back to the start, \
             or let it begin once, with start = \"power\" and neither repeat nor [inputs.button]",
        )
    }

    /// Returns true if a board without a host may slow down on its path: by a door, or by a stop of its drives.
    pub fn may_slow_down(&self) -> bool {
        let reactions = &self.reactions;
        let stop = self.inputs.interlocks.emergency_stop;
        let categories = [
            reactions.limit,
            reactions.overrun,
            reactions.drive,
            reactions.limit_switch,
            stop.map_or(StopCategory::Off, |stop| stop.category),
        ];
        let has_drives = self.drives.is_some();
        let stops = categories.iter().any(|each| *each != StopCategory::Off);
        self.inputs.interlocks.door.is_some() || (has_drives && stops)
    }

    /// Puts all passes of a job that a board repeats by itself one behind another, as it plays them: one where they have no end, or are
    /// more than a computer should hold. Returns the number of passes.
    pub fn unroll(&mut self) -> u32 {
        let passes = self.service.autonomous.map_or(1, |own| own.passes);
        let ticks = u64::from(self.ticks()) * u64::from(passes);
        let moves = self.job.moves.len() * passes as usize;
        if passes == 1 || moves > MOST_UNROLLED || ticks > u64::from(u32::MAX) {
            return 1;
        }
        self.job.moves = self.job.moves.repeat(passes as usize);
        passes
    }

    /// The moves of the job as a tick plays them, in the number type `N` and in its units. Each was admitted with the room for a stop
    /// anywhere on it.
    ///
    /// # Errors
    /// A move that is refused in `N`, or a machine that is none there.
    pub fn own_moves<N: ServiceNumber>(&self) -> Result<Vec<QueuedMove<N, Quintics>>, String> {
        let units = crate::units::<N>(self).map_err(|error| error.to_string())?;
        let judged = judge_in_type::<N>(self).map_err(|error| error.to_string())?;
        let period = settings::<N>(self, &units).period;
        let moves = offer::moves::<N>(self, &units);
        let numbered = (1..).zip(moves.iter().zip(judged));
        let each = numbered.map(|(number, (each, judged))| {
            let paces = judged.map_err(|objection| match objection {
                Objection::Limit(violation) => {
                    format!("job.move[{number}] is not admitted in the number type of the image: {:?} is beyond its limit", violation.what)
                }
                objection => format!("job.move[{number}] is no move in the number type of the image: {objection:?}"),
            })?;
            QueuedMove::of(each, paces, period).ok_or_else(|| format!("job.move[{number}] is of no kind that is played"))
        });
        each.collect()
    }
}
