#!/usr/bin/env bash
# R's optim(method = "BFGS") (R 4.2.2, Debian 12) returns a `par` that it has not
# evaluated and a `value` of another point, if its last line search finds no lower point:
# here on a parabola with its exact gradient. Its manual says of `value`: "The value of
# 'fn' corresponding to 'par'". The points differ in the last digits alone, where the
# search gives up, but a caller that compares `value` with fn(par), or looks up what
# was computed at `par`, finds nothing.
#
# Seen on 2026-11-28:
#   par was evaluated: FALSE, fn(par) is value: FALSE, convergence: 0
#
# Needs Rscript (r-base-core 4.2.2).
# Status 0: as described. 1: no more.
set -euo pipefail

said=$(Rscript --vanilla - <<'R'
seen <- c()
fn <- function(x) {
  seen <<- c(seen, x)
  1e4 * (x - 0.01)^2
}
end <- optim(0.8, fn, function(x) 2e4 * (x - 0.01), method = "BFGS")
evaluated <- end$par %in% seen
cat("par was evaluated: ", evaluated, ", fn(par) is value: ",
    fn(end$par) == end$value, ", convergence: ", end$convergence, "\n",
    sep = "")
R
)
echo "$said"
[[ $said == "par was evaluated: FALSE, fn(par) is value: FALSE"* ]]
