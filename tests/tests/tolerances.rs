//! Bounds of `trirrr-tolerances` against machines drawn from the box of the tolerances: Newton's method in binary64 finds
//! where the platform of each stands, differences in time how it moves, and the balance of seven bodies the torques.

use nalgebra::{Matrix3, Vector2, Vector3};
use proptest::prelude::*;
use proptest::test_runner::{RngAlgorithm, TestRng};
use trirrr_core::machine::Parameters;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_scene::{BodyTolerances, Job, JobMove, Scene, Tolerances};
use trirrr_tests::double_double::DoubleDouble;
use trirrr_tests::inputs::Inputs;
use trirrr_tests::random::{case, for_all};
use trirrr_tolerances::{Parameter, TimeSpan, ToleranceAnalysis};

const THESIS: &str = include_str!("../../scenes/thesis.toml");

/// Every move of these tests takes a second.
const TICKS: u32 = 100;

/// A pose as a vector: x, y, alpha.
type Place = Vector3<f64>;

/// A machine, the ends of its move, and by how much it may differ.
#[derive(Clone, Debug)]
struct Uncertain {
    parameters: Parameters,
    from: Place,
    to: Place,
    tolerances: Tolerances,
    seed: [u8; 32],
}

impl Uncertain {
    fn scene(&self) -> Scene {
        let pose = |place: Place| Pose::from_f64(place.x, place.y, place.z);
        Scene {
            parameters: self.parameters,
            tolerances: Some(self.tolerances),
            job: Job::of(
                pose(self.from),
                vec![JobMove {
                    from: pose(self.from),
                    to: pose(self.to),
                    start_velocity: Vector3::zeros(),
                    end_velocity: Vector3::zeros(),
                    accelerations: None,
                    duration_ticks: TICKS,
                    tool: None,
                }],
            ),
            ..Scene::parse(THESIS, "thesis.toml").expect("the thesis scene")
        }
    }

    /// The commanded pose at the time `t`, 0 to 1.
    fn commanded(&self, t: f64) -> Place {
        self.from + (self.to - self.from) * (t * t * (3.0 - 2.0 * t))
    }

    /// Motor angles of the nominal machine at the time `t`, in 31 digits.
    fn motor_angles(&self, t: f64) -> [f64; 3] {
        let setpoint = at_rest(self.commanded(t));
        let motion = Inputs::<DoubleDouble>::exact(&self.parameters, &setpoint).kinematics();
        motion.legs.map(|leg| leg.angles[0].value())
    }

    /// Half-widths, in the order in which [`Real::take`] takes them.
    fn half_widths(&self) -> Vec<f64> {
        let (t, p) = (&self.tolerances, &self.parameters);
        let mut all = Vec::new();
        for (leg, of) in p.legs.iter().enumerate() {
            let links = &t.links;
            all.extend([t.base_m[leg], t.base_m[leg], t.joint_m[leg], t.joint_m[leg]]);
            all.extend([t.proximal_m[leg], t.distal_m[leg], t.motor_angle_rad[leg]]);
            for link in [of.proximal, of.distal] {
                all.extend([links.mass_fraction * link.mass_kg, links.com_m]);
                all.push(links.inertia_fraction * link.inertia_kgm2);
            }
            all.push(t.rotor_inertia_fraction[leg] * of.rotor_inertia_kgm2);
        }
        all.push(t.platform.mass_fraction * p.platform.mass_kg);
        all.push(t.platform.inertia_fraction * p.platform.inertia_kgm2);
        all.extend([
            t.platform.com_m,
            t.platform.com_m,
            t.force_n,
            t.force_n,
            t.torque_nm,
        ]);
        all
    }
}

fn at_rest(place: Place) -> Setpoint<f64> {
    Setpoint {
        pose: Pose::from_f64(place.x, place.y, place.z),
        velocity: Vector3::zeros(),
        acceleration: Vector3::zeros(),
    }
}

/// A machine out of the box.
struct Real {
    parameters: Parameters,
    motor_errors: [f64; 3],
}

