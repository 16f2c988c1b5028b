//! Replaces the program of a board over its line, or the scene of a program that takes one.

use crate::describe::{self, Units};
use crate::dialogue::{Dialogue, Turn};
use crate::exchange::{Exchange, Patience};
use crate::scene_image::SceneImage;
use std::time::Duration;
use trirrr_protocol::message::{
    Command, Firmware, Hello, IMAGE_MARK, Identity, ImageBlock, ImageHeader, Message, PROTOCOL,
    Refusal, Reply, Request, SceneNeeds, Transmit, UpdateOutcome, UpdateRefusal, UpdateStatus,
    UpdateStep,
};
use trirrr_protocol::wire::{checksum_of_bytes, schema};
use trirrr_scene::{NumberType, in_number_type};

/// Time from the answer to a restart until the first hello: the board starts anew after a tenth of a second.
const RESTART: Duration = Duration::from_millis(500);

/// Longest wait for a board that installs an image, and goes back if it fails: eight erasures of 2 s, twice.
const INSTALLATION: Duration = Duration::from_secs(60);

/// Image of a board's program, as it lies in the flash.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProgramImage {
    header: ImageHeader,
    bytes: Vec<u8>,
}

impl ProgramImage {
    /// Image that begins at the address `start`. `None` if it has no label, or several: its scene has no `update` in `[service]`.
    pub fn new(start: u32, bytes: Vec<u8>) -> Option<Self> {
        let length = u32::try_from(bytes.len()).ok()?;
        let mut labels = bytes
            .windows(IMAGE_MARK.len())
            .enumerate()
            .filter(|(_, window)| *window == IMAGE_MARK);
        let (at, _) = labels.next()?;
        if labels.next().is_some() {
            return None;
        }
        let firmware = Firmware::of_bytes(bytes.get(at + IMAGE_MARK.len()..)?)?;
        let header = ImageHeader {
            start,
            length,
            checksum: checksum_of_bytes(&bytes),
            firmware,
        };
        Some(Self { header, bytes })
    }

    /// Description of the image.
    pub fn header(&self) -> &ImageHeader {
        &self.header
    }
}

/// Content that a client brings.
#[derive(Clone, Debug)]
enum Brought {
    Program(ProgramImage),
    Scene(SceneImage),
}

impl Brought {
    fn begin(&self) -> UpdateStep {
        match self {
            Self::Program(image) => UpdateStep::Begin(image.header),
            Self::Scene(scene) => UpdateStep::BeginScene(*scene.header()),
        }
    }

    fn checksum(&self) -> u32 {
        match self {
            Self::Program(image) => image.header.checksum,
            Self::Scene(scene) => scene.header().checksum,
        }
    }

    fn bytes(&self) -> &[u8] {
        match self {
            Self::Program(image) => &image.bytes,
            Self::Scene(scene) => scene.bytes(),
        }
    }

    /// Bytes: at most those of an image, whose length fits.
    fn length(&self) -> u32 {
        self.bytes().len() as u32
    }
}

/// Reason why the new program, or the new scene, does not run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum UpdateFailure<N: Transmit> {
    /// The machine refused a step.
    Refused(Refusal<N>),
    /// The machine speaks in messages of another layout.
    Layout,
    /// The machine runs the program of before: the new one failed, or was not installed.
    Reverted,
    /// The machine does not answer after the restart.
    Silent,
    /// The types of the machine's image lack this for the scene.
    Lacks(SceneNeeds),
    /// The machine runs another scene than that which was brought.
    OtherScene,
    /// The user has stopped the update.
    Stopped,
}

