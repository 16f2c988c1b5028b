//! Lagrange's equations: a derivation of the torques that knows neither virtual work nor a balance of forces.
//!
//! The coordinates q are those of the platform, x, y and alpha, and the positions of the sliders. The links' angles follow
//! from q by the closure of the loops, which [Newton's method](bodies) solves in numbers that carry derivatives. The energies
//! of all bodies make the Lagrangian L(q, q') = T - V, and automatic differentiation makes of it
//!
//! ```text
//! d/dt dL/dq'_k - dL/dq_k = sum_i tau_i dtheta_i/dq_k + F_k + W_k
//! ```
//! with the torques tau_i of the motors, the forces F_k of the sliders' drives, and the wrench W. Nothing is shared with the
//! core but the description of the machine, and no acceleration of a body, inertia matrix or Jacobian is written by hand.
//!
//! | module | contents |
//! |---|---|
//! | [`bodies`] | loop closure, places of the bodies, energies |
//! | [`equations`] | derivatives of the Lagrangian, torques and forces |

pub mod bodies;
pub mod equations;

use crate::double_double::DoubleDouble;
use trirrr_core::machine::{LegParameters, Parameters, PlatformParameters};
use trirrr_linkage::redundant::{RedundantParameters, SliderParameters};

/// Machine with three or more legs, some of them on sliders.
#[derive(Clone, Debug)]
pub struct LagrangeMachine {
    /// The legs.
    pub legs: Vec<LegParameters>,
    /// Slider of each leg, if it has one.
    pub sliders: Vec<Option<SliderParameters>>,
    /// The platform.
    pub platform: PlatformParameters,
    /// Gravity, m/s^2.
    pub gravity: [f64; 2],
    /// Force on the platform at D, N.
    pub force: [f64; 2],
    /// Moment on the platform, N m.
    pub moment: f64,
}

/// State of a machine: each coordinate with its rate and its acceleration.
#[derive(Clone, Debug)]
pub struct LagrangeState {
    /// x, y (m) and alpha (rad).
    pub platform: [[f64; 3]; 3],
    /// Each leg's slider, m; not used for a leg without one.
    pub sliders: Vec<[f64; 3]>,
}

/// Torques and forces that drive the machine.
#[derive(Clone, Debug)]
pub struct LagrangeLoads {
    /// Torque of each motor, N m.
    pub torques: Vec<DoubleDouble>,
    /// Force of each leg's slider, N, if it has one.
    pub sliders: Vec<Option<DoubleDouble>>,
}

impl<const LEGS: usize> From<&RedundantParameters<LEGS>> for LagrangeMachine {
    fn from(given: &RedundantParameters<LEGS>) -> Self {
        Self {
            legs: given.legs.to_vec(),
            sliders: given.sliders.to_vec(),
            platform: given.platform,
            gravity: given.gravity_m_s2.into(),
            force: given.wrench_force_n.into(),
            moment: given.wrench_torque_nm,
        }
    }
}

impl From<&Parameters> for LagrangeMachine {
    fn from(given: &Parameters) -> Self {
        Self {
            legs: given.legs.to_vec(),
            sliders: vec![None; 3],
            platform: given.platform,
            gravity: given.gravity_m_s2.into(),
            force: given.wrench_force_n.into(),
            moment: given.wrench_torque_nm,
        }
    }
}
