//! Holds of a sender at random instants, with the true machine in virtual time.

use super::bench::{Bench, LATENCY, Random, planned, with_bench};
use trirrr_scene::{LongestStop, Scene};

/// Number type. Its planner has room for all that these jobs ask for.
type N = f64;

/// Ticks from a real-time byte to the one that slows down, at most: an order under way, its answer and the hold on the line, and a tick for
/// the dialect, the driver and the machine each. The door is heard by the machine itself.
const BYTE: u64 = 3 * LATENCY as u64 + 3;

/// Way of a hold over its promise, at most: the machine plans these jobs by itself, and its moves may be nearer to the feed than those of a
/// plan on the host. The time is that of the promise.
const WAY: f64 = 1.02;

/// Ticks after which each hold is at rest.
const REST: usize = 600;

/// Figures of holds.
#[derive(Debug, Default)]
struct Figures {
    holds: u32,
    lost: u32,
    /// Jobs that the machine's proof has dropped: they count for nothing.
    dropped: u32,
    /// Most ticks from a byte to the tick that slows down.
    byte: u64,
    /// Holds with a promise, and their greatest time and way over it.
    promised: u32,
    time: f64,
    way: f64,
}

impl Figures {
    /// Compares a hold with its promise: the ticks that slow down, and the way in them.
    fn compare(&mut self, byte: u64, ticks: u64, way_m: f64, promise: Option<LongestStop>) {
        self.byte = self.byte.max(byte);
        if let Some(promise) = promise {
            self.promised += 1;
            // A tick lasts for a millisecond. The promise is of whole ticks.
            let promised = (1000.0 * promise.time_s).round();
            self.time = self.time.max(ticks as f64 / promised);
            self.way = self.way.max(way_m / promise.way_m);
        }
    }
}

/// The engraving machine with a door, an output and an input, that plans paths.
fn scene() -> Scene {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../scenes/engraving.toml");
    let text = include_str!("../../../scenes/engraving.toml");
    let more = "[inputs.door]\n\n[inputs.probe]\n\n[[io.outputs]]\nname = \"air\"\n\n[[io.inputs]]\nname = \"sheet\"\n\n[service]\nplans_paths = true";
    Scene::parse(&text.replacen("[service]", more, 1), file).unwrap()
}

/// A line of a job near the start of the scene's, mm.
fn line(random: &mut Random) -> String {
    let mut near = |middle: usize| (middle - 15 + random.below(30)) as f64;
    let (x, y) = (near(250), near(245));
    let feed = 300 + random.below(5000);
    match random.below(12) {
        0..=3 => format!("G1 X{x} Y{y} F{feed}"),
        4 => format!("G0 X{x} Y{y}"),
        5 => format!("G91 G2 X4 Y0 I2 J0 F{feed}\nG3 X-4 Y0 I-2 J0\nG90"),
        6 | 7 => format!("G4 P0.{}", 1 + random.below(4)),
        8 => "M64 P0".into(),
        9 => format!("M62 P0\nG1 X{x} F{feed}"),
        10 => "M66 P0 L3 Q100".into(),
        _ => format!("M{} S{}", 3 + random.below(3), random.below(1000)),
    }
}

/// What `trirrr check` promises for a hold in a job of these `lines` from `place` on; none of a job that it refuses.
fn promise(place: [f64; 2], lines: &str) -> Option<LongestStop> {
    // A jog is a line at its feed.
    planned(scene(), place, &lines.replace("$J=", "G1 "))?.longest_stop()
}

/// Plays jobs with so many holds.
fn play(seed: u64, holds: u32) -> Figures {
    with_bench(&scene(), seed, |bench| {
        let mut figures = Figures::default();
        while figures.holds < holds {
            hold_in_a_job(bench, &mut figures);
        }
        figures
    })
}