impl Real {
    /// The machine whose parameters differ from the nominal ones by `v`, each -1 to 1, times the half-widths.
    fn take(uncertain: &Uncertain, half_widths: &[f64], v: &[f64]) -> Self {
        let mut parameters = uncertain.parameters;
        let mut motor_errors = [0.0; 3];
        let mut differences = half_widths.iter().zip(v).map(|(width, v)| width * v);
        let mut next = || differences.next().expect("a value for each parameter");
        for (leg, motor_error) in parameters.legs.iter_mut().zip(&mut motor_errors) {
            leg.base_m += Vector2::new(next(), next());
            let (sin, cos) = leg.joint_angle_rad.sin_cos();
            let joint = Vector2::new(cos, sin) * leg.joint_radius_m + Vector2::new(next(), next());
            leg.joint_radius_m = joint.x.hypot(joint.y);
            leg.joint_angle_rad = joint.y.atan2(joint.x);
            leg.proximal_m += next();
            leg.distal_m += next();
            *motor_error = next();
            for link in [&mut leg.proximal, &mut leg.distal] {
                link.mass_kg += next();
                link.com_m += next();
                link.inertia_kgm2 += next();
            }
            leg.rotor_inertia_kgm2 += next();
        }
        parameters.platform.mass_kg += next();
        parameters.platform.inertia_kgm2 += next();
        parameters.platform.com_m += Vector2::new(next(), next());
        parameters.wrench_force_n += Vector2::new(next(), next());
        parameters.wrench_torque_nm += next();
        Self {
            parameters,
            motor_errors,
        }
    }

    /// Pose of the platform with the motors at `angles`, near `start`; `None` where Newton's method does not end.
    fn place(&self, angles: [f64; 3], start: Place) -> Option<Place> {
        let mut place = start;
        let mut is_near = false;
        for _ in 0..50 {
            let (mut jacobian, mut residual) = (Matrix3::zeros(), Vector3::zeros());
            for (index, leg) in self.parameters.legs.iter().enumerate() {
                let (sin, cos) = (angles[index] + self.motor_errors[index]).sin_cos();
                let elbow = leg.base_m + Vector2::new(cos, sin) * leg.proximal_m;
                let (sin, cos) = (place.z + leg.joint_angle_rad).sin_cos();
                let arm = Vector2::new(cos, sin) * leg.joint_radius_m;
                let r2 = place.xy() + arm - elbow;
                let across = arm.x * r2.y - arm.y * r2.x;
                jacobian.set_row(index, &Vector3::new(r2.x, r2.y, across).transpose());
                residual[index] = (r2.dot(&r2) - leg.distal_m * leg.distal_m) / 2.0;
            }
            let determinant = jacobian.determinant();
            let columns = [0, 1, 2].map(|column| {
                let mut replaced = jacobian;
                replaced.set_column(column, &residual);
                replaced.determinant() / determinant
            });
            let step = Vector3::from(columns);
            place -= step;
            if is_near {
                return Some(place);
            }
            // One step more leaves nothing but rounding.
            is_near = step.abs().max() <= 1e-10 * (1.0 + place.abs().max());
        }
        None
    }

    /// The platform at the time `t`.
    fn place_at(&self, uncertain: &Uncertain, t: f64) -> Option<Place> {
        self.place(uncertain.motor_angles(t), uncertain.commanded(t))
    }

    /// The torques of the motors at the time `t`; `None` where the machine has no pose soon before or after.
    fn torques(&self, uncertain: &Uncertain, t: f64) -> Option<[f64; 3]> {
        let h = 5e-3;
        let place = |steps: f64| self.place_at(uncertain, t + steps * h);
        let [far_before, before, now, after, far_after] = [
            place(-2.0)?,
            place(-1.0)?,
            place(0.0)?,
            place(1.0)?,
            place(2.0)?,
        ];
        let velocity = ((after - before) * 8.0 - (far_after - far_before)) / (12.0 * h);
        let acceleration =
            ((after + before) * 16.0 - (far_after + far_before) - now * 30.0) / (12.0 * h * h);
        let setpoint = Setpoint {
            velocity,
            acceleration,
            ..at_rest(now)
        };
        let inputs = Inputs::<DoubleDouble>::exact(&self.parameters, &setpoint);
        let torques = inputs.dynamics(&inputs.kinematics()).torques;
        Some(torques.map(DoubleDouble::value))
    }
}

