//! The machines that are compared, and random ones of their kinds.

use crate::draws::Draws;
use crate::error::ReportError;
use trirrr_core::setpoint::Setpoint;
use trirrr_linkage::redundant::SliderState;
use trirrr_linkage::redundant::scene::{RedundantPlayer, RedundantScene};
use trirrr_scene::{JobPlayer, Scene};
use trirrr_truth::lagrange::{LagrangeMachine, LagrangeState};

/// Number of machines.
pub(super) const COUNT: usize = 8;

const ALL_LOADS: &str = "links, rotors, payload off centre, gravity, wrench";

/// A machine, the states of its job, and what random machines of its kind have.
pub(super) struct Variant {
    pub(super) name: &'static str,
    pub(super) loads: &'static str,
    pub(super) machine: LagrangeMachine,
    pub(super) job: Vec<LagrangeState>,
    /// Preload, N m.
    pub(super) wanted: Vec<f64>,
    /// Random machines have masses of links and rotors.
    links: bool,
    /// Random machines have gravity, a wrench, and a centre of mass off D.
    others: bool,
}

/// All machines.
///
/// # Errors
/// Refused: a scene of the program.
pub(super) fn all() -> Result<Vec<Variant>, ReportError> {
    let thesis = include_str!("../../../../scenes/thesis.toml");
    let mut all = Vec::with_capacity(COUNT);
    for (loads, text, links, others) in [
        ("massless links", thesis, false, false),
        (
            "links and rotors",
            include_str!("../../../../scenes/thesis-links.toml"),
            true,
            false,
        ),
        (
            ALL_LOADS,
            include_str!("../../../../scenes/vertical.toml"),
            true,
            true,
        ),
    ] {
        let scene = Scene::parse(text, "a scene of the 3-RRR").map_err(refused)?;
        let player = JobPlayer::new(&scene.job, scene.period_s());
        let sliders = [SliderState::at(0.0); 3];
        all.push(Variant {
            name: "3-RRR",
            loads,
            machine: LagrangeMachine::from(&scene.parameters),
            job: player.setpoints().map(|it| state(&it, &sliders)).collect(),
            wanted: vec![0.0; 3],
            links,
            others,
        });
    }
    for (name, text) in [
        (
            "4-RRR",
            include_str!("../../../../scenes/redundant/4rrr.toml"),
        ),
        (
            "6-RRR",
            include_str!("../../../../scenes/redundant/6rrr.toml"),
        ),
        (
            "PRRR+2RRR",
            include_str!("../../../../scenes/redundant/prrr-2rrr.toml"),
        ),
        (
            "2PRRR+RRR",
            include_str!("../../../../scenes/redundant/2prrr-rrr.toml"),
        ),
        (
            "3PRRR",
            include_str!("../../../../scenes/redundant/3prrr.toml"),
        ),
    ] {
        let scene = RedundantScene::parse_set(text, name, &[]).map_err(refused)?;
        let player = RedundantPlayer::new(&scene);
        let ticks = 0..=player.ticks();
        let job = ticks.map(|tick| state(&player.platform(tick), &player.sliders(tick)));
        let sliders = scene.sliders.iter();
        all.push(Variant {
            name,
            loads: ALL_LOADS,
            job: job.collect(),
            wanted: scene.preload_nm.clone(),
            machine: LagrangeMachine {
                legs: scene.legs.clone(),
                sliders: sliders.map(|it| it.map(|it| it.parameters())).collect(),
                platform: scene.platform,
                gravity: scene.gravity_m_s2,
                force: scene.wrench_force_n,
                moment: scene.wrench_torque_nm,
            },
            links: true,
            others: true,
        });
    }
    Ok(all)
}

fn refused(error: impl std::fmt::Display) -> ReportError {
    ReportError::Refused(error.to_string())
}

fn state(setpoint: &Setpoint<f64>, sliders: &[SliderState<f64>]) -> LagrangeState {
    let pose = &setpoint.pose;
    let pose = [pose.position.x, pose.position.y, pose.angle];
    let platform = [0, 1, 2].map(|axis: usize| {
        [
            pose[axis],
            setpoint.velocity[axis],
            setpoint.acceleration[axis],
        ]
    });
    let slider = |it: &SliderState<f64>| [it.position, it.velocity, it.acceleration];
    LagrangeState {
        platform,
        sliders: sliders.iter().map(slider).collect(),
    }
}

impl Variant {
    /// A machine like this one in a state near its job. Every length, mass, load, position, rate and acceleration differs.
    pub(super) fn random(&self, seed: u64) -> (LagrangeMachine, LagrangeState, Vec<f64>) {
        let mut draws = Draws(seed.wrapping_mul(0xd129_0cf7_63a1_9c35));
        let mut machine = self.machine.clone();
        for leg in &mut machine.legs {
            for length in [
                &mut leg.proximal_m,
                &mut leg.distal_m,
                &mut leg.joint_radius_m,
            ] {
                *length *= draws.within(0.9, 1.1);
            }
            leg.base_m.x += draws.around(0.02);
            leg.base_m.y += draws.around(0.02);
            leg.joint_angle_rad += draws.around(0.2);
            let own = if self.links { 1.0 } else { 0.0 };
            for (link, length) in [
                (&mut leg.proximal, leg.proximal_m),
                (&mut leg.distal, leg.distal_m),
            ] {
                link.mass_kg = own * draws.within(0.0, 0.3);
                link.com_m = own * length * draws.within(-0.2, 1.1);
                link.inertia_kgm2 = own * draws.within(0.0, 2e-3);
            }
            leg.rotor_inertia_kgm2 = own * draws.within(0.0, 2e-3);
        }
        for slider in machine.sliders.iter_mut().flatten() {
            slider.direction_rad += draws.around(1.0);
            slider.mass_kg = draws.within(0.0, 1.0);
        }
        let platform = &mut machine.platform;
        platform.mass_kg = draws.within(0.2, 1.5);
        platform.inertia_kgm2 = draws.within(1e-3, 1e-2);
        let others = if self.others { 1.0 } else { 0.0 };
        platform.com_m.x = others * draws.around(0.03);
        platform.com_m.y = others * draws.around(0.03);
        machine.gravity = [0; 2].map(|_| others * draws.around(10.0));
        machine.force = [0; 2].map(|_| others * draws.around(10.0));
        machine.moment = others * draws.around(1.0);

        let tick = draws.within(0.0, self.job.len() as f64) as usize;
        let mut state = self.job[tick.min(self.job.len() - 1)].clone();
        for (axis, sizes) in
            state
                .platform
                .iter_mut()
                .zip([[0.03, 1.0, 10.0], [0.03, 1.0, 10.0], [0.4, 4.0, 40.0]])
        {
            for (value, size) in axis.iter_mut().zip(sizes) {
                *value += draws.around(size);
            }
        }
        for slider in &mut state.sliders {
            for (value, size) in slider.iter_mut().zip([0.03, 0.5, 5.0]) {
                *value += draws.around(size);
            }
        }
        let wanted = self.wanted.iter().map(|_| draws.around(1.0)).collect();
        (machine, state, wanted)
    }
}