impl<N: Transmit> UpdateFailure<N> {
    /// Describes the failure, and what to do.
    pub fn describe(&self) -> String {
        match self {
            Self::Refused(Refusal::State(state)) => format!(
                "the machine takes it with its drives off alone, and it is {}: `trirrr disable` first",
                describe::state(*state, trirrr_protocol::message::Acting::Nothing)
            ),
            Self::Refused(refusal) => describe::refusal(refusal, 0, &Units::si(1.0)),
            Self::Lacks(needs) => {
                let needs: Vec<String> = needs
                    .iter()
                    .map(|need| format!("\n  {}", describe::scene_need(need)))
                    .collect();
                format!(
                    "the board's image lacks what the scene needs:{}\nmake them the same as in the scene of the image, or build an image from \
                     this scene and send it by `trirrr update`",
                    needs.concat()
                )
            }
            Self::OtherScene => "the board runs another scene after its restart: it could not build this one; send it again, by the trirrr of \
                 the version that the board runs"
                .into(),
            Self::Stopped => "ended by Ctrl-C".into(),
            Self::Layout => "the board's messages have another layout: update it by the trirrr of the version that it runs, or \
                 flash it with a probe"
                .into(),
            Self::Reverted => "the new program failed before this host could talk to it: the board is back at its program of before".into(),
            Self::Silent => format!(
                "the board does not answer within {} s of its restart: switch it off and on, and it goes back to its program of before",
                INSTALLATION.as_secs()
            ),
        }
    }
}

/// Part of the conversation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// The state of the machine's update is not known.
    Ask,
    /// Blocks go out; the next begins here.
    Send { next: u32 },
    /// The machine installs the image. A hello is due, and the wait ends.
    Restart { hello: Duration, end: Duration },
    /// The machine is back, and tells the outcome.
    Outcome,
}

/// Client that replaces a program, or a scene, without a port and a clock of its own.
#[derive(Clone, Debug)]
pub struct UpdateClient<N: Transmit> {
    exchange: Exchange<N>,
    brought: Brought,
    hello: Hello,
    phase: Phase,
    identity: Option<Identity>,
    /// Bytes that the machine has.
    received: u32,
    result: Option<Result<(), UpdateFailure<N>>>,
}

/// Keys of the messages' layout, in all number types.
fn layouts() -> impl Iterator<Item = u64> {
    NumberType::ALL
        .into_iter()
        .map(|number| in_number_type!(number, N => schema::key::<Request<N>, Message<N>>()))
}

impl<N: Transmit> UpdateClient<N> {
    /// Creates the client that brings `image`. Another conversation with the machine should have another number `conversation`.
    pub fn new(image: ProgramImage, patience: Patience, conversation: u32) -> Self {
        Self::bringing(Brought::Program(image), patience, conversation)
    }

    /// Creates the client that brings `scene` to a machine whose program takes one. The number `conversation` is as for
    /// [`new`](Self::new).
    pub fn of_scene(scene: SceneImage, patience: Patience, conversation: u32) -> Self {
        Self::bringing(Brought::Scene(scene), patience, conversation)
    }

    fn bringing(brought: Brought, patience: Patience, conversation: u32) -> Self {
        Self {
            exchange: Exchange::new(patience, conversation),
            brought,
            hello: Hello {
                protocol: PROTOCOL,
                schema: schema::key::<Request<N>, Message<N>>(),
                scene: 0,
            },
            phase: Phase::Ask,
            identity: None,
            received: 0,
            result: None,
        }
    }

    /// Returns the identity of the machine that answered last.
    pub fn identity(&self) -> Option<&Identity> {
        self.identity.as_ref()
    }

    /// Returns the bytes that the machine has, of how many.
    pub fn progress(&self) -> (u32, u32) {
        (self.received, self.brought.length())
    }

    /// Returns true once all of it is there, and the machine starts anew.
    pub fn is_restarting(&self) -> bool {
        matches!(self.phase, Phase::Restart { .. } | Phase::Outcome)
    }

    /// Asks for blocks, as many as may be in flight.
    fn send(&mut self, now: Duration) {
        while let Phase::Send { next } = self.phase
            && self.exchange.has_room()
            && let Some(rest) = self.brought.bytes().get(next as usize..)
            && !rest.is_empty()
        {
            let block = ImageBlock::new(next, rest);
            self.phase = Phase::Send {
                next: next + u32::from(block.count),
            };
            self.exchange
                .ask(Command::Update(UpdateStep::Block(block)), now);
        }
    }

