//! Statistics of a run.

/// Peak and root mean square of a signal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Signal {
    /// Largest size.
    pub peak: f64,
    /// Instant of the peak, s.
    pub peak_t: f64,
    sum: f64,
    count: u64,
}

impl Signal {
    /// Takes one value.
    #[inline(always)]
    pub fn push(&mut self, t: f64, value: f64) {
        let square = value * value;
        self.sum += square;
        self.count += 1;
        if value.abs() > self.peak {
            (self.peak, self.peak_t) = (value.abs(), t);
        }
    }

    /// Root mean square; 0 of nothing.
    pub fn rms(&self) -> f64 {
        if self.count == 0 {
            return 0.0;
        }
        (self.sum / self.count as f64).sqrt()
    }
}

/// Time during which a limit acted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Active {
    /// First time, s.
    pub first: Option<f64>,
    /// In all, s.
    pub total: f64,
    since: Option<f64>,
}

impl Active {
    /// From `t` on it acts, or does not.
    #[inline(always)]
    pub fn set(&mut self, t: f64, active: bool) {
        match (self.since, active) {
            (None, true) => {
                self.since = Some(t);
                self.first = self.first.or(Some(t));
            }
            (Some(since), false) => {
                self.total += t - since;
                self.since = None;
            }
            _ => {}
        }
    }
}

/// One motor over a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MotorStatistics {
    /// Reference less joint angle, rad.
    pub error: Signal,
    /// Torque of the motor at the joint, N m, its rotor's inertia included.
    pub torque: Signal,
    /// Current, A.
    pub current: Signal,
    /// Mechanical power of the motor, W.
    pub power: Signal,
    /// Limit of the current.
    pub current_limit: Active,
    /// Limit of the voltage.
    pub voltage_limit: Active,
    /// Times that a stepper fell to the next stable position, four full steps each, either way.
    pub slips: u64,
    /// Time of the first.
    pub first_slip: Option<f64>,
    /// Full steps that it is behind its field now; negative where it is ahead.
    pub lost_steps: i64,
}

/// A whole run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Distance of the platform's D from its setpoint, m.
    pub tool_position: Signal,
    /// Angle of the platform less its setpoint, rad.
    pub tool_angle: Signal,
    /// The motors.
    pub motors: [MotorStatistics; 3],
}

impl Statistics {
    /// Takes the platform at `pose`, which should be at `setpoint`.
    pub fn tool(&mut self, t: f64, pose: [f64; 3], setpoint: [f64; 3]) {
        let (dx, dy) = (pose[0] - setpoint[0], pose[1] - setpoint[1]);
        self.tool_position.push(t, dx.hypot(dy));
        self.tool_angle.push(t, pose[2] - setpoint[2]);
    }

    /// Ends what is still active at the end of the run.
    pub fn finish(&mut self, t: f64) {
        for motor in &mut self.motors {
            motor.current_limit.set(t, false);
            motor.voltage_limit.set(t, false);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn peak_and_rms() {
        let mut signal = Signal::default();
        assert_eq!(signal.rms(), 0.0);
        for (t, value) in [(0.0, 3.0), (1.0, -4.0)] {
            signal.push(t, value);
        }
        assert_eq!((signal.peak, signal.peak_t), (4.0, 1.0));
        assert_eq!(signal.rms(), 12.5f64.sqrt());
    }

    #[test]
    fn time_of_a_limit() {
        let mut active = Active::default();
        for (t, on) in [
            (0.0, false),
            (1.0, true),
            (2.0, true),
            (3.5, false),
            (5.0, true),
        ] {
            active.set(t, on);
        }
        active.set(6.0, false);
        assert_eq!((active.first, active.total), (Some(1.0), 3.5));
    }
}
