//! Control of a machine: one client at a time, as long as its lease runs and its liveliness token stands.

use std::collections::BTreeSet;
use std::time::Duration;

/// Client that has control.
#[derive(Clone, Debug)]
struct Holder {
    client: String,
    lease: Duration,
    until: Duration,
    /// The client has had a token since it took control: without it, it is gone.
    has_token: bool,
}

/// Control of a machine. Times count from any start.
#[derive(Clone, Debug, Default)]
pub(crate) struct Control {
    holder: Option<Holder>,
    /// Clients whose token stands.
    tokens: BTreeSet<String>,
}

impl Control {
    /// Gives control to `client`.
    ///
    /// # Errors
    /// Another client has it, and is there.
    pub(crate) fn take(
        &mut self,
        client: &str,
        lease: Duration,
        now: Duration,
    ) -> Result<(), String> {
        if let Some(holder) = self.present(now)
            && holder != client
        {
            return Err(format!("{holder} has control"));
        }
        self.holder = Some(Holder {
            client: client.into(),
            lease,
            until: now + lease,
            has_token: self.tokens.contains(client),
        });
        Ok(())
    }

    /// Takes control back, if `client` has it.
    pub(crate) fn release(&mut self, client: &str) {
        self.holder.take_if(|holder| holder.client == client);
    }

    /// Lets the lease of `client` begin again, if it has control.
    ///
    /// # Errors
    /// It has not, or its lease has ended: it has to take control again.
    pub(crate) fn renew(&mut self, client: &str, now: Duration) -> Result<(), String> {
        let present = self.present(now).map(str::to_owned);
        match (&mut self.holder, present) {
            (Some(holder), Some(name)) if name == client => {
                holder.until = now + holder.lease;
                Ok(())
            }
            (_, Some(other)) => Err(format!("{other} has control")),
            _ => Err(format!(
                "{client} has no control, or its lease has ended: take it"
            )),
        }
    }

    /// Takes note of the token of `client`.
    pub(crate) fn token(&mut self, client: &str, stands: bool) {
        match stands {
            true => self.tokens.insert(client.into()),
            false => self.tokens.remove(client),
        };
        if let Some(holder) = &mut self.holder
            && holder.client == client
        {
            holder.has_token |= stands;
        }
    }

    /// Returns true if no lease runs: a client whose token is gone may still come back within its own.
    pub(crate) fn has_ended(&self, now: Duration) -> bool {
        self.holder
            .as_ref()
            .is_none_or(|holder| now >= holder.until)
    }

    /// Returns the client that has control and is there.
    pub(crate) fn present(&self, now: Duration) -> Option<&str> {
        let holder = self.holder.as_ref()?;
        let is_gone = holder.has_token && !self.tokens.contains(&holder.client);
        (now < holder.until && !is_gone).then_some(holder.client.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LEASE: Duration = Duration::from_secs(2);

    fn at(seconds: f64) -> Duration {
        Duration::from_secs_f64(seconds)
    }

    #[test]
    fn control_ends_with_the_lease() {
        let mut control = Control::default();
        control.take("a", LEASE, at(0.0)).unwrap();
        assert_eq!(control.present(at(1.9)), Some("a"));
        assert!(control.take("b", LEASE, at(1.9)).is_err());
        control.renew("a", at(1.9)).unwrap();
        assert_eq!(control.present(at(3.8)), Some("a"));
        assert_eq!(control.present(at(3.9)), None);
        // What has ended is not renewed: another one may have moved the machine.
        assert!(control.renew("a", at(3.9)).is_err());
        control.take("b", LEASE, at(4.0)).unwrap();
        assert!(control.renew("a", at(4.1)).is_err());
        control.release("a");
        assert_eq!(control.present(at(4.1)), Some("b"));
        control.release("b");
        assert_eq!(control.present(at(4.1)), None);
    }

    #[test]
    fn control_ends_with_the_token_and_comes_back_with_it_within_the_lease() {
        let mut control = Control::default();
        control.take("a", LEASE, at(0.0)).unwrap();
        assert_eq!(control.present(at(0.1)), Some("a"), "none is needed");
        control.token("a", true);
        control.token("a", false);
        assert_eq!(control.present(at(0.2)), None);
        assert!(!control.has_ended(at(0.2)) && control.has_ended(at(2.0)));
        assert!(control.renew("a", at(0.2)).is_err());
        control.token("a", true);
        assert_eq!(control.present(at(0.3)), Some("a"));
        control.token("b", false);
        assert_eq!(control.present(at(0.3)), Some("a"));
        assert_eq!(control.present(at(2.1)), None);
    }
}
