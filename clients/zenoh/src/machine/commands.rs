//! Commands of clients, from their numbers to the machine and back.

use super::{RESUMING, Worker, pose_si};
use crate::answer::CommandOutcome;
use crate::command::{Act, CommandText, Right, session_text};
use crate::command_log::NumberEntry;
use crate::keys;
use crate::task::Task;
use serde_json::json;
use trirrr_client::exchange::Patience;
use trirrr_client::{GoalClient, JobClient, JobWork, describe};
use trirrr_core::setpoint::Pose;
use trirrr_line::entropy;
use trirrr_protocol::message::{Acting, Command, Goal, Refusal, Reply, State, Status, Transmit};
use trirrr_scene::offer;
use trirrr_service::ServiceNumber;
use zenoh::query::Query;

/// Command that waits for its turn.
pub(super) struct Order<N: Transmit> {
    /// Client and number; none of an order of the program itself.
    from: Option<(String, u64)>,
    /// It is sent only while its client has control.
    needs_control: bool,
    work: OrderWork<N>,
    /// A status has come since the order is the next one.
    is_surveyed: bool,
}

enum OrderWork<N: Transmit> {
    /// One request.
    Command(Command<N>),
    /// A motion of several.
    Motion(Act),
}

impl<N: Transmit> Order<N> {
    pub(super) fn own(command: Command<N>) -> Self {
        Self {
            from: None,
            needs_control: false,
            work: OrderWork::Command(command),
            is_surveyed: false,
        }
    }
}

