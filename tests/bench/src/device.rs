//! The thesis machine with the service and its end of the line: what a board is, in one thread and
//! without one.

use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::example;
use trirrr_core::model::Dynamic;
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{
    AngleReference, Board, Command, Firmware, Hello, Message, PROTOCOL, Reply, Request, Telemetry,
};
use trirrr_protocol::wire::schema::{key, longest};
use trirrr_protocol::wire::{Counters, Decoder, checksum, decoded_length, encode, frame_length};
use trirrr_service::features::{NoImage, On};
use trirrr_service::paces::Ramp;
use trirrr_service::{
    Adjustable, Channels, Output, PowerTimes, Reactions, SceneIdentity, SceneParts, Service,
    ServiceNumber, Settings, name, scene,
};

/// Ticks per second.
pub const TICK_RATE_HZ: f64 = 1000.0;

/// Ticks from normal speed to rest.
pub const RAMP_TICKS: u16 = 8;

/// Key of the device's scene.
pub const SCENE: u32 = 77;

/// Moves that can wait.
pub const QUEUE: usize = 15;

// The numbers of no machine are longer.
const LONGEST_REQUEST: usize = decoded_length(longest::<Request<f64>>());
const LONGEST_MESSAGE: usize = decoded_length(longest::<Message<f64>>());

/// The decoder of a machine.
pub type RequestDecoder = Decoder<LONGEST_REQUEST>;

/// The decoder of a client.
pub type MessageDecoder = Decoder<LONGEST_MESSAGE>;

/// The queues of a [`Device`].
pub type DeviceChannels = DeviceRoom<f64, { QUEUE + 1 }>;

/// The same with room for another number of moves, less one.
pub type DeviceRoom<N, const MOVES: usize> =
    Channels<DeviceScene<N>, MOVES, 64, { LEVELS as usize }>;

/// Levels of power for which the device has room.
pub const LEVELS: u16 = 1024;

scene! {
    /// The thesis machine, whose parts can be changed, with power lists.
    pub DeviceScene [N: ServiceNumber] [N]: Adjustable<Dynamic<N>>,
    batches = On, update = NoImage, levels = On
}

/// The service, and a decoder in front of it that lets a test see every request.
pub struct Device<'q, N: ServiceNumber = f64> {
    /// The service.
    pub service: Service<'q, DeviceScene<N>>,
    decoder: RequestDecoder,
}

/// Where the machine stands first.
pub fn home() -> Pose<f64> {
    Pose::from_f64(0.21, 0.22, 0.157)
}

/// The hello that the device accepts.
pub fn hello() -> Hello {
    hello_in::<f64>()
}

/// The hello that the device of this number type accepts.
pub fn hello_in<N: ServiceNumber>() -> Hello {
    Hello {
        protocol: PROTOCOL,
        schema: key::<Request<N>, Message<N>>(),
        scene: SCENE,
    }
}

impl<'q> Device<'q> {
    /// Switches the machine on, at [`home`], with its drives off. `silence_ticks`: silence after which it stops, 0 for
    /// never.
    pub fn new<const MOVES: usize>(
        channels: &'q mut DeviceRoom<f64, MOVES>,
        limits: LimitParameters,
        silence_ticks: u32,
    ) -> Self {
        Self::standing(channels, limits, silence_ticks, home())
    }

    /// Switches the machine on, and its drives.
    pub fn enabled<const MOVES: usize>(
        channels: &'q mut DeviceRoom<f64, MOVES>,
        limits: LimitParameters,
        silence_ticks: u32,
    ) -> Self {
        let mut device = Self::new(channels, limits, silence_ticks);
        let reply = device.service.submit(&Command::Enable);
        assert_eq!(reply, Reply::Done);
        device.tick();
        while device.service.outgoing().is_some() {}
        device
    }
}

impl<'q, N: ServiceNumber> Device<'q, N> {
    /// Switches the machine on as [`Device::new`] does, where it stands at `pose`.
    pub fn standing<const MOVES: usize>(
        channels: &'q mut DeviceRoom<N, MOVES>,
        limits: LimitParameters,
        silence_ticks: u32,
        pose: Pose<N>,
    ) -> Self {
        let settings = Settings {
            period: N::factor_from_f64(1.0 / TICK_RATE_HZ),
            ramp: Ramp::within(RAMP_TICKS, None),
            host_timeout_ticks: silence_ticks,
            telemetry_every: 0,
            power: PowerTimes::default(),
            reactions: Reactions::OFF,
            planning: None,
            scene: SceneIdentity {
                schema: hello_in::<N>().schema,
                key: SCENE,
                name: name("torture"),
                tick_rate_hz: TICK_RATE_HZ,
                length_m: 1.0,
                time_s: 1.0,
                mass_kg: 1.0,
                reference: AngleReference::Declared,
            },
            board: Board::HOST,
            firmware: &Firmware::SIMULATOR,
        };
        let scene = SceneParts {
            levels: LEVELS,
            ..Adjustable::new(example(), limits).into()
        };
        let service = channels
            .service(scene, pose, settings)
            .expect("the thesis machine stands at its start");
        Self {
            service,
            decoder: Decoder::new(),
        }
    }
}

impl<N: ServiceNumber> Device<'_, N> {
    /// One tick, and what came of it: the sample is there whenever one was asked for.
    pub fn tick(&mut self) -> Output<N> {
        *self.service.tick()
    }

    /// The next sample.
    pub fn sample(&mut self) -> Option<Telemetry<N>> {
        self.service.sample()
    }

    /// Takes bytes from the line. `heard` sees each request that was understood, `answer` the
    /// answer to it.
    pub fn receive(
        &mut self,
        mut bytes: &[u8],
        mut heard: impl FnMut(&Request<N>),
        mut answer: impl FnMut(&Message<N>),
    ) {
        while let Some(frame) = self.decoder.take::<Request<N>>(&mut bytes) {
            let Ok(request) = frame else {
                continue;
            };
            heard(&request);
            let reply = self.service.answer(&request, self.decoder.checksum());
            answer(&Message::Reply {
                sequence: request.sequence,
                reply,
            });
            while let Some((sequence, reply)) = self.service.answer_kept() {
                answer(&Message::Reply { sequence, reply });
            }
        }
    }

    /// What the decoder has seen.
    pub fn counters(&self) -> Counters {
        self.decoder.counters()
    }
}

/// The answer to a request that comes over no line.
pub fn answer(device: &mut Device, request: &Request<f64>) -> Reply<f64> {
    let checksum = checksum(request).expect("a request has a length");
    device.service.answer(request, checksum)
}

/// The frame of a request.
pub fn request_frame<N: ServiceNumber>(request: &Request<N>) -> Vec<u8> {
    let mut room = [0; frame_length(LONGEST_REQUEST)];
    let frame = encode(request, &mut room).expect("the room is for the longest request");
    frame.to_vec()
}

/// The frame of a message.
pub fn message_frame<N: ServiceNumber>(message: &Message<N>) -> Vec<u8> {
    let mut room = [0; frame_length(LONGEST_MESSAGE)];
    let frame = encode(message, &mut room).expect("the room is for the longest message");
    frame.to_vec()
}
