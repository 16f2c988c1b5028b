//! Spare outputs, low until the scene switches them, and spare inputs, pulled up: contacts to ground.

use crate::board::{
    Input1, Input2, Input3, Input4, Input5, Input6, Input7, Input8, Output1, Output2, Output3,
    Output4, Output5, Output6, Output7, Output8,
};
use crate::wiring::BoardPin;
use trirrr_app::digital::{SpareOutputs, WithSpareInputs};

/// Pin `P` as an output.
type OutputOf<P> = <P as BoardPin>::Output;
/// Pin `P` as an input.
type InputOf<P> = <P as BoardPin>::Input;

/// Spare outputs of the board.
pub(crate) type SpareOutputPins = SpareOutputs<(
    OutputOf<Output1>,
    OutputOf<Output2>,
    OutputOf<Output3>,
    OutputOf<Output4>,
    OutputOf<Output5>,
    OutputOf<Output6>,
    OutputOf<Output7>,
    OutputOf<Output8>,
)>;

/// Inputs `I` beside the spare ones.
pub(crate) type SensedInputs<I> = WithSpareInputs<
    I,
    (
        InputOf<Input1>,
        InputOf<Input2>,
        InputOf<Input3>,
        InputOf<Input4>,
        InputOf<Input5>,
        InputOf<Input6>,
        InputOf<Input7>,
        InputOf<Input8>,
    ),
>;

/// Pins of the spare outputs.
pub(crate) type OutputPins = (
    Output1,
    Output2,
    Output3,
    Output4,
    Output5,
    Output6,
    Output7,
    Output8,
);

/// Pins of the spare inputs.
pub(crate) type InputPins = (
    Input1,
    Input2,
    Input3,
    Input4,
    Input5,
    Input6,
    Input7,
    Input8,
);

/// Makes the pins outputs that are off.
pub(crate) fn outputs((a, b, c, d, e, f, g, h): OutputPins) -> SpareOutputPins {
    SpareOutputs::new((
        a.output(false),
        b.output(false),
        c.output(false),
        d.output(false),
        e.output(false),
        f.output(false),
        g.output(false),
        h.output(false),
    ))
}

/// Pulls the pins up.
pub(crate) fn inputs<I: trirrr_app::inputs::Inputs>(
    beside: I,
    (a, b, c, d, e, f, g, h): InputPins,
) -> SensedInputs<I> {
    let pins = (
        a.pulled_up(),
        b.pulled_up(),
        c.pulled_up(),
        d.pulled_up(),
        e.pulled_up(),
        f.pulled_up(),
        g.pulled_up(),
        h.pulled_up(),
    );
    WithSpareInputs::new(beside, pins)
}
