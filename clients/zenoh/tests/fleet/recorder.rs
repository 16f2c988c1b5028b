//! Recorder: accounts for each sample of each machine, and fetches what it has missed.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;
use trirrr_zenoh::records::{self, RecordPlace};
use zenoh::pubsub::Subscriber;
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
    /// Index of the first that has not come.
    complete: usize,
    /// A history is asked.
    is_asking: bool,
    fetched: u64,
}

/// Word of a machine.
enum Heard {
    /// A batch, and true if it was fetched.
    Batch(Vec<u8>, bool),
    /// A history has said all that it says.
    Asked,
}

/// Says that a history has said all, as soon as the query is dropped.
struct Asking(String, Sender<(String, Heard)>);

impl Drop for Asking {
    fn drop(&mut self) {
        let _ = self.1.send((self.0.clone(), Heard::Asked));
    }
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
    sender: Sender<(String, Heard)>,
    heard: Receiver<(String, Heard)>,
    _subscriber: Subscriber<()>,
    machines: BTreeMap<String, Recorded>,
}

impl Recorder {
    pub(crate) fn start(session: &Session) -> Self {
        let (sender, heard) = channel();
        let batches = sender.clone();
        let subscriber = session
            .declare_subscriber("trirrr/*/telemetry")
            .callback(move |sample| {
                let name = sample.key_expr().as_str().split('/').nth(1).unwrap();
                let bytes = sample.payload().to_bytes().into_owned();
                let _ = batches.send((name.to_owned(), Heard::Batch(bytes, false)));
            })
            .wait()
            .unwrap();
        Self {
            session: session.clone(),
            sender,
            heard,
            _subscriber: subscriber,
            machines: BTreeMap::new(),
        }
    }

    /// Takes what has come, and asks for what is missing before it.
    pub(crate) fn work(&mut self) {
        while let Ok((name, heard)) = self.heard.try_recv() {
            let recorded = self.machines.entry(name).or_default();
            match heard {
                Heard::Batch(bytes, is_fetched) => {
                    let new = recorded.take(&bytes, is_fetched);
                    recorded.fetched += if is_fetched { new } else { 0 };
                }
                Heard::Asked => recorded.is_asking = false,
            }
        }
        for (name, recorded) in &mut self.machines {
            // One range at a time: the next call has the next.
            if let Some(range) = recorded.missing().filter(|_| !recorded.is_asking) {
                recorded.is_asking = true;
                fetch(&self.session, name, recorded, range, &self.sender);
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
                before = place;
            }
        }
        account
    }
}

impl Recorded {
    fn end(&self) -> u64 {
        self.first + self.samples.len() as u64
    }

    /// Takes a batch. Returns the number of samples that had not come. A batch that was fetched reaches over several gaps: what lies between
    /// them was asked for once more, and is not doubled.
    fn take(&mut self, bytes: &[u8], is_fetched: bool) -> u64 {
        let (header, places) = records::read(bytes).expect("a batch of this version");
        self.every = header.every;
        let session = *self.session.get_or_insert(header.session);
        assert_eq!(session, header.session, "the program was started anew");
        let mut new = 0;
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
            if is_fetched && *times > 0 {
                continue;
            }
            new += u64::from(*times == 0);
            *times += 1;
            *kept = Some(place);
        }
        let rest = self.samples[self.complete..].iter();
        self.complete += rest.take_while(|(times, _)| *times > 0).count();
        new
    }

    /// Range from the first to the last sample that is missing before what has come.
    fn missing(&self) -> Option<Range<u64>> {
        let rest = self.samples.get(self.complete..)?;
        let last = rest.iter().rposition(|(times, _)| *times == 0)?;
        let start = self.first + self.complete as u64;
        Some(start..start + last as u64 + 1)
    }
}

/// Asks for a range. What does not come stays missing.
fn fetch(
    session: &Session,
    name: &str,
    recorded: &Recorded,
    range: Range<u64>,
    sender: &Sender<(String, Heard)>,
) {
    let Range { start, end } = range;
    let of = recorded.session.unwrap_or_default();
    let selector = format!("trirrr/{name}/telemetry?session={of:016x};from={start};to={end}");
    let asking = Asking(name.into(), sender.clone());
    session
        .get(selector)
        .timeout(Duration::from_secs(2))
        .callback(move |reply| {
            if let Ok(sample) = reply.result() {
                let bytes = sample.payload().to_bytes().into_owned();
                let _ = asking.1.send((asking.0.clone(), Heard::Batch(bytes, true)));
            }
        })
        .wait()
        .unwrap();
}
