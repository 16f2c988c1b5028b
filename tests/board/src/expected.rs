//! What the host computes for a scene: its machine, and its own service playing the job.

use anyhow::{Result, anyhow, bail, ensure};
use trirrr_core::message::{Command, Hello, Message, Move, Reply, Request, Telemetry, Transmit};
use trirrr_core::setpoint::Setpoint;
use trirrr_core::tick::Motor;
use trirrr_core::units::Units;
use trirrr_host_sim::evaluator::{self, Evaluator};
use trirrr_host_sim::job;
use trirrr_host_sim::machine::{self, Machine};
use trirrr_host_sim::telemetry::is_of_a_job;
use trirrr_scene::Scene;

/// A scene in the number type `N`.
pub(crate) struct Expected<N: Transmit> {
    pub(crate) scene: Scene,
    pub(crate) hello: Hello,
    pub(crate) units: Units,
    evaluator: Box<dyn Evaluator<N>>,
}

impl<N: Transmit> Expected<N> {
    pub(crate) fn of(scene: &Scene) -> Result<Self> {
        let units = trirrr_scene::units::<N>(scene).map_err(|error| anyhow!("{error}"))?;
        Ok(Self {
            scene: scene.clone(),
            hello: machine::hello::<N>(scene),
            units,
            evaluator: evaluator::build_in(&scene.parameters, units)?,
        })
    }

    /// The moves of the scene's job, numbered from 0.
    pub(crate) fn moves(&self) -> Vec<Move<N>> {
        job::moves(&self.scene, &self.units)
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
        // As the image has it; the scene's reader holds it to the range.
        (self.scene.service.hold_ramp_s * self.scene.tick_rate_hz)
            .round()
            .max(1.0) as u16
    }

    /// The samples of every tick of the scene's job, and of the idle tick after it, from the
    /// service on the host. The first idle one, before the job, comes first.
    pub(crate) fn samples(&self) -> Result<Vec<Telemetry<N>>> {
        machine::with_machine::<N, _>(&self.scene, |machine| {
            Host {
                machine,
                sequence: 0,
                moves: self.moves(),
                offered: 0,
            }
            .play(self.hello)
        })?
    }
}

/// The host's own machine and its client.
struct Host<'a, N: Transmit> {
    machine: &'a mut dyn Machine<N>,
    sequence: u32,
    moves: Vec<Move<N>>,
    offered: usize,
}

impl<N: Transmit> Host<'_, N> {
    fn play(mut self, hello: Hello) -> Result<Vec<Telemetry<N>>> {
        self.ask(Command::Hello(hello));
        self.sequence = 0;
        ensure!(
            self.ask(Command::Telemetry { every: 1 }) == Reply::Done,
            "the host's own machine refuses telemetry"
        );
        self.machine.tick();
        let mut samples = self.samples();
        samples.truncate(1);
        self.feed();
        ensure!(
            self.ask(Command::Start) == Reply::Done,
            "the host's own machine does not start"
        );
        // The first tick takes the start.
        for _ in 0..=u64::from(self.moves.iter().map(|each| each.ticks).sum::<u32>()) + 1 {
            self.machine.tick();
            samples.append(&mut self.samples());
            self.feed();
            if samples.len() > 2 && samples.last().is_some_and(|last| !is_of_a_job(last.state)) {
                return Ok(samples);
            }
        }
        bail!("the host's own machine does not end the job")
    }

    /// Offers as many moves as there is room for, has them judged, and is heard.
    fn feed(&mut self) {
        while let Some(next) = self.moves.get(self.offered).copied()
            && self.ask(Command::Move(next)) == Reply::Done
        {
            self.offered += 1;
        }
        while self.machine.work() {}
        // A host that says nothing is taken for lost.
        self.ask(Command::Status);
    }

    fn samples(&mut self) -> Vec<Telemetry<N>> {
        let mut samples = Vec::new();
        while let Some(message) = self.machine.outgoing() {
            if let Message::Telemetry(sample) = message {
                samples.push(sample);
            }
        }
        samples
    }

    fn ask(&mut self, command: Command<N>) -> Reply<N> {
        let sequence = self.sequence;
        self.sequence += 1;
        self.machine.receive(&Request { sequence, command })
    }
}
