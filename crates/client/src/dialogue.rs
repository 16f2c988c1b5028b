//! Dialogue with a machine, and the one loop that carries a dialogue over a line.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use trirrr_line::{Line, LostLine, Reopening, is_answer};
use trirrr_protocol::message::{Message, Request, Transmit};

/// Next act of a dialogue. Times count from any start.
#[derive(Clone, Debug, PartialEq)]
pub enum Turn<N: Transmit, E> {
    /// Send this to the machine.
    Send(Request<N>),
    /// Listen. Unless something comes, there is nothing to say before this time.
    Wait(Duration),
    /// The machine does not answer: open the line anew and call [`Dialogue::reconnected`], or give up.
    Reconnect,
    /// The dialogue has ended.
    Done(E),
}

impl<N: Transmit, E> Turn<N, E> {
    /// Returns the same turn with `map` of its end.
    pub fn map<T>(self, map: impl FnOnce(E) -> T) -> Turn<N, T> {
        match self {
            Self::Send(request) => Turn::Send(request),
            Self::Wait(until) => Turn::Wait(until),
            Self::Reconnect => Turn::Reconnect,
            Self::Done(end) => Turn::Done(map(end)),
        }
    }
}

/// One side of a conversation with a machine, without a line and a clock of its own.
///
/// A dialogue may hold another one, to look at its messages or to end it in another way.
pub trait Dialogue<N: Transmit> {
    /// Result of the dialogue.
    type End;

    /// Longest wait for the machine before [`attend`](Self::attend) is called again.
    const LOOK: Duration = Duration::from_millis(20);

    /// Returns the next act at `now`, counted from any start and never going back.
    fn poll(&mut self, now: Duration) -> Turn<N, Self::End>;

    /// Takes a message of the machine.
    fn receive(&mut self, message: &Message<N>, now: Duration);

    /// Takes the stop signal of the user, which comes once. The dialogue ends once a machine in motion has come to rest.
    fn stop(&mut self);

    /// Goes on over a line that was opened anew.
    fn reconnected(&mut self);

    /// Takes the reason why the line is lost, or still is. The line is opened anew. `is_news`: the reason is another one, or the
    /// machine has answered since.
    fn lost(&mut self, _why: &LostLine, _is_news: bool) {}

    /// Handles what does not come from the machine, such as commands of a user. Called before the dialogue speaks, and while the
    /// line is lost. Returns an end that the dialogue has without the machine.
    fn attend(&mut self, _now: Duration) -> Option<Self::End> {
        None
    }
}

/// Carries `dialogue` over `line` to its end: sends, listens, opens a lost line anew, and hands `stop` on.
///
/// # Errors
/// The line is lost, and is not opened anew.
pub fn drive<N: Transmit, D: Dialogue<N>>(
    dialogue: &mut D,
    line: &mut dyn Line<N>,
    stop: &AtomicBool,
) -> Result<D::End, LostLine> {
    let mut is_stopped = false;
    let mut reported = None;
    let mut lost = (!line.is_open()).then(|| LostLine::NotOpen(String::new()));
    loop {
        if stop.load(Ordering::Relaxed) && !std::mem::replace(&mut is_stopped, true) {
            dialogue.stop();
        }
        if let Some(end) = dialogue.attend(line.now()) {
            return Ok(end);
        }
        let failure = match &lost {
            None => match send_and_listen(dialogue, line, &mut reported) {
                Ok(Some(end)) => return Ok(end),
                Ok(None) => continue,
                Err(why) => why,
            },
            Some(why) => match line.reopen(why, is_stopped) {
                Reopening::Open => {
                    lost = None;
                    dialogue.reconnected();
                    continue;
                }
                Reopening::Pending => continue,
                Reopening::Failed(why) => why,
                Reopening::GivenUp(why) => return Err(why),
            },
        };
        let why = Some(failure.to_string());
        dialogue.lost(&failure, reported != why);
        (reported, lost) = (why, Some(failure));
    }
}

