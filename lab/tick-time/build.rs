//! Compiles the peer of the benchmark `symforce`, with the processor that the Rust code is compiled for.

fn main() {
    println!("cargo::rerun-if-changed=symforce");
    #[cfg(feature = "symforce")]
    {
        let flags = std::env::var("CARGO_ENCODED_RUSTFLAGS").unwrap_or_default();
        let mut peer = cc::Build::new();
        peer.cpp(true).file("symforce/symforce.cc");
        peer.opt_level(3).debug(false);
        peer.flag("-ffast-math");
        if flags.contains("target-cpu=native") {
            peer.flag("-march=native");
        }
        peer.compile("symforce_tick");
    }
}
