/// Conditions of claims: a label, a quantity, and bounds that write their own
/// words.
///
///   within("updates to 0.1", median({"hig"}, first_below(0.1)), 55, 95)
///   above("Adam / HIG", ratio(...), 2)
#pragma once

#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

#include "suite/evidence/quantity.h"
#include "suite/results/report_model.h"

namespace physinv {

struct Condition {
  std::string label;
  std::string bounds;                ///< in words: "in 55 .. 95"
  std::vector<Quantity> quantities;  ///< what registration checks
  std::function<ConditionResult(const Evidence&)> judge;
};

/// Bounds may be measured themselves ("as many as BFGS").
Condition at_least(std::string label, Quantity q, Quantity bound);
Condition at_most(std::string label, Quantity q, Quantity bound);
Condition above(std::string label, Quantity q, Quantity bound);
Condition below(std::string label, Quantity q, Quantity bound);
/// Both ends belong to it.
Condition within(std::string label, Quantity q, double lowest, double highest);
/// A number that decides nothing.
Condition report(std::string label, Quantity q);
/// Holds if one of them does.
Condition either(Condition a, Condition b);
std::vector<Condition> joined(
    std::initializer_list<std::vector<Condition>> parts);

/// Whether our number is the printed one. Without a printed spread,
/// |m - p| <= max(0.05, 2.83 s) with s our deviation over at least three seeds
/// (the paper's spread assumed as large as ours); not judged if that is wider
/// than 20. With one, b: |m - p| <= max(0.05, 2 sqrt(s^2 + b^2)). In the unit
/// of the printed value, as a rule per cent.
Condition as_printed(std::string label, Quantity q, std::string quantity);

/// "About x %": |m - x| <= max(5, 2 standard errors), in per cent.
Condition about(std::string label, Quantity percent, double x);

/// Half a decade around a value read from a logarithmic plot:
/// in [v / 3.2, 3.2 v].
Condition near(std::string label, Quantity q, double v);

/// Shares need three digits, losses an exponent.
std::string number_text(double value);

}  // namespace physinv
