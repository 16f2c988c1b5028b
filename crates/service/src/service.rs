//! The front door: a whole service in one thread.

use crate::background::Background;
use crate::feedback::Readings;
use crate::foreground::{Foreground, Output};
use crate::interlock::InterlockReadings;
use crate::number::ServiceNumber;
use crate::scene::{CommandOf, PartOf, RequestOf, Scene};
use trirrr_core::setpoint::Setpoint;
use trirrr_core::tick::Motion;
use trirrr_protocol::message::{FaultCode, Message, MessageRef, Reply, State, Status, Telemetry};
use trirrr_protocol::wire::schema::longest;
use trirrr_protocol::wire::{Counters, Decoder, decoded_length, encode, frame_length};

/// Setpoint and motion that a tick played.
pub type Played<N> = (Setpoint<N>, Motion<N>);

/// Both halves of a service for one thread, with the end of a line in front of them.
///
/// [`Channels::service`](crate::Channels::service) builds one. A board that ticks in an interrupt
/// takes the [two halves](crate::Channels::split) instead.
///
/// | call | effect |
/// |---|---|
/// | [`submit`](Service::submit) | executes a command of this program and returns the reply |
/// | [`receive`](Service::receive) | takes bytes from a line and executes the request in them |
/// | [`tick`](Service::tick) | computes what the motors do until the next tick |
/// | [`step`](Service::step) | does a bounded slice of the work below the tick, such as admission |
/// | [`poll`](Service::outgoing) | returns the next event or telemetry sample |
/// | [`transmit`](Service::transmit) | returns the next frame for the line: reply, event or sample |
///
/// Call [`step`](Service::step) until it returns false, or as often as time permits: a move is
/// admitted there, and only an admitted move is played.
///
/// `LINE` is the size of the two buffers for a frame of the line, in bytes.
///
/// # Example
/// The thesis machine moves 7 cm and 6 cm in one second.
/// ```
/// use trirrr_core::limits::LimitParameters;
/// use trirrr_core::machine::example;
/// use trirrr_core::model::Dynamic;
/// use trirrr_core::setpoint::Pose;
/// use trirrr_protocol::message::{Command, Move, Reply, State};
/// use trirrr_service::{Adjustable, Channels, Settings};
///
/// // Room for 15 moves and 63 telemetry samples.
/// let mut channels = Channels::<Adjustable<Dynamic<f64>>, 16, 64>::new();
/// let scene = Adjustable::new(example(), LimitParameters::default());
/// let start = Pose::from_f64(0.21, 0.22, 0.157);
/// let mut service = channels.service(scene, start, Settings::at(100.0))?;
///
/// assert_eq!(service.submit(&Command::Enable), Reply::Done);
/// service.tick(); // The drives go on.
///
/// let there = Pose::from_f64(0.28, 0.28, 0.209);
/// let reply = service.submit(&Command::Move(Move::rest_to_rest(0, start, there, 100)));
/// assert_eq!(reply, Reply::Done);
/// while service.step() {} // The admission judges the move.
/// assert_eq!(service.submit(&Command::Start), Reply::Done);
///
/// // The first tick of a path stands at its start.
/// for _ in 0..=100 {
///     let output = service.tick();
///     assert!(output.is_on() && output.motors[0].torque.abs() < 0.1);
/// }
/// service.tick();
/// assert_eq!(service.state(), State::Idle);
/// # Ok::<(), trirrr_service::ServiceError>(())
/// ```
pub struct Service<'q, S: Scene, const LINE: usize = 512> {
    pub(crate) foreground: Foreground<'q, S>,
    pub(crate) background: Background<'q, S>,
    inputs: [bool; 3],
    motion: Option<Played<S::N>>,
    decoder: Decoder<LINE>,
    frame: [u8; LINE],
    /// Length of the reply in `frame` that waits to be sent.
    reply: Option<usize>,
}

impl<'q, N: ServiceNumber, S: Scene<N = N>, const LINE: usize> Service<'q, S, LINE> {
    pub(crate) fn new(foreground: Foreground<'q, S>, background: Background<'q, S>) -> Self {
        Self {
            foreground,
            background,
            inputs: [false; 3],
            motion: None,
            decoder: Decoder::new(),
            frame: [0; LINE],
            reply: None,
        }
    }

    /// Executes a command at once. This program needs no hello and no sequence numbers.
    pub fn submit(&mut self, command: &CommandOf<S>) -> Reply<N, PartOf<S>> {
        self.background.submit(command)
    }

    /// Executes a request of a line, unless the service has executed the request before. `checksum` is
    /// that of the request's frame, see [`Background::answer`].
    pub fn answer(&mut self, request: &RequestOf<S>, checksum: u32) -> Reply<N, PartOf<S>> {
        self.background.answer(request, checksum)
    }

    /// Executes the next request if it came before one that was missing, see [`Background::answer_kept`].
    pub fn answer_kept(&mut self) -> Option<(u32, Reply<N, PartOf<S>>)> {
        self.background.answer_kept()
    }

    /// Computes one tick and returns the output. Never waits.
    pub fn tick(&mut self) -> &Output<N> {
        self.motion = None;
        let motion = &mut self.motion;
        self.foreground
            .tick_observed(self.inputs, |setpoint, found| {
                *motion = Some((*setpoint, *found));
            })
    }

