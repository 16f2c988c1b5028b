//! The figures against time: which quantities of the record stand in which panel.

use super::marks::{least, of_motors};
use trirrr_core::limits::LimitParameters;
use trirrr_figures::panel::LimitLine;
use trirrr_figures::style::{ANGLE, MOTORS, RGBColor, X, Y};
use trirrr_scene::record::{LegRecord, Record};

/// One quantity of the record as a curve.
pub(super) struct CurveSource {
    pub(super) label: &'static str,
    pub(super) value: fn(&Record) -> f64,
    pub(super) colour: RGBColor,
    /// Angles that jump by a turn where atan2 does: drawn without the jump.
    pub(super) unwrap: bool,
}

const fn curve(label: &'static str, colour: RGBColor, value: fn(&Record) -> f64) -> CurveSource {
    CurveSource {
        label,
        value,
        colour,
        unwrap: false,
    }
}

const fn angle(label: &'static str, colour: RGBColor, value: fn(&Record) -> f64) -> CurveSource {
    CurveSource {
        unwrap: true,
        ..curve(label, colour, value)
    }
}

/// A curve for each leg by the given function.
macro_rules! of_legs {
    ($make:ident, $names:ident, $value:expr) => {
        &[
            $make($names[0], MOTORS[0], |r| {
                let value: fn(&LegRecord) -> f64 = $value;
                value(&r.legs[0])
            }),
            $make($names[1], MOTORS[1], |r| {
                let value: fn(&LegRecord) -> f64 = $value;
                value(&r.legs[1])
            }),
            $make($names[2], MOTORS[2], |r| {
                let value: fn(&LegRecord) -> f64 = $value;
                value(&r.legs[2])
            }),
        ]
    };
}

/// Names of curves of motors and of the joints that they turn.
pub(super) const MOTOR_NAMES: [&str; 3] = ["motor 1", "motor 2", "motor 3"];
/// Names of curves of legs.
const LEG_NAMES: [&str; 3] = ["leg 1", "leg 2", "leg 3"];

/// One panel of a figure.
pub(super) struct PanelSource {
    pub(super) quantity: &'static str,
    pub(super) unit: &'static str,
    /// The axis starts at zero, because the distance from zero matters.
    pub(super) from_zero: bool,
    pub(super) curves: &'static [CurveSource],
    /// Limits of the curves.
    pub(super) limits: fn(&LimitParameters) -> Vec<LimitLine>,
}

/// One figure: its file, what its title says, its panels.
pub(super) struct FigureSource {
    pub(super) file: &'static str,
    pub(super) title: &'static str,
    /// Shows torques or powers: a scene that computes none has no such figure.
    pub(super) dynamic: bool,
    pub(super) panels: &'static [PanelSource],
}

const fn panel(
    quantity: &'static str,
    unit: &'static str,
    curves: &'static [CurveSource],
) -> PanelSource {
    PanelSource {
        quantity,
        unit,
        from_zero: false,
        curves,
        limits: |_| Vec::new(),
    }
}

impl PanelSource {
    const fn within(mut self, limits: fn(&LimitParameters) -> Vec<LimitLine>) -> Self {
        self.limits = limits;
        self
    }

    const fn with_zero(mut self) -> Self {
        self.from_zero = true;
        self
    }
}