/// A random machine with a short move and tolerances up to `most` of its size.
fn uncertain(most: f64) -> impl Strategy<Value = Uncertain> {
    let unit = || -1.0..1.0_f64;
    let size = (most / 100.0).ln()..most.ln();
    let present = proptest::array::uniform12(prop_oneof![1 => Just(0.0), 3 => 0.1..1.0_f64]);
    let ends = [unit(), unit(), unit()];
    (case(), ends, size, present, any::<[u8; 32]>()).prop_map(
        move |(case, ends, size, present, seed)| {
            let (part, length) = (size.exp(), case.size);
            let pose = case.setpoint.pose;
            let from = Vector3::new(pose.position.x, pose.position.y, pose.angle);
            let to = from + Vector3::new(ends[0] * length, ends[1] * length, ends[2]) * 0.05;
            let of = |index: usize| part * present[index];
            let each = |index: usize, unit: f64| [1.0, 0.7, 0.4].map(|leg| leg * unit * of(index));
            let body = |index: usize| BodyTolerances {
                mass_fraction: 5.0 * of(index),
                inertia_fraction: 5.0 * of(index + 1),
                com_m: of(index + 2) * length,
            };
            let platform = &case.parameters.platform;
            Uncertain {
                parameters: case.parameters,
                from,
                to,
                tolerances: Tolerances {
                    proximal_m: each(0, length),
                    distal_m: each(1, length),
                    base_m: each(2, length),
                    joint_m: each(3, length),
                    motor_angle_rad: each(4, 1.0),
                    rotor_inertia_fraction: each(5, 1.0),
                    platform: body(6),
                    links: body(9),
                    force_n: of(10) * platform.mass_kg * length,
                    torque_nm: of(11) * platform.mass_kg * length * length,
                },
                seed,
            }
        },
    )
}

/// Findings of the samples of many machines.
#[derive(Debug, Default)]
struct Tally {
    machines: u32,
    bounded: u32,
    samples: u32,
    /// Part of the error that a share may be off by.
    linear: f64,
    /// Bound over greatest sample, of each case that is bounded: error of x, y and alpha; torque.
    errors: Vec<f64>,
    torques: Vec<f64>,
}

