//! A scene of a machine that plays power lists.

use super::Scene;
use crate::levels::LevelRing;
use crate::number::ServiceNumber;

/// Scene `S` of a machine that plays power lists, with memory for `BYTES` levels: a power of two, at most 32,768.
#[derive(Clone, Copy, Debug)]
pub struct WithLevels<S, const BYTES: usize> {
    /// Everything else of the scene.
    pub scene: S,
    /// Levels for which there is room, at most `BYTES`; 0 of a machine that plays no power lists.
    pub room: u16,
}

impl<N: ServiceNumber, S: Scene<N = N>, const BYTES: usize> Scene for WithLevels<S, BYTES> {
    super::inner!(update, digital, homing, feedback, contact, interlocks);
    type Levels = LevelRing<N, BYTES>;

    #[inline(always)]
    fn levels(&self) -> u16 {
        (BYTES as u16).min(self.room)
    }
}
