//! The truth of a case as the study has it, with what the study does not show: its events.

use trirrr_integrate::{Action, Direction, End, Integrator, Matrix, Method, System};
use trirrr_plant::{Plant, Refusal, control_of};
use trirrr_report::work_precision::cases::Case;
use trirrr_report::work_precision::{COMPARED_S, TRUTH, truth};

/// A plant that notes its events.
struct Noted<const N: usize> {
    plant: Plant<N>,
    events: Vec<(usize, f64)>,
}

impl<const N: usize> System<N> for Noted<N> {
    type Refusal = Refusal;
    fn derivative(&self, t: f64, y: &[f64; N], dy: &mut [f64; N]) -> Result<(), Refusal> {
        self.plant.derivative(t, y, dy)
    }
    fn scales(&self) -> [f64; N] {
        self.plant.scales()
    }
    fn jacobian(&self, t: f64, y: &[f64; N], jacobian: &mut Matrix<N>) -> Result<(), Refusal> {
        self.plant.jacobian(t, y, jacobian)
    }
    fn events(&self) -> usize {
        self.plant.events()
    }
    fn direction(&self, event: usize) -> Option<Direction> {
        self.plant.direction(event)
    }
    fn event_values(&self, t: f64, y: &[f64; N], values: &mut [f64]) {
        self.plant.event_values(t, y, values);
    }
    fn at_event(&mut self, event: usize, t: f64, y: &mut [f64; N]) -> Result<Action, Refusal> {
        self.events.push((event, t));
        self.plant.at_event(event, t, y)
    }
}

/// The plant of a case, its state at the start, and the end of its run in s.
pub(crate) fn build<const N: usize>(case: &Case) -> (Plant<N>, [f64; N], f64) {
    let scene = case.scene().unwrap();
    let control = control_of(&scene).unwrap();
    let settle_s = scene.plant.as_ref().map_or(0.0, |plant| plant.settle_s);
    let end = f64::from(scene.ticks()) / scene.tick_rate_hz + settle_s;
    let (plant, y) = Plant::build(&scene, control).unwrap();
    (plant, y, end)
}

/// The truth of a case.
pub(crate) struct Known {
    /// Poses every [`COMPARED_S`].
    pub(crate) poses: Vec<[f64; 3]>,
    /// Which event, and when in s.
    pub(crate) events: Vec<(usize, f64)>,
    /// When the run ends, s.
    pub(crate) end: f64,
}

/// A part of a run without events.
pub(crate) struct Phase {
    pub(crate) start: f64,
    pub(crate) end: f64,
    /// The events that end it; none at the end of the run.
    pub(crate) events: Vec<usize>,
}

impl Known {
    /// The parts of the run from event to event.
    pub(crate) fn phases(&self) -> Vec<Phase> {
        let mut phases = Vec::new();
        let mut start = 0.0;
        for together in self.events.chunk_by(|(_, one), (_, other)| one == other) {
            let end = together[0].1;
            phases.push(Phase {
                start,
                end,
                events: together.iter().map(|(event, _)| *event).collect(),
            });
            start = end;
        }
        if start < self.end {
            phases.push(Phase {
                start,
                end: self.end,
                events: Vec::new(),
            });
        }
        phases
    }
}

/// The truth of a case once more, as the study finds it, to the last bit.
pub(crate) fn known<const N: usize>(case: &Case) -> Known {
    let (plant, mut y, end) = build::<N>(case);
    let mut noted = Noted {
        plant,
        events: Vec::new(),
    };
    let method = Method::RadauIia { tolerance: TRUTH };
    let mut integrator = Integrator::new(&noted, method).unwrap();
    let mut poses = vec![[y[0], y[1], y[2]]];
    let mut t = 0.0;
    while t < end {
        let next = (poses.len() as f64 * COMPARED_S).min(end);
        match integrator
            .advance(&mut noted, t, &mut y, next, |_, _| {})
            .unwrap()
        {
            End::Reached => t = next,
            End::Stopped { t: stopped } => {
                t = stopped;
                break;
            }
        }
        poses.push([y[0], y[1], y[2]]);
    }
    let of_study = truth(&case.scene().unwrap()).unwrap();
    let of_study: Vec<[f64; 3]> = of_study.poses.iter().map(|(_, pose)| *pose).collect();
    assert_eq!(poses, of_study, "{}: not the study's truth", case.name);
    Known {
        poses,
        events: noted.events,
        end: t,
    }
}

/// Whether the study refuses a case.
pub(crate) fn refused(case: &Case) -> bool {
    truth(&case.scene().unwrap()).is_err()
}
