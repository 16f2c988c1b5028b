//! Arguments of `trirrr eval`.

use crate::arguments::number_type;
use clap::Args;
use std::path::PathBuf;
use trirrr_scene::NumberType;

/// `trirrr eval`.
#[derive(Args, Clone, Debug)]
#[command(after_long_help = EVAL_COLUMNS)]
pub struct EvalArgs {
    /// Table of cases (columns: see --help): CSV with a header, or an Arrow IPC file (.arrow, .feather); `-` is
    /// standard input, CSV
    #[arg(value_name = "CASES.csv|CASES.arrow")]
    pub cases: PathBuf,
    /// Number type to compute in
    #[arg(long, default_value = "f64", value_parser = number_type())]
    pub scalar: NumberType,
    /// File for the results: CSV, or an Arrow IPC file by its ending [default: standard output, CSV]
    #[arg(long, value_name = "RESULTS.csv|RESULTS.arrow")]
    pub out: Option<PathBuf>,
}

const EVAL_COLUMNS: &str = "\
Columns of the cases, in any order, SI units and radians; others are ignored:
  case                          name of the row; its number if the column is missing
  for each leg i = 1, 2, 3:
    ax_i, ay_i                  base joint A
    z1_i, z2_i                  proximal and distal link length
    h_i, lam_i                  platform joint C in polar coordinates about D
    sg_i                        elbow sign, 1 or -1
  m, I                          platform mass and moment of inertia
  ml                            mass of each of the six links, uniform rods (0 if missing)
  gx, gy                        gravity (0 if missing)
  Wx, Wy, Wa                    wrench on the platform at D (0 if missing)
and either the state
  x, y, alpha, vx, vy, valpha, acx, acy, acalpha
or a move from rest to rest along a cubic, at the time t from 0 to T
  x0, xf, y0, yf, a0, af, T, t
The move is used only where the table does not have every column of the state.

Columns of the results, i = 1, 2, 3 side by side:
  case, status, th1_i, th2_i, dth1_i, dth2_i, ddth1_i, ddth2_i, D_i (named D1, D2, D3), detA,
  tau_i, P_i (named tau1, P1 and so on)
status is `ok`, or begins with why there are no numbers: `unreachable: leg 1`,
`serial singular: leg 2`, `parallel singular`, `out of range ...`, or `invalid: ` with column,
value and reason. `ok` says that the numbers are in range: in fixed point, links of 30:1 or more
may cost the digits of torques, so compare such machines with f64. Rows without numbers do not
change the exit code, unless all rows are such: then it is 1.

Results of f32 and micromath are binary32 numbers, those of f64 and fixed binary64 numbers. CSV has the fewest digits that
read back as the same bits. Rows are evaluated on all cores, in any number: RAYON_NUM_THREADS says on how many.
In an Arrow file, numbers stand in columns of floats or whole numbers, labels in columns of text or whole numbers. A null is an
empty field. Compression by LZ4 is read.";
