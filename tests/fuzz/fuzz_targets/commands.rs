#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| trirrr_bench::targets::commands(data));
