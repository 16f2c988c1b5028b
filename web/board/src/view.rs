//! Values that the page shows of a machine, in SI units.

use crate::talk::{BoardTalk, Talking};
use crate::{BoardCommand, BoardSample, BoardView, DriveValues};
use trirrr_client::describe::{self, Units};
use trirrr_core::setpoint::Setpoint;
use trirrr_protocol::message::{DriveState, State, Transmit};

impl<N: Transmit> BoardTalk<N> {
    pub(crate) fn pose(&self, setpoint: &Setpoint<N>) -> [f64; 3] {
        let position = setpoint.pose.position;
        let [x, y] = [position.x, position.y].map(|value| value.to_f64() * self.units.length_m);
        [x, y, N::angle_to_f64(setpoint.pose.angle)]
    }

    /// Pose, velocity and acceleration, SI.
    fn setpoint(&self, setpoint: &Setpoint<N>) -> Vec<f64> {
        let Units {
            length_m, time_s, ..
        } = self.units;
        let rates = |values: nalgebra::Vector3<N>, time: f64| {
            let [x, y, turn] = <[N; 3]>::from(values).map(N::to_f64);
            [x * length_m / time, y * length_m / time, turn / time]
        };
        let velocity = rates(setpoint.velocity, time_s);
        let acceleration = rates(setpoint.acceleration, time_s * time_s);
        [self.pose(setpoint), velocity, acceleration].concat()
    }

    /// Torque of one unit, N m.
    fn torque(&self) -> f64 {
        let speed = self.units.length_m / self.units.time_s;
        self.units.mass_kg * speed * speed
    }

    /// State of the machine as far as it is known.
    pub(crate) fn shown(&self) -> BoardView {
        let status = self.status.as_ref();
        let state = self.state();
        let shown = status.map(|status| describe::state(status.state, status.acting));
        let (done, moves) = match &self.talking {
            Talking::Job(client) => (client.done(), client.moves()),
            _ => (0, 0),
        };
        let sentence = match (&self.closed, &shown) {
            (Some(why), _) => why.clone(),
            (None, _) if self.is_silent => "the board does not answer".into(),
            (None, Some(shown)) => shown.clone(),
            (None, None) => "waiting for the board".into(),
        };
        let hindrances = BoardCommand::ALL.map(|command| {
            let why = self.hindrance(command).unwrap_or_default();
            why.to_owned()
        });
        let sample = self.sample.as_ref().map(|sample| BoardSample {
            time: f64::from(sample.tick) / self.units.tick_rate_hz,
            setpoint: self.setpoint(&sample.setpoint),
            commanded: DriveValues {
                angles: sample.angles.map(N::angle_to_f64).into(),
                rates: (sample.rates.map(|rate| rate.to_f64() / self.units.time_s)).into(),
                torques: (sample.torques.map(|torque| torque.to_f64() * self.torque())).into(),
            },
            measured: self.drives.as_ref().and_then(|drives| {
                let heard = drives.drives;
                let is_heard = heard.iter().all(|drive| drive.state != DriveState::Silent);
                is_heard.then(|| DriveValues {
                    angles: heard.map(|drive| N::angle_to_f64(drive.angle)).into(),
                    rates: heard
                        .map(|drive| drive.rate.to_f64() / self.units.time_s)
                        .into(),
                    torques: heard
                        .map(|drive| drive.torque.to_f64() * self.torque())
                        .into(),
                })
            }),
        });
        BoardView {
            sentence,
            is_closed: self.closed.is_some(),
            is_bad: self.closed.is_some() || self.is_silent || state.is_some_and(State::has_fault),
            is_playing: matches!(self.talking, Talking::Job(_)),
            is_recovery: state == Some(State::Cleared) && !self.has_homing,
            done,
            moves,
            inputs: status.and_then(|status| describe::inputs(&status.inputs)),
            hindrances: hindrances.into(),
            sample,
        }
    }
}
