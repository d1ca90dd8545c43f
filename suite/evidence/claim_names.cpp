#include "suite/evidence/claim_names.h"

#include <fmt/format.h>

#include <stdexcept>

#include "suite/evidence/curve_shape.h"
#include "suite/evidence/of_experiment.h"
#include "suite/evidence/run_values.h"
#include "suite/evidence/statistics.h"
#include "suite/evidence/training.h"

namespace physinv {

const ClaimValue* ClaimNames::value(const std::string& name) const {
  const auto found = values_.find(name);
  return found == values_.end() ? nullptr : &found->second;
}

const std::vector<ClaimNames::Function>* ClaimNames::functions(
    const std::string& name) const {
  const auto found = functions_.find(name);
  return found == functions_.end() ? nullptr : &found->second;
}

std::vector<std::string> ClaimNames::all() const {
  std::vector<std::string> names;
  for (const auto& [name, value] : values_) names.push_back(name);
  for (const auto& [name, functions] : functions_) names.push_back(name);
  return names;
}

ArrayKey array_named(const std::string& name) {
  const ArrayInfo* found = find_array(name);
  if (found == nullptr)
    throw std::logic_error(fmt::format("there is no array {}", name));
  return ArrayKey::own(found->name);
}

std::string kind_of(std::type_index type) {
  static const std::map<std::type_index, const char*> kinds{
      {typeid(double), "a number"},
      {typeid(Index), "a whole number"},
      {typeid(int), "a whole number"},
      {typeid(std::string), "text"},
      {typeid(Select), "runs"},
      {typeid(std::vector<Select>), "a list of runs"},
      {typeid(RunValue), "a value of a run"},
      {typeid(RunRow), "a value of each example"},
      {typeid(Quantity), "a number of the campaign"},
      {typeid(std::vector<Quantity>), "a list of numbers of the campaign"},
      {typeid(ArrayKey), "the name of an array"},
      {typeid(Clock), "a clock"},
      {typeid(RowOfCurve), "a row of the curve"},
      {typeid(Condition), "a condition"},
      {typeid(std::vector<Condition>), "conditions"},
      {typeid(Labelled), "conditions"},
      {typeid(ClaimList), "a list"}};
  const auto found = kinds.find(type);
  return found == kinds.end() ? "a value" : found->second;
}

namespace {

using Test = std::function<bool(double)>;

void add_runs(ClaimNames& names) {
  names.add("run", [](const std::string& method, const std::string& stage) {
    return Select{method, stage};
  });
  names.add("sizes",
            [](const Select& s, Index from) { return s.of_sizes(from); });
  names.add("sizes", [](const Select& s, Index from, Index to) {
    return s.of_sizes(from, to);
  });
  names.add("at", [](const Select& s, Index n) { return s.of_sizes(n, n); });
  names.add("in", [](const Select& s, const std::string& experiment) {
    return s.in(experiment);
  });
  names.add("in", [](const Quantity& q, const std::string& experiment) {
    return of_experiment(experiment, q);
  });
}

/// Of a list that is not empty: of none, a number that is missing.
template <class F>
auto of_some(F f) {
  return [=](const std::vector<Quantity>& all) -> Quantity {
    if (!all.empty()) return f(all);
    return {[](const Evidence&) { return missing("numbers"); }, {}};
  };
}

/// Over all runs that are selected.
void add_quantities(ClaimNames& names) {
  names.add("median", [](const Select& s, const RunValue& v) {
    return physinv::median(s, v);
  });
  names.add("lowest", lowest);
  names.add("highest", highest);
  names.add("mean", mean);
  names.add("share", share);
  names.add("count", count);
  names.add("median_ratio", median_ratio);
  names.add("worst_ratio", worst_ratio);
  names.add("median_of_examples", median_of_examples);
  names.add("share_of_examples", share_of_examples);
  names.add("ratio_of_medians", ratio_of_medians);
  names.add("percent", percent);
  names.add("least", of_some(least));
  names.add("most", of_some(most));
  names.add("spread_ratio", of_some(spread_ratio));
  names.add("medians", medians);
  names.add("lowests", lowests);
  names.add("depends_on", depends_on);
  names.add("from_at_least", from_at_least);
  names.add("printed", printed);
  names.add("median_after", median_after);
  names.add("median_at_end", median_at_end);
  names.add("lowest_at_end", lowest_at_end);
  names.add("lead", lead);
  names.add("spread_of_seeds",
            [](const Select& first,
               const std::vector<Select>& others,
               const RunValue& value) {
              std::vector<Select> all{first};
              all.insert(all.end(), others.begin(), others.end());
              return spread_of_seeds(all, value);
            });
  names.add("most_stay_above", most_stay_above);
  names.add("most_stay_below", most_stay_below);
  names.add("above", [](double bound) {
    return Test([=](double v) { return v > bound; });
  });
  names.add("below", [](double bound) {
    return Test([=](double v) { return v < bound; });
  });
  names.add("at_least", [](double bound) {
    return Test([=](double v) { return v >= bound; });
  });
  names.add("at_most", [](double bound) {
    return Test([=](double v) { return v <= bound; });
  });
  names.add("below_on_every_seed",
            [](const Select& a, const Select& b, const RunValue& value) {
              return Labelled([=](const std::string& label) {
                return below_on_every_seed(label, a, b, value);
              });
            });
}

/// Without arguments of the whole curve of the test loss.
void add_curves(ClaimNames& names) {
  names.add("updates", updates);
  names.add("own_seconds", own_seconds);
  names.add("metric", [](Index row) { return metric(row); });
  names.add("loss_at",
            [](const Clock& c, double time) { return loss_at(c, time); });
  names.add("loss_after", loss_after);
  names.add("loss_at_share", loss_at_share);
  names.add("last_loss", last_loss);
  names.add("first_loss", first_loss);
  names.add("lowest_loss", lowest_loss);
  names.add("highest_loss", highest_loss);
  names.add("time_to",
            [](const Clock& c, double level) { return time_to(c, level); });
  names.add("time_to", [](const Clock& c, const RunValue& level) {
    return time_to(c, level);
  });
  names.add("length", length);
  names.add("first_below", [](double level) { return first_below(level); });
  names.add("first_below", [](double level, RowOfCurve row) {
    return first_below(level, row);
  });
  names.add("first_of", first_of);
  names.add("last_of", last_of);
  names.add("value_after", value_after);
  names.add("lowest_of", lowest_of);
  names.add("highest_of", highest_of);
  names.add("largest_rise", largest_rise);
  names.add("largest_rise", [] { return largest_rise(); });
  names.add("share_left", share_left);
  names.add("share_left", [] { return share_left(); });
  names.add("steepness", [] { return steepness(); });
  names.add("steepness", [](int before) { return steepness(before); });
  names.add("log_fall", log_fall);
  names.add("plateau", plateau);
  names.add("scatter", scatter);
  names.add("settled_loss", settled_loss);
}

/// Of a run, whatever it solved.
void add_run_values(ClaimNames& names) {
  names.add("late_training_error", late_training_error);
  names.add("diverged", diverged);
  names.add("seconds_per_update", seconds_per_update);
  names.add("if_ran", if_ran);
  names.add("or_infinite", or_infinite);
  names.add("beside", beside);
  names.add("over", over);
  names.add("losses", losses);
  names.add("iterations", iterations);
  names.add("evaluations", evaluations);
  names.add("mean_of", [](const RunRow& row) { return of_row(row, mean_of); });
  names.add("least_of",
            [](const RunRow& row) { return of_row(row, least_of); });
  names.add("median_of",
            [](const RunRow& row) { return of_row(row, physinv::median); });
  names.add("most_of", [](const RunRow& row) { return of_row(row, most_of); });
}

}  // namespace

ClaimNames claim_names() {
  ClaimNames names;
  add_runs(names);
  add_quantities(names);
  add_curves(names);
  add_run_values(names);
  return names;
}

}  // namespace physinv
