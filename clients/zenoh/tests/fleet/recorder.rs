//! Recorder: accounts for each sample of each machine, and fetches what it has missed.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;
use trirrr_zenoh::records::{self, RecordPlace};
use zenoh::pubsub::Subscriber;
use zenoh::query::ConsolidationMode;
use zenoh::{Session, Wait};

/// Samples of one machine.
#[derive(Default)]
struct Recorded {
    session: Option<u64>,
    every: u32,
    /// Number of the first sample that came.
    first: u64,
    /// Times that each came, and its tick and loss.
    samples: Vec<(u32, Option<RecordPlace>)>,
    fetched: u64,
}

/// Account of all samples.
#[derive(Debug, Default, PartialEq, Eq)]
pub(crate) struct Account {
    pub(crate) machines: usize,
    pub(crate) ticks: u64,
    /// Of these, fetched from a history.
    pub(crate) fetched: u64,
    pub(crate) lost: u64,
    pub(crate) doubled: u64,
    /// Ticks that do not follow the one before, or that the machine has dropped.
    pub(crate) out_of_step: u64,
}

pub(crate) struct Recorder {
    session: Session,
    batches: Receiver<(String, Vec<u8>)>,
    _subscriber: Subscriber<()>,
    machines: BTreeMap<String, Recorded>,
}

impl Recorder {
    pub(crate) fn start(session: &Session) -> Self {
        let (sender, batches) = channel();
        let subscriber = session
            .declare_subscriber("trirrr/*/telemetry")
            .callback(move |sample| {
                let name = sample.key_expr().as_str().split('/').nth(1).unwrap();
                let bytes = sample.payload().to_bytes().into_owned();
                let _ = sender.send((name.to_owned(), bytes));
            })
            .wait()
            .unwrap();
        Self {
            session: session.clone(),
            batches,
            _subscriber: subscriber,
            machines: BTreeMap::new(),
        }
    }

    /// Takes what has come, and fetches what is missing before it.
    pub(crate) fn work(&mut self) {
        while let Ok((name, bytes)) = self.batches.try_recv() {
            self.machines.entry(name).or_default().take(&bytes);
        }
        for (name, recorded) in &mut self.machines {
            // One range for each machine: the next call has the next.
            if let Some(range) = recorded.missing() {
                recorded.fetch(&self.session, name, range);
            }
        }
    }

    /// Works until each of `wanted`, a name and a number, has come, and all before it.
    pub(crate) fn complete(&mut self, wanted: &BTreeMap<String, u64>, within: Duration) {
        let begin = std::time::Instant::now();
        let has = |recorded: &Recorded, number: u64| {
            recorded.end() >= number && recorded.missing().is_none()
        };
        loop {
            self.work();
            let machines = &self.machines;
            let is_done = |(name, number): (&String, &u64)| {
                (machines.get(name)).is_some_and(|recorded| has(recorded, *number))
            };
            if wanted.iter().all(is_done) || begin.elapsed() > within {
                return;
            }
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// Account up to `wanted`.
    pub(crate) fn account(&self, wanted: &BTreeMap<String, u64>) -> Account {
        let mut account = Account {
            machines: wanted.len(),
            ..Account::default()
        };
        for (name, end) in wanted {
            let none = Recorded::default();
            let recorded = self.machines.get(name).unwrap_or(&none);
            account.fetched += recorded.fetched;
            let mut before: Option<RecordPlace> = None;
            for number in recorded.first..*end {
                let index = (number - recorded.first) as usize;
                let (times, place) = recorded.samples.get(index).copied().unwrap_or_default();
                account.ticks += u64::from(times > 0);
                account.lost += u64::from(times == 0);
                account.doubled += u64::from(times.saturating_sub(1));
                if let (Some(place), Some(before)) = (place, before) {
                    let step = place.tick.wrapping_sub(before.tick);
                    let is_next = step == recorded.every && place.lost == before.lost;
                    account.out_of_step += u64::from(!is_next);
                }
                before = place.or(before);
            }
        }
        account
    }
}

impl Recorded {
    fn end(&self) -> u64 {
        self.first + self.samples.len() as u64
    }

    fn take(&mut self, bytes: &[u8]) {
        let (header, places) = records::read(bytes).expect("a batch of this version");
        self.every = header.every;
        let session = *self.session.get_or_insert(header.session);
        assert_eq!(session, header.session, "the program was started anew");
        for place in places {
            if self.samples.is_empty() {
                self.first = place.number;
            }
            let Some(index) = place.number.checked_sub(self.first) else {
                panic!("sample {} comes behind {}", place.number, self.first);
            };
            let index = index as usize;
            if index >= self.samples.len() {
                self.samples.resize(index + 1, (0, None));
            }
            let (times, kept) = &mut self.samples[index];
            *times += 1;
            *kept = Some(place);
        }
    }

    /// First range that is missing before what has come.
    fn missing(&self) -> Option<Range<u64>> {
        let is_missing = |(times, _): &(u32, Option<RecordPlace>)| *times == 0;
        let start = self.samples.iter().position(is_missing)?;
        let length = self.samples[start..]
            .iter()
            .take_while(|s| is_missing(s))
            .count();
        let start = self.first + start as u64;
        Some(start..start + length as u64)
    }

    /// Asks for a range. What does not come stays missing.
    fn fetch(&mut self, session: &Session, name: &str, range: Range<u64>) {
        let Range { start, end } = range;
        let of = self.session.unwrap_or_default();
        let selector = format!("trirrr/{name}/telemetry?session={of:016x};from={start};to={end}");
        let replies = session
            .get(selector)
            .consolidation(ConsolidationMode::None)
            .timeout(Duration::from_secs(2))
            .wait()
            .unwrap();
        for reply in replies {
            if let Ok(sample) = reply.result() {
                let bytes = sample.payload().to_bytes();
                let before = self.samples.iter().filter(|(times, _)| *times > 0).count();
                self.take(&bytes);
                let after = self.samples.iter().filter(|(times, _)| *times > 0).count();
                self.fetched += (after - before) as u64;
            }
        }
    }
}