impl Tally {
    /// Checks every sample of a machine against the bounds.
    fn compare(&mut self, uncertain: &Uncertain) {
        self.machines += 1;
        let scene = uncertain.scene();
        let analysis = ToleranceAnalysis::new(&scene).expect("a machine with tolerances");
        let spans: Vec<TimeSpan> = analysis.spans().collect();
        let half_widths = uncertain.half_widths();
        let mut random = TestRng::from_seed(RngAlgorithm::ChaCha, &uncertain.seed);
        let any = &spans[random.random_range(0..spans.len())];
        // Anywhere in it, and not so near to the ends of the move that differences in time would leave it.
        let t = random
            .random_range(any.start_s..=any.end_s)
            .clamp(0.02, 0.98);
        let holds = |span: &&TimeSpan| span.start_s <= t && t <= span.end_s;
        let span = spans
            .iter()
            .find(holds)
            .expect("all of the move is covered");
        let Some(tool) = span.tool else { return };
        self.bounded += 1;

        // The corner in which each output is greatest, as far as differences tell.
        let real = |v: &[f64]| Real::take(uncertain, &half_widths, v);
        let error = |v: &[f64]| {
            let place = real(v).place_at(uncertain, t);
            place.unwrap_or_else(|| panic!("{uncertain:?}: bounded, but without a pose at {t}"))
                - uncertain.commanded(t)
        };
        let outputs = |v: &[f64]| {
            let torques = real(v).torques(uncertain, t).unwrap_or([0.0; 3]);
            [error(v).into(), torques].concat()
        };
        let none = vec![0.0; half_widths.len()];
        let nominal = outputs(&none);
        let slopes: Vec<Vec<f64>> = (0..half_widths.len())
            .map(|index| {
                let mut v = none.clone();
                v[index] = 1.0;
                let moved = outputs(&v);
                moved
                    .iter()
                    .zip(&nominal)
                    .map(|(moved, at_rest)| moved - at_rest)
                    .collect()
            })
            .collect();
        // The budget is of the middle of the interval, over which the slopes change by little.
        let budget = analysis.budget(&tool);
        for (index, parameter) in Parameter::all().enumerate() {
            let share = budget.iter().find(|share| share.parameter == parameter);
            let share = share.map_or([0.0; 3], |share| [share.dx_m, share.dy_m, share.dalpha_rad]);
            for (k, (share, size)) in share.into_iter().zip(tool.sizes()).enumerate() {
                let off = (share - slopes[index][k]).abs();
                let rounding = 1e-12 * uncertain.commanded(t).abs().max();
                assert!(
                    off <= self.linear * size + rounding,
                    "{parameter}: {share} {off}"
                );
            }
        }
        let mut samples: Vec<Vec<f64>> = Vec::new();
        for output in 0..6 {
            for sign in [1.0, -1.0] {
                samples.push(
                    slopes
                        .iter()
                        .map(|slope| sign * slope[output].signum())
                        .collect(),
                );
            }
        }
        for _ in 0..8 {
            samples.push(
                half_widths
                    .iter()
                    .map(|_| random.random_range(-1.0..=1.0))
                    .collect(),
            );
            let corner = |_| if random.random::<bool>() { 1.0 } else { -1.0 };
            samples.push(half_widths.iter().map(corner).collect());
        }

        let sizes = tool.sizes();
        let (mut errors, mut most_torque) = ([0.0; 3], 0.0_f64);
        for v in &samples {
            self.samples += 1;
            let found = error(v);
            // Newton's method ends within the rounding of the place, times its condition.
            let rounding = 1e-12 * uncertain.commanded(t).abs().max();
            for ((value, size), most) in found.iter().zip(sizes).zip(&mut errors) {
                *most = value.abs().max(*most);
                let bound = size * (1.0 + 1e-9) + rounding;
                assert!(
                    value.abs() <= bound,
                    "{uncertain:?}\n{t} {v:?}: {value} beyond {size}"
                );
            }
            let distance = found.x.hypot(found.y);
            assert!(distance <= tool.distance_m() * (1.0 + 1e-9) + rounding);
            let (Some(ranges), Some(torques)) = (span.torques, real(v).torques(uncertain, t))
            else {
                continue;
            };
            let greatest = ranges
                .iter()
                .flatten()
                .fold(0.0, |most: f64, t| most.max(t.abs()));
            for (value, [least, most]) in torques.into_iter().zip(ranges) {
                // The differences in time leave this much.
                let slack = 1e-6 * greatest;
                most_torque = most_torque.max(value.abs());
                assert!(
                    least - slack <= value && value <= most + slack,
                    "{uncertain:?}\n{t} {v:?}: {value} beyond [{least}, {most}]"
                );
            }
            if v == &samples[samples.len() - 1] {
                self.torques.push(greatest / most_torque);
            }
        }
        for (found, size) in errors.into_iter().zip(sizes) {
            if found > 1e-9 * sizes[0].max(sizes[1]) {
                self.errors.push(size / found);
            }
        }
    }

    fn print(&mut self, what: &str) {
        let quantiles = |ratios: &mut Vec<f64>| {
            ratios.sort_by(f64::total_cmp);
            let at = |part: f64| ratios[((ratios.len() - 1) as f64 * part) as usize];
            format!(
                "median {:.3}, 95 % {:.3}, most {:.3}",
                at(0.5),
                at(0.95),
                at(1.0)
            )
        };
        println!(
            "{what}: {} machines, {} bounded, {} samples, none outside\n  error, bound over worst corner: {}\n  \
             greatest torque, bound over worst corner: {}",
            self.machines,
            self.bounded,
            self.samples,
            quantiles(&mut self.errors),
            quantiles(&mut self.torques),
        );
    }
}

fn compare(machines: u32, most: f64) -> Tally {
    let tally = core::cell::RefCell::new(Tally {
        // What is not linear grows with the tolerances.
        linear: 0.05 + 20.0 * most,
        ..Tally::default()
    });
    for_all(machines, uncertain(most), |each| {
        tally.borrow_mut().compare(&each)
    });
    tally.into_inner()
}

#[test]
fn no_machine_within_its_tolerances_leaves_the_bounds() {
    let mut tally = compare(25, 1e-4);
    tally.print("tolerances to 1e-4");
}

#[test]
#[ignore = "takes minutes"]
fn no_machine_of_many_leaves_the_bounds() {
    for most in [1e-5, 1e-4, 1e-3, 1e-2] {
        compare(500, most).print(&format!("tolerances to {most:e}"));
    }
}