/// Sends what there is to send, and listens once. Returns the end of a dialogue that has ended. An answer of the machine clears
/// `reported`.
fn send_and_listen<N: Transmit, D: Dialogue<N>>(
    dialogue: &mut D,
    line: &mut dyn Line<N>,
    reported: &mut Option<String>,
) -> Result<Option<D::End>, LostLine> {
    let wait = loop {
        let now = line.now();
        match dialogue.poll(now) {
            Turn::Send(request) => line.send(&request)?,
            Turn::Wait(until) => break until.saturating_sub(now),
            Turn::Reconnect => return Err(LostLine::Silent),
            Turn::Done(end) => return Ok(Some(end)),
        }
    };
    for message in line.receive(wait.min(D::LOOK))? {
        reported.take_if(|_| is_answer(&message));
        dialogue.receive(&message, line.now());
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{JobClient, JobFailure, JobWork, Patience, local};
    use std::cell::Cell;
    use trirrr_scene::Scene;

    /// Dialogue that notes what it hears of its line.
    #[derive(Default)]
    struct Noting {
        notes: Vec<String>,
        /// Calls of `attend` after which the dialogue ends by itself.
        left: Option<u32>,
        is_stopped: bool,
    }

    impl Dialogue<f32> for Noting {
        type End = Vec<String>;

        fn poll(&mut self, now: Duration) -> Turn<f32, Self::End> {
            match self.is_stopped {
                true => Turn::Done(std::mem::take(&mut self.notes)),
                false => Turn::Wait(now + Self::LOOK * 100),
            }
        }

        fn receive(&mut self, _: &Message<f32>, _: Duration) {
            self.notes.push("message".into());
        }

        fn stop(&mut self) {
            self.is_stopped = true;
            self.notes.push("stop".into());
        }

        fn reconnected(&mut self) {
            self.notes.push("open".into());
        }

        fn lost(&mut self, why: &LostLine, is_news: bool) {
            let news = if is_news { "" } else { " again" };
            self.notes.push(format!("lost{news}: {why}"));
        }

        fn attend(&mut self, _: Duration) -> Option<Self::End> {
            let left = self.left.as_mut()?;
            *left -= 1;
            (*left == 0).then(|| std::mem::take(&mut self.notes))
        }
    }

    /// Line that follows a list: how each wait, and each attempt to open it, ends. Behind the list the user stops.
    struct Listed<'a> {
        waits: std::vec::IntoIter<Result<Vec<Message<f32>>, &'static str>>,
        openings: std::vec::IntoIter<Reopening>,
        now: Cell<Duration>,
        stop: &'a AtomicBool,
        is_open: bool,
    }

    impl Line<f32> for Listed<'_> {
        fn now(&self) -> Duration {
            self.now.set(self.now.get() + Duration::from_millis(1));
            self.now.get()
        }

        fn send(&mut self, _: &Request<f32>) -> Result<(), LostLine> {
            Ok(())
        }

        fn receive(&mut self, timeout: Duration) -> Result<Vec<Message<f32>>, LostLine> {
            assert_eq!(timeout, Noting::LOOK, "a stop is heard in time");
            let came = self.waits.next().unwrap_or_else(|| {
                self.stop.store(true, Ordering::Relaxed);
                Ok(Vec::new())
            });
            came.map_err(|why| LostLine::NotOpen(why.into()))
        }

        fn reopen(&mut self, _: &LostLine, is_stopped: bool) -> Reopening {
            assert_eq!(is_stopped, self.stop.load(Ordering::Relaxed));
            self.openings.next().unwrap_or_else(|| {
                self.stop.store(true, Ordering::Relaxed);
                match is_stopped {
                    true => Reopening::GivenUp(LostLine::Silent),
                    false => Reopening::Pending,
                }
            })
        }

        fn is_open(&self) -> bool {
            self.is_open
        }
    }

    fn run(
        dialogue: &mut Noting,
        waits: Vec<Result<Vec<Message<f32>>, &'static str>>,
        openings: Vec<Reopening>,
        is_open: bool,
    ) -> Result<Vec<String>, LostLine> {
        let stop = AtomicBool::new(false);
        let mut line = Listed {
            waits: waits.into_iter(),
            openings: openings.into_iter(),
            now: Cell::new(Duration::ZERO),
            stop: &stop,
            is_open,
        };
        drive(dialogue, &mut line, &stop)
    }

    fn failed(why: &str) -> Reopening {
        Reopening::Failed(LostLine::NotOpen(why.into()))
    }

    fn answer() -> Message<f32> {
        Message::Reply {
            sequence: 0,
            reply: trirrr_protocol::message::Reply::Done,
        }
    }

    #[test]
    fn a_reason_is_news_until_the_machine_has_answered() {
        let waits = vec![Err("cut"), Err("cut"), Ok(vec![answer()]), Err("cut")];
        let openings = vec![
            Reopening::Open,
            Reopening::Pending,
            failed("busy"),
            failed("busy"),
            Reopening::Open,
            Reopening::Open,
        ];
        let notes = run(&mut Noting::default(), waits, openings, true).unwrap();
        let expected = [
            "lost: cut",
            "open",
            "lost again: cut",
            "lost: busy",
            "lost again: busy",
            "open",
            "message",
            "lost: cut",
            "open",
            "stop",
        ];
        assert_eq!(notes, expected);
    }

    #[test]
    fn a_line_that_was_not_opened_is_opened_without_a_word_of_loss() {
        let notes = run(&mut Noting::default(), vec![], vec![Reopening::Open], false);
        assert_eq!(notes.unwrap(), ["open", "stop"]);
    }

    /// The user and all others are heard while the line is lost.
    #[test]
    fn a_stop_ends_the_wait_for_a_lost_line() {
        let mut dialogue = Noting::default();
        let given_up = run(&mut dialogue, vec![Err("cut")], vec![], true);
        assert!(given_up.is_err());
        assert_eq!(dialogue.notes, ["lost: cut", "stop"]);
        let mut dialogue = Noting {
            left: Some(5),
            ..Noting::default()
        };
        let pending = || Reopening::Pending;
        let openings = std::iter::repeat_with(pending).take(9).collect();
        let ended = run(&mut dialogue, vec![Err("cut")], openings, true);
        assert_eq!(ended.unwrap(), ["lost: cut"]);
    }

    /// Ctrl-C before the first answer: the job ends at once, and nothing is sent.
    #[test]
    fn a_stop_before_the_first_answer_ends_a_job_unsent() {
        let scene = Scene::read("../../scenes/thesis.toml").unwrap();
        local::with_machine::<f32, _>(&scene, |machine| {
            let mut line = crate::tick_line::TickLine::new(machine);
            let work = JobWork::of(Vec::new(), &scene.job.levels);
            let hello = local::hello::<f32>(&scene);
            let mut client = JobClient::new(work, hello, 1, Patience::default(), 1);
            let ended = line.talk_until(&AtomicBool::new(true), &mut client, 100);
            assert_eq!(ended, Some(Err(JobFailure::Stopped { done: 0 })));
            assert_eq!(line.sent, []);
        })
        .unwrap();
    }
}