/// The figures against time. Translation and rotation have panels of their own.
const FIGURES: &[FigureSource] = &[
    FigureSource {
        file: "pose.svg",
        title: "pose of the platform",
        dynamic: false,
        panels: &[
            panel(
                "position",
                "m",
                &[curve("x", X, |r| r.pose[0]), curve("y", Y, |r| r.pose[1])],
            ),
            panel(
                "orientation",
                "rad",
                &[curve("\u{3b1}", ANGLE, |r| r.pose[2])],
            ),
        ],
    },
    FigureSource {
        file: "velocity.svg",
        title: "velocity of the platform",
        dynamic: false,
        panels: &[
            panel(
                "velocity",
                "m/s",
                &[
                    curve("x", X, |r| r.velocity[0]),
                    curve("y", Y, |r| r.velocity[1]),
                ],
            ),
            panel(
                "angular velocity",
                "rad/s",
                &[curve("\u{3b1}", ANGLE, |r| r.velocity[2])],
            ),
        ],
    },
    FigureSource {
        file: "acceleration.svg",
        title: "acceleration of the platform",
        dynamic: false,
        panels: &[
            panel(
                "acceleration",
                "m/s\u{b2}",
                &[
                    curve("x", X, |r| r.acceleration[0]),
                    curve("y", Y, |r| r.acceleration[1]),
                ],
            ),
            panel(
                "angular acceleration",
                "rad/s\u{b2}",
                &[curve("\u{3b1}", ANGLE, |r| r.acceleration[2])],
            ),
        ],
    },
    FigureSource {
        file: "joint_angle.svg",
        title: "angles of the links",
        dynamic: false,
        panels: &[
            panel(
                "angle of the motors",
                "rad",
                of_legs!(angle, MOTOR_NAMES, |leg| leg.th1),
            ),
            panel(
                "angle of the distal links",
                "rad",
                of_legs!(angle, LEG_NAMES, |leg| leg.th2),
            ),
        ],
    },
    FigureSource {
        file: "joint_rate.svg",
        title: "angular velocities of the links",
        dynamic: false,
        panels: &[
            panel(
                "rate of the motors",
                "rad/s",
                of_legs!(curve, MOTOR_NAMES, |leg| leg.dth1),
            )
            .within(|limits| of_motors(limits.rate_rad_s)),
            panel(
                "rate of the distal links",
                "rad/s",
                of_legs!(curve, LEG_NAMES, |leg| leg.dth2),
            ),
        ],
    },
    FigureSource {
        file: "joint_acceleration.svg",
        title: "angular accelerations of the links",
        dynamic: false,
        panels: &[
            panel(
                "acceleration of the motors",
                "rad/s\u{b2}",
                of_legs!(curve, MOTOR_NAMES, |leg| leg.ddth1),
            )
            .within(|limits| of_motors(limits.acceleration_rad_s2)),
            panel(
                "acceleration of the distal links",
                "rad/s\u{b2}",
                of_legs!(curve, LEG_NAMES, |leg| leg.ddth2),
            ),
        ],
    },
    FigureSource {
        file: "torque.svg",
        title: "torques of the motors",
        dynamic: true,
        panels: &[panel(
            "torque",
            "N m",
            of_legs!(curve, MOTOR_NAMES, |leg| leg.torque),
        )
        .within(|limits| of_motors(limits.torque_nm))],
    },
    FigureSource {
        file: "power.svg",
        title: "powers of the motors",
        dynamic: true,
        panels: &[
            panel("power", "W", of_legs!(curve, MOTOR_NAMES, |leg| leg.power))
                .within(|limits| of_motors(limits.power_w)),
            panel(
                "sum of the powers",
                "W",
                &[curve("sum", ANGLE, |r| {
                    r.legs.iter().map(|leg| leg.power).sum()
                })],
            ),
        ],
    },
    FigureSource {
        file: "singularity.svg",
        title: "scale-free distances to singularity",
        dynamic: false,
        panels: &[
            panel(
                "serial distance",
                "",
                of_legs!(curve, LEG_NAMES, |leg| leg.serial),
            )
            .with_zero()
            .within(|limits| least(limits.serial_distance_min)),
            panel(
                "parallel distance",
                "",
                &[curve("machine", ANGLE, |r| r.parallel)],
            )
            .with_zero()
            .within(|limits| least(limits.parallel_distance_min)),
        ],
    },
];

/// Returns the figures of a scene with or without `torque`.
pub(super) fn figures(torque: bool) -> impl Iterator<Item = &'static FigureSource> {
    FIGURES
        .iter()
        .filter(move |figure| torque || !figure.dynamic)
}

/// Returns every curve, in the order of figures and panels.
pub(super) fn sources(torque: bool) -> impl Iterator<Item = &'static CurveSource> {
    figures(torque)
        .flat_map(|figure| figure.panels)
        .flat_map(|panel| panel.curves)
}
