#![no_main]
#[path = "../../tests/suite/checks/mod.rs"]
mod checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| checks::parquet_reader(bytes));
