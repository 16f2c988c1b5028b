//! Planar linkages: the closed forms against the closure equations over a turn of every shipped
//! mechanism, and dyads of random dimensions on random motions.

mod agreement;
mod dyads;
mod mechanisms;
mod paths;
mod robust;
