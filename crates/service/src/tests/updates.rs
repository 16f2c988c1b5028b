//! Updates: when a step is taken, and how often.

use super::*;
use trirrr_protocol::message::{
    ImageBlock, ImageHeader, UpdateOutcome, UpdateRefusal, UpdateStatus, UpdateStep,
};

/// Slot that keeps what it was given, and takes blocks in their order.
#[derive(Debug, Default)]
struct KeptImage {
    steps: u32,
    bytes: Vec<u8>,
}

crate::scene! {
    /// The thesis machine, whose program a host may replace.
    Updated: Thesis<f32>, batches = On, update = KeptImage
}

impl ImageSlot for KeptImage {
    type Step = UpdateStep;

    fn step(&mut self, step: &UpdateStep) -> Result<(), UpdateRefusal> {
        self.steps += 1;
        let expected = self.bytes.len() as u32;
        match step {
            UpdateStep::Block(block) if block.offset != expected => {
                Err(UpdateRefusal::Block { expected })
            }
            UpdateStep::Block(block) => {
                self.bytes.extend(block.bytes());
                Ok(())
            }
            UpdateStep::Begin(_)
            | UpdateStep::BeginScene(_)
            | UpdateStep::Finish
            | UpdateStep::Restart => Ok(()),
        }
    }

    /// The steps stand for the checksum.
    fn status(&self) -> Option<UpdateStatus> {
        Some(UpdateStatus {
            start: 0,
            room: 0,
            coming: Some(self.steps),
            received: self.bytes.len() as u32,
            outcome: UpdateOutcome::Never,
            scene: None,
        })
    }
}

fn updated() -> Bench<Updated> {
    let scene = Adjustable::new(example(), LimitParameters::default());
    Bench::off(scene, home(), settings())
}

impl Bench<Updated> {
    /// Steps that the slot was given, and bytes that it has.
    fn given(&mut self) -> (u32, u32) {
        match self.ask(Command::UpdateStatus) {
            Reply::Update(UpdateStatus {
                coming: Some(steps),
                received,
                ..
            }) => (steps, received),
            other => panic!("{other:?}"),
        }
    }
}

fn block(offset: u32, bytes: &[u8]) -> Command<f32> {
    Command::Update(UpdateStep::Block(ImageBlock::new(offset, bytes)))
}

#[test]
fn a_step_is_taken_while_the_drives_are_off_and_once() {
    let mut bench = updated();
    let header = ImageHeader {
        start: 0,
        length: 8,
        checksum: 0,
        firmware: Firmware::SIMULATOR,
    };
    bench.done(Command::Update(UpdateStep::Begin(header)));
    bench.done(block(0, &[1, 2, 3, 4]));
    assert_eq!(bench.given(), (2, 4));
    // The same request again, as a host sends it that has not heard the answer.
    assert_eq!(bench.ask_as(1, block(0, &[1, 2, 3, 4])), Reply::Done);
    assert_eq!(bench.given(), (2, 4));
    let refused = bench.refused(block(0, &[1]));
    assert_eq!(
        refused,
        Refusal::Update(UpdateRefusal::Block { expected: 4 })
    );
    bench.done(Command::Enable);
    // From here on the machine is on its way to drives that are on.
    for _ in 0..3 {
        let refused = bench.refused(block(4, &[5, 6, 7, 8]));
        assert!(matches!(refused, Refusal::State(_)), "{refused:?}");
        bench.tick();
    }
    assert_eq!(bench.given(), (3, 4));
    bench.done(Command::Disable);
    bench.until(State::Disabled);
    bench.done(block(4, &[5, 6, 7, 8]));
    assert_eq!(bench.given(), (4, 8));
}

#[test]
fn a_program_that_is_not_replaced_says_so() {
    let mut bench = Bench::<Thesis<f32>>::new();
    for command in [
        Command::UpdateStatus,
        Command::Update(UpdateStep::Restart),
        block(0, &[0; 128]),
    ] {
        assert_eq!(bench.refused(command), Refusal::NoUpdate);
    }
    bench.done(Command::Disable);
    bench.until(State::Disabled);
    let refused = bench.refused(Command::Update(UpdateStep::Finish));
    assert_eq!(refused, Refusal::NoUpdate);
}

#[test]
fn an_image_for_another_chip_or_board_is_refused() {
    let text = |text: &str| {
        let mut bytes = [0; 32];
        bytes[..text.len()].copy_from_slice(text.as_bytes());
        bytes
    };
    let of = |board, chip| Firmware {
        board: text(board),
        chip: text(chip)[..16].try_into().expect("16 bytes"),
        ..Firmware::SIMULATOR
    };
    const START: u32 = 0x0802_0000;
    let own = of("generic-f405", "stm32f405rg");
    let check = |firmware, start| {
        let header = ImageHeader {
            start,
            length: 8,
            checksum: 0,
            firmware,
        };
        check_image(&header, &own, START)
    };
    assert_eq!(check(own, START), Ok(()));
    let other_chip = of("nucleo-g474re", "stm32g474re");
    assert_eq!(check(other_chip, START), Err(UpdateRefusal::Chip));
    // A board file of one's own may have the name of another.
    let same_name = of("generic-f405", "stm32g474re");
    assert_eq!(check(same_name, START), Err(UpdateRefusal::Chip));
    let other_board = of("feather-f405", "stm32f405rg");
    assert_eq!(check(other_board, START), Err(UpdateRefusal::Board));
    let expected = START;
    assert_eq!(
        check(own, 0x0800_4000),
        Err(UpdateRefusal::Start { expected })
    );
}
