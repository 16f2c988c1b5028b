//! Planar linkages: the closed forms against the closure equations and against the linkage files
//! over a turn of every shipped mechanism, and dyads of random dimensions on random motions.

mod agreement;
mod closes;
mod compositions;
mod dyads;
mod ends;
mod files;
mod one_loop;
mod paths;
mod robust;
mod two_loops;