    /// Goes on from the update as the machine has it.
    fn meet(&mut self, status: &UpdateStatus, now: Duration) {
        if self.phase == Phase::Outcome {
            self.result = Some(self.outcome(status));
            return;
        }
        if let Err(failure) = self.check_room(status) {
            self.result = Some(Err(failure));
            return;
        }
        let is_program = matches!(self.brought, Brought::Program(_));
        let is_sent = is_program && self.received == self.brought.length();
        if status.coming == Some(self.brought.checksum()) {
            self.from(status.received, now);
        } else if is_sent && status.outcome == UpdateOutcome::Requested {
            // The answer to the end was lost.
            self.exchange.ask(Command::Update(UpdateStep::Restart), now);
        } else {
            self.exchange
                .ask(Command::Update(self.brought.begin()), now);
        }
    }

    /// Result of a machine that has started anew.
    fn outcome(&self, status: &UpdateStatus) -> Result<(), UpdateFailure<N>> {
        match &self.brought {
            Brought::Program(_) => match status.outcome {
                UpdateOutcome::OnTrial | UpdateOutcome::Confirmed => Ok(()),
                UpdateOutcome::Never | UpdateOutcome::Requested | UpdateOutcome::Reverted => {
                    Err(UpdateFailure::Reverted)
                }
            },
            Brought::Scene(scene) => match &self.identity {
                Some(identity) if identity.scene == scene.key() => Ok(()),
                _ => Err(UpdateFailure::OtherScene),
            },
        }
    }

    /// Compares the types that a scene needs with those of the machine's image.
    fn check_room(&self, status: &UpdateStatus) -> Result<(), UpdateFailure<N>> {
        let Brought::Scene(scene) = &self.brought else {
            return Ok(());
        };
        let refused = |refusal| Err(UpdateFailure::Refused(Refusal::Update(refusal)));
        let Some(room) = &status.scene else {
            return refused(UpdateRefusal::NoScene);
        };
        let lacks = room.types.lacks(&scene.header().types);
        if lacks != SceneNeeds::default() {
            return Err(UpdateFailure::Lacks(lacks));
        }
        if room.layout != scene.header().layout {
            return refused(UpdateRefusal::SceneLayout);
        }
        Ok(())
    }

    /// Sends the bytes from `received` on.
    fn from(&mut self, received: u32, now: Duration) {
        self.received = received;
        self.phase = Phase::Send { next: received };
        if received >= self.brought.length() {
            self.exchange.ask(Command::Update(UpdateStep::Finish), now);
        }
    }

    fn go_on(&mut self, done: &Command<N>, now: Duration) {
        let Command::Update(step) = done else {
            return;
        };
        match step {
            UpdateStep::Begin(_) | UpdateStep::BeginScene(_) => self.from(0, now),
            UpdateStep::Block(block) => {
                self.received = block.offset + u32::from(block.count);
                if self.received >= self.brought.length() {
                    self.exchange.ask(Command::Update(UpdateStep::Finish), now);
                }
            }
            UpdateStep::Finish => self.exchange.ask(Command::Update(UpdateStep::Restart), now),
            UpdateStep::Restart => {
                self.identity = None;
                self.phase = Phase::Restart {
                    hello: now + RESTART,
                    end: now + INSTALLATION,
                };
            }
        }
    }

    fn refused(&mut self, refusal: Refusal<N>, now: Duration) {
        match refusal {
            // Another number type than this program's, or than that of the program before.
            Refusal::Schema { expected } if expected != self.hello.schema => {
                match layouts().any(|known| known == expected) {
                    true => {
                        self.hello.schema = expected;
                        self.exchange.greet(self.hello, now);
                    }
                    false => self.result = Some(Err(UpdateFailure::Layout)),
                }
            }
            Refusal::Schema { .. } | Refusal::Protocol { .. } => {
                self.result = Some(Err(UpdateFailure::Layout))
            }
            // A board that was switched off meanwhile has forgotten the image.
            Refusal::HelloFirst | Refusal::Update(UpdateRefusal::NotBegun) => self.reconnected(),
            other => self.result = Some(Err(UpdateFailure::Refused(other))),
        }
    }
}

impl<N: Transmit> Dialogue<N> for UpdateClient<N> {
    /// The new program, or the new scene, runs, or the reason why not.
    type End = Result<(), UpdateFailure<N>>;

