//! Declaration of a scene.

/// Declares a kind of [`Scene`](crate::Scene): a machine, and the features that it has. Each is [`On`](crate::features::On), or a type of its
/// own; what is not named is `()`. The order is that of this list; parameters of the kind stand in brackets, once with their
/// bounds.
/// ```
/// use trirrr_core::model::{Dynamic, Model};
/// use trirrr_service::{Adjustable, ServiceNumber, scene};
/// use trirrr_service::features::{On, input_bits::DOOR};
///
/// scene! {
///     /// A machine with a door and spare outputs.
///     pub Guarded: Adjustable<Dynamic<f64>>, batches = On, interlocks = On<DOOR>, digital = On
/// }
///
/// scene! {
///     /// A machine of any model, with homing.
///     pub Homed [N: ServiceNumber, M: Model<N = N>] [N, M]: Adjustable<M>, homing = On
/// }
/// ```
#[macro_export]
macro_rules! scene {
    (
        $(#[$meta:meta])*
        $visibility:vis $name:ident $([$($bounds:tt)*] [$($parameter:ident),*])?: $machine:ty
        $(, batches = $batches:ty)?
        $(, update = $update:ty)?
        $(, levels = $levels:ty)?
        $(, homing = $homing:ty)?
        $(, feedback = $feedback:ty)?
        $(, contact = $contact:ty)?
        $(, retreat = $retreat:ty)?
        $(, interlocks = $interlocks:ty)?
        $(, probe = $probe:ty)?
        $(, digital = $digital:ty)?
        $(,)?
    ) => {
        $(#[$meta])*
        $visibility struct $name $(<$($parameter),*>)? (
            ::core::marker::PhantomData<($($($parameter,)*)?)>,
        );

        impl $(<$($bounds)*>)? $crate::Scene for $name $(<$($parameter),*>)? {
            type N = <$machine as $crate::Machine>::N;
            type Machine = $machine;
            type Batches = $crate::scene!(@ $($batches)?);
            type Update = $crate::scene!(@ $($update)?);
            type Levels = $crate::scene!(@ $($levels)?);
            type Homing = $crate::scene!(@ $($homing)?);
            type Feedback = $crate::scene!(@ $($feedback)?);
            type Contact = $crate::scene!(@ $($contact)?);
            type Retreat = $crate::scene!(@ $($retreat)?);
            type Interlocks = $crate::scene!(@ $($interlocks)?);
            type Probe = $crate::scene!(@ $($probe)?);
            type Digital = $crate::scene!(@ $($digital)?);
        }
    };
    (@) => { () };
    (@ $feature:ty) => { $feature };
}

/// All features that [`scene!`](crate::scene!) names behind the place of another program, as a scene lacks them.
macro_rules! lacks {
    () => {
        type Levels = ();
        type Homing = ();
        type Feedback = ();
        type Contact = ();
        type Retreat = ();
        type Interlocks = ();
        type Probe = ();
        type Digital = ();
    };
}

pub(super) use lacks;
