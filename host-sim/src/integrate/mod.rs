//! Initial value problems of ordinary differential equations: [`System`] is what is integrated,
//! [`Method`] is how. Knows nothing of what the equations describe.

pub mod failure;
pub mod jacobian;
pub mod method;
pub mod system;

pub use failure::{Failure, Reason, Unfit};
pub use method::Method;
pub use system::{Action, Direction, Matrix, System};
