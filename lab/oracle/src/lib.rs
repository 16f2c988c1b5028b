//! Nothing but tests: the truth of the work-precision study (`trirrr report`) against the stiff
//! solvers of the crate diffsol, which comes with some ninety others that nobody else has to build.
