//! A machine that plays power lists.

use super::*;

/// Most acts on the way to a state.
const DEPTH: usize = 5;

type ListedScene = super::super::levels::ListedScene<f64>;

struct ListedMachine(Bench<ListedScene>);

impl Explored for ListedMachine {
    type Scene = ListedScene;

    const ACTS: &'static [Act] = &[
        Act::Ask(Ask::Enable),
        Act::Ask(Ask::Start),
        Act::Ask(Ask::Hold),
        Act::Ask(Ask::Resume),
        Act::Ask(Ask::Stop),
        Act::Ask(Ask::ClearFault),
        Act::Ask(Ask::Recover),
        Act::Ask(Ask::Offer),
        Act::Ask(Ask::Levels),
        Act::Ask(Ask::Listed),
        Act::Ask(Ask::Retarget),
        Act::Fails(FaultCode::Drive(DriveFault::Reported)),
        Act::Ticks(1),
        Act::Ticks(7),
    ];

    const STARTS: &'static [&'static [Act]] = &[&[Act::Ask(Ask::Enable), Act::Ticks(7)]];

    fn switched_on() -> Self {
        let scene = Adjustable::new(example(), LimitParameters::default());
        let scene = SceneParts {
            levels: 128,
            ..scene.into()
        };
        Self(Bench::with_room::<4>(scene, home(), timed_settings()))
    }

    fn bench(&mut self) -> &mut Bench<ListedScene> {
        &mut self.0
    }

    fn tick(&mut self) -> Output<f64> {
        self.0.tick()
    }

    /// Levels that no move has, and the lists that wait: they tell states apart.
    fn world(&self) -> String {
        let levels = self.0.service.background.levels_waiting();
        format!("{levels:?}")
    }
}

#[test]
fn commands_with_levels_are_survivable_and_every_state_has_a_way_out() {
    // Those of a machine without homing, but for its way off.
    assert!(explore::<ListedMachine>(Some(DEPTH)).kinds.len() >= 9);
}
