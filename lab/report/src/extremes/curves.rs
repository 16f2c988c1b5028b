//! Families of machines that come nearer and nearer to an edge: links of unequal lengths, the two
//! kinds of singularity, a leg folded onto its base joint.

use super::cases::{CaseMotion, ExtremeCase, polar};
use super::measure::CaseOutcome;
use super::{Column, columns};
use crate::colours::of_number;
use crate::draws::Draws;
use crate::error::ReportError;
use crate::page::Page;
use crate::table::{Table, two_digits};
use core::f64::consts::PI;
use nalgebra::{Vector2, Vector3};
use trirrr_core::machine::{Elbow, LinkParameters, Parameters};
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_figures::scatter::{Over, Point, RADIUS, Scatter, Series, draw};

/// Machines at each place of a curve.
const MACHINES: usize = 40;

/// A family of machines.
struct Curve {
    name: &'static str,
    file: &'static str,
    /// Title of the horizontal axis.
    axis: &'static str,
    /// Decimal exponents of the places.
    exponents: &'static [i32],
    /// Takes ordinary legs, for a pose, to the place.
    take: fn(&mut [Leg; 3], &Pose<f64>, f64, &mut Draws),
}

const CURVES: [Curve; 4] = [
    Curve {
        name: "links of leg 1",
        file: "edges-links.svg",
        axis: "length of the proximal over that of the distal link, leg 1",
        exponents: &[-4, -3, -2, -1, 0, 1, 2, 3, 4],
        take: |legs, _, ratio, _| {
            // The longer link keeps its length.
            let leg = &mut legs[0];
            match ratio < 1.0 {
                true => leg.proximal = leg.distal * ratio,
                false => leg.distal = leg.proximal / ratio,
            }
        },
    },
    Curve {
        name: "leg 1 stretched",
        file: "edges-serial.svg",
        axis: "angle between the links of leg 1 (rad)",
        exponents: &[-1, -2, -3, -4, -5, -6, -7],
        take: |legs, _, angle, _| {
            legs[0].elbow = angle.copysign(legs[0].elbow);
        },
    },
    Curve {
        name: "leg 1 on its base joint",
        file: "edges-base.svg",
        axis: "angle of the links of leg 1 from folded (rad)",
        exponents: &[-1, -2, -3, -4, -5, -6, -7],
        take: |legs, _, angle, _| {
            legs[0].distal = legs[0].proximal;
            legs[0].elbow = (PI - angle).copysign(legs[0].elbow);
        },
    },
    Curve {
        name: "distal lines in one point",
        file: "edges-parallel.svg",
        axis: "angle of distal link 1 from the common point (rad)",
        exponents: &[-1, -2, -3, -4, -5, -6, -7],
        take: |legs, pose, angle, draws| {
            let meet = pose.position + Vector2::new(draws.within(0.2, 0.4), draws.within(0.2, 0.4));
            for (index, leg) in legs.iter_mut().enumerate() {
                let to_meet = meet - leg.platform_joint(pose);
                let distal = to_meet.y.atan2(to_meet.x) + if index == 0 { angle } else { 0.0 };
                leg.direction = distal - leg.elbow;
            }
        },
    },
];

/// A leg, laid from its platform joint to its base joint.
struct Leg {
    proximal: f64,
    distal: f64,
    radius: f64,
    lambda: f64,
    /// Of the proximal link.
    direction: f64,
    /// Angle from the proximal to the distal link.
    elbow: f64,
}

impl Leg {
    fn platform_joint(&self, pose: &Pose<f64>) -> Vector2<f64> {
        pose.position + polar(self.radius, pose.angle + self.lambda)
    }
}

/// Legs away from every edge.
fn ordinary(draws: &mut Draws) -> ([Leg; 3], Pose<f64>) {
    let pose = Pose::from_f64(
        draws.within(-0.5, 0.5),
        draws.within(-0.5, 0.5),
        draws.within(-1.0, 1.0),
    );
    let legs = [0.0, 2.0, 4.0].map(|lambda| {
        let elbow = draws.within(0.6, 2.4);
        Leg {
            proximal: draws.within(0.15, 0.3),
            distal: draws.within(0.15, 0.3),
            radius: draws.within(0.05, 0.1),
            lambda: lambda + draws.within(-0.4, 0.4),
            // About at right angles to the radius, as far from the parallel singularity as it goes.
            direction: pose.angle + lambda + PI / 2.0 + draws.within(-0.4, 0.4) - elbow,
            elbow: if draws.within(0.0, 1.0) < 0.5 {
                elbow
            } else {
                -elbow
            },
        }
    });
    (legs, pose)
}

