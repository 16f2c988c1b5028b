//! From the machine to the tick: what its switches, or drives that stall, say.

/// For each motor, whether its switch is closed or its drive stalls.
#[cfg(homing)]
pub(crate) type Closed = [bool; 3];

/// Nobody asks.
#[cfg(not(homing))]
pub(crate) type Closed = ();

/// Switches that close by rule, for tests in an emulator, which has none. In no image that is
/// shipped: only with the feature `switches`, and of a scene with homing.
#[cfg(feature = "switches")]
pub(crate) type Ruled = trirrr_image::RuledSwitches<'static, trirrr_station::scene::Scalar>;

/// Those of the scene.
#[cfg(feature = "switches")]
pub(crate) fn ruled() -> Ruled {
    trirrr_image::RuledSwitches::new(&trirrr_station::scene::HOMING)
}

/// Where a tick's inputs come from.
pub(crate) trait Inputs {
    /// As they are now.
    fn read(&mut self) -> Closed;
}

/// No input.
#[cfg(not(homing))]
pub(crate) struct NoInputs;

#[cfg(not(homing))]
impl Inputs for NoInputs {
    fn read(&mut self) -> Closed {}
}
