#!/bin/sh
# Builds the targets with coverage instrumentation on a stable compiler and runs each for so many seconds:
#   fuzz/run.sh SECONDS [TARGET...]
# An input that takes more than 20 seconds or 2 GB, or asks for 1.5 GiB at once, is a finding; TIMEOUT is other seconds, for a machine that does
# other things too. What is found is left in fuzz/artifacts. `cargo fuzz run TARGET` does the same on a nightly compiler.
set -eu
cd "$(dirname "$0")"
seconds=$1
shift
[ $# -gt 0 ] || set -- csv_reader parquet_reader polygon_reader names picture_reader picture_stream picture_folder tracing fit_and_decomposition adaptive_identifier motion_filter saved_state
instrumentation="-Cpasses=sancov-module -Cllvm-args=-sanitizer-coverage-level=4
 -Cllvm-args=-sanitizer-coverage-inline-8bit-counters -Cllvm-args=-sanitizer-coverage-pc-table
 -Cllvm-args=-sanitizer-coverage-trace-compares"
host=$(rustc -vV | sed -n 's/^host: //p')
RUSTFLAGS="--cfg fuzzing $(echo $instrumentation)" cargo build --release --target "$host"
for target in "$@"; do
    mkdir -p "corpus/$target" "artifacts/$target"
    "${CARGO_TARGET_DIR:-target}/$host/release/$target" -max_total_time="$seconds" -timeout="${TIMEOUT:-20}" -rss_limit_mb=2048 \
        -malloc_limit_mb=1536 -max_len=4096 -artifact_prefix="artifacts/$target/" -print_final_stats=1 "corpus/$target" 2>&1 |
        tee "artifacts/$target.log" | grep -E "SUMMARY|panicked|ERROR|stat::number_of_executed|Done" || true
done
