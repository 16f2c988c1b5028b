//! Functions on models of binary32, compiled with this crate.
//!
//! A generic function is compiled as the crate that first uses it. An image compiles the application for size, at
//! level `z`, which calls shared fragments out of every function: too slow for operations that each take some forty
//! cycles. This crate is compiled at level `s`. Others reuse what it has compiled, if their own level is `s` or `z`.

use super::taylor::operators as of;

/// Addresses of the functions: naming them has them compiled.
// No other crate may compile the names themselves.
#[doc(hidden)]
#[inline(never)]
pub fn instances() -> [*const (); 7] {
    [
        of::sum::<f32> as *const (),
        of::difference::<f32> as *const (),
        of::product::<f32> as *const (),
        of::inverse::<f32> as *const (),
        of::root::<f32> as *const (),
        of::sum_of_products::<f32> as *const (),
        of::difference_of_products::<f32> as *const (),
    ]
}
