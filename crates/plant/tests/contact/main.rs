//! Detection of forces at the tool, on a machine in forward dynamics: the judge shares no equation with the observer.

mod alarms;
mod bench;
mod estimate;
mod figures;
