//! A machine under way that is sent to goals, at rest and in motion, near and far: holds with a cut ahead, other goals in their place.

use super::*;

/// Most acts on the way to a state in the short search.
const DEPTH: usize = 4;

struct MovingMachine(Bench<Thesis<f64>>);

impl Explored for MovingMachine {
    type Scene = Thesis<f64>;

    const ACTS: &'static [Act] = &[
        Act::Ask(Ask::Start),
        Act::Ask(Ask::Hold),
        Act::Ask(Ask::Resume),
        Act::Ask(Ask::Stop),
        Act::Ask(Ask::Offer),
        Act::Ask(Ask::OfferMoving),
        Act::Ask(Ask::Retarget),
        Act::Ask(Ask::RetargetMoving { near: false }),
        Act::Ask(Ask::RetargetMoving { near: true }),
        Act::Ask(Ask::Feed(50)),
        Act::Ticks(1),
        Act::Ticks(7),
    ];

    const STARTS: &'static [&'static [Act]] = &[&[
        Act::Ask(Ask::Enable),
        Act::Ticks(7),
        Act::Ask(Ask::OfferMoving),
        Act::Ask(Ask::Start),
        Act::Ticks(20),
    ]];

    fn switched_on() -> Self {
        let scene = Adjustable::new(example(), LimitParameters::default());
        Self(Bench::with_room::<4>(scene, home(), timed_settings()))
    }

    fn bench(&mut self) -> &mut Bench<Thesis<f64>> {
        &mut self.0
    }

    fn tick(&mut self) -> Output<f64> {
        self.0.tick()
    }

    /// A cut that is ahead, and how it is worked on.
    fn world(&self) -> String {
        let service = &self.0.service;
        format!(
            "{} {}",
            service.foreground.cut_ahead(),
            service.background.retarget_phase()
        )
    }
}

#[test]
fn every_goal_in_motion_leads_on() {
    assert!(explore::<MovingMachine>(Some(DEPTH)).kinds.len() >= 4);
    assert_taken(taken::MOVING_MACHINE);
}

/// The search ends by itself: there are no other states.
#[test]
#[ignore = "takes minutes; cargo xtask nightly"]
fn all_states_of_goals_in_motion_are_explored() {
    assert!(explore::<MovingMachine>(None).deepest > DEPTH);
}