    fn poll(&mut self, now: Duration) -> Turn<N, Self::End> {
        if let Some(result) = self.result {
            return Turn::Done(result);
        }
        match self.phase {
            Phase::Restart { hello, .. } if now < hello => return Turn::Wait(hello),
            _ if self.identity.is_none() && self.exchange.open().next().is_none() => {
                self.exchange.greet(self.hello, now);
            }
            Phase::Send { .. } => self.send(now),
            _ => {}
        }
        match (self.exchange.poll(now), self.phase) {
            (Turn::Done(()), _) => Turn::Wait(now),
            (Turn::Reconnect, Phase::Restart { end, .. }) if now < end => {
                self.exchange.greet(self.hello, now);
                Turn::Wait(now)
            }
            (Turn::Reconnect, Phase::Restart { .. }) => {
                self.result = Some(Err(UpdateFailure::Silent));
                Turn::Wait(now)
            }
            (turn, _) => turn.map(Ok),
        }
    }

    fn receive(&mut self, message: &Message<N>, now: Duration) {
        let Some((request, reply)) = self.exchange.receive(message) else {
            return;
        };
        match reply {
            Reply::Hello(identity) => {
                self.identity = Some(identity);
                if let Phase::Restart { .. } = self.phase {
                    self.phase = Phase::Outcome;
                }
                self.exchange.ask(Command::UpdateStatus, now);
            }
            Reply::Update(status) => self.meet(&status, now),
            Reply::Done => self.go_on(&request.command, now),
            // The answer to the restart was lost, and the machine has started anew.
            Reply::Refused(Refusal::HelloFirst)
                if request.command == Command::Update(UpdateStep::Restart) =>
            {
                self.go_on(&request.command, now);
            }
            Reply::Refused(refusal) => self.refused(refusal, now),
            _ => {}
        }
    }

    /// The board's part of the image waits for another client.
    fn stop(&mut self) {
        self.result = Some(Err(UpdateFailure::Stopped));
    }

    /// What the machine has of the image is not sent again.
    fn reconnected(&mut self) {
        self.exchange.forget();
        self.identity = None;
        if let Phase::Send { .. } = self.phase {
            self.phase = Phase::Ask;
        }
    }
}

/// Machine of a test, as an update sees it.
#[cfg(test)]
pub(crate) trait OtherEnd {
    /// Answers a command.
    fn answer(&mut self, command: &Command<f64>) -> Reply<f64>;

    /// Returns true once the talk is over for the test.
    fn is_enough(&self) -> bool {
        false
    }
}

/// Lets both talk until the end, or until the test has enough.
#[cfg(test)]
pub(crate) fn talk(
    client: &mut UpdateClient<f64>,
    machine: &mut impl OtherEnd,
) -> Option<Result<(), UpdateFailure<f64>>> {
    let mut now = Duration::ZERO;
    for _ in 0..1000 {
        match client.poll(now) {
            Turn::Send(request) => {
                let message = Message::Reply {
                    sequence: request.sequence,
                    reply: machine.answer(&request.command),
                };
                client.receive(&message, now);
            }
            Turn::Wait(until) => now = until.max(now + Duration::from_millis(1)),
            Turn::Reconnect => panic!("the machine answers"),
            Turn::Done(result) => return Some(result),
        }
        if machine.is_enough() {
            return None;
        }
    }
    panic!("no end");
}

#[cfg(test)]
mod tests {
    use super::*;
    use trirrr_protocol::message::BLOCK;

    fn image(bytes: usize) -> ProgramImage {
        let mut content = vec![0x5A; bytes];
        let firmware = Firmware::new("0.2.0", "13154213b7", "feather-f405", "stm32f405rg");
        content[512..528].copy_from_slice(IMAGE_MARK);
        for (at, text) in [
            (528, &firmware.version[..]),
            (544, &firmware.commit),
            (560, &firmware.board),
            (592, &firmware.chip),
        ] {
            content[at..at + text.len()].copy_from_slice(text);
        }
        ProgramImage::new(0x0802_0000, content).expect("an image with a label")
    }

