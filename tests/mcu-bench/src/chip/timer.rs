//! A timer that counts up: updates, PWM, the interface of an encoder (RM0090, chapters 17 to 20).

use crate::time::Time;

/// Change of a PWM channel's output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ChannelEdge {
    pub(crate) time: Time,
    /// 0 to 3.
    pub(crate) channel: u8,
    pub(crate) high: bool,
}

#[derive(Clone, Debug)]
pub(crate) struct Timer {
    /// Period of the clock at its input.
    pub(crate) clock: Time,
    control: u32,
    slave: u32,
    interrupts: u32,
    status: u32,
    modes: [u32; 2],
    outputs: u32,
    prescaler: u32,
    prescaler_next: u32,
    reload: u32,
    reload_next: u32,
    compare: [u32; 4],
    compare_next: [u32; 4],
    breaks: u32,
    control_2: u32,
    /// Time at which the counter was 0.
    start: Time,
    /// Time up to which edges were given out.
    seen: Time,
    /// Counter of one that stands, or counts an encoder.
    count: u32,
    /// Greatest count: of 16 bits, or of 32.
    most: u32,
}

const ENABLE: u32 = 1;

impl Timer {
    pub(crate) fn new(wide: bool) -> Self {
        let most = if wide { u32::MAX } else { 0xFFFF };
        Self {
            clock: 1,
            control: 0,
            slave: 0,
            interrupts: 0,
            status: 0,
            modes: [0; 2],
            outputs: 0,
            prescaler: 0,
            prescaler_next: 0,
            reload: most,
            reload_next: most,
            compare: [0; 4],
            compare_next: [0; 4],
            breaks: 0,
            control_2: 0,
            start: 0,
            seen: 0,
            count: 0,
            most,
        }
    }

    fn runs(&self) -> bool {
        self.control & ENABLE != 0 && !self.is_encoder()
    }

    /// Counts the edges of an encoder in place of a clock.
    fn is_encoder(&self) -> bool {
        matches!(self.slave & 7, 1..=3)
    }

    /// Moves the counter of an encoder by `counts`.
    pub(crate) fn turn(&mut self, counts: i32) {
        if self.is_encoder() && self.control & ENABLE != 0 {
            self.count = self.count.wrapping_add_signed(counts) & self.most;
        }
    }

    /// Returns the time for which a level at an input of an encoder has to last to count, of the input that lets the shorter ones through (RM0090, 17.4.7).
    pub(crate) fn shortest_level(&self) -> Time {
        // Divider of the clock that samples, and samples.
        const FILTERS: [(Time, Time); 16] = [
            (1, 0),
            (1, 2),
            (1, 4),
            (1, 8),
            (2, 6),
            (2, 8),
            (4, 6),
            (4, 8),
            (8, 6),
            (8, 8),
            (16, 5),
            (16, 6),
            (16, 8),
            (32, 5),
            (32, 6),
            (32, 8),
        ];
        let of = |channel: u8| FILTERS[(self.mode(channel) >> 4 & 0xF) as usize];
        let times = [0, 1].map(|channel| {
            let (divider, samples) = of(channel);
            self.clock * divider * samples
        });
        times[0].min(times[1])
    }

    /// Returns the set value of a channel's PWM, and the counts of its period; none if the timer does not drive it.
    pub(crate) fn set_value(&self, channel: u8) -> Option<(u16, u16)> {
        let full = (self.reload + 1).min(u32::from(u16::MAX)) as u16;
        self.is_pwm(channel)
            .then(|| (self.compare[usize::from(channel)] as u16, full))
    }

    fn count_time(&self) -> Time {
        self.clock * (Time::from(self.prescaler) + 1)
    }

    /// Returns the time from one update to the next.
    pub(crate) fn period(&self) -> Time {
        self.count_time() * (Time::from(self.reload) + 1)
    }

    /// Returns the time of the next update that asks for an interrupt.
    pub(crate) fn next_interrupt(&self) -> Option<Time> {
        (self.runs() && self.interrupts & 1 != 0).then(|| self.start + self.period())
    }

    pub(crate) fn interrupts(&self) -> bool {
        self.status & self.interrupts & 1 != 0
    }

    /// Counts on to `now`, and gives out the edges of the channels on the way.
    pub(crate) fn advance(&mut self, now: Time, mut edge: impl FnMut(ChannelEdge)) {
        if !self.runs() {
            self.seen = now;
            return;
        }
        loop {
            let end = self.start + self.period();
            self.match_channels(now.min(end - 1), &mut edge);
            if now < end {
                // An interrupt may go back by a part of a block.
                self.seen = self.seen.max(now);
                return;
            }
            self.seen = end;
            self.start = end;
            self.update(end, &mut edge);
        }
    }

    /// Levels of the channels that fall until `until`, within a period.
    fn match_channels(&self, until: Time, edge: &mut impl FnMut(ChannelEdge)) {
        for channel in 0..4_u8 {
            let compare = self.compare[usize::from(channel)];
            if self.is_pwm(channel) && compare <= self.reload && compare > 0 {
                let time = self.start + Time::from(compare) * self.count_time();
                if time > self.seen && time <= until {
                    let high = self.inverts(channel);
                    edge(ChannelEdge {
                        time,
                        channel,
                        high,
                    });
                }
            }
        }
    }

    fn update(&mut self, time: Time, edge: &mut impl FnMut(ChannelEdge)) {
        self.status |= 1;
        self.prescaler = self.prescaler_next;
        self.reload = self.reload_next;
        self.compare = self.compare_next;
        for channel in 0..4 {
            if self.is_pwm(channel) {
                let high = self.level(channel, time);
                edge(ChannelEdge {
                    time,
                    channel,
                    high,
                });
            }
        }
    }

