//! The machine in one pose with the names of its joints, lengths, angles and signs, and the platform once more, enlarged.

mod pen;

use pen::{AngleArc, away, beside, centre_of_mass, midpoint, named, outside};
use std::f64::consts::TAU;
use trirrr_core::machine::Parameters;
use trirrr_figures::canvas::{CENTRED, Canvas, Draw, Drawn, RIGHT_OF, Size, page};
use trirrr_figures::plane::View;
use trirrr_figures::style::{ANGLE, FRAME, GROUND, INK, MOTORS, PATH, faded};
use trirrr_scene::record::Record;
use trirrr_scene::words::written;

const LEFT: f64 = 84.0;
const TOP: f64 = 56.0;
const SIDE: f64 = 560.0;
const PLATFORM_SIDE: f64 = 340.0;
/// Lines below the drawing, with the axis's labels.
const BELOW_IT: f64 = 66.0;
const LINE: f64 = 20.0;

/// Machine in a pose, as it is drawn.
struct Posed<'a> {
    parameters: &'a Parameters,
    record: &'a Record,
}

/// Draws the machine of `parameters` in the pose of `record`.
pub(crate) fn draw(title: &str, parameters: &Parameters, record: &Record) -> Drawn {
    let posed = Posed { parameters, record };
    let d = posed.place();
    let mut points = vec![d];
    for leg in &record.legs {
        points.extend([leg.base, leg.elbow(), leg.platform_joint()]);
    }
    // Room for names.
    let size = |axis: usize| {
        let (low, high) = trirrr_figures::panel::range(points.iter().map(|point| point[axis]));
        high - low
    };
    let room = 0.1 * size(0).max(size(1));
    let bases = record.legs.map(|leg| leg.base);
    points.extend(bases.map(|[x, y]| [x - room, y - room]));
    points.extend(bases.map(|[x, y]| [x + room, y + room]));
    // Names of elbows stand farther out.
    let elbows = record.legs.map(|leg| leg.elbow());
    points.extend(elbows.map(|[x, y]| [x - 1.4 * room, y - 1.4 * room]));
    points.extend(elbows.map(|[x, y]| [x + 1.4 * room, y + 1.4 * room]));
    let whole = View::around(&points, "m", (LEFT, TOP), SIDE);
    let left = LEFT + whole.width + 110.0;
    let reach = 1.35 * posed.radius();
    let around = [[-reach; 2], [reach; 2]].map(|[x, y]| [d[0] + x, d[1] + y]);
    let platform = View::around(&around, "m", (left, TOP), PLATFORM_SIDE);
    let lines = posed.lines();
    let width = (left + platform.width + 40.0).max(Size::Title.width(title) + 40.0);
    let tall = whole.height.max(platform.height + 110.0);
    let height = TOP + tall + BELOW_IT + LINE * (lines.len() as f64 + 0.5);
    page(width, height, |canvas| {
        canvas.text(title, (width / 2.0, 26.0), Size::Title, CENTRED, INK)?;
        whole.grid(canvas, ["x", "y"])?;
        posed.machine(canvas, &whole)?;
        posed.platform(canvas, &platform)?;
        let top = TOP + tall + BELOW_IT;
        for (row, line) in lines.iter().enumerate() {
            let at = (LEFT - 54.0, top + LINE * row as f64);
            canvas.text(line, at, Size::Tick, RIGHT_OF, INK)?;
        }
        Ok(())
    })
}

