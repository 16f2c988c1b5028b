//! The figures against time: which quantities of the record stand in which panel.

use trirrr_scene::record::Record;

/// One quantity of the record as a curve.
pub(super) struct Source {
    pub(super) label: &'static str,
    pub(super) value: fn(&Record) -> f64,
    /// Angles that jump by a turn where atan2 does: drawn without the jump.
    pub(super) unwrap: bool,
}

const fn curve(label: &'static str, value: fn(&Record) -> f64) -> Source {
    Source {
        label,
        value,
        unwrap: false,
    }
}

const fn angle(label: &'static str, value: fn(&Record) -> f64) -> Source {
    Source {
        label,
        value,
        unwrap: true,
    }
}

/// One panel of a figure.
pub(super) struct PanelSource {
    pub(super) quantity: &'static str,
    pub(super) unit: &'static str,
    /// The axis starts at zero, because the distance from zero matters.
    pub(super) from_zero: bool,
    pub(super) curves: &'static [Source],
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
    curves: &'static [Source],
) -> PanelSource {
    PanelSource {
        quantity,
        unit,
        from_zero: false,
        curves,
    }
}

const fn distances(quantity: &'static str, curves: &'static [Source]) -> PanelSource {
    PanelSource {
        quantity,
        unit: "",
        from_zero: true,
        curves,
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
                &[curve("x", |r| r.pose[0]), curve("y", |r| r.pose[1])],
            ),
            panel("orientation", "rad", &[curve("\u{3b1}", |r| r.pose[2])]),
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
                &[curve("x", |r| r.velocity[0]), curve("y", |r| r.velocity[1])],
            ),
            panel(
                "angular velocity",
                "rad/s",
                &[curve("\u{3b1}", |r| r.velocity[2])],
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
                    curve("x", |r| r.acceleration[0]),
                    curve("y", |r| r.acceleration[1]),
                ],
            ),
            panel(
                "angular acceleration",
                "rad/s\u{b2}",
                &[curve("\u{3b1}", |r| r.acceleration[2])],
            ),
        ],
    },
    FigureSource {
        file: "joint_angle.svg",
        title: "angles of the links",
        dynamic: false,
        panels: &[
            panel(
                "proximal links",
                "rad",
                &[
                    angle("leg 1", |r| r.legs[0].th1),
                    angle("leg 2", |r| r.legs[1].th1),
                    angle("leg 3", |r| r.legs[2].th1),
                ],
            ),
            panel(
                "distal links",
                "rad",
                &[
                    angle("leg 1", |r| r.legs[0].th2),
                    angle("leg 2", |r| r.legs[1].th2),
                    angle("leg 3", |r| r.legs[2].th2),
                ],
            ),
        ],
    },
    FigureSource {
        file: "joint_rate.svg",
        title: "angular velocities of the links",
        dynamic: false,
        panels: &[
            panel(
                "proximal links",
                "rad/s",
                &[
                    curve("leg 1", |r| r.legs[0].dth1),
                    curve("leg 2", |r| r.legs[1].dth1),
                    curve("leg 3", |r| r.legs[2].dth1),
                ],
            ),
            panel(
                "distal links",
                "rad/s",
                &[
                    curve("leg 1", |r| r.legs[0].dth2),
                    curve("leg 2", |r| r.legs[1].dth2),
                    curve("leg 3", |r| r.legs[2].dth2),
                ],
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
            &[
                curve("motor 1", |r| r.legs[0].torque),
                curve("motor 2", |r| r.legs[1].torque),
                curve("motor 3", |r| r.legs[2].torque),
            ],
        )],
    },
    FigureSource {
        file: "power.svg",
        title: "powers of the motors",
        dynamic: true,
        panels: &[panel(
            "power",
            "W",
            &[
                curve("motor 1", |r| r.legs[0].power),
                curve("motor 2", |r| r.legs[1].power),
                curve("motor 3", |r| r.legs[2].power),
                curve("sum", |r| r.legs.iter().map(|leg| leg.power).sum()),
            ],
        )],
    },
    FigureSource {
        file: "singularity.svg",
        title: "scale-free distances to singularity",
        dynamic: false,
        panels: &[
            distances(
                "serial",
                &[
                    curve("leg 1", |r| r.legs[0].serial),
                    curve("leg 2", |r| r.legs[1].serial),
                    curve("leg 3", |r| r.legs[2].serial),
                ],
            ),
            distances("parallel", &[curve("machine", |r| r.parallel)]),
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
pub(super) fn sources(torque: bool) -> impl Iterator<Item = &'static Source> {
    figures(torque)
        .flat_map(|figure| figure.panels)
        .flat_map(|panel| panel.curves)
}
