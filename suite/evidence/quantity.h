/// Quantities: how a number is measured from a campaign, and which runs and
/// printed values it needs, so that registration can check them.
///
///   ratio(median({"adam"}, loss), median({"hig"}, loss))
#pragma once

#include <functional>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "suite/evidence/runs.h"
#include "suite/results/published.h"

namespace physinv {

struct Measured {
  std::optional<double> value;   ///< may be infinite
  std::optional<double> spread;  ///< sample deviation over seeds
  Index runs = 0;                ///< runs or seeds behind it
  std::string missing;           ///< what is not there, if there is no value
};

/// A number with nothing behind it but a reason.
Measured missing(std::string why);

class Quantity {
 public:
  using Measure = std::function<Measured(const Evidence&)>;
  using Make =
      std::function<Measured(const std::vector<Measured>&, const Evidence&)>;
  using Find = std::function<std::optional<Measured>(const std::string&)>;
  struct Part;

  /// Of numbers that a campaign keeps under labels of their own, such as those
  /// of other conditions of the claim. `make` gets them in this order.
  static Quantity made_of(const std::vector<Part>& parts,
                          const Make& make,
                          std::vector<std::string> printed = {});
  Quantity(double constant);  // NOLINT(google-explicit-constructor)
  Quantity(Measure measure,
           std::vector<Select> runs,
           std::vector<std::string> printed = {});

  Measured operator()(const Evidence& evidence) const {
    return body_->measure(evidence);
  }
  /// Of its parts as `find` has them by label; nothing if it lacks one, or if
  /// there are none.
  std::optional<Measured> of_parts(const Evidence& evidence,
                                   const Find& find) const;
  /// What registration looks up.
  const std::vector<Select>& runs() const { return body_->runs; }
  const std::vector<std::string>& printed() const { return body_->printed; }

 private:
  struct Body {
    Measure measure;
    std::vector<Select> runs;
    std::vector<std::string> printed;
    std::vector<std::string> parts = {};
    Make make = {};
  };
  /// Shared, as claims are made of copies of copies.
  std::shared_ptr<const Body> body_;
};

struct Quantity::Part {
  std::string label;
  Quantity number;
};

/// What `printed` looks up.
std::optional<PublishedValue> find_printed(const Published& published,
                                           const std::string& experiment,
                                           const std::string& name);

/// Over all runs selected, whatever their n; missing if one is not a number.
Quantity median(Select select, RunValue value);
Quantity lowest(Select select, RunValue value);
Quantity highest(Select select, RunValue value);
/// The mean over n of each seed; of these the mean, their deviation as spread.
Quantity mean(Select select, RunValue value);
/// Share of the runs that have a value and pass; their number.
Quantity share(Select select, RunValue value, std::function<bool(double)> test);
Quantity count(Select select, RunValue value, std::function<bool(double)> test);
/// Medians, and lowest values, of several methods.
std::vector<Quantity> medians(const std::vector<Select>& of,
                              const RunValue& value);
std::vector<Quantity> lowests(const std::vector<Select>& of,
                              const RunValue& value);
/// Of value(a) / value(b) over pairs of runs of one n and seed; the median over
/// those that have a ratio.
Quantity median_ratio(Select a, Select b, RunValue value);
Quantity worst_ratio(Select a, Select b, RunValue value);

/// Values of a run's examples, joined over all runs.
using RunRow = std::function<std::vector<double>(const Run&)>;
Quantity median_of_examples(Select select, RunRow row);
/// Share of all examples, the deviation of each seed's share as spread.
Quantity share_of_examples(Select select,
                           RunRow row,
                           std::function<bool(double)> test);

/// f of each: least(each({"sgd", "adam"}, at_end)).
template <class Range, class F>
auto each(const Range& range, F f) {
  std::vector<decltype(f(*std::begin(range)))> all;
  for (const auto& one : range) all.push_back(f(one));
  return all;
}

/// Of those alone that are wanted.
template <class Range, class Wanted, class F>
auto each_if(const Range& range, Wanted wanted, F f) {
  std::vector<decltype(f(*std::begin(range)))> all;
  for (const auto& one : range)
    if (wanted(one)) all.push_back(f(one));
  return all;
}

Quantity ratio(const Quantity& a, const Quantity& b);
/// Of a's median over b's, each over all its runs.
inline Quantity ratio_of_medians(Select a, Select b, const RunValue& value) {
  return ratio(median(std::move(a), value), median(std::move(b), value));
}
Quantity difference(const Quantity& a, const Quantity& b);
/// Value and spread times a factor; 100 makes per cent of a share.
Quantity times(double factor, const Quantity& a);
Quantity percent(const Quantity& share);
/// The smallest and the largest of those that are there, missing if one is.
Quantity least(std::vector<Quantity> of);
Quantity most(std::vector<Quantity> of);
/// The largest over the smallest.
Quantity spread_ratio(const std::vector<Quantity>& of);

/// Names the other runs that the values read, for registration to look up.
Quantity depends_on(const Quantity& a, const std::vector<Select>& others);

/// Missing unless it is of so many runs (or seeds).
Quantity from_at_least(Index runs, const Quantity& a);

/// A value of the paper, with its printed spread: of the experiment that asks,
/// or of another one, "jpo/billiards table3/n=4".
Quantity printed(std::string quantity);

}  // namespace physinv