    /// Sets the inputs of the next ticks: one for each motor, true if its switch is closed or its drive
    /// reports a stall. A machine without homing has no inputs.
    pub fn set_inputs(&mut self, inputs: [bool; 3]) {
        self.inputs = inputs;
    }

    /// Takes what the drives tell, before the tick, see [`Foreground::hear`].
    pub fn hear(&mut self, readings: Readings<N>) {
        self.foreground.hear(readings);
    }

    /// Takes what the contacts of the interlocks tell, before the tick, see [`Foreground::sense`].
    pub fn sense(&mut self, readings: InterlockReadings) {
        self.foreground.sense(readings);
    }

    /// Takes the levels of the spare inputs, before the tick, see [`Foreground::sense_digital`].
    pub fn sense_digital(&mut self, readings: u8) {
        self.foreground.sense_digital(readings);
    }

    /// Returns the spare outputs that are on, see [`Foreground::digital_outputs`].
    pub fn digital_outputs(&self) -> u8 {
        self.foreground.digital_outputs()
    }

    /// Returns the output of the last tick.
    pub fn output(&self) -> &Output<N> {
        self.foreground.output()
    }

    /// Returns setpoint and motion that the last tick played. `None` if the platform had no setpoint:
    /// at rest, in homing, in a recovery and in a fault.
    pub fn motion(&self) -> Option<&Played<N>> {
        self.motion.as_ref()
    }

    /// Returns the angles that the last tick added to the commanded ones without a motion, where
    /// homing found a reference.
    pub fn shift(&self) -> Option<[N::Angle; 3]> {
        self.foreground.shift()
    }

    /// Returns the state of the tick.
    pub fn state(&self) -> State {
        self.foreground.state()
    }

    /// Returns the status as the host would read it.
    pub fn status(&mut self) -> Status<N> {
        self.background.status()
    }

    /// Does a bounded slice of the work below the tick. Returns false if nothing is left to do.
    pub fn step(&mut self) -> bool {
        self.background.step()
    }

    /// Returns the next event, or else the next telemetry sample.
    pub fn outgoing(&mut self) -> Option<Message<N, PartOf<S>>> {
        self.background.outgoing()
    }

    /// Returns the next telemetry sample and leaves the events.
    pub fn sample(&mut self) -> Option<Telemetry<N>> {
        self.background.sample()
    }

    /// Latches a fault from outside, see [`Foreground::raise`].
    pub fn raise(&mut self, code: FaultCode, index: Option<u8>, value: N, limit: N) {
        self.foreground.raise(code, index, value, limit);
    }

    /// Sets the angles of the motors as an encoder measured them, see
    /// [`Foreground::set_position`]. Returns false if the machine moves.
    pub fn set_position(&mut self, angles: [N::Angle; 3]) -> bool {
        self.foreground.set_position(angles)
    }

    /// Counts a tick that came too late, see [`Foreground::count_late`].
    pub fn count_late(&mut self) {
        self.foreground.count_late();
    }

    /// Makes the numbers of the conversations to come depend on `noise`, see [`Background::stir`].
    pub fn stir(&mut self, noise: u32) {
        self.background.stir(noise);
    }

    /// Reports the latency of the last tick, see [`Foreground::report_timing`]. Returns false if the
    /// tick was late.
    pub fn report_timing(&mut self, duration: u32, period: u32) -> bool {
        self.foreground.report_timing(duration, period)
    }
}

impl<N: ServiceNumber, S: Scene<N = N>, const LINE: usize> Service<'_, S, LINE> {
    /// Takes bytes from a line, of any number, and executes the request that they complete. Returns
    /// the number of bytes taken.
    ///
    /// The service takes no more bytes while a reply waits in [`transmit`](Service::transmit). A damaged
    /// frame is dropped and [counted](Service::counters): the host asks again.
    pub fn receive(&mut self, bytes: &[u8]) -> usize {
        const {
            assert!(
                LINE >= decoded_length(longest::<RequestOf<S>>())
                    && LINE >= frame_length(longest::<Message<N, PartOf<S>>>()),
                "LINE is shorter than a message"
            );
        }
        let mut rest = bytes;
        while self.reply.is_none() {
            let request = match self.decoder.take::<RequestOf<S>>(&mut rest) {
                None => break,
                Some(Err(_)) => continue,
                Some(Ok(request)) => request,
            };
            let reply = self.background.answer(&request, self.decoder.checksum());
            self.put_reply(request.sequence, &reply);
        }
        bytes.len() - rest.len()
    }

    fn put_reply(&mut self, sequence: u32, reply: &Reply<N, PartOf<S>>) {
        let message = MessageRef::Reply { sequence, reply };
        self.reply = encode(&message, &mut self.frame).ok().map(<[u8]>::len);
    }

    /// Returns the next frame for the line: a reply first, then events and samples in turn.
    pub fn transmit(&mut self) -> Option<&[u8]> {
        if self.reply.is_none()
            && let Some((sequence, reply)) = self.background.answer_kept()
        {
            self.put_reply(sequence, &reply);
        }
        let mut length = self.reply.take();
        if length.is_none() {
            let frame = &mut self.frame;
            self.background.send_next(|message| {
                length = encode(message, frame).ok().map(<[u8]>::len);
            });
        }
        self.frame.get(..length?)
    }

    /// Returns the counters of the frames that came.
    pub fn counters(&self) -> Counters {
        self.decoder.counters()
    }
}