    #[test]
    fn an_image_tells_its_build_by_one_label() {
        let image = image(1000);
        let firmware = Firmware::new("0.2.0", "13154213b7", "feather-f405", "stm32f405rg");
        assert_eq!(image.header().firmware, firmware);
        assert_eq!(image.header().length, 1000);
        assert_eq!(ProgramImage::new(0, vec![0x5A; 1000]), None);
        let twice = [image.bytes.clone(), image.bytes.clone()].concat();
        assert_eq!(ProgramImage::new(0, twice), None);
        // Cut off in the label.
        assert_eq!(ProgramImage::new(0, image.bytes[..600].to_vec()), None);
    }

    /// A machine as the client sees it: what it has of the image, and what it answers.
    #[derive(Default)]
    struct Answering {
        received: u32,
        coming: Option<u32>,
        blocks: u32,
        /// Blocks after which the talk is over.
        most: u32,
        outcome: Option<UpdateOutcome>,
    }

    impl OtherEnd for Answering {
        fn answer(&mut self, command: &Command<f64>) -> Reply<f64> {
            match command {
                Command::Hello(_) => Reply::Hello(crate::exchange::identity_of_tests(300)),
                Command::UpdateStatus => Reply::Update(UpdateStatus {
                    start: 0x0802_0000,
                    room: 1 << 18,
                    coming: self.coming,
                    received: self.received,
                    outcome: self.outcome.unwrap_or(UpdateOutcome::Never),
                    scene: None,
                }),
                Command::Update(UpdateStep::Begin(header)) => {
                    (self.coming, self.received) = (Some(header.checksum), 0);
                    Reply::Done
                }
                Command::Update(UpdateStep::Block(block)) if block.offset == self.received => {
                    self.received += u32::from(block.count);
                    self.blocks += 1;
                    Reply::Done
                }
                Command::Update(UpdateStep::Finish | UpdateStep::Restart) => Reply::Done,
                other => panic!("{other:?}"),
            }
        }

        fn is_enough(&self) -> bool {
            self.blocks == self.most
        }
    }

    #[test]
    fn an_image_goes_on_where_the_line_was_lost() {
        let mut client = UpdateClient::new(image(1000), Patience::default(), 7);
        let mut machine = Answering {
            most: 3,
            outcome: Some(UpdateOutcome::Confirmed),
            ..Answering::default()
        };
        assert_eq!(talk(&mut client, &mut machine), None);
        assert_eq!(client.progress(), (3 * BLOCK as u32, 1000));
        client.reconnected();
        machine.most = u32::MAX;
        assert_eq!(talk(&mut client, &mut machine), Some(Ok(())));
        assert_eq!((machine.received, machine.blocks), (1000, 8));
    }

    #[test]
    fn a_board_that_went_back_is_told() {
        let mut client = UpdateClient::new(image(1000), Patience::default(), 7);
        let mut machine = Answering {
            most: u32::MAX,
            outcome: Some(UpdateOutcome::Reverted),
            ..Answering::default()
        };
        let result = talk(&mut client, &mut machine);
        assert_eq!(result, Some(Err(UpdateFailure::Reverted)));
    }

    #[test]
    fn a_board_of_another_layout_is_refused_and_one_of_another_number_is_not() {
        let mut client = UpdateClient::<f64>::new(image(1000), Patience::default(), 7);
        let refuse = |client: &mut UpdateClient<f64>, expected| {
            let Turn::Send(request) = client.poll(Duration::ZERO) else {
                panic!("a hello");
            };
            let reply = Reply::Refused(Refusal::Schema { expected });
            client.receive(
                &Message::Reply {
                    sequence: request.sequence,
                    reply,
                },
                Duration::ZERO,
            );
        };
        let fixed =
            in_number_type!(NumberType::Fixed, N => schema::key::<Request<N>, Message<N>>());
        refuse(&mut client, fixed);
        let Turn::Send(Request {
            command: Command::Hello(hello),
            ..
        }) = client.poll(Duration::ZERO)
        else {
            panic!("another hello");
        };
        assert_eq!(hello.schema, fixed);
        let mut client = UpdateClient::<f64>::new(image(1000), Patience::default(), 7);
        refuse(&mut client, 1);
        assert_eq!(
            client.poll(Duration::ZERO),
            Turn::Done(Err(UpdateFailure::Layout))
        );
    }
}