impl<N: ServiceNumber> Worker<'_, N> {
    /// Takes a command. Returns the answer, unless it follows later.
    pub(super) fn command(
        &mut self,
        verb: &str,
        text: &CommandText,
        payload: &[u8],
        query: &Query,
    ) -> Option<String> {
        let refused = |why: String| Some(CommandOutcome::Refused(why).plain());
        let Some(client) = text.client.as_deref() else {
            return refused("client is missing: the name of the client".into());
        };
        if !keys::is_name(client) {
            return refused(format!(
                "client {client:?}: expected 1 to 64 letters, digits, '-', '_' or '.'"
            ));
        }
        if verb == "hello" {
            let next = self.log.greet(client);
            let session = session_text(self.setup.session);
            let takes = self.setup.takes_commands;
            let answer = json!({ "client": client, "session": session, "next_seq": next, "takes_commands": takes });
            return Some(answer.to_string());
        }
        if !self.setup.takes_commands {
            return refused("the program looks on: start it with --control".into());
        }
        let session = text.session.as_deref().unwrap_or_default();
        if let Err(why) = self.check_session(session) {
            return refused(why);
        }
        let now = self.now();
        if verb == "renew" {
            let outcome = match self.control.renew(client, now) {
                Ok(()) => CommandOutcome::Accepted,
                Err(why) => CommandOutcome::Refused(why),
            };
            return Some(outcome.plain());
        }
        let act = match text.act(verb) {
            Ok(act) => act,
            Err(why) => return refused(why),
        };
        let Some(number) = text.seq else {
            return refused("seq is missing: the number of the command".into());
        };
        let written = format!("{verb} {}", String::from_utf8_lossy(payload));
        match self.log.enter(client, number, &written) {
            NumberEntry::New => {}
            NumberEntry::Repeated(outcome) => {
                // Who repeats is there.
                let _ = self.control.renew(client, now);
                return Some(outcome.answer(client, number));
            }
            NumberEntry::Open => {
                let _ = self.control.renew(client, now);
                self.wait(client, number, query);
                return None;
            }
            NumberEntry::Wrong(why) => {
                return Some(CommandOutcome::Refused(why).answer(client, number));
            }
        }
        self.wait(client, number, query);
        if let Some(outcome) = self.begin(act, client, number) {
            self.complete(client, number, outcome);
        }
        None
    }

    fn wait(&mut self, client: &str, number: u64, query: &Query) {
        let waiting = self.queries.entry((client.into(), number));
        waiting.or_default().push(query.clone());
    }

    /// Begins a command. Returns the outcome if it is known.
    fn begin(&mut self, act: Act, client: &str, number: u64) -> Option<CommandOutcome> {
        let now = self.now();
        let leads = self.control.renew(client, now);
        let needs_control = act.right() == Right::Holder;
        if let (true, Err(why)) = (needs_control, leads) {
            return Some(CommandOutcome::Refused(why));
        }
        let command = match act {
            Act::Take(lease) => {
                return Some(match self.control.take(client, lease, now) {
                    Ok(()) => {
                        self.event("control", &format!("{client} takes control"));
                        CommandOutcome::Accepted
                    }
                    Err(why) => CommandOutcome::Refused(why),
                });
            }
            Act::Release => {
                self.control.release(client);
                self.event("control", &format!("{client} gives control back"));
                return Some(CommandOutcome::Accepted);
            }
            Act::Enable => Command::Enable,
            Act::Disable => Command::Disable,
            Act::Clear => Command::ClearFault,
            Act::Home => Command::Home,
            Act::Hold => Command::Hold,
            Act::Resume => Command::Resume,
            Act::Stop => Command::Stop,
            Act::Feed(percent) => Command::FeedOverride { percent },
            Act::GoTo(..) | Act::Jog(_) | Act::Run => {
                return self.put((client, number), needs_control, OrderWork::Motion(act));
            }
        };
        self.put((client, number), needs_control, OrderWork::Command(command))
    }

    fn put(
        &mut self,
        (client, number): (&str, u64),
        needs_control: bool,
        work: OrderWork<N>,
    ) -> Option<CommandOutcome> {
        if !self.is_connected {
            return Some(CommandOutcome::refused("the line of the machine is lost"));
        }
        self.orders.push_back(Order {
            from: Some((client.into(), number)),
            needs_control,
            work,
            is_surveyed: false,
        });
        None
    }

    /// Drops the commands whose client has lost control since they came, on a line that was lost or behind other commands: nothing moves for
    /// nobody. One that was sent is not sent again.
    pub(super) fn drop_orders_without_control(&mut self) {
        let now = self.now();
        let present = self.control.present(now).map(str::to_owned);
        let is_lost = |order: &Order<N>| match &order.from {
            Some((client, _)) => order.needs_control && present.as_ref() != Some(client),
            None => false,
        };
        let orders = std::mem::take(&mut self.orders).into_iter();
        let (lost, kept): (Vec<_>, Vec<_>) = orders.partition(is_lost);
        self.orders = kept.into();
        let why =
            "control has ended before the command was sent: nothing was done, take control again";
        for (client, number) in lost.into_iter().filter_map(|order| order.from) {
            self.complete(&client, number, CommandOutcome::refused(why));
        }
        if let Some((client, number)) = self
            .asked
            .take_if(|order| is_lost(order))
            .and_then(|order| order.from)
        {
            self.exchange.forget();
            self.is_greeted = false;
            let why = "control has ended while the command was open: see the state of the machine";
            self.complete(&client, number, CommandOutcome::Unknown(why.into()));
        }
    }

    /// Answers the command `number` of `client`, to all who ask.
    pub(super) fn complete(&mut self, client: &str, number: u64, outcome: CommandOutcome) {
        self.log.answered(client, number, &outcome);
        let text = outcome.answer(client, number);
        let waiting = self.queries.remove(&(client.into(), number));
        for query in waiting.unwrap_or_default() {
            let verb = query.key_expr().as_str().rsplit('/').next();
            let verb = verb.unwrap_or_default().to_owned();
            self.reply(&query, &verb, text.clone());
        }
    }

    /// Next request of an order.
    pub(super) fn next_order(&mut self) -> Option<Command<N>> {
        while let Some(order) = self.orders.pop_front() {
            match order.work {
                OrderWork::Command(command) => {
                    self.asked = Some(order);
                    return Some(command);
                }
                OrderWork::Motion(_) if !order.is_surveyed => {
                    self.orders.push_front(order);
                    return Some(Command::Status);
                }
                OrderWork::Motion(act) => {
                    let Some((client, number)) = order.from else {
                        continue;
                    };
                    if let Err(outcome) = self.begin_motion(act, &client, number) {
                        self.complete(&client, number, outcome);
                    } else {
                        return None;
                    }
                }
            }
        }
        None
    }

    /// Takes note of a status: the order that is next goes by it.
    pub(super) fn surveyed(&mut self) {
        if let Some(order) = self.orders.front_mut() {
            order.is_surveyed = true;
        }
    }

    fn begin_motion(&mut self, act: Act, client: &str, number: u64) -> Result<(), CommandOutcome> {
        let is_left = |task: &Task<N>| task.is_held || task.owner != client;
        if self.task.as_ref().is_some_and(is_left) {
            self.drop_task("another motion was asked for");
        }
        let status = self.status.filter(|_| self.task.is_none());
        let stands = |status: &Status<N>| {
            status.state == State::Idle && status.next == status.done && !status.planning
        };
        let Some(status) = status.filter(stands) else {
            let state = self.state.map_or(State::Running, |(state, _)| state);
            // A machine that plans is idle, and not free.
            let state = match state {
                State::Idle => State::Running,
                state => state,
            };
            let why = describe::refusal(&Refusal::<N>::State(state), 0, &self.units);
            return Err(CommandOutcome::Refused(why));
        };
        let end = status.end.map(|end| pose_si(&end.pose, &self.units));
        let Some([x, y, alpha]) = end else {
            return Err(CommandOutcome::refused(
                "the machine does not know its pose",
            ));
        };
        self.task = Some(match act {
            Act::GoTo([x, y], angle) => self.goal([x, y, angle.unwrap_or(alpha)], client, number),
            Act::Jog([dx, dy, dalpha]) => {
                self.goal([x + dx, y + dy, alpha + dalpha], client, number)
            }
            _ => self.job(client, number),
        });
        Ok(())
    }

    fn goal(&self, [x, y, alpha]: [f64; 3], client: &str, number: u64) -> Task<N> {
        let mut goals = GoalClient::new(self.hello, Patience::default(), entropy());
        goals.aim(Goal {
            to: offer::pose(&self.machine_units.pose(&Pose::from_f64(x, y, alpha))),
            velocity: [N::ZERO; 3],
            cut: true,
            least_ticks: 0,
        });
        goals.finish();
        Task::goal(goals, client, number)
    }

    fn job(&self, client: &str, number: u64) -> Task<N> {
        let scene = self.setup.scene;
        let moves = offer::moves(scene, &self.machine_units);
        let work = JobWork::of(moves, &scene.job.levels);
        let job = JobClient::new(
            work,
            self.hello,
            self.setup.telemetry,
            Patience::default(),
            entropy(),
        );
        let job = job.named(&scene.name).without_homing();
        let job = job.with_outputs(&scene.job.outputs);
        let job = job.with_tools(trirrr_scene::CarriedTools::of(scene));
        Task::job(job, client, number)
    }

    /// Takes the answer to the order that was asked.
    pub(super) fn order_answered(&mut self, reply: Reply<N>) {
        let Some(order) = self.asked.take() else {
            return;
        };
        let outcome = match reply {
            Reply::Refused(refusal) => {
                CommandOutcome::Refused(describe::refusal(&refusal, 0, &self.units))
            }
            _ => CommandOutcome::Accepted,
        };
        if outcome == CommandOutcome::Accepted {
            self.executed += u64::from(order.from.is_some());
            match order.work {
                OrderWork::Command(Command::Resume) => {
                    let now = self.now();
                    self.resumed = Some(now);
                    if let Some(task) = &mut self.task {
                        task.is_held = false;
                    }
                }
                OrderWork::Command(Command::Stop | Command::Disable) => {
                    self.drop_task("the machine was stopped");
                }
                _ => {}
            }
        }
        if let Some((client, number)) = order.from {
            self.complete(&client, number, outcome);
        }
    }

    /// Asks the order again, under another number: the machine has not executed it.
    pub(super) fn repeat_order(&mut self) {
        if let Some(order) = self.asked.take() {
            self.orders.push_front(order);
        }
    }

    /// The machine does not know the conversation any more: it may have executed the order or not.
    pub(super) fn lose_order(&mut self) {
        if let Some(order) = self.asked.take()
            && let Some((client, number)) = order.from
        {
            let why = "the machine was switched on anew, or had another client, while the command was open: see its state";
            self.complete(&client, number, CommandOutcome::Unknown(why.into()));
        }
    }

    /// Ends the task of a client that is gone, while the machine stands. What waits to be started is dropped: nothing moves for nobody.
    pub(super) fn leave_task(&mut self, status: &Status<N>) {
        let Some(task) = &mut self.task else {
            return;
        };
        if let Some(number) = task.asked.take() {
            let owner = task.owner.clone();
            let why = "control has ended before the machine has decided: see its state";
            self.complete(&owner, number, CommandOutcome::Unknown(why.into()));
        }
        if status.next != status.done || status.planning {
            self.orders.push_back(Order::own(Command::Stop));
        }
        self.drop_task("left by its client, the machine stands");
    }

    /// Ends the task before the machine is at its end.
    fn drop_task(&mut self, why: &str) {
        self.finish_task(Err(why.into()));
    }

    /// Takes note of the end of the task.
    pub(super) fn finish_task(&mut self, end: Result<(), String>) {
        let Some(task) = self.task.take() else {
            return;
        };
        if self.is_task_on {
            self.is_task_on = false;
            self.exchange.forget();
            self.is_greeted = false;
        }
        let word = task.word();
        match &end {
            Ok(()) => self.event("motion", &format!("{word}: done")),
            Err(why) => self.event("motion", &format!("{word}: {why}")),
        }
        if let Some(number) = task.asked {
            let outcome = end.map_or_else(CommandOutcome::Refused, |()| CommandOutcome::Accepted);
            self.executed += u64::from(outcome == CommandOutcome::Accepted);
            self.complete(&task.owner, number, outcome);
        }
    }

    /// Takes note of the state of a machine whose host was silent.
    pub(super) fn host_was_silent(&mut self, acting: Acting) {
        let now = self.now();
        // Samples before a resume tell of the silence still.
        let is_old = self.resumed.is_some_and(|at| now < at + RESUMING);
        if acting == Acting::Silence
            && !is_old
            && let Some(task) = &mut self.task
        {
            task.is_held = true;
        }
    }
}
