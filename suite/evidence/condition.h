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

/// What an earlier judgement kept.
using Kept = std::vector<ConditionResult>;

struct Condition {
  std::string label;   ///< by which its number is kept
  std::string bounds;  ///< in words: "in 55 .. 95"; none: it decides nothing
  /// The number and its bound: what registration checks.
  std::vector<Quantity> quantities;
  /// Holds a number, measured or kept, against its bound.
  std::function<void(const Evidence&, ConditionResult& number)> decide = {};
  std::vector<Condition> alternatives = {};  ///< of `either`; their numbers
  /// Asks for no more than results.json keeps of every stage.
  bool of_stages = false;
  std::string shown = {};  ///< instead of the label, if any

  const std::string& text() const { return shown.empty() ? label : shown; }
  ConditionResult judge(const Evidence& evidence) const;
};

/// What is left of a campaign that was published.
struct Remains {
  const Evidence& planned;  ///< the cases of its profile, without a number
  /// What results.json keeps of each stage: end, iterations, times, mean and
  /// largest loss.
  const Evidence& stages;
};

/// What is missing where no number was kept, although runs were asked for.
inline constexpr const char* kNotKept = "not kept; needs a run";

/// Judged by the stages that are left, if the condition is of them; else by the
/// number that an earlier judgement kept under this label and relation, or only
/// reported under it, or by the parts of the number. A bound that was measured
/// is not kept: what was decided by it remains. Missing if there is nothing.
ConditionResult judge_kept(const Condition& condition,
                           const Kept& kept,
                           const Remains& remains);

/// What a condition of these words makes of a number before it is decided.
ConditionResult result_of(const std::string& label,
                          const std::string& bounds,
                          const Measured& measured);

/// Bounds may be measured themselves ("as many as BFGS").
Condition at_least(std::string label, Quantity q, Quantity bound);
Condition at_most(std::string label, Quantity q, Quantity bound);
Condition above(std::string label, Quantity q, Quantity bound);
Condition below(std::string label, Quantity q, Quantity bound);
/// Both ends belong to it.
Condition within(std::string label, Quantity q, double lowest, double highest);
/// In [value - off, value + off].
Condition equals(std::string label, Quantity q, double value, double off = 0);
/// On every seed that both methods have, and of two seeds at least, the first
/// one's value is below the second one's.
std::vector<Condition> below_on_every_seed(const std::string& label,
                                           const Select& a,
                                           const Select& b,
                                           const RunValue& value);
/// A number that decides nothing.
Condition reported(std::string label, Quantity q);
/// Holds if one of them does.
Condition either(Condition a, Condition b);
/// Of ends, iterations, times, mean or largest losses of stages alone, which
/// results.json keeps: decided again for every campaign.
Condition of_stages(Condition c);
/// Under another text; numbers are kept by the label as before.
Condition shown_as(Condition c, std::string text);
std::vector<Condition> joined(
    std::initializer_list<std::vector<Condition>> parts);

/// Whether our mean over K seeds is the one that the paper prints of `seeds`:
/// |m - p| <= 2 sqrt(s^2 / K + s^2 / seeds), twice the standard error of the
/// difference of two means, or half a printed digit, 0.05. Per cent. s is our
/// deviation over at least three seeds, and at least that of shares of so many
/// problems (binomial, at the mean of both numbers).
Condition as_printed(std::string label,
                     Quantity q,
                     std::string quantity,
                     Index seeds);
/// The same of a number that no file has under one name.
Condition as_stated(std::string label,
                    Quantity percent,
                    double stated,
                    Index seeds);

/// One of several means, next to its name among the printed ones.
struct PrintedMean {
  std::string label;
  Quantity quantity;
  std::string name;
};
/// Whether means are those that the paper prints with deviations, all together:
/// the probability of differences as large, sum (m - p)^2 / (s^2 / K + b^2 /
/// seeds) after chi squared, is 5 % at least. Variances are at least those of
/// rounding to 0.1. Behind it the means, and the printed ones, as numbers.
std::vector<Condition> jointly_as_printed(std::string label,
                                          std::vector<PrintedMean> means,
                                          Index seeds);

/// "About x %": |m - x| <= max(5, 2 standard errors), in per cent.
Condition about(std::string label, Quantity percent, double x);

/// Half a decade around a value read from a logarithmic plot:
/// in [v / 3.2, 3.2 v].
Condition near(std::string label, Quantity q, double v);

/// Shares need three digits, losses an exponent.
std::string number_text(double value);

}  // namespace physinv
