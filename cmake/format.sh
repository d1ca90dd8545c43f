#!/usr/bin/env bash
# Fails on a source that clang-format would change; with --fix, changes it.
set -euo pipefail
here=$(readlink -f "${BASH_SOURCE[0]}")
cd "${here%/*}/.."
action=(--dry-run --Werror --ferror-limit=1)
[[ ${1:-} != --fix ]] || action=(-i)
find suite problems optimizers baselines reports tests python examples \
  \( -name '*.h' -o -name '*.cpp' \) -print0 |
  xargs -0 -P "$(nproc)" -n 64 clang-format-14 "${action[@]}" || exit 1
