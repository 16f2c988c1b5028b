//! Label of an image that is replaced over the line.

use trirrr_protocol::message::{Firmware, IMAGE_MARK};

/// Label of the image, by which a host finds its build in the file.
#[derive(Debug)]
#[repr(C)]
pub struct ImageLabel {
    mark: [u8; 16],
    /// Build of the image.
    pub firmware: Firmware,
}

impl ImageLabel {
    /// Label of an image with this build.
    pub const fn new(firmware: Firmware) -> Self {
        Self {
            mark: *IMAGE_MARK,
            firmware,
        }
    }
}
