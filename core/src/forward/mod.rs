//! Forward kinematics: from the motor angles to the pose.
//!
//! | question | module |
//! |---|---|
//! | which pose near this guess? | [`Forward::solve`], Newton-Raphson |
//! | which poses at all? | [`Forward::assemblies`], every assembly mode from the univariate polynomial |
//! | where is the platform now, given where it was? | [`Tracker`], which never changes mode silently |
//!
//! # The polynomial
//! With the motors at rest the elbows B_i are fixed points and the machine is the 3-RPR problem of
//! three legs of given lengths: circles of radius l2_i about B_i, on which the corners of the
//! platform's triangle have to lie. Let e_i = h_i - h_0 and b_i = B_i - B_0 for i = 1, 2, R the
//! platform's rotation by alpha, p = r2_0 the distal link of leg 0, and m_i = R e_i - b_i. Then
//!
//! ```text
//! |p|^2 = l_0^2,   |p + m_i|^2 = l_i^2     <=>     |p|^2 = l_0^2,   p . m_i = n_i
//! n_i = (l_i^2 - l_0^2 - |m_i|^2) / 2
//! ```
//!
//! The two linear equations give p = (q.y, -q.x) / (m_1 x m_2) with q = n_1 m_2 - n_2 m_1, and the
//! first one leaves the condition on alpha alone
//!
//! ```text
//! f(alpha) = |q|^2 - l_0^2 (m_1 x m_2)^2
//!          = n_1^2 (m_2.m_2) + n_2^2 (m_1.m_1) - 2 n_1 n_2 (m_1.m_2) - l_0^2 (m_1 x m_2)^2 = 0
//! ```
//!
//! n_i, m_i . m_j and m_1 x m_2 are each of the form a + b cos alpha + c sin alpha, so f is a
//! trigonometric polynomial of degree 3: with t = tan(alpha / 2) and (1 + t^2)^3 f a sextic, hence
//! at most six assembly modes. f is, up to a factor, the Cayley-Menger determinant of D and the
//! three points B_i - R h_i, from which D has the distances l2_i. Source of the sextic: Gosselin,
//! Sefrioui, Richard, *Solutions polynomiales au probleme de la cinematique directe des
//! manipulateurs paralleles plans a trois degres de liberte*, Mechanism and Machine Theory 27
//! (1992); the form above is derived here because it keeps every factor small where it matters.
//!
//! The seven coefficients are never formed for the whole circle, where the roots of a small
//! platform or of short links would drown in their rounding. The circle is divided into arcs, and on
//! each arc f is formed afresh, about the arc's middle, in the Bernstein basis with a bound on its
//! rounding error. An arc whose coefficients all have one sign holds no root; one whose
//! differences all have one sign holds a root exactly if f changes sign between its ends; any
//! other is halved. So no root is missed that the number type can tell from its neighbours, and
//! what it cannot tell apart is said to be so.

pub mod assembly;
mod isolate;
mod newton;
mod polynomial;
#[cfg(test)]
pub(crate) mod random;
mod search;
pub mod tracking;

pub use assembly::{Assemblies, Assembly, AssemblyError, Completeness};
pub use newton::{Forward, ForwardError, Found};
pub use tracking::{Track, Tracker, TrackingError};
