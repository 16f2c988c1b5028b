//! Tools: from the power of a tick to a duty, a servo's pulse or a level.
//!
//! | tool | pins | output |
//! |---|---|---|
//! | laser, spindle | [`DutyOutput`] | duty between the least and the greatest, 0 where the tool is off; an enable line beside it |
//! | pen lifter on a servo | [`DutyOutput`] | pulse between that of the pen up and that of the pen down |
//! | gripper, relay | [`LevelOutput`] | level |
//!
//! A [`ToolLine`] stands between the tick and these. It delays the power by whole ticks, as the motors follow their commands,
//! and switches off without a delay where no job runs.

use crate::count::Countable;
use crate::enable::{Active, Enable};
use embedded_hal::digital::OutputPin;
use embedded_hal::pwm::SetDutyCycle;

/// Full power, and the full duty, in parts.
pub const FULL: u16 = u16::MAX;

/// Output of a tool.
pub trait ToolOutput {
    /// Sets the power, in parts of [`FULL`]; 0 is off. `runs` is true while a job runs.
    fn set(&mut self, parts: u16, runs: bool);
}

/// Duties of a tool, in parts of [`FULL`] of the full duty.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DutySpan {
    /// Duty of the tool that is off,
    pub off: u16,
    /// at the end of power towards 0,
    pub least: u16,
    /// and at full power; less than `least` for a servo that turns the other way.
    pub most: u16,
}

impl DutySpan {
    /// Returns the same duties in counts of a timer with the full duty `full`, each to the nearest.
    fn counts(&self, full: u16) -> Self {
        let count = |part: u16| {
            let counts = u32::from(part) * u32::from(full) + u32::from(FULL) / 2;
            (counts / u32::from(FULL)) as u16
        };
        Self {
            off: count(self.off),
            least: count(self.least),
            most: count(self.most),
        }
    }

    /// Returns the duty at a power in parts of [`FULL`].
    #[inline(always)]
    fn at(&self, parts: u16) -> u16 {
        if parts == 0 {
            return self.off;
        }
        let (least, most) = (i64::from(self.least), i64::from(self.most));
        // Rounded towards `least`: no power gives more than it asks for.
        (least + (most - least) * i64::from(parts) / i64::from(FULL)) as u16
    }
}

/// PWM output of a tool, with its enable line if it has one.
#[derive(Debug)]
pub struct DutyOutput<P, E> {
    pwm: P,
    enable: Option<Enable<E>>,
    /// In counts of the timer.
    span: DutySpan,
    full: u16,
    inverted: bool,
}

impl<P: SetDutyCycle, E: OutputPin> DutyOutput<P, E> {
    /// Takes the output with its duties, and switches off. `inverted`: the tool takes a low level for on.
    pub fn new(pwm: P, enable: Option<Enable<E>>, span: DutySpan, inverted: bool) -> Self {
        let full = pwm.max_duty_cycle();
        let mut output = Self {
            pwm,
            enable,
            span: span.counts(full),
            full,
            inverted,
        };
        output.set(0, false);
        output
    }
}

impl<P: SetDutyCycle, E: OutputPin> ToolOutput for DutyOutput<P, E> {
    #[inline(always)]
    fn set(&mut self, parts: u16, runs: bool) {
        let duty = self.span.at(parts);
        let duty = match self.inverted {
            true => self.full - duty.min(self.full),
            false => duty,
        };
        // Pins of the chip itself do not fail. What is left would be off in the next tick.
        let _ = self.pwm.set_duty_cycle(duty);
        if let Some(enable) = &mut self.enable {
            let _ = enable.switch(runs);
        }
    }
}

/// Digital output of a tool: on at any power.
#[derive(Debug)]
pub struct LevelOutput<P> {
    pin: P,
    on: Active,
}

impl<P: OutputPin> LevelOutput<P> {
    /// Takes the pin with the level at which the tool is on, and switches off.
    pub fn new(pin: P, on: Active) -> Self {
        let mut output = Self { pin, on };
        output.set(0, false);
        output
    }
}

impl<P: OutputPin> ToolOutput for LevelOutput<P> {
    #[inline(always)]
    fn set(&mut self, parts: u16, _: bool) {
        // A pin of the chip itself does not fail.
        let _ = match (parts > 0) == (self.on == Active::High) {
            true => self.pin.set_high(),
            false => self.pin.set_low(),
        };
    }
}

/// Tool behind its output: the power of each tick, `DELAY` ticks later while a job runs.
#[derive(Debug)]
pub struct ToolLine<O, const DELAY: usize> {
    output: O,
    /// Powers of the last ticks, the oldest at `next`.
    waiting: [u16; DELAY],
    next: usize,
    /// Power that a job has asked for last.
    asked: u16,
    holds: bool,
}

impl<O: ToolOutput, const DELAY: usize> ToolLine<O, DELAY> {
    /// Takes an output that is off. A tool that `holds` keeps its power where no job runs: a gripper does not let go.
    pub const fn new(output: O, holds: bool) -> Self {
        Self {
            output,
            waiting: [0; DELAY],
            next: 0,
            asked: 0,
            holds,
        }
    }

    /// Carries out the `power` of a tick, 0 to 1; `runs` is true while a job runs. Once per tick.
    #[inline(always)]
    pub fn apply<N: Countable>(&mut self, power: N, runs: bool) {
        if runs {
            // No power below 0: `parts` would take it for one above.
            self.asked = if power > N::ZERO {
                power.parts(FULL)
            } else {
                0
            };
        } else if !self.holds {
            return self.switch_off();
        }
        let parts = self.delayed(self.asked);
        self.output.set(parts, runs);
    }

