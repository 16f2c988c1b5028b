//! A machine without anything more. Its drives and its brake take their time, under gravity; parts of its scene are replaced.

use super::*;

/// Most acts on the way to a state in the short search.
const DEPTH: usize = 6;

struct PlainMachine(Bench<Thesis<f64>>);

impl Explored for PlainMachine {
    type Scene = Thesis<f64>;

    const ACTS: &'static [Act] = &[
        Act::Ask(Ask::Enable),
        Act::Ask(Ask::Disable),
        Act::Ask(Ask::Start),
        Act::Ask(Ask::Hold),
        Act::Ask(Ask::Resume),
        Act::Ask(Ask::Stop),
        Act::Ask(Ask::ClearFault),
        Act::Ask(Ask::Recover),
        Act::Ask(Ask::RecoverFar),
        Act::Ask(Ask::Offer),
        Act::Ask(Ask::OfferMoving),
        Act::Ask(Ask::Retarget),
        Act::Ask(Ask::Feed(50)),
        Act::Ask(Ask::Feed(100)),
        // Below what it takes to stand, and above.
        Act::Ask(Ask::Torque(Some(1e-3))),
        Act::Ask(Ask::Torque(Some(5.0))),
        Act::Ask(Ask::Torque(None)),
        Act::Ask(Ask::Gravity(-9.81)),
        Act::Fails(FaultCode::Drive(DriveFault::Reported)),
        Act::Fails(FaultCode::Overrun),
        Act::Ticks(1),
        Act::Ticks(7),
        Act::Silence,
    ];

    fn switched_on() -> Self {
        let scene = Adjustable::new(under(-2.0), LimitParameters::default());
        Self(Bench::with_room::<4>(scene, home(), timed_settings()))
    }

    fn bench(&mut self) -> &mut Bench<Thesis<f64>> {
        &mut self.0
    }

    fn tick(&mut self) -> Output<f64> {
        self.0.tick()
    }
}

#[test]
fn every_command_is_survivable_and_every_state_has_a_way_out() {
    // All but those of homing.
    assert_eq!(explore::<PlainMachine>(Some(DEPTH)).kinds.len(), 12);
    assert_taken(taken::PLAIN_MACHINE);
}

/// The search ends by itself: there are no other states.
#[test]
#[ignore = "takes minutes; cargo xtask nightly"]
fn all_states_are_explored() {
    assert!(explore::<PlainMachine>(None).deepest > DEPTH);
}
