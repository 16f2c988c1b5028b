//! The Noise protocol, by the library `snow`. Without the feature `keys` no conversation can begin.

#[cfg(feature = "keys")]
pub(crate) use of_snow::{Handshake, Transport};
#[cfg(not(feature = "keys"))]
pub(crate) use without::{Handshake, Transport};

#[cfg(feature = "keys")]
mod of_snow {
    use crate::SharedKey;
    use snow::{Builder, HandshakeState, TransportState};
    use std::io;

    /// Patterns and functions of Noise.
    const PATTERN: &str = "Noise_NNpsk0_25519_ChaChaPoly_BLAKE2s";

    /// Both ends agree on this, too: another protocol with the same key is not understood.
    const PROLOGUE: &[u8] = b"trirrr 1";

    /// State before both ends have greeted each other.
    pub(crate) struct Handshake(HandshakeState);

    /// State under the keys of the link.
    pub(crate) struct Transport(TransportState);

    impl Handshake {
        /// Begins the end of a client, or that of a machine.
        ///
        /// # Errors
        /// The system has no random numbers.
        pub(crate) fn begin(key: &SharedKey, is_client: bool) -> io::Result<Self> {
            let builder = || {
                Builder::new(PATTERN.parse()?)
                    .prologue(PROLOGUE)?
                    .psk(0, key.bytes())
            };
            let built = builder().and_then(|builder| match is_client {
                true => builder.build_initiator(),
                false => builder.build_responder(),
            });
            built.map(Self).map_err(broken)
        }

        pub(crate) fn write(&mut self, record: &mut [u8]) -> io::Result<usize> {
            self.0.write_message(&[], record).map_err(broken)
        }

        /// Returns true if the far end has greeted with the same key.
        pub(crate) fn read(&mut self, greeting: &[u8]) -> bool {
            self.0.read_message(greeting, &mut []).is_ok()
        }

        pub(crate) fn into_transport(self) -> io::Result<Transport> {
            let transport = self.0.into_transport_mode();
            transport.map(Transport).map_err(broken)
        }
    }

    impl Transport {
        pub(crate) fn write(&mut self, bytes: &[u8], record: &mut [u8]) -> io::Result<usize> {
            self.0.write_message(bytes, record).map_err(broken)
        }

        /// Returns true if the far end has sealed the record, in this place.
        pub(crate) fn read(&mut self, record: &[u8], bytes: &mut [u8]) -> bool {
            self.0.read_message(record, bytes).is_ok()
        }
    }

    /// Error of a library that was asked for what it cannot do.
    fn broken(error: snow::Error) -> io::Error {
        io::Error::other(format!("the key cannot be used: {error}"))
    }
}

#[cfg(not(feature = "keys"))]
mod without {
    use crate::SharedKey;
    use std::io;

    /// None is ever made.
    pub(crate) enum Handshake {}

    /// None is ever made.
    pub(crate) enum Transport {}

    impl Handshake {
        pub(crate) fn begin(_: &SharedKey, _: bool) -> io::Result<Self> {
            let reason = "this program is built without keys: the feature `keys` of trirrr-line";
            Err(io::Error::new(io::ErrorKind::Unsupported, reason))
        }

        pub(crate) fn write(&mut self, _: &mut [u8]) -> io::Result<usize> {
            match *self {}
        }

        pub(crate) fn read(&mut self, _: &[u8]) -> bool {
            match *self {}
        }

        pub(crate) fn into_transport(self) -> io::Result<Transport> {
            match self {}
        }
    }

    impl Transport {
        pub(crate) fn write(&mut self, _: &[u8], _: &mut [u8]) -> io::Result<usize> {
            match *self {}
        }

        pub(crate) fn read(&mut self, _: &[u8], _: &mut [u8]) -> bool {
            match *self {}
        }
    }
}
