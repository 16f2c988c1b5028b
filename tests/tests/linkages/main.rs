//! Planar linkages: the closed forms against the closure equations over a turn of every shipped
//! mechanism, and dyads of random dimensions on random motions.

mod agreement;
mod closes;
mod dyads;
mod ends;
mod one_loop;
mod paths;
mod robust;
mod two_loops;
