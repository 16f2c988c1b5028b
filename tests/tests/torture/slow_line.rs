//! Jobs over a line with a delay, and with the bytes of a serial line: the queue must not run dry.

use std::f64::consts::TAU;
use std::time::Duration;
use trirrr_bench::device::{
    Device, DeviceRoom, MessageDecoder, TICK_RATE_HZ, hello, home, message_frame, request_frame,
};
use trirrr_bench::slow_link::SlowLink;
use trirrr_client::{Dialogue, JobClient, JobWork, Patience, Turn};
use trirrr_core::limits::LimitParameters;
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{Acting, AnyMove, Message, Move, State};

/// Bytes in a tick of 1 ms on a serial line of 921,600 baud, ten bits a byte.
pub(crate) const SERIAL: usize = 92;
/// The same on a line such as USB, 1 MB/s.
pub(crate) const USB: usize = 1000;

/// Places of the queue, as on a board.
const MOVES: usize = 257;

/// Slices of background work between two ticks.
const STEPS_PER_TICK: usize = 200;

/// Count of one job.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Pace {
    /// Ticks from the start of the path to its end.
    pub(crate) ticks: u64,
    /// Ticks of them in which the machine slowed down, or stood, because its queue ran dry.
    pub(crate) dry: u64,
    /// Requests that the client repeated.
    pub(crate) repeated: u64,
}

/// Circles of 8 mm radius in `count` moves of `ticks`, from rest to rest: 0.1 mm a tick where it does not speed up or slow down.
pub(crate) fn circles(count: u32, ticks: u32) -> Vec<AnyMove<f64>> {
    const RADIUS_M: f64 = 0.008;
    const SPEED_M_S: f64 = 0.1;
    // The rate of the angle rises and falls linearly over this time.
    const RAMP_S: f64 = 0.4;
    let duration = f64::from(count) * f64::from(ticks) / TICK_RATE_HZ;
    let most = SPEED_M_S / RADIUS_M;
    let at = |time: f64| {
        let left = duration - time;
        let whole = most * (duration - RAMP_S);
        let ramp = |time: f64| most * time * time / (2.0 * RAMP_S);
        match (time < RAMP_S, left < RAMP_S) {
            (true, _) => (ramp(time), most * time / RAMP_S),
            (_, true) => (whole - ramp(left), most * left / RAMP_S),
            _ => (most * (time - RAMP_S / 2.0), most),
        }
    };
    let platform = |index: u32| {
        let (angle, rate) = at(f64::from(index) * f64::from(ticks) / TICK_RATE_HZ);
        let (sin, cos) = (angle % TAU).sin_cos();
        let start = home();
        let pose = Pose::from_f64(
            start.position.x + RADIUS_M * (cos - 1.0),
            start.position.y + RADIUS_M * sin,
            start.angle,
        );
        (pose, [-RADIUS_M * rate * sin, RADIUS_M * rate * cos, 0.0])
    };
    let each = |index: u32| {
        let ((from, start_velocity), (to, end_velocity)) = (platform(index), platform(index + 1));
        let rest = |velocity: [f64; 3], stands| if stands { [0.0; 3] } else { velocity };
        AnyMove::Cubic(Move {
            number: 0,
            from,
            to,
            start_velocity: rest(start_velocity, index == 0),
            end_velocity: rest(end_velocity, index + 1 == count),
            ticks,
            tool_power: 0.0,
            tool_speed: 0.0,
        })
    };
    (0..count).map(each).collect()
}

/// Plays `work` over a line with `delay` ticks and `bytes_per_tick` each way.
///
/// # Panics
/// A job that fails, or does not end.
pub(crate) fn play(work: impl Into<JobWork<f64>>, delay: u64, bytes_per_tick: usize) -> Pace {
    let work = work.into();
    let moves = work.moves().unwrap_or_default();
    let length: u64 = moves
        .iter()
        .map(|each| u64::from(each.common().ticks))
        .sum();
    let mut channels = Box::new(DeviceRoom::<f64, MOVES>::new());
    let mut device = Device::new(&mut channels, LimitParameters::default(), 0);
    let mut client = JobClient::new(work, hello(), 0, Patience::default(), 1);
    let mut decoder = MessageDecoder::new();
    let mut there = SlowLink::new(delay, bytes_per_tick);
    let mut back = there.clone();
    let mut pace = Pace::default();
    for tick in 0..20 * length + 10_000 {
        let now = Duration::from_secs_f64(tick as f64 / TICK_RATE_HZ);
        device.tick();
        let state = device.service.state();
        let moves = matches!(state, State::Running | State::Slowing | State::Holding);
        pace.ticks += u64::from(moves);
        pace.dry += u64::from(device.service.status().acting == Acting::QueueDry);
        for _ in 0..STEPS_PER_TICK {
            if !device.service.step() {
                break;
            }
        }
        while let Some(bytes) = there.receive(tick) {
            device.receive(&bytes, |_| {}, |message| back.send(&message_frame(message)));
        }
        while back.is_free()
            && let Some(message) = device.service.outgoing()
        {
            back.send(&message_frame(&message));
        }
        while let Some(bytes) = back.receive(tick) {
            let mut line = bytes.as_slice();
            while let Some(frame) = decoder.take::<Message<f64>>(&mut line) {
                client.receive(&frame.expect("no damage"), now);
            }
        }
        loop {
            match client.poll(now) {
                Turn::Send(request) => there.send(&request_frame(&request)),
                Turn::Wait(_) => break,
                Turn::Reconnect => panic!("the line is there"),
                Turn::Done(result) => {
                    if let Err(failure) = result {
                        panic!("{}", client.describe(&failure));
                    }
                    pace.repeated = client.repeated();
                    return pace;
                }
            }
        }
        there.tick(tick);
        back.tick(tick);
    }
    panic!("the job does not end: {:?}", client.status());
}
