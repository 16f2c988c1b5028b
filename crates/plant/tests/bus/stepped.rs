//! A bus that goes on from event to event, for a controller that is modelled by its registers.

use crate::bench::odrive;
use embedded_can::{Frame, Id, StandardId};
use trirrr_plant::bus::{BusFrame, ControllerEvent, Medium};

const BIT_NS: u64 = 1000;

fn medium() -> Medium<8> {
    Medium::new(1_000_000, [odrive(0), odrive(1), odrive(2)])
}

/// A frame that goes before all of the drives.
fn frame() -> BusFrame<8> {
    BusFrame::new(StandardId::ZERO, &[0x55; 8]).unwrap()
}

/// Events of a bus that carries `frame` as often as its controller can, for a millisecond.
fn events(medium: &mut Medium<8>) -> Vec<(u64, ControllerEvent<8>)> {
    let mut events = Vec::new();
    loop {
        medium.offer(Some(frame()));
        match medium.step(1_000_000) {
            Some(event) => events.push(event),
            None => return events,
        }
    }
}

#[test]
fn a_frame_that_is_offered_goes_out_in_its_bits() {
    let mut medium = medium();
    let sent = events(&mut medium);
    let duration_ns = frame().duration_ns(1_000_000);
    for (number, (at_ns, event)) in sent.iter().enumerate() {
        assert_eq!(*event, ControllerEvent::Sent(frame()));
        assert_eq!(*at_ns, (number as u64 + 1) * duration_ns);
    }
    assert_eq!(sent.len() as u64, 1_000_000 / duration_ns);
    assert!(medium.is_sending());
    // Nothing is offered: the drives have the wire, and the controller hears them.
    medium.offer(None);
    let mut heard = Vec::new();
    while let Some((_, event)) = medium.step(4_000_000) {
        match event {
            ControllerEvent::Received(frame) => heard.push(frame.id()),
            other => assert_eq!(other, ControllerEvent::Sent(frame())),
        }
    }
    for node in 1..=3 {
        let of = |id: &Id| matches!(id, Id::Standard(id) if id.as_raw() >> 5 == node);
        assert!(heard.iter().any(of), "{node}: {heard:?}");
    }
}

#[test]
fn faults_of_the_wire_are_told_apart() {
    let mut cut = medium();
    cut.faults.is_cut = true;
    let told = events(&mut cut);
    assert!(told.len() > 5);
    let missing = |(_, event): &(u64, _)| *event == ControllerEvent::NotAcknowledged;
    assert!(told.iter().all(missing), "{told:?}");

    let mut shorted = medium();
    shorted.faults.is_shorted = true;
    let told = events(&mut shorted);
    let wrong = |(_, event): &(u64, _)| *event == ControllerEvent::BitError;
    assert!(told.iter().all(wrong), "{told:?}");
    // Every attempt ends with its error frame, long before a frame would.
    assert_eq!(told[1].0 - told[0].0, 18 * BIT_NS);
}
