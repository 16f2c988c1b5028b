//! Pins as the functions of a board take them: as they are, or inverted by the wiring, which the pin itself takes back.

// An image uses those of its scene's functions.
#![allow(dead_code)]

use embedded_hal::digital::PinState;
use rp2040_hal::gpio::{
    DynPinId, FunctionNull, FunctionSioInput, FunctionSioOutput, InputOverride, OutputOverride,
    Pin, PinId, PullDown, PullUp, ValidFunction,
};
use rp2040_hal::gpio::{FunctionSio, SioInput, SioOutput};
use rp2040_hal::pac::{UART0, UART1, USBCTRL_DPRAM, USBCTRL_REGS};
use trirrr_boards::BoardPin;

/// Ports of the chip, of which [`Pins`](crate::board::Pins) takes those of the board file.
pub(crate) struct Ports {
    pub(crate) uart0: UART0,
    pub(crate) uart1: UART1,
    pub(crate) usb: UsbPort,
}

/// Controller of USB, with its memory.
pub(crate) type UsbPort = (USBCTRL_REGS, USBCTRL_DPRAM);

/// Output of any pin, for arrays.
pub(crate) type AnyOutput = Pin<DynPinId, FunctionSioOutput, PullDown>;

/// Pin as it is.
pub(crate) struct Direct<I: PinId>(pub(crate) Pin<I, FunctionNull, PullDown>);

impl<I: PinId> BoardPin for Direct<I>
where
    I: ValidFunction<FunctionSio<SioOutput>> + ValidFunction<FunctionSio<SioInput>>,
{
    const INVERTED: bool = false;
    type Plain = Pin<I, FunctionNull, PullDown>;
    type Output = Pin<I, FunctionSioOutput, PullDown>;
    type Input = Pin<I, FunctionSioInput, PullUp>;

    fn plain(self) -> Self::Plain {
        self.0
    }

    fn output(self, high: bool) -> Self::Output {
        self.0.into_push_pull_output_in_state(PinState::from(high))
    }

    fn pulled_up(self) -> Self::Input {
        self.0.into_pull_up_input()
    }
}

/// Pin behind which the wiring inverts the level.
pub(crate) struct Inverted<P>(pub(crate) P);

impl<I: PinId> BoardPin for Inverted<Direct<I>>
where
    I: ValidFunction<FunctionSio<SioOutput>> + ValidFunction<FunctionSio<SioInput>>,
{
    const INVERTED: bool = true;
    type Plain = Pin<I, FunctionNull, PullDown>;
    type Output = Pin<I, FunctionSioOutput, PullDown>;
    type Input = Pin<I, FunctionSioInput, PullDown>;

    fn plain(self) -> Self::Plain {
        self.0.0
    }

    fn output(mut self, high: bool) -> Self::Output {
        // Before the pin is an output. What is written to it is then the level of the function.
        self.0.0.set_output_override(OutputOverride::Invert);
        self.0
            .0
            .into_push_pull_output_in_state(PinState::from(high))
    }

    fn pulled_up(mut self) -> Self::Input {
        self.0.0.set_input_override(InputOverride::Invert);
        self.0.0.into_pull_down_input()
    }
}
