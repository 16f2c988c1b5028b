//! Torques and forces of the drives, by virtual work.
//!
//! With J the derivatives of all equations by the poses of all links, the rates of the links for a rate of drive k alone are
//! v_k = J^-1 e_k. A drive does the work of everything else: its torque is v_k . f, where f is, for each link, m (a_G - g) and the moment
//! I e + r_G x m (a_G - g) about the link's origin. So all drives together are J^-T f at the drives' equations.

use super::constraint::equations;
use super::description::{FRAME, Linkage};
use super::factors::Factors;
use super::parts::BodyMass;
use super::solve::Position;
use nalgebra::DMatrix;
use trirrr_core::number::cross;

impl Linkage {
    /// Returns `true` if a link has mass or inertia: the drives have loads.
    pub fn has_masses(&self) -> bool {
        self.links.iter().any(|link| link.mass != BodyMass::NONE)
    }
}

/// Loads of the drives at a position, in their order: N m on the driven link, or N along the guide on the slider. `None` at a singular
/// position.
pub fn drive_loads(linkage: &Linkage, position: &Position) -> Option<Vec<f64>> {
    let unknowns = 3 * (linkage.links.len() - 1);
    let mut states = position.states.clone();
    for state in &mut states[FRAME + 1..] {
        state.known = false;
    }
    let mut transposed = DMatrix::zeros(unknowns, unknowns);
    let mut rows_of_drives = vec![0; linkage.drives.len()];
    let mut row = 0;
    // As they are solved: each joint ties a group to what comes before it.
    for group in &linkage.groups {
        let of_group = equations(linkage, group, &states, position.t);
        // The drives' equations are the last ones.
        let first_drive = row + of_group.len().checked_sub(group.drives.len())?;
        for (index, &drive) in group.drives.iter().enumerate() {
            rows_of_drives[drive] = first_drive + index;
        }
        for equation in of_group {
            if row == unknowns {
                return None;
            }
            for (link, by) in equation.by {
                for (axis, by) in by.into_iter().enumerate().filter(|_| link != FRAME) {
                    transposed[(3 * (link - 1) + axis, row)] += by;
                }
            }
            row += 1;
        }
        for &link in &group.links {
            states[link].known = true;
        }
    }
    let mut forces = Vec::with_capacity(unknowns);
    for (link, state) in linkage.links.iter().zip(&position.states).skip(1) {
        let mass = &link.mass;
        let centre = state.motion.point(mass.com_m);
        let force = (centre.acceleration - linkage.gravity_m_s2) * mass.mass_kg;
        let arm = centre.position - state.motion.origin.position;
        let moment = mass.inertia_kgm2 * state.motion.acceleration + cross(arm, force);
        forces.extend([force.x, force.y, moment]);
    }
    let multipliers = Factors::new(transposed)?.solve(forces);
    let loads: Vec<f64> = rows_of_drives.iter().map(|&row| multipliers[row]).collect();
    loads.iter().all(|load| load.is_finite()).then_some(loads)
}
