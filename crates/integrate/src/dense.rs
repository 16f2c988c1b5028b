//! Dense output: the solution between the two ends of a step.

/// Polynomial through a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Interpolant {
    /// A straight line between the ends. No terms. Error of order h^2.
    Linear,
    /// Of the four stages of the classical method (terms 0 to 3), order 3.
    Rk4,
    /// Of the seven stages of Dormand and Prince (terms 0 to 6), order 4.
    DormandPrince,
    /// The collocation polynomial of Radau IIA through its stages less y0 (terms 0 to 2), order 3.
    RadauIia,
}

/// Most terms that an interpolant has.
pub(crate) const TERMS: usize = 7;

/// One step and the solution anywhere within it.
#[derive(Clone, Debug)]
pub struct Dense<const N: usize> {
    pub(crate) t0: f64,
    pub(crate) t1: f64,
    pub(crate) y0: [f64; N],
    pub(crate) y1: [f64; N],
    pub(crate) interpolant: Interpolant,
    pub(crate) terms: [[f64; N]; TERMS],
}

impl<const N: usize> Dense<N> {
    pub(crate) fn new(interpolant: Interpolant) -> Self {
        Self {
            t0: 0.0,
            t1: 0.0,
            y0: [0.0; N],
            y1: [0.0; N],
            interpolant,
            terms: [[0.0; N]; TERMS],
        }
    }

    /// Time in s at which the step starts.
    pub fn start(&self) -> f64 {
        self.t0
    }

    /// Time in s at which the step ends.
    pub fn end(&self) -> f64 {
        self.t1
    }

    /// State at the start of the step.
    pub fn first(&self) -> &[f64; N] {
        &self.y0
    }

    /// State at the end of the step, before any event there changes it.
    pub fn last(&self) -> &[f64; N] {
        &self.y1
    }

    /// State at the time `t` in s. At the ends of the step it is [`Dense::first`] and
    /// [`Dense::last`] to the last bit; outside the step the polynomial is continued.
    pub fn at(&self, t: f64) -> [f64; N] {
        if t == self.t0 {
            return self.y0;
        }
        if t == self.t1 {
            return self.y1;
        }
        let h = self.t1 - self.t0;
        let theta = (t - self.t0) / h;
        match self.interpolant {
            Interpolant::Linear => self.sum(theta, []),
            Interpolant::Rk4 => {
                let (square, cube) = (theta * theta, theta * theta * theta);
                let first = theta - 1.5 * square + 2.0 / 3.0 * cube;
                let middle = square - 2.0 / 3.0 * cube;
                let last = -0.5 * square + 2.0 / 3.0 * cube;
                self.sum(0.0, [first, middle, middle, last].map(|weight| h * weight))
            }
            Interpolant::DormandPrince => {
                let rest = 1.0 - theta;
                let bow = theta * rest;
                let mut weights = DORMAND_PRINCE.map(|d| h * bow * bow * d);
                weights[0] += h * bow * rest;
                weights[6] -= h * bow * theta;
                self.sum(theta + bow * (2.0 * theta - 1.0), weights)
            }
            Interpolant::RadauIia => {
                let [c1, c2, c3] = RADAU_NODES;
                // Lagrange polynomials over the nodes 0, c1, c2, c3.
                let basis = |node: f64, other: f64, third: f64| {
                    theta * (theta - other) * (theta - third)
                        / (node * (node - other) * (node - third))
                };
                self.sum(
                    0.0,
                    [basis(c1, c2, c3), basis(c2, c1, c3), basis(c3, c1, c2)],
                )
            }
        }
    }

    /// y0 + `chord` (y1 - y0) + the weighted sum of the first terms.
    fn sum<const K: usize>(&self, chord: f64, weights: [f64; K]) -> [f64; N] {
        std::array::from_fn(|i| {
            let mut bend = chord * (self.y1[i] - self.y0[i]);
            for (weight, term) in weights.iter().zip(&self.terms) {
                bend += weight * term[i];
            }
            self.y0[i] + bend
        })
    }
}

/// sqrt(6)
pub(crate) const SQRT_6: f64 = 2.449_489_742_783_178;
/// Instants of the stages of Radau IIA within a step.
pub(crate) const RADAU_NODES: [f64; 3] = [(4.0 - SQRT_6) / 10.0, (4.0 + SQRT_6) / 10.0, 1.0];
/// Weights of the stages in the highest coefficient of Dormand and Prince's dense output
/// (Hairer, Norsett, Wanner, *Solving Ordinary Differential Equations I*, II.6, and DOPRI5).
const DORMAND_PRINCE: [f64; 7] = [
    -12_715_105_075.0 / 11_282_082_432.0,
    0.0,
    87_487_479_700.0 / 32_700_410_799.0,
    -10_690_763_975.0 / 1_880_347_072.0,
    701_980_252_875.0 / 199_316_789_632.0,
    -1_453_857_185.0 / 822_651_844.0,
    69_997_945.0 / 29_380_423.0,
];