impl Posed<'_> {
    fn place(&self) -> [f64; 2] {
        [self.record.pose[0], self.record.pose[1]]
    }

    /// Largest distance of something on the platform from D, m.
    fn radius(&self) -> f64 {
        let radii = self.parameters.legs.iter().map(|leg| leg.joint_radius_m);
        let com = self.parameters.platform.com_m;
        let most = radii.fold(com.x.hypot(com.y), f64::max);
        if most > 0.0 { most } else { 1.0 }
    }

    fn machine(&self, canvas: &Canvas<'_>, view: &View) -> Draw {
        let Self { parameters, record } = self;
        let corners = record.legs.map(|leg| view.at(leg.platform_joint()));
        canvas.polygon(&corners, faded(PATH, 0.25))?;
        for (index, (leg, colour)) in record.legs.iter().zip(MOTORS).enumerate() {
            let places = [leg.base, leg.elbow(), leg.platform_joint()];
            let [a, b, c] = places.map(|place| view.at(place));
            canvas.dashed(a, c, faded(FRAME, 0.7))?;
            canvas.line(&[a, b], colour, 5.6)?;
            canvas.line(&[b, c], colour, 3.2)?;
            let foot = [a, (a.0 - 10.0, a.1 + 16.0), (a.0 + 10.0, a.1 + 16.0)];
            canvas.polygon(&foot, GROUND)?;
            // The angle of the motor, from the x axis to the proximal link.
            canvas.dashed(a, (a.0 + 62.0, a.1), FRAME)?;
            let name = format!("th1_{}", index + 1);
            AngleArc::new(a, 46.0, 0.0, leg.th1).draw(canvas, &name, colour)?;
            if index == 0 {
                canvas.dashed(b, (b.0 + 62.0, b.1), FRAME)?;
                AngleArc::new(b, 38.0, 0.0, leg.th2).draw(canvas, "th2_1", colour)?;
                beside(canvas, "proximal_m", a, b)?;
                beside(canvas, "distal_m", b, c)?;
            }
            let sign = match parameters.legs[index].elbow.sign() > 0.0 {
                true => "+1",
                false => "\u{2212}1",
            };
            for (joint, radius, colour) in [(a, 6.4, GROUND), (b, 5.4, INK), (c, 4.4, INK)] {
                canvas.joint(joint, radius, colour)?;
            }
            let side = if a.0 > view.at(self.place()).0 {
                26.0
            } else {
                -26.0
            };
            named(canvas, &format!("A{}", index + 1), (a.0 + side, a.1 + 13.0))?;
            let name = format!("B{} (elbow {sign})", index + 1);
            outside(canvas, &name, b, midpoint(a, c))?;
        }
        canvas.dot(view.at(self.place()), 4.0, PATH)?;
        self.loads(canvas, view)
    }

    /// Gravity and the wrench, with their sizes; centres of mass of the links.
    fn loads(&self, canvas: &Canvas<'_>, view: &View) -> Draw {
        let Parameters {
            gravity_m_s2: gravity,
            wrench_force_n: force,
            ..
        } = self.parameters;
        let (left, top) = view.corner();
        let tip = |from: (f64, f64), x: f64, y: f64, length: f64| {
            let size = x.hypot(y);
            (from.0 + length * x / size, from.1 - length * y / size)
        };
        if gravity.norm() > 0.0 {
            // Right of the drawing, below the platform.
            let (x, y) = (left + view.width + 130.0, top + PLATFORM_SIDE + 84.0);
            let [from, to] = [-22.0, 22.0].map(|part| tip((x, y), gravity.x, gravity.y, part));
            canvas.arrow(&[from, to], INK, 2.0)?;
            let text = format!("gravity {} m/s\u{b2}", gravity.norm());
            canvas.text(&text, (x + 34.0, y), Size::Tick, RIGHT_OF, INK)?;
        }
        if force.norm() > 0.0 {
            let from = view.at(self.place());
            let to = tip(from, force.x, force.y, 58.0);
            canvas.arrow(&[from, to], INK, 2.0)?;
            let text = format!("force {} N", trirrr_figures::document::digits(force.norm()));
            named(canvas, &text, (to.0, to.1 + 13.0))?;
        }
        let links = self.record.legs.iter().zip(&self.parameters.legs);
        for (leg, given) in links {
            for (link, from, along, length) in [
                (&given.proximal, leg.base, leg.r1, given.proximal_m),
                (&given.distal, leg.elbow(), leg.r2, given.distal_m),
            ] {
                if link.mass_kg > 0.0 {
                    let part = link.com_m / length;
                    let at = [from[0] + part * along[0], from[1] + part * along[1]];
                    centre_of_mass(canvas, view.at(at))?;
                }
            }
        }
        Ok(())
    }

    /// The platform, with its own axes.
    fn platform(&self, canvas: &Canvas<'_>, view: &View) -> Draw {
        let Self { parameters, record } = self;
        let alpha = record.pose[2];
        view.grid(canvas, ["x, near D", "y"])?;
        let d = view.at(self.place());
        let corners = record.legs.map(|leg| view.at(leg.platform_joint()));
        canvas.polygon(&corners, faded(PATH, 0.25))?;
        let [c1, c2, c3] = corners;
        canvas.line(&[c1, c2, c3, c1], PATH, 2.0)?;
        let half = 0.46 * view.width;
        let along =
            |angle: f64, length: f64| (d.0 + length * angle.cos(), d.1 - length * angle.sin());
        canvas.dashed(d, along(0.0, half), FRAME)?;
        canvas.arrow(&[d, along(alpha, half)], PATH, 1.6)?;
        canvas.arrow(&[d, along(alpha + TAU / 4.0, 0.24 * half)], PATH, 1.6)?;
        named(canvas, "x'", along(alpha + 0.09, half))?;
        named(canvas, "y'", along(alpha + TAU / 4.0 - 0.3, 0.24 * half))?;
        AngleArc::new(d, 0.8 * half, 0.0, alpha).draw(canvas, "\u{3b1}", ANGLE)?;
        for (index, (leg, colour)) in parameters.legs.iter().zip(MOTORS).enumerate() {
            let c = corners[index];
            canvas.dashed(d, c, colour)?;
            if index == 0 {
                let to = alpha + leg.joint_angle_rad;
                AngleArc::new(d, 0.36 * half, alpha, to).draw(canvas, "joint_angle_rad", colour)?;
            }
            canvas.joint(c, 5.4, INK)?;
            named(canvas, &format!("C{}", index + 1), away(c, d, 18.0))?;
        }
        beside(canvas, "joint_radius_m", c1, d)?;
        canvas.dot(d, 5.0, PATH)?;
        named(canvas, "D", (d.0 - 12.0, d.1 + 14.0))?;
        let platform = &parameters.platform;
        if platform.mass_kg > 0.0 {
            let (sin, cos) = alpha.sin_cos();
            let (u, v) = (platform.com_m.x, platform.com_m.y);
            let [x, y] = self.place();
            centre_of_mass(
                canvas,
                view.at([x + cos * u - sin * v, y + sin * u + cos * v]),
            )?;
        }
        Ok(())
    }

    /// Definitions, and the values of this machine.
    fn lines(&self) -> Vec<String> {
        let mut lines = vec![
            "A: motor, on the base at base_m. B: elbow. C: joint of the platform. D: reference point of the platform, at (x, y).".to_owned(),
            "Angles count counter-clockwise from the x axis of the base: th1 of A to B, th2 of B to C, \u{3b1} of the platform's own axis x'; joint_angle_rad counts from x'.".to_owned(),
            "elbow +1: seen from A to C, B lies to the left; \u{2212}1: to the right. Quartered discs: centres of mass of what has a mass.".to_owned(),
        ];
        for (index, leg) in self.parameters.legs.iter().enumerate() {
            lines.push(format!(
                "leg {}: base_m = [{}, {}], proximal_m = {}, distal_m = {}, joint_radius_m = {}, joint_angle_rad = {:.5} ({:.2}\u{b0}), elbow = {}",
                index + 1,
                written(leg.base_m.x),
                written(leg.base_m.y),
                written(leg.proximal_m),
                written(leg.distal_m),
                written(leg.joint_radius_m),
                leg.joint_angle_rad,
                leg.joint_angle_rad.to_degrees(),
                leg.elbow.sign(),
            ));
        }
        lines
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use trirrr_core::setpoint::{Pose, Setpoint};
    use trirrr_scene::{Scene, pipeline};

    #[test]
    fn every_name_of_the_machine_is_in_its_figure() {
        let text = include_str!("../../../../scenes/vertical.toml");
        let scene = Scene::parse(text, "vertical.toml").unwrap();
        let machine = pipeline::build::<f64>(&scene.parameters).unwrap();
        let pose: Pose<f64> = scene.job.start;
        let at = Setpoint {
            pose,
            velocity: Vector3::zeros(),
            acceleration: Vector3::zeros(),
        };
        let record = machine.evaluate(0.0, &at).unwrap();
        let title = "vertical: joints, links, angles and signs, at the start";
        let drawn = draw(title, &scene.parameters, &record).unwrap();
        for name in [
            "A1",
            "A2",
            "A3",
            "B1 (elbow \u{2212}1)",
            "B2 (elbow \u{2212}1)",
            "B3 (elbow \u{2212}1)",
            "C1",
            "C2",
            "C3",
            "D",
            "th1_1",
            "th1_2",
            "th1_3",
            "th2_1",
            "\u{3b1}",
            "proximal_m",
            "distal_m",
            "joint_radius_m",
            "joint_angle_rad",
        ] {
            assert!(drawn.contains(&format!(">\n{name}\n<")), "{name}");
        }
        for text in [
            "gravity 9.81",
            "force 0.9434 N",
            "proximal_m = 0.3",
            "150.00\u{b0}",
        ] {
            assert!(drawn.contains(text), "{text}");
        }
    }
}
