//! Paths that a machine in the same program plans and plays, in virtual time.

use super::*;
use crate::local::{hello, with_machine_switched_on};
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{PathCurve, PathPiece, Refusal};
use trirrr_scene::Scene;

const TICK: Duration = Duration::from_millis(1);

/// A job takes less, and what takes longer does not end.
const LONGEST_TICKS: u32 = 60_000;

const CORNER: [f64; 2] = [0.25, 0.245];

/// `count` lines within 20 mm, each from where the last one ends: the machine stops at each corner.
fn lines(count: u32) -> Vec<PathPiece<f32>> {
    let mut bits = 1_u32;
    let mut draw = || {
        bits = bits.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        0.02 * f64::from(bits >> 8) / f64::from(1 << 24)
    };
    let line = |number| PathPiece {
        number,
        curve: PathCurve::Line {
            to: Pose::from_f64(CORNER[0] + draw(), CORNER[1] + draw(), 0.4),
        },
        feed: 0.05,
        tool_power: 0.5,
        tool_speed: 0.0,
        last: number + 1 == count,
    };
    (0..count).map(line).collect()
}

/// Plays lines on a machine that has no room for the piece `refused`. Returns the end of the job and its time.
fn play(count: u32, refused: Option<u32>) -> (Result<(), JobFailure<f32>>, Duration) {
    let text = include_str!("../../../../scenes/paths/onboard.toml");
    let scene = Scene::parse(text, "onboard.toml").expect("a scene");
    let work = JobWork::Path {
        start: Pose::from_f64(CORNER[0], CORNER[1], 0.4),
        pieces: lines(count),
    };
    let mut client = JobClient::new(work, hello::<f32>(&scene), 0, Patience::default(), 1);
    let played = with_machine_switched_on::<f32, _>(&scene, |machine| {
        for tick in 0..LONGEST_TICKS {
            let now = TICK * tick;
            loop {
                match client.poll(now) {
                    Turn::Send(request) => {
                        let sequence = request.sequence;
                        let reply = match request.command {
                            Command::Path(piece) if Some(piece.number) == refused => {
                                // The machine counts the request.
                                let command = Command::Status;
                                machine.answer(&Request { sequence, command });
                                Reply::Refused(Refusal::QueueFull)
                            }
                            _ => machine.answer(&request),
                        };
                        client.receive(&Message::Reply { sequence, reply }, now);
                    }
                    Turn::Wait(_) => break,
                    Turn::Reconnect => panic!("the machine answers"),
                    Turn::Done(result) => return (result, now),
                }
            }
            while machine.step() {}
            machine.tick();
            while let Some(message) = machine.outgoing() {
                client.receive(&message, now);
            }
        }
        panic!("no end: {:?}", client.status());
    });
    played.expect("a machine")
}

#[test]
fn a_path_that_fills_the_queue_before_its_last_piece_is_played() {
    let (result, _) = play(63, None);
    assert_eq!(result, Ok(()));
}

#[test]
fn a_machine_that_stands_and_takes_nothing_ends_the_job() {
    let (result, time) = play(2, Some(1));
    let refused = JobFailure::Refused {
        index: Some(1),
        refusal: Refusal::QueueFull,
    };
    assert_eq!(result, Err(refused));
    let patience = Patience::default().total();
    assert!(time > patience && time < 2 * patience, "{time:?}");
}
