#!/usr/bin/env bash
# R's package ucminf (1.1-4.1, Debian 12) passes one vector to the objective again and
# again and writes the next point into it. In R a function's argument does not change
# after the call, so one would expect an objective to be allowed to keep it. Here one
# keeps its last argument to answer the gradient from the same computation, finds every
# new point identical to the last, and so gives the loss of the start for each:
# ucminf stops there. `kept <- x + 0` avoids it.
#
# Seen on 2026-11-28:
#   keeps x: ends at 0 0 after 1 computation: Stopped by zero step from line search
#   keeps x + 0: ends at 3 3 after 4 computations: Stopped by small gradient (grtol).
#
# Needs Rscript (r-base-core 4.2.2, r-cran-ucminf 1.1-4.1-1).
# Status 0: as described. 1: no more.
set -euo pipefail

solve() {  # WHAT IS KEPT
  Rscript --vanilla - <<R
kept <- known <- NULL
count <- 0
at <- function(x) {
  if (!identical(x, kept)) {
    count <<- count + 1
    known <<- c(sum((x - 3)^2) / 2, x - 3)
    kept <<- $1
  }
  known
}
end <- ucminf::ucminf(c(0, 0), function(x) at(x)[1], function(x) at(x)[-1])
cat("ends at ", paste(round(end\$par, 6), collapse = " "), " after ", count,
    if (count == 1) " computation: " else " computations: ", end\$message, "\n",
    sep = "")
R
}

argument=$(solve 'x') copy=$(solve 'x + 0')
echo "keeps x: $argument"
echo "keeps x + 0: $copy"
[[ $argument == "ends at 0 0 after 1 "* && $copy == "ends at 3 3 "* ]]