/// A part of a job, or a jog, with a hold somewhere in it; then all of it is played.
fn hold_in_a_job(bench: &mut Bench<'_, N>, figures: &mut Figures) {
    bench.said.clear();
    let lines: Vec<String> = match bench.random.below(6) {
        0 => vec![format!("$J=G90 X{} F900", 235 + bench.random.below(30))],
        lines => (0..2 * lines).map(|_| line(&mut bench.random)).collect(),
    };
    let lines = lines.join("\n") + "\n";
    let promise = promise(bench.place, &lines);
    bench.input = false;
    bench.send(lines.as_bytes());
    let delay = bench.random.below(1500);
    bench.pass_for(delay);
    bench.input = bench.random.below(2) == 0;
    // One that ends in this very moment is a jog no more.
    let is_jog = bench.state() == "Jog";
    let at = bench.tick;
    bench.slowed = None;
    let wanted = match bench.random.below(3) {
        0 => {
            bench.send(b"!");
            "Hold:0"
        }
        1 => {
            bench.send(b"\x84");
            "Door:0"
        }
        _ => {
            bench.door = true;
            "Door:1"
        }
    };
    bench.pass_for(REST);
    let state = bench.state();
    let rest = bench.place;
    // Nothing moves, whatever ends meanwhile, before the user goes on.
    let stands = bench.random.below(700);
    bench.pass_for(stands);
    let is_kept = state == wanted || (is_jog && state == "Idle" && !bench.door);
    // What the machine's proof has dropped stands for that.
    if !bench.said.contains("ALARM:2") {
        figures.holds += 1;
        if !is_kept || bench.place != rest {
            figures.lost += 1;
            println!(
                "{state}, not {wanted}, {delay} ms into {lines:?}: {}",
                bench.told()
            );
        }
        match bench.slowed {
            // It stood, or came to the end of its way before the hold.
            None => assert!(bench.moved <= at + BYTE, "{lines:?}"),
            Some((slowed, from)) => figures.compare(
                slowed - at,
                (bench.moved + 1).saturating_sub(slowed),
                (rest[0] - from[0]).hypot(rest[1] - from[1]),
                promise,
            ),
        }
    }
    (bench.door, bench.input) = (false, true);
    bench.pass_for(60);
    bench.send(b"~");
    let mut all = lines.lines().count();
    bench.until(60_000, |bench| bench.answers() >= all);
    bench.until(60_000, |bench| {
        matches!(bench.state().as_str(), "Idle" | "Alarm")
    });
    if bench.said.contains("ALARM:2") {
        figures.dropped += 1;
        bench.send(b"$X\n");
        all += 1;
        bench.until(2000, |bench| bench.state() == "Idle");
    }
    assert_eq!(bench.answers(), all, "{}", bench.told());
    let alarms = bench.said.matches("ALARM").count();
    assert_eq!(
        alarms,
        bench.said.matches("ALARM:2").count(),
        "{}",
        bench.told()
    );
}

fn check(holds: u32) {
    let seed = 0x7472_6972_7272_0471;
    let figures = play(seed, holds);
    println!(
        "seed {seed:#x}: {} holds at random instants, {} lost, {} jobs dropped; slowed down within {} ms, {} with a promise, {:.4} of its \
         time and {:.4} of its way",
        figures.holds,
        figures.lost,
        figures.dropped,
        figures.byte,
        figures.promised,
        figures.time,
        figures.way
    );
    assert_eq!(figures.lost, 0);
    assert!(figures.byte <= BYTE);
    assert!(figures.promised > holds / 5, "{figures:?}");
    assert!(figures.time <= 1.0 && figures.way <= WAY, "{figures:?}");
}

/// A machine of slow ticks has no room for what a sender asks meanwhile: feed overrides, a hold that is repeated. A reset is heard all the same.
#[test]
fn a_reset_is_heard_behind_orders_that_the_tick_has_not_taken() {
    with_bench::<N, _>(&scene(), 1, |bench| {
        for period in [4, 10, 50] {
            bench.period = 1;
            bench.send(b"$X\nG90 G1 X250 Y245 F6000\n");
            bench.pass_for(3000);
            bench.period = period;
            for (bytes, wait) in [(&b"!"[..], 7), (b"!~!", 60), (&[0x94; 30], 2)] {
                bench.send(b"G1 X300 F300\n");
                bench.pass_for(500 * period as usize);
                bench.send(bytes);
                bench.pass_for(wait);
                bench.send(b"\x18");
                bench.pass_for(300 * period as usize);
                let place = bench.place;
                let state = bench.state();
                assert!(
                    state == "Idle" || state == "Alarm",
                    "{state} at {period} ms"
                );
                bench.pass_for(100 * period as usize);
                assert_eq!(bench.place, place, "it goes on at {period} ms");
                bench.send(b"$X\n");
                bench.pass_for(50 * period as usize);
            }
        }
    });
}

#[test]
fn holds_at_random_instants_are_none_lost() {
    check(12);
}

#[test]
#[ignore = "minutes; cargo xtask nightly runs it"]
fn a_thousand_holds_are_none_lost() {
    check(1000);
}
