//! The figures of a job against time: which quantities of the record stand in which panel.

use super::job::{DrawnJob, least, of_motors};
use crate::tick_record::AnyTick;
use trirrr_figures::chart::{Chart, Figure, Series};
use trirrr_figures::style::{ANGLE, X, Y};
use trirrr_linkage::redundant::scene::{RedundantLegRecord, RedundantRecord, SliderRecord};
use trirrr_scene::record::LegRecord;

type TickSeries = Series<AnyTick>;
type TickChart = Chart<AnyTick>;

/// Value of a quantity of a redundant machine; a gap in the curve of another.
fn more(record: &AnyTick, value: impl Fn(&RedundantRecord) -> f64) -> f64 {
    record.redundant().map_or(f64::NAN, value)
}

/// Place, velocity or acceleration of the platform, by its number. Translation and rotation have panels of their own.
fn platform(
    number: usize,
    [along, unit]: [&'static str; 2],
    [about, unit_about]: [&'static str; 2],
) -> [TickChart; 2] {
    let axis = |label, axis: usize, colour| {
        let value = move |record: &AnyTick| record.platform()[number][axis];
        TickSeries::new(label, value).coloured(colour)
    };
    [
        Chart::new(along, unit, [axis("x", 0, X), axis("y", 1, Y)]),
        Chart::new(about, unit_about, [axis("\u{3b1}", 2, ANGLE)]),
    ]
}

impl DrawnJob {
    /// A curve for each motor, or for each leg.
    fn each(&self, thing: &str, value: fn(&LegRecord) -> f64) -> Vec<TickSeries> {
        Series::numbered(thing, self.legs, move |record: &AnyTick, index| {
            value(record.leg(index))
        })
    }

    /// A curve for each leg of a redundant machine.
    fn each_more(&self, value: fn(&RedundantLegRecord) -> f64) -> Vec<TickSeries> {
        Series::numbered("leg", self.legs, move |record: &AnyTick, index| {
            more(record, |it| value(&it.legs[index]))
        })
    }

    /// A curve for each slider.
    fn sliders(&self, value: fn(&SliderRecord) -> f64) -> Vec<TickSeries> {
        let series = |&leg: &usize| {
            let value = move |record: &AnyTick| {
                more(record, |it| it.legs[leg].slider.as_ref().map_or(0.0, value))
            };
            Series::new(format!("slider {}", leg + 1), value)
        };
        self.sliders.iter().map(series).collect()
    }

    /// Figures against time.
    pub(super) fn figures(&self) -> Vec<Figure<AnyTick>> {
        let limits = &self.limits;
        let mut figures = vec![
            Figure::new(
                "pose.svg",
                "pose of the platform",
                platform(0, ["position", "m"], ["orientation", "rad"]),
            ),
            Figure::new(
                "velocity.svg",
                "velocity of the platform",
                platform(1, ["velocity", "m/s"], ["angular velocity", "rad/s"]),
            ),
            Figure::new(
                "acceleration.svg",
                "acceleration of the platform",
                platform(
                    2,
                    ["acceleration", "m/s\u{b2}"],
                    ["angular acceleration", "rad/s\u{b2}"],
                ),
            ),
            Figure::new(
                "joint_angle.svg",
                "angles of the links",
                [
                    ("angle of the motors", self.each("motor", |leg| leg.th1)),
                    ("angle of the distal links", self.each("leg", |leg| leg.th2)),
                ]
                .map(|(quantity, angles)| {
                    Chart::new(quantity, "rad", angles.into_iter().map(Series::unwrapped))
                }),
            ),
            Figure::new(
                "joint_rate.svg",
                "angular velocities of the links",
                [
                    Chart::new(
                        "rate of the motors",
                        "rad/s",
                        self.each("motor", |leg| leg.dth1),
                    )
                    .within(of_motors(limits.rate_rad_s.as_ref())),
                    Chart::new(
                        "rate of the distal links",
                        "rad/s",
                        self.each("leg", |leg| leg.dth2),
                    ),
                ],
            ),
            Figure::new(
                "joint_acceleration.svg",
                "angular accelerations of the links",
                [
                    Chart::new(
                        "acceleration of the motors",
                        "rad/s\u{b2}",
                        self.each("motor", |leg| leg.ddth1),
                    )
                    .within(of_motors(limits.acceleration_rad_s2.as_ref())),
                    Chart::new(
                        "acceleration of the distal links",
                        "rad/s\u{b2}",
                        self.each("leg", |leg| leg.ddth2),
                    ),
                ],
            ),
        ];
        if self.torque {
            figures.extend(self.loads());
        }
        let parallel = TickSeries::new("machine", |record| record.parallel()).coloured(ANGLE);
        figures.push(Figure::new(
            "singularity.svg",
            "scale-free distances to singularity",
            [
                Chart::new("serial distance", "", self.each("leg", |leg| leg.serial))
                    .within(least(limits.serial_distance_min)),
                Chart::new("parallel distance", "", [parallel])
                    .within(least(limits.parallel_distance_min)),
            ]
            .map(Chart::with_zero),
        ));
        if !self.sliders.is_empty() {
            let charts = [
                Chart::new("position", "m", self.sliders(|slider| slider.position)),
                Chart::new("velocity", "m/s", self.sliders(|slider| slider.velocity)),
                Chart::new("force", "N", self.sliders(|slider| slider.force)),
                Chart::new("power", "W", self.sliders(|slider| slider.power)),
            ];
            figures.push(Figure::new("slider.svg", "sliders", charts));
        }
        figures
    }

    /// Figures of torques, powers and forces.
    fn loads(&self) -> Vec<Figure<AnyTick>> {
        let limits = &self.limits;
        let torque = Chart::new("torque", "N m", self.each("motor", |leg| leg.torque))
            .within(of_motors(limits.torque_nm.as_ref()));
        let mut torques = vec![torque];
        // With more than three legs many sets of torques give one motion.
        if self.legs > 3 {
            let least = self.each_more(|leg| leg.least_torque);
            torques.push(Chart::new("least norm", "N m", least));
            let norms = [
                TickSeries::new("with preload", |record| {
                    more(record, RedundantRecord::torque_norm)
                }),
                Series::new("without", |record| {
                    more(record, RedundantRecord::least_norm)
                }),
            ];
            torques.push(Chart::new("norm", "N m", norms));
        }
        let sum = TickSeries::new("sum", |record| record.each_leg().map(|leg| leg.power).sum());
        let powers = [
            Chart::new("power", "W", self.each("motor", |leg| leg.power))
                .within(of_motors(limits.power_w.as_ref())),
            Chart::new("sum of the powers", "W", [sum.coloured(ANGLE)]),
        ];
        let mut figures = vec![
            Figure::new("torque.svg", "torques of the motors", torques),
            Figure::new("power.svg", "powers of the motors", powers),
        ];
        if self.is_redundant {
            let forces = [
                ("force in A", self.each_more(|leg| size_of(leg.joints[0]))),
                ("force in B", self.each_more(|leg| size_of(leg.joints[1]))),
                ("force in C", self.each_more(|leg| size_of(leg.joints[2]))),
            ];
            let charts = forces.map(|(quantity, series)| Chart::new(quantity, "N", series));
            figures.push(Figure::new(
                "joint_force.svg",
                "forces in the joints",
                charts,
            ));
        }
        figures
    }
}

fn size_of([x, y]: [f64; 2]) -> f64 {
    x.hypot(y)
}