    /// Switches off at once, and forgets what was to come.
    #[inline(always)]
    pub fn switch_off(&mut self) {
        self.asked = 0;
        self.waiting = [0; DELAY];
        self.output.set(0, false);
    }

    /// Puts a power in, and takes that of `DELAY` ticks ago out.
    #[inline(always)]
    fn delayed(&mut self, parts: u16) -> u16 {
        let Some(oldest) = self.waiting.get_mut(self.next) else {
            return parts;
        };
        self.next = match self.next + 1 < DELAY {
            true => self.next + 1,
            false => 0,
        };
        core::mem::replace(oldest, parts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::cell::RefCell;
    use core::convert::Infallible;
    use embedded_hal::{digital, pwm};
    use trirrr_core::number::{Coarse, Fixed};

    /// Timer of a thousand counts, which notes its duties.
    struct Timer<'a>(&'a RefCell<Vec<u16>>);

    impl pwm::ErrorType for Timer<'_> {
        type Error = Infallible;
    }

    impl SetDutyCycle for Timer<'_> {
        fn max_duty_cycle(&self) -> u16 {
            1000
        }

        fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
            self.0.borrow_mut().push(duty);
            Ok(())
        }
    }

    /// Pin that notes its levels.
    struct Level<'a>(&'a RefCell<Vec<bool>>);

    impl digital::ErrorType for Level<'_> {
        type Error = Infallible;
    }

    impl OutputPin for Level<'_> {
        fn set_low(&mut self) -> Result<(), Infallible> {
            self.0.borrow_mut().push(false);
            Ok(())
        }

        fn set_high(&mut self) -> Result<(), Infallible> {
            self.0.borrow_mut().push(true);
            Ok(())
        }
    }

    const LASER: DutySpan = DutySpan {
        off: 0,
        least: FULL / 10,
        most: FULL,
    };

    /// Duties of a tool without a delay, for powers of a job that runs.
    fn duties<N: Countable>(span: DutySpan, inverted: bool, powers: &[f64]) -> Vec<u16> {
        let duties = RefCell::default();
        let output = DutyOutput::<_, Level>::new(Timer(&duties), None, span, inverted);
        let mut line = ToolLine::<_, 0>::new(output, false);
        for power in powers {
            line.apply(N::from_f64(*power), true);
        }
        duties.into_inner()
    }

    #[test]
    fn the_duty_goes_from_the_least_to_the_greatest_and_off_is_none() {
        fn check<N: Countable>() {
            let powers = [1e-4, 0.5, 1.0, 0.0, -1.0];
            // The first is that of the output before any tick.
            assert_eq!(
                duties::<N>(LASER, false, &powers),
                [0, 100, 550, 1000, 0, 0]
            );
            assert_eq!(
                duties::<N>(LASER, true, &powers),
                [1000, 900, 450, 0, 1000, 1000]
            );
        }
        check::<f64>();
        check::<f32>();
        check::<Coarse>();
        check::<Fixed>();
        assert_eq!(duties::<f64>(LASER, false, &[f64::NAN, 2.0]), [0, 0, 1000]);
    }

    #[test]
    fn a_servo_keeps_its_pulses_and_goes_either_way() {
        let span = DutySpan {
            off: FULL / 10,
            least: FULL / 10,
            most: FULL / 20,
        };
        let found = duties::<f32>(span, false, &[1.0, 0.5, 0.0]);
        assert_eq!(found, [100, 50, 75, 100]);
    }

    #[test]
    fn a_power_comes_after_its_delay_and_goes_at_once_where_no_job_runs() {
        let (duties, levels) = (RefCell::default(), RefCell::default());
        let Ok(enable) = Enable::new(Level(&levels), Active::High);
        let output = DutyOutput::new(Timer(&duties), Some(enable), LASER, false);
        let mut line = ToolLine::<_, 2>::new(output, false);
        for power in [1.0, 0.0, 1.0, 1.0, 0.0] {
            line.apply(power, true);
        }
        assert_eq!(duties.take(), [0, 0, 0, 1000, 0, 1000]);
        assert_eq!(levels.take(), [false, true]);
        // A hold: off in this very tick, and what was to come does not come afterwards.
        line.apply(0.0, false);
        assert_eq!((duties.take(), levels.take()), (vec![0], vec![false]));
        for power in [0.0, 0.0, 1.0] {
            line.apply(power, true);
        }
        assert_eq!((duties.take(), levels.take()), (vec![0, 0, 0], vec![true]));
        line.switch_off();
        assert_eq!((duties.take(), levels.take()), (vec![0], vec![false]));
    }

    #[test]
    fn a_gripper_lets_go_where_a_job_says_so_and_nowhere_else() {
        let levels = RefCell::default();
        let mut line = ToolLine::<_, 1>::new(LevelOutput::new(Level(&levels), Active::Low), true);
        assert_eq!(levels.take(), [true]);
        line.apply(0.3f32, true);
        for _ in 0..3 {
            line.apply(0.0f32, false);
        }
        assert_eq!(levels.take(), [true, false, false, false]);
        line.apply(0.0f32, true);
        line.apply(0.0f32, true);
        assert_eq!(levels.take(), [false, true]);
    }

    #[test]
    fn a_relay_is_off_where_no_job_runs() {
        let levels = RefCell::default();
        let output = LevelOutput::new(Level(&levels), Active::High);
        let mut line = ToolLine::<_, 0>::new(output, false);
        line.apply(0.01f32, true);
        line.apply(1.0f32, false);
        assert_eq!(levels.take(), [false, true, false]);
    }
}
