//! Columns of `ticks.csv`: those of a 3-RRR for the legs there are, then torques of least norm, joint forces and sliders.

use super::RedundantScene;
use super::record::{RedundantLegRecord, RedundantRecord, SliderRecord};

type OfLeg = (&'static str, fn(&RedundantLegRecord) -> f64);
type OfSlider = (&'static str, fn(&SliderRecord) -> f64);

/// Names and values of the columns of a leg, in groups, of which each has a column for each leg.
const OF_LEGS: [OfLeg; 17] = [
    ("th1_", |leg| leg.leg.th1),
    ("dth1_", |leg| leg.leg.dth1),
    ("ddth1_", |leg| leg.leg.ddth1),
    ("tau", |leg| leg.leg.torque),
    ("P", |leg| leg.leg.power),
    ("th2_", |leg| leg.leg.th2),
    ("dth2_", |leg| leg.leg.dth2),
    ("ddth2_", |leg| leg.leg.ddth2),
    ("D", |leg| leg.leg.cross),
    ("serial", |leg| leg.leg.serial),
    ("tau_least", |leg| leg.least_torque),
    ("FAx", |leg| leg.joints[0][0]),
    ("FAy", |leg| leg.joints[0][1]),
    ("FBx", |leg| leg.joints[1][0]),
    ("FBy", |leg| leg.joints[1][1]),
    ("FCx", |leg| leg.joints[2][0]),
    ("FCy", |leg| leg.joints[2][1]),
];

/// Names and values of the columns of a slider; there is one for each leg with a slider.
const OF_SLIDERS: [OfSlider; 5] = [
    ("s", |slider| slider.position),
    ("ds", |slider| slider.velocity),
    ("dds", |slider| slider.acceleration),
    ("Fs", |slider| slider.force),
    ("Ps", |slider| slider.power),
];

const OF_PLATFORM: [&str; 10] = [
    "t", "x", "y", "alpha", "vx", "vy", "valpha", "ax", "ay", "aalpha",
];
const OF_MACHINE: [&str; 3] = ["parallel", "tau_norm", "tau_least_norm"];

/// Returns the columns of the machine of `scene`.
pub fn columns(scene: &RedundantScene) -> Vec<String> {
    let mut names: Vec<String> = OF_PLATFORM.map(str::to_owned).into();
    for (stem, _) in OF_LEGS {
        names.extend((1..=scene.legs.len()).map(|leg| format!("{stem}{leg}")));
    }
    for (stem, _) in OF_SLIDERS {
        let legs = scene.slider_legs().into_iter();
        names.extend(legs.map(|leg| format!("{stem}{}", leg + 1)));
    }
    names.extend(OF_MACHINE.map(str::to_owned));
    names
}

/// Returns the values of a row, in the order of [`columns`].
pub fn row(record: &RedundantRecord) -> Vec<f64> {
    let mut values = vec![record.t];
    for triple in [record.pose, record.velocity, record.acceleration] {
        values.extend(triple);
    }
    for (_, value) in OF_LEGS {
        values.extend(record.legs.iter().map(value));
    }
    for (_, value) in OF_SLIDERS {
        let sliders = record.legs.iter().filter_map(|leg| leg.slider.as_ref());
        values.extend(sliders.map(value));
    }
    values.extend([record.parallel, record.torque_norm(), record.least_norm()]);
    values
}
