#!/usr/bin/env bash
# run.sh PROGRAM FOLDER READER: feeds a fuzzer PHYSINV_FUZZ_RUNS inputs, made of
# the corpus of its reader. What leads on is kept in inputs/READER in the
# program's folder, for the next time; what should be mended, in found. An input
# may take 5 s (PHYSINV_FUZZ_SECONDS, for a machine that does other things) and
# a gigabyte.
set -euo pipefail
program=$1 folder=$2 reader=$3
beside=${program%/*}
mkdir -p "$beside/inputs/$reader" "$beside/found"
dictionary=$folder/$reader.dict
[[ -e $dictionary ]] || dictionary=$folder/json.dict
# HDF5 forgets memory when it refuses a file.
printf 'leak:libhdf5\n' >"$beside/inputs/leaks.$reader"
export LSAN_OPTIONS=suppressions=$beside/inputs/leaks.$reader:print_suppressions=0
# Four calls show where memory comes from; more take longer.
export ASAN_OPTIONS=quarantine_size_mb=16:malloc_context_size=4
exec "$program" -runs="${PHYSINV_FUZZ_RUNS:-20000}" -dict="$dictionary" \
  -max_len=16384 -timeout="${PHYSINV_FUZZ_SECONDS:-5}" \
  -rss_limit_mb=1024 -malloc_limit_mb=1024 \
  -close_fd_mask=1 -print_final_stats=1 \
  -artifact_prefix="$beside/found/$reader-" \
  "$beside/inputs/$reader" "$folder/corpus/$reader"
