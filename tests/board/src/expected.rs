//! What the host computes for a scene: its machine, and its own service playing the job.

use anyhow::{Context, Result, anyhow, bail, ensure};
use trirrr_client::local::{self, HostNumber, LocalService};
use trirrr_client::{describe, short_way};
use trirrr_core::setpoint::Setpoint;
use trirrr_core::tick::Motor;
use trirrr_core::units::Units;
use trirrr_drives::ObeyingDrives;
use trirrr_image::RuledSwitches;
use trirrr_protocol::message::{
    AnyMove, Command, Hello, Message, Reply, Request, State, Telemetry,
};
use trirrr_scene::Scene;
use trirrr_scene::offer;
use trirrr_scene::pipeline::{self, Pipeline};
use trirrr_service::coefficients::HomingCoefficients;

/// Ticks after which the host's own machine is taken for one that does not come to an end.
const LONGEST: usize = 1_000_000;

/// A scene in the number type `N`.
pub(crate) struct Expected<N: HostNumber> {
    pub(crate) scene: Scene,
    pub(crate) hello: Hello,
    pub(crate) units: Units,
    evaluator: Box<dyn Pipeline<N>>,
}

impl<N: HostNumber> Expected<N> {
    pub(crate) fn of(scene: &Scene) -> Result<Self> {
        let units = trirrr_scene::units::<N>(scene).map_err(|error| anyhow!("{error}"))?;
        Ok(Self {
            scene: scene.clone(),
            hello: local::hello::<N>(scene),
            units,
            evaluator: pipeline::of_scene(scene, units)?,
        })
    }

    /// The moves of the scene's job, numbered from 0.
    pub(crate) fn moves(&self) -> Vec<AnyMove<N>> {
        offer::moves(&self.scene, &self.units)
    }

    /// What a setpoint asks of the motors.
    pub(crate) fn motors(&self, setpoint: &Setpoint<N>) -> Option<[Motor<N>; 3]> {
        self.evaluator.motors(setpoint).ok()
    }

    /// A tick's length.
    pub(crate) fn period(&self) -> N::Factor {
        N::factor_from_f64(self.units.time(self.scene.period_s()))
    }

    /// Ticks from normal speed to rest.
    pub(crate) fn ramp(&self) -> u16 {
        self.scene.ramp().ticks
    }

    /// What a board that has just been switched on does, from the service on the host: its homing,
    /// where the scene has one, then its job, unless homing has failed.
    pub(crate) fn stretches(&self, inputs: HomingInputs) -> Result<Vec<Stretch<N>>> {
        let homing = match &self.scene.homing {
            Some(homing) => {
                let parameters = homing.parameters(&self.scene, &self.units);
                let parameters = parameters.map_err(|status| anyhow!("{status}"))?;
                let period = self.units.time(self.scene.period_s());
                Some(HomingCoefficients::build(&parameters, period))
            }
            None => None,
        };
        local::with_machine_switched_on::<N, _>(&self.scene, |machine| {
            Host {
                switches: match inputs {
                    HomingInputs::Switches => homing.as_ref().map(RuledSwitches::new),
                    HomingInputs::Open => None,
                },
                drives: self
                    .scene
                    .feedback
                    .map(|_| ObeyingDrives::new(machine.motors().map(|motor| motor.angle))),
                units: describe::Units::of_scene(&self.scene, &self.units),
                machine,
                sequence: 0,
                moves: self.moves(),
                offered: 0,
            }
            .play(self.hello)
        })?
    }
}

/// What the board's inputs of homing do.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum HomingInputs {
    /// They close by rule, as in an image with the feature `switches`
    Switches,
    /// They never close
    Open,
}

/// Ticks of a board that follow from one command, and what it does until then.
pub(crate) struct Stretch<N: HostNumber> {
    /// The sample of any tick before.
    pub(crate) standing: Telemetry<N>,
    /// The samples of every tick, and of the first one in which it stands again.
    pub(crate) samples: Vec<Telemetry<N>>,
}

