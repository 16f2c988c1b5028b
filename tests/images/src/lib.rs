//! The constants of images against what the host builds, for every shipped scene: see `tests/images.rs`.
