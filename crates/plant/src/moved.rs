//! The machine of a scene under torques that come from outside, in stretches of time: for a board that is simulated elsewhere.

use crate::model::{Control, Plant, layout_of};
use crate::motor::wrapped;
use crate::power_stage::PowerStage;
use crate::refusal::Refusal;
use trirrr_integrate::{End, Integrator, Method};
use trirrr_scene::Scene;

/// Tolerance of a stretch: encoders of 16,384 counts see nothing of it.
const TOLERANCE: f64 = 1e-8;

/// Machine that torques move, at rest at the start of the job at first.
pub struct MovedMachine {
    body: Box<dyn MovedBody>,
    /// Joint angles with everything that the joints have turned, rad.
    angles: [f64; 3],
}

impl MovedMachine {
    /// Builds the machine of `scene`, with its motors, friction and gravity.
    ///
    /// # Errors
    /// The machine is refused.
    pub fn build(scene: &Scene) -> Result<Self, Refusal> {
        let mut body: Box<dyn MovedBody> = match layout_of(scene).dimension() {
            8 => Box::new(SizedBody::<8>::build(scene)?),
            11 => Box::new(SizedBody::<11>::build(scene)?),
            14 => Box::new(SizedBody::<14>::build(scene)?),
            _ => Box::new(SizedBody::<17>::build(scene)?),
        };
        let angles = body.measure()?.map(|[angle, _]| angle);
        Ok(Self { body, angles })
    }

    /// Returns the joint angles with everything that the joints have turned, rad.
    pub fn angles(&self) -> [f64; 3] {
        self.angles
    }

    /// Lets `seconds` pass with `torques` of the motors at their joints, N m, as far as amplifiers can give them.
    ///
    /// # Errors
    /// The motion ends at a singularity or leaves the machine's reach.
    pub fn advance(&mut self, torques: [f64; 3], seconds: f64) -> Result<(), Refusal> {
        self.body.advance(torques, seconds)?;
        for (angle, [measured, _]) in self.angles.iter_mut().zip(self.body.measure()?) {
            *angle += wrapped(measured - *angle);
        }
        Ok(())
    }
}

/// Body without its dimension.
trait MovedBody: Send {
    /// Angles within a turn and rates of the rotors at their joints.
    fn measure(&mut self) -> Result<[[f64; 2]; 3], Refusal>;
    fn advance(&mut self, torques: [f64; 3], seconds: f64) -> Result<(), Refusal>;
}

struct SizedBody<const D: usize> {
    plant: Plant<D>,
    y: [f64; D],
    integrator: Integrator<D>,
    t: f64,
    /// Of motors with a winding.
    stages: [Option<PowerStage>; 3],
}

impl<const D: usize> SizedBody<D> {
    fn build(scene: &Scene) -> Result<Self, Refusal> {
        let (plant, y) = Plant::<D>::build(scene, Control::Held)?;
        let method = Method::DormandPrince {
            tolerance: TOLERANCE,
        };
        let integrator = Integrator::new(&plant, method).map_err(|unfit| Refusal::Scene {
            key: "plant.method".into(),
            reason: unfit.to_string(),
        })?;
        let stage = |leg: usize| {
            let drives = scene.drives.as_ref()?;
            PowerStage::of(&drives[leg])
        };
        Ok(Self {
            plant,
            y,
            integrator,
            t: 0.0,
            stages: [stage(0), stage(1), stage(2)],
        })
    }
}

impl<const D: usize> MovedBody for SizedBody<D> {
    fn measure(&mut self) -> Result<[[f64; 2]; 3], Refusal> {
        let measured = self.plant.measure(&self.y)?.measured;
        Ok(measured.map(|measured| [measured.angle, measured.rate]))
    }

    fn advance(&mut self, torques: [f64; 3], seconds: f64) -> Result<(), Refusal> {
        let measured = self.measure()?;
        let mut commands = torques;
        for (leg, command) in commands.iter_mut().enumerate() {
            if let Some(stage) = &self.stages[leg] {
                (*command, _) = stage.voltage(torques[leg], measured[leg][1]);
            }
        }
        self.plant.hold(commands);
        self.integrator.input_changed();
        let end = self.t + seconds;
        while self.t < end {
            let reached =
                self.integrator
                    .advance(&mut self.plant, self.t, &mut self.y, end, |_, _| {});
            self.t = match reached {
                Ok(End::Reached) => end,
                Ok(End::Stopped { t }) => t,
                Err(failure) => {
                    return Err(Refusal::Scene {
                        key: "plant".into(),
                        reason: failure.to_string(),
                    });
                }
            };
            if let Some(ending) = self.plant.ending() {
                return Err(Refusal::Scene {
                    key: "plant".into(),
                    reason: ending.to_string(),
                });
            }
        }
        Ok(())
    }
}