/// The host's own machine and its client.
struct Host<'a, N: HostNumber> {
    machine: &'a mut dyn LocalService<N>,
    switches: Option<RuledSwitches<'a, N>>,
    drives: Option<ObeyingDrives<N>>,
    units: describe::Units,
    sequence: u32,
    moves: Vec<AnyMove<N>>,
    offered: usize,
}

impl<N: HostNumber> Host<'_, N> {
    fn play(mut self, hello: Hello) -> Result<Vec<Stretch<N>>> {
        if let Reply::Hello(identity) = self.ask(Command::Hello(hello)) {
            self.sequence = identity.next_sequence;
        }
        ensure!(
            self.ask(Command::telemetry(1)) == Reply::Done,
            "the host's own machine refuses telemetry"
        );
        let off = self.tick()?;
        let enabling = self.stretch(off, Command::Enable)?;
        let mut standing = *enabling.samples.last().context("a stretch has an end")?;
        let mut stretches = vec![enabling];
        if standing.state == State::Unhomed {
            let homing = self.stretch(standing, Command::Home)?;
            standing = *homing.samples.last().context("a stretch has an end")?;
            stretches.push(homing);
        }
        // A machine that was measured stands beside its start.
        if standing.state == State::Idle
            && let Some(first) = self.moves.first()
            && let Some(way) = short_way(&standing.setpoint.pose, &first.common().from, &self.units)
        {
            let approach = self.stretch(standing, Command::Recover(way))?;
            standing = *approach.samples.last().context("a stretch has an end")?;
            stretches.push(approach);
        }
        if standing.state == State::Idle {
            self.feed();
            stretches.push(self.stretch(standing, Command::Start)?);
        }
        Ok(stretches)
    }

    /// The ticks that follow from `command`.
    fn stretch(&mut self, standing: Telemetry<N>, command: Command<N>) -> Result<Stretch<N>> {
        let reply = self.ask(command);
        ensure!(
            reply == Reply::Done,
            "the host's own machine does not obey {command:?}: {reply:?}"
        );
        let mut samples = Vec::new();
        while samples.len() < LONGEST {
            let sample = self.tick()?;
            // How long that takes is a matter of the board.
            if sample.state == State::Enabling {
                continue;
            }
            samples.push(sample);
            if sample.state.is_at_rest() {
                return Ok(Stretch { standing, samples });
            }
            self.feed();
        }
        bail!("the host's own machine does not end what follows from {command:?}")
    }

    /// One tick of the machine, with its motors and switches; its sample.
    fn tick(&mut self) -> Result<Telemetry<N>> {
        if let Some(switches) = &self.switches {
            let closed = switches.closed(self.machine.motors());
            self.machine.inputs(closed);
        }
        if let Some(drives) = &self.drives {
            self.machine.hear(drives.measure());
        }
        self.machine.tick();
        if let Some(drives) = &mut self.drives {
            drives.apply(self.machine.output());
        }
        while self.machine.step() {}
        if let (Some(switches), Some(by)) = (&mut self.switches, self.machine.shift()) {
            switches.shift(by);
        }
        let mut sample = None;
        while let Some(message) = self.machine.outgoing() {
            if let Message::Telemetry(telemetry) = message {
                sample = Some(telemetry);
            }
        }
        sample.context("the host's own machine has sent no sample")
    }

    /// Offers as many moves as there is room for, has them judged, and is heard.
    fn feed(&mut self) {
        while let Some(next) = self.moves.get(self.offered).copied()
            && self.ask(next.command()) == Reply::Done
        {
            self.offered += 1;
        }
        while self.machine.step() {}
        // A host that says nothing is taken for lost.
        self.ask(Command::Status);
    }

    fn ask(&mut self, command: Command<N>) -> Reply<N> {
        let sequence = self.sequence;
        self.sequence = sequence.wrapping_add(1);
        self.machine.answer(&Request { sequence, command })
    }
}
