/// Numbers of one run, whatever it solved, and of each of its examples.
///
///   mean({"bfgs"}, of_row(losses(), mean_of))
///   median_of_examples({"bfgs"}, iterations())
#pragma once

#include <functional>
#include <vector>

#include "suite/core/arrays.h"
#include "suite/evidence/quantity.h"
#include "suite/evidence/shares.h"

namespace physinv {

/// Of an array that the stage recorded; empty without it.
RunValue of_array(ArrayKey name,
                  std::function<double(const Batch<double>&)> value);

/// At the end of the stage.
RunRow losses();
RunRow iterations();
RunRow evaluations();

/// A statistic of a row (suite/evidence/statistics.h); empty without examples.
RunValue of_row(RunRow row, double (*statistic)(std::vector<double>));

/// A share of the run's problems, of its losses compared with those of `other`
/// in the same experiment, of the same n and seed; empty without that run.
using Share = double (*)(const Shares&);
RunValue against(const Select& other,
                 Share share,
                 Equality equality = Equality::strict);

}  // namespace physinv
