# R's minimizers on problems that another process evaluates, line by line:
#
#   in   BFGS 1000 0x1p+0,0x1p-1 lower upper    method, limit, start, bounds
#   out  f 0x1p+0 0x1p-1                        asks for loss and gradient there
#   in   0x1p+3 0x1p+1 0x1p+2
#   out  end gtol the message                   how it ended
#   out  x loss x...                            what it returned
#
# again and again, until the input ends. Bounds may be "none".
input <- file("stdin", "r")
numbers <- function(text, by = " ") as.numeric(strsplit(text, by)[[1]])
hex <- function(x) paste(sprintf("%a", as.numeric(x)), collapse = " ")
say <- function(...) {
  cat(..., "\n")
  flush(stdout())
}

# Loss and gradient come together; R asks for one after the other.
at <- known <- NULL
evaluate <- function(x) {
  if (!identical(x, at)) {
    say("f", hex(x))
    known <<- numbers(readLines(input, 1))
    at <<- x + 0  # ucminf writes into its vector
  }
  known
}
loss <- function(x) evaluate(as.numeric(x))[1]
slope <- function(x) evaluate(as.numeric(x))[-1]

of_optim <- function(end)
  list(x = end$par, loss = end$value, message = end$message,
       status = switch(as.character(end$convergence),
                       "0" = if (grepl("GRADIENT", paste("", end$message)))
                               "gtol"
                             else "ftol",  # BFGS tests nothing else
                       "1" = "maxiter", "linesearch"))
of_nlminb <- function(end)
  list(x = end$par, loss = end$objective, message = end$message,
       status = if (end$convergence == 0)
                  if (grepl("relative|function", end$message)) "ftol"
                  else "gtol"
                else if (grepl("limit", end$message)) "maxiter"
                else "linesearch")
of_ucminf <- function(end)
  list(x = end$par, loss = end$value, message = end$message,
       status = switch(as.character(end$convergence),
                       "1" = , "2" = "gtol", "3" = "maxiter", "linesearch"))

solve <- function(method, limit, start, lower, upper)
  switch(method,
    "BFGS" = of_optim(optim(start, loss, slope, method = method,
                            control = list(maxit = limit))),
    "L-BFGS-B" = of_optim(optim(start, loss, slope, method = method,
                                lower = lower, upper = upper,
                                control = list(maxit = limit))),
    "nlminb" = of_nlminb(nlminb(start, loss, slope, lower = lower,
                                upper = upper,
                                control = list(iter.max = limit))),
    "ucminf" = of_ucminf(ucminf::ucminf(start, loss, slope,
                                        control = list(maxeval = limit))))

bound <- function(text, none) if (text == "none") none else numbers(text, ",")
while (length(line <- readLines(input, 1)) > 0) {
  asked <- strsplit(line, " ")[[1]]
  at <- NULL
  start <- numbers(asked[3], ",")
  end <- tryCatch(
    suppressWarnings(solve(asked[1], as.integer(asked[2]), start,
                           bound(asked[4], -Inf), bound(asked[5], Inf))),
    error = function(e)
      list(x = start, loss = NaN, status = "error",
           message = conditionMessage(e)))
  say("end", end$status, gsub("[[:space:]]+", " ", paste("", end$message)))
  say("x", hex(c(end$loss, end$x)))
}
