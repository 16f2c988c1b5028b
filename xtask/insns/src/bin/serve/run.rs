//! The program: the job twice, every tick of the service counted.

use super::counter;
use core::hint::black_box;
use semihosting::{println, process};
use trirrr_image::Checksum;
#[cfg(homing)]
use trirrr_image::RuledSwitches;
#[cfg(homing)]
use trirrr_insns::scene::HOMING;
use trirrr_insns::scene::{MOVES, SETTINGS, Scalar};
use trirrr_insns::service::{
    CountedScene, SceneBackground, SceneChannels, SceneCommand, SceneReply, Ticking, offered,
    scene, settings, start, tick,
};
#[cfg(drive = "odrive")]
use trirrr_protocol::message::Recovery;
use trirrr_protocol::message::{Command, Hello, Move, PROTOCOL, Reply, Request, State};
use trirrr_service::Channels;
use trirrr_service::board::command_of;

/// In the second run, a hold and a resume take turns after so many ticks: a prime, so that they
/// come everywhere on the moves.
const TURN: u32 = 37;

/// Stands in for [`tick`]: what a call and the counter's own reading cost.
#[inline(never)]
fn empty(_: &mut Ticking) {}

/// Counts one call through a pointer that the compiler cannot see through.
#[inline(never)]
fn count(function: fn(&mut Ticking), ticking: &mut Ticking) -> u32 {
    let before = counter::now();
    function(ticking);
    counter::elapsed(before, counter::now())
}

/// A host that sits in the same image.
struct Host {
    background: SceneBackground,
    sequence: u32,
    /// Moves of the job that were offered,
    offered: usize,
    /// and their number at the machine.
    number: u32,
}

impl Host {
    fn ask(&mut self, command: SceneCommand) -> SceneReply {
        let sequence = self.sequence;
        // None is repeated, so any checksum will do.
        let reply = self
            .background
            .answer(&Request { sequence, command }, sequence);
        self.sequence = match &reply {
            Reply::Hello(identity) => identity.next_sequence,
            _ => sequence.wrapping_add(1),
        };
        reply
    }

    fn done(&mut self, command: SceneCommand) {
        let reply = self.ask(command);
        if !matches!(reply, Reply::Done | Reply::Hello(_)) {
            counter::fail(format_args!("{command:?}: {reply:?}"));
        }
    }

    /// Gives a sign of life, and takes what there is to hear.
    #[cfg(homing)]
    fn listen(&mut self) {
        self.ask(Command::Status);
        while self.background.step() {}
        while self.background.outgoing().is_some() {}
    }

    /// Gives a sign of life, offers what there is room for, and lets it be judged.
    fn feed(&mut self) {
        self.ask(Command::Status);
        while self.offered < MOVES.len() && self.background.status().room > 0 {
            self.done(command_of::<CountedScene>(&offered(
                self.offered,
                self.number,
            )));
            self.offered += 1;
            self.number = self.number.wrapping_add(1);
        }
        while self.background.step() {}
        if let Some(refused) = self.background.status().refused {
            counter::fail(format_args!("{refused:?}"));
        }
        while self.background.outgoing().is_some() {}
    }
}

/// Homes the machine, every tick counted, with switches that close by rule.
#[cfg(homing)]
fn home(ticking: &mut Ticking, host: &mut Host) {
    let mut switches = RuledSwitches::new(&HOMING);
    host.done(Command::Home);
    loop {
        ticking.closed = switches.closed(&ticking.foreground.output().motors);
        counter::announce();
        let counted = count(black_box(tick), ticking);
        if let Some(by) = ticking.foreground.shift() {
            switches.shift(by);
        }
        println!("homing {counted}");
        host.listen();
        match ticking.foreground.state() {
            State::Homing | State::Recovering => {}
            State::Idle => return,
            state => counter::fail(format_args!("{state:?} in the end of homing")),
        }
    }
}

/// Brings a machine that was measured to the start of its job, in the bits.
#[cfg(drive = "odrive")]
fn go_to_start(ticking: &mut Ticking, host: &mut Host) {
    host.done(Command::Recover(Recovery {
        to: start(),
        ticks: 100,
    }));
    loop {
        count(black_box(tick), ticking);
        host.ask(Command::Status);
        while host.background.step() {}
        while host.background.outgoing().is_some() {}
        match ticking.foreground.state() {
            State::Recovering => {}
            State::Idle => return,
            state => counter::fail(format_args!("{state:?} on the way to the start")),
        }
    }
}

/// The whole program.
pub(crate) fn run() -> ! {
    counter::start();
    // They live as long as the program does.
    let mut channels: SceneChannels = Channels::new();
    let channels: *mut SceneChannels = &raw mut channels;
    // SAFETY: this function never returns, and nobody else has the pointer.
    #[allow(unsafe_code)]
    let channels: &'static mut SceneChannels = unsafe { &mut *channels };
    let halves = channels.split(scene(), start(), settings());
    let (foreground, background) = halves.unwrap_or_else(|error| counter::fail(error));
    let mut ticking = Ticking::new(foreground);
    let mut host = Host {
        background,
        sequence: 0,
        offered: 0,
        number: 0,
    };
    host.done(Command::Hello(Hello {
        protocol: PROTOCOL,
        schema: SETTINGS.scene.schema,
        scene: 0,
    }));
    host.done(Command::Enable);
    while matches!(
        ticking.foreground.state(),
        State::Disabled | State::Enabling
    ) {
        count(black_box(tick), &mut ticking);
        // The background finds the pose of drives that tell where they are.
        while host.background.step() {}
    }
    #[cfg(drive = "odrive")]
    go_to_start(&mut ticking, &mut host);
    println!("empty {}", count(black_box(empty), &mut ticking));

    #[cfg(homing)]
    home(&mut ticking, &mut host);
    let mut checksum = Checksum::default();
    host.feed();
    host.done(Command::Start);
    loop {
        counter::announce();
        let counted = count(black_box(tick), &mut ticking);
        if ticking.foreground.state() == State::Idle {
            break;
        }
        println!("tick {counted}");
        checksum.add(&ticking.foreground.output().motors);
        host.feed();
    }

    // Back to the start, and the job again.
    let end = host.background.status().end;
    let pose = end.map_or(start(), |end| end.pose);
    let back = Move {
        to: start(),
        from: pose,
        start_velocity: [0.0; 3].map(<Scalar as trirrr_core::number::Arithmetic>::from_f64),
        end_velocity: [0.0; 3].map(<Scalar as trirrr_core::number::Arithmetic>::from_f64),
        ticks: 10 * offered(0, 0).common().ticks.max(100),
        ..*offered(0, host.number).common()
    };
    host.done(Command::Move(back));
    host.number = host.number.wrapping_add(1);
    host.offered = 0;
    host.feed();
    host.done(Command::Start);
    let mut since = 0;
    loop {
        counter::announce();
        let counted = count(black_box(tick), &mut ticking);
        if ticking.foreground.state() == State::Idle {
            break;
        }
        println!("held {counted}");
        host.feed();
        since += 1;
        if since == TURN {
            since = 0;
            // Refused near the end, where the job is over; that is no matter here.
            let command = match host.background.status().state {
                State::Holding => Command::Resume,
                _ => Command::Hold,
            };
            host.ask(command);
        }
    }
    println!("bits {:016x}", checksum.value());
    process::exit(0)
}
