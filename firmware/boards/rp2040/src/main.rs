//! Image for the RP2040.
#![cfg_attr(target_os = "none", no_std, no_main)]

trirrr_app::image!(trirrr_rp2040, "cargo fw-rp2040");
