//! Cost of an integration.

/// Counts of work: they repeat exactly, which time does not.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Steps accepted.
    pub steps: u64,
    /// Steps tried and rejected.
    pub rejected: u64,
    /// Derivatives evaluated, those for Jacobians apart.
    pub derivatives: u64,
    /// Jacobians evaluated.
    pub jacobians: u64,
    /// Factorisations of the matrices of the implicit equations, a real and a complex one each.
    pub factorisations: u64,
    /// Events located.
    pub events: u64,
}

impl Tally {
    /// Cost in derivatives for a system of `dimension` variables, a Jacobian counted as the
    /// derivatives that its central differences take.
    pub fn cost(&self, dimension: usize) -> u64 {
        self.derivatives + 2 * dimension as u64 * self.jacobians
    }
}