/// The machine of `legs` in motion at `pose`, everything else as in `like`.
fn case(
    group: &'static str,
    like: &Parameters,
    legs: &[Leg; 3],
    pose: Pose<f64>,
    draws: &mut Draws,
) -> ExtremeCase {
    let mut parameters = *like;
    for (leg, of) in parameters.legs.iter_mut().zip(legs) {
        let links = polar(of.proximal, of.direction) + polar(of.distal, of.direction + of.elbow);
        leg.base_m = of.platform_joint(&pose) - links;
        leg.proximal_m = of.proximal;
        leg.distal_m = of.distal;
        leg.joint_radius_m = of.radius;
        leg.joint_angle_rad = of.lambda;
        // r1 x r2 = -sigma S.
        leg.elbow = match of.elbow < 0.0 {
            true => Elbow::Positive,
            false => Elbow::Negative,
        };
        leg.proximal = LinkParameters::uniform_rod(leg.proximal.mass_kg, of.proximal);
        leg.distal = LinkParameters::uniform_rod(leg.distal.mass_kg, of.distal);
    }
    let mut three = || Vector3::from([(); 3].map(|()| draws.within(-0.5, 0.5)));
    ExtremeCase {
        group,
        name: String::new(),
        parameters,
        motion: CaseMotion::State(Setpoint {
            pose,
            velocity: three(),
            acceleration: three(),
        }),
    }
}

/// Worst errors of one number type at one place of a curve.
struct PlaceErrors {
    with_results: usize,
    forward: f64,
    relative: f64,
}

impl PlaceErrors {
    fn of(column: &Column) -> Self {
        let mut errors = Self {
            with_results: 0,
            forward: 0.0,
            relative: 0.0,
        };
        for outcome in &column.outcomes {
            if let CaseOutcome::Motion {
                forward, relative, ..
            } = outcome
            {
                errors.with_results += 1;
                errors.forward = errors.forward.max(*forward);
                errors.relative = errors.relative.max(*relative);
            }
        }
        errors
    }

    /// The cell of a table; with the count where machines have no results.
    fn cell(&self, value: f64) -> String {
        match self.with_results {
            0 => "none".into(),
            MACHINES => two_digits(value),
            some => format!("{} ({some})", two_digits(value)),
        }
    }
}

/// Writes the tables and figures of all curves. `like` gives masses, gravity and payload.
pub(super) fn write(page: &mut Page, like: &Parameters) -> Result<(), ReportError> {
    page.heading(3, "Error against the distance from an edge");
    page.paragraph(&format!(
        "{MACHINES} random machines with link masses, in motion, at each place. *u cond*: the worst \
         error of the motors' results in units of u cond. *relative*: the worst error of a rate, an \
         acceleration or a torque over the largest of the three motors, or of an angle in rad. In \
         brackets: machines with results, where not all have them."
    ));
    let headings = |kind: &str| {
        let types = ["f64", "f32", "fixed", "micromath"].map(|name| format!("{name}, {kind}"));
        types.to_vec()
    };
    let headings: Vec<String> = [
        vec!["edge".into(), "at".into()],
        headings("u cond"),
        headings("relative"),
    ]
    .concat();
    let headings: Vec<&str> = headings.iter().map(String::as_str).collect();
    let mut table = Table::new(&headings);
    let mut figures = Vec::new();
    for curve in &CURVES {
        let mut series: Vec<Series> = Vec::new();
        for &exponent in curve.exponents {
            let at = 10f64.powi(exponent);
            let mut draws = Draws(exponent.unsigned_abs().into());
            let cases: Vec<ExtremeCase> = (0..MACHINES)
                .map(|_| {
                    let (mut legs, pose) = ordinary(&mut draws);
                    (curve.take)(&mut legs, &pose, at, &mut draws);
                    case(curve.name, like, &legs, pose, &mut draws)
                })
                .collect();
            let columns = columns(&cases);
            let errors = columns.each_ref().map(PlaceErrors::of);
            let forward = errors.each_ref().map(|errors| errors.cell(errors.forward));
            let relative = errors.each_ref().map(|errors| errors.cell(errors.relative));
            let names = [curve.name.to_owned(), format!("1e{exponent}")];
            table.row(names.into_iter().chain(forward).chain(relative));
            for (index, (column, errors)) in columns.iter().zip(&errors).enumerate() {
                if series.len() == index {
                    series.push(Series {
                        label: column.scalar.into(),
                        colour: of_number(column.scalar),
                        line: 1.8,
                        radius: RADIUS,
                        points: Vec::new(),
                    });
                }
                series[index].points.push(Point {
                    x: at,
                    y: errors.relative,
                    mark: 0,
                });
            }
        }
        figures.push((curve, series));
    }
    page.block("edges", true, &table.markdown());
    for (curve, series) in figures {
        let title = format!("Relative error, {}", curve.name);
        let figure = Scatter {
            title: &title,
            x: Over::Decades(curve.axis),
            y: Over::Decades("worst relative error"),
            series: &series,
            marks: &[],
            fronts: &[],
        };
        page.figure(curve.file, &title, draw(&figure))?;
    }
    Ok(())
}