/// The thesis machine with one half-width for all lengths and one for the motors, on a move between two places.
fn thesis(from: Place, to: Place, length_m: f64, motor_angle_rad: f64) -> Uncertain {
    let body = BodyTolerances::default();
    Uncertain {
        parameters: trirrr_core::machine::example(),
        from,
        to,
        tolerances: Tolerances {
            proximal_m: [length_m; 3],
            distal_m: [length_m; 3],
            base_m: [length_m; 3],
            joint_m: [length_m; 3],
            motor_angle_rad: [motor_angle_rad; 3],
            rotor_inertia_fraction: [0.0; 3],
            platform: body,
            links: body,
            force_n: 0.0,
            torque_nm: 0.0,
        },
        seed: [0; 32],
    }
}

#[test]
fn a_machine_without_tolerances_has_no_error_but_rounding() {
    let exact = thesis(
        Vector3::new(0.21, 0.22, 0.15),
        Vector3::new(0.28, 0.28, 0.2),
        0.0,
        0.0,
    );
    let scene = exact.scene();
    let analysis = ToleranceAnalysis::new(&scene).unwrap();
    let mut covered = 0.0;
    for span in analysis.spans() {
        assert_eq!(span.start_s, covered, "no interval is left out");
        covered = span.end_s;
        let tool = span.tool.expect("bounded");
        assert!(
            tool.sizes().iter().all(|size| *size < 1e-12),
            "{:?}",
            tool.sizes()
        );
        assert!(analysis.budget(&tool).is_empty());
    }
    assert_eq!(covered, 1.0);
}

/// Half-widths twice as large make the error twice as large, as long as they are small.
#[test]
fn the_error_grows_with_the_tolerances() {
    let greatest = |half_width: f64| {
        let ends = (
            Vector3::new(0.21, 0.22, 0.15),
            Vector3::new(0.28, 0.28, 0.2),
        );
        let scene = thesis(ends.0, ends.1, half_width, half_width).scene();
        let analysis = ToleranceAnalysis::new(&scene).unwrap();
        let distance = |span: TimeSpan| span.tool.expect("bounded").distance_m();
        analysis.spans().map(distance).fold(0.0, f64::max)
    };
    let (small, twice) = (greatest(1e-6), greatest(2e-6));
    assert!((twice / small - 2.0).abs() < 0.01, "{small} {twice}");
    let much = greatest(1e-4) / small;
    assert!((100.0..103.0).contains(&much), "{much}");
}

/// The thesis machine has a parallel singularity at x = 0.245 m, y = 0.25 m, alpha = -0.7534 rad.
#[test]
fn near_a_parallel_singularity_nothing_is_bounded() {
    const SINGULAR: f64 = -0.753_418_931_929_448_5;
    let place = |alpha: f64| Vector3::new(0.245, 0.25, alpha);
    for length_m in [1e-6, 1e-5, 1e-4] {
        let towards = thesis(place(-0.3), place(SINGULAR - 1e-3), length_m, 0.0);
        let scene = towards.scene();
        let analysis = ToleranceAnalysis::new(&scene).unwrap();
        let spans: Vec<TimeSpan> = analysis.spans().collect();
        let first = spans
            .iter()
            .find(|span| span.tool.is_none())
            .expect("a singularity");
        let (before, behind): (Vec<&TimeSpan>, Vec<&TimeSpan>) =
            spans.iter().partition(|span| span.start_s < first.start_s);
        // Two poses meet at the singularity, as the roots of a quadratic equation do: the way from there grows with the
        // tolerance's root.
        let distance = first.pose.angle - SINGULAR;
        let scale = (length_m / 0.02).sqrt();
        assert!(
            distance > 0.0 && distance < 4.0 * scale,
            "{length_m} {distance}"
        );
        assert!(
            before
                .iter()
                .all(|span| span.tool.is_some() && span.torques.is_some())
        );
        assert!(
            behind.iter().all(|span| span.torques.is_none()),
            "{length_m}"
        );
        for span in &before {
            assert!(span.pose.angle > SINGULAR);
        }
        println!("{length_m:e}: not bounded from {distance:.2e} rad before the singularity on");
    }
}

#[test]
fn a_scene_without_tolerances_is_refused() {
    let mut scene = Scene::parse(THESIS, "thesis.toml").unwrap();
    scene.tolerances = None;
    let Err(error) = ToleranceAnalysis::new(&scene) else {
        panic!("analysed");
    };
    assert!(
        error.to_string().contains("no [tolerances]: add the table"),
        "{error}"
    );
}