    fn mode(&self, channel: u8) -> u32 {
        self.modes[usize::from(channel / 2)] >> (8 * (channel % 2)) & 0xFF
    }

    /// In PWM mode 1, with its output on.
    fn is_pwm(&self, channel: u8) -> bool {
        self.mode(channel) >> 4 & 7 == 6 && self.outputs >> (4 * channel) & 1 != 0
    }

    fn inverts(&self, channel: u8) -> bool {
        self.outputs >> (4 * channel + 1) & 1 != 0
    }

    fn counter(&self, now: Time) -> u32 {
        match self.runs() {
            true => (now.saturating_sub(self.start) / self.count_time()) as u32,
            false => self.count,
        }
    }

    fn level(&self, channel: u8, now: Time) -> bool {
        (self.counter(now) < self.compare[usize::from(channel)]) != self.inverts(channel)
    }

    /// Returns the level of a channel's output, or none if the timer does not drive it.
    pub(crate) fn output(&self, channel: u8, now: Time) -> Option<bool> {
        self.is_pwm(channel).then(|| self.level(channel, now))
    }

    pub(crate) fn read(&self, offset: u32, now: Time) -> Option<u32> {
        Some(match offset {
            0x00 => self.control,
            0x04 => self.control_2,
            0x08 => self.slave,
            0x0C => self.interrupts,
            0x10 => self.status,
            0x14 => 0,
            0x18 => self.modes[0],
            0x1C => self.modes[1],
            0x20 => self.outputs,
            0x24 => self.counter(now),
            0x28 => self.prescaler_next,
            0x2C => self.reload_next,
            0x34..=0x40 => self.compare_next[(offset as usize - 0x34) / 4],
            0x44 => self.breaks,
            _ => return None,
        })
    }

    /// The timer has to be [advanced](Self::advance) to `now` before.
    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Time) -> bool {
        match offset {
            0x00 => {
                let count = self.counter(now);
                self.control = value;
                self.count = count;
                self.start = now - Time::from(count) * self.count_time().min(now);
            }
            0x04 => self.control_2 = value,
            0x08 => self.slave = value,
            0x0C => self.interrupts = value,
            0x10 => self.status &= value,
            0x14 if value & 1 != 0 => {
                self.count = 0;
                self.start = now;
                self.update(now, &mut |_| {});
            }
            0x14 => {}
            0x18 => self.modes[0] = value,
            0x1C => self.modes[1] = value,
            0x20 => self.outputs = value,
            0x24 => {
                self.count = value & self.most;
                self.start = now.saturating_sub(Time::from(value) * self.count_time());
            }
            0x28 => self.prescaler_next = value,
            0x2C => {
                self.reload_next = value;
                // Without the preload it counts at once.
                if self.control & 1 << 7 == 0 {
                    self.reload = value;
                }
            }
            0x34..=0x40 => {
                let channel = (offset as usize - 0x34) / 4;
                self.compare_next[channel] = value;
                if self.mode(channel as u8) & 1 << 3 == 0 {
                    self.compare[channel] = value;
                }
            }
            0x44 => self.breaks = value,
            _ => return false,
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pwm(preload: u32) -> Timer {
        let mut timer = Timer::new(false);
        timer.clock = 12;
        timer.write(0x2C, 99, 0);
        timer.write(0x18, 6 << 4 | preload << 3, 0);
        timer.write(0x20, 1, 0);
        timer.write(0x14, 1, 0);
        timer.write(0x00, 1, 0);
        timer
    }

    fn edges(timer: &mut Timer, until: Time) -> Vec<(Time, bool)> {
        let mut edges = Vec::new();
        timer.advance(until, |edge| edges.push((edge.time, edge.high)));
        edges
    }

    #[test]
    fn a_duty_is_high_for_so_many_counts() {
        let mut timer = pwm(0);
        timer.write(0x34, 25, 0);
        assert_eq!(
            edges(&mut timer, 1500),
            [(300, false), (1200, true), (1500, false)]
        );
        assert_eq!(edges(&mut timer, 2700), [(2400, true), (2700, false)]);
    }

    #[test]
    fn a_preloaded_duty_waits_for_the_end_of_the_period() {
        let mut timer = pwm(1);
        timer.write(0x34, 25, 0);
        assert_eq!(edges(&mut timer, 1199), []);
        assert_eq!(edges(&mut timer, 1500), [(1200, true), (1500, false)]);
    }

    #[test]
    fn all_and_none_of_the_duty_have_no_edge() {
        let mut timer = pwm(0);
        timer.write(0x34, 100, 0);
        assert!(edges(&mut timer, 5000).iter().all(|(_, high)| *high));
        timer.write(0x34, 0, 5000);
        assert!(edges(&mut timer, 9000).iter().all(|(_, high)| !high));
    }

    #[test]
    fn an_update_asks_for_an_interrupt_until_it_is_cleared() {
        let mut timer = pwm(0);
        timer.write(0x0C, 1, 0);
        timer.write(0x10, 0, 0);
        assert_eq!(timer.next_interrupt(), Some(1200));
        edges(&mut timer, 1200);
        assert!(timer.interrupts());
        timer.write(0x10, !1, 1200);
        assert!(!timer.interrupts());
        assert_eq!(timer.next_interrupt(), Some(2400));
    }

    #[test]
    fn an_encoder_counts_in_both_directions_and_no_time() {
        let mut timer = Timer::new(false);
        timer.write(0x08, 3, 0);
        timer.write(0x00, 1, 0);
        timer.turn(-3);
        edges(&mut timer, 1_000_000);
        assert_eq!(timer.read(0x24, 1_000_000), Some(0xFFFD));
    }
}
