//! Features: capabilities that a scene may lack.
//!
//! A [scene](crate::Scene) names a type for each feature: [`On`], or `()` where it lacks the feature. The type chooses everything that
//! belongs to the feature: memory between the halves, ends, reports, contents of requests. Where the feature is absent these have no
//! size, and code for them is compiled out. A feature itself is plain types, which know nothing of the choice.

use core::fmt::Debug;
use postcard_schema::Schema;
use serde::de::DeserializeOwned;
use trirrr_protocol::message::{Content, Unread};

/// Presence of a feature: [`On`], or `()` without it.
pub trait Feature: 'static {
    /// True with the feature.
    const EXISTS: bool;

    /// Variants of the feature that are there, a bit for each; for features that have some.
    const BITS: u8 = 0;

    /// A `T` with the feature, `()` without.
    type Of<T>: Optional<T>;

    /// The same for memory that is empty at the start.
    type Memory<T: ChannelMemory>: Optional<T> + ChannelMemory;

    /// The same for a `T` in a request: without the feature it is not read.
    type Read<T: Copy + Debug + PartialEq + DeserializeOwned + Schema>: Content<T>;

    /// Makes a `T`, with the feature.
    fn of<T>(make: impl FnOnce() -> T) -> Self::Of<T>;

    /// Takes the two ends of a memory.
    fn split<'q, T: ChannelMemory + 'q, A, B>(
        memory: &'q mut Self::Memory<T>,
        split: impl FnOnce(&'q mut T) -> (A, B),
    ) -> (Self::Of<A>, Self::Of<B>);

    /// Makes a part from another.
    fn map<T, U>(part: &Self::Of<T>, map: impl FnOnce(&T) -> U) -> Self::Of<U>;

    /// Takes `content` as it would be read.
    fn read<T: Copy + Debug + PartialEq + DeserializeOwned + Schema>(content: &T) -> Self::Read<T>;
}

/// Part of a feature: present, or `()`.
pub trait Optional<T> {
    /// The part, if there is one.
    fn get(&self) -> Option<&T>;

    /// The same, to be changed.
    fn get_mut(&mut self) -> Option<&mut T>;
}

/// Memory that is part of [`Channels`](crate::Channels).
pub trait ChannelMemory {
    /// Nothing in it.
    const EMPTY: Self;
}

/// The scene has the feature.
#[derive(Clone, Copy, Debug)]
pub struct On<const BITS: u8 = 0>;

/// A part of a feature that is there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Present<T>(T);

impl<const BITS: u8> Feature for On<BITS> {
    const EXISTS: bool = true;
    const BITS: u8 = BITS;
    type Of<T> = Present<T>;
    type Memory<T: ChannelMemory> = Present<T>;
    type Read<T: Copy + Debug + PartialEq + DeserializeOwned + Schema> = T;

    #[inline(always)]
    fn of<T>(make: impl FnOnce() -> T) -> Present<T> {
        Present(make())
    }

    #[inline(always)]
    fn split<'q, T: ChannelMemory + 'q, A, B>(
        memory: &'q mut Present<T>,
        split: impl FnOnce(&'q mut T) -> (A, B),
    ) -> (Present<A>, Present<B>) {
        let (a, b) = split(&mut memory.0);
        (Present(a), Present(b))
    }

    #[inline(always)]
    fn map<T, U>(part: &Present<T>, map: impl FnOnce(&T) -> U) -> Present<U> {
        Present(map(&part.0))
    }

    fn read<T: Copy + Debug + PartialEq + DeserializeOwned + Schema>(content: &T) -> T {
        *content
    }
}

impl Feature for () {
    const EXISTS: bool = false;
    type Of<T> = ();
    type Memory<T: ChannelMemory> = ();
    type Read<T: Copy + Debug + PartialEq + DeserializeOwned + Schema> = Unread<T>;

    #[inline(always)]
    fn of<T>(_: impl FnOnce() -> T) {}

    #[inline(always)]
    fn split<'q, T: ChannelMemory + 'q, A, B>(
        (): &'q mut (),
        _: impl FnOnce(&'q mut T) -> (A, B),
    ) -> ((), ()) {
        ((), ())
    }

    #[inline(always)]
    fn map<T, U>((): &(), _: impl FnOnce(&T) -> U) {}

    #[inline(always)]
    fn read<T: Copy + Debug + PartialEq + DeserializeOwned + Schema>(_: &T) -> Unread<T> {
        Unread::CONTENT
    }
}

impl<T> Optional<T> for () {
    #[inline(always)]
    fn get(&self) -> Option<&T> {
        None
    }

    #[inline(always)]
    fn get_mut(&mut self) -> Option<&mut T> {
        None
    }
}

impl<T> Optional<T> for Present<T> {
    #[inline(always)]
    fn get(&self) -> Option<&T> {
        Some(&self.0)
    }

    #[inline(always)]
    fn get_mut(&mut self) -> Option<&mut T> {
        Some(&mut self.0)
    }
}

impl ChannelMemory for () {
    const EMPTY: Self = ();
}

impl<T: ChannelMemory> ChannelMemory for Present<T> {
    const EMPTY: Self = Self(T::EMPTY);
}

/// `T` of the feature `F`.
pub(crate) type Of<F, T> = <F as Feature>::Of<T>;
