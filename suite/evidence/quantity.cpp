#include "suite/evidence/quantity.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "suite/evidence/failures.h"
#include "suite/evidence/statistics.h"
#include "suite/evidence/training.h"
#include "suite/results/published.h"
#include "suite/store/record.h"

namespace physinv {
namespace {

/// A statistic of samples, or why there are none.
template <class F>
Quantity over_runs(Select select, RunValue value, F statistic) {
  std::vector<Select> runs = {select};
  return {[=](const Evidence& e) {
            const auto samples = sample(e, select, value);
            if (samples.empty()) return missing(why_no_value(e, select));
            return statistic(samples);
          },
          std::move(runs)};
}

template <class F>
Quantity of_values(Select select, RunValue value, F statistic) {
  return over_runs(std::move(select),
                   std::move(value),
                   [=](const std::vector<Sample>& samples) {
                     const double found = statistic(values_of(samples));
                     if (std::isnan(found)) return missing("no finite value");
                     return Measured{
                         .value = found,
                         .runs = static_cast<Index>(samples.size())};
                   });
}

/// A statistic of the order of values, which they lack if one is NaN.
template <class F>
Quantity of_ordered(Select select, RunValue value, F statistic) {
  return of_values(
      std::move(select), std::move(value), [=](const auto& values) {
        for (const double v : values)
          if (std::isnan(v)) return v;
        return statistic(values);
      });
}

std::vector<Select> joined(std::vector<Select> a,
                           const std::vector<Select>& b) {
  a.insert(a.end(), b.begin(), b.end());
  return a;
}

template <class F>
Quantity of_two(const Quantity& a, const Quantity& b, F f) {
  auto printed = a.printed();
  printed.insert(printed.end(), b.printed().begin(), b.printed().end());
  return {[=](const Evidence& e) {
            Measured x = a(e), y = b(e);
            if (!x.value) return x;
            if (!y.value) return y;
            const double value = f(*x.value, *y.value);
            if (std::isnan(value)) return missing("no finite value");
            const Index runs = x.runs == 0   ? y.runs
                               : y.runs == 0 ? x.runs
                                             : std::min(x.runs, y.runs);
            return Measured{.value = value, .runs = runs};
          },
          joined(a.runs(), b.runs()),
          std::move(printed)};
}

Quantity extreme(const std::vector<Quantity>& of, bool largest) {
  Quantity out = of.front();
  for (std::size_t i = 1; i < of.size(); ++i)
    out = of_two(out, of[i], [=](double a, double b) {
      return largest ? std::max(a, b) : std::min(a, b);
    });
  return out;
}

/// Missing if one of the runs that it is of failed, whatever it makes of the
/// others.
Quantity::Measure guarded(Quantity::Measure measure,
                          const std::vector<Select>& runs) {
  if (runs.empty()) return measure;
  return [=](const Evidence& e) {
    for (const Select& select : runs)
      if (const auto failed = failed_text(e, select); !failed.empty())
        return missing(select.text() + ": " + failed);
    return measure(e);
  };
}

}  // namespace

Measured missing(std::string why) { return {.missing = std::move(why)}; }

Quantity::Quantity(double constant)
    : Quantity([=](const Evidence&) { return Measured{.value = constant}; },
               {}) {}

Quantity::Quantity(Measure measure,
                   std::vector<Select> runs,
                   std::vector<std::string> printed)
    : body_(std::make_shared<const Body>(Body{guarded(std::move(measure), runs),
                                              std::move(runs),
                                              std::move(printed)})) {}

Quantity Quantity::made_of(const std::vector<Part>& parts,
                           const Make& make,
                           std::vector<std::string> printed) {
  std::vector<Select> runs;
  std::vector<std::string> labels;
  for (const Part& part : parts) {
    runs = joined(std::move(runs), part.number.runs());
    labels.push_back(part.label);
  }
  const auto measure = [=](const Evidence& e) {
    return make(each(parts, [&](const Part& part) { return part.number(e); }),
                e);
  };
  Quantity made(measure, std::move(runs), std::move(printed));
  Body body = *made.body_;
  body.parts = std::move(labels), body.make = make;
  made.body_ = std::make_shared<const Body>(std::move(body));
  return made;
}

std::optional<Measured> Quantity::of_parts(const Evidence& evidence,
                                           const Find& find) const {
  std::vector<Measured> found;
  for (const std::string& label : body_->parts)
    if (auto part = find(label)) found.push_back(std::move(*part));
  if (found.empty() || found.size() < body_->parts.size()) return {};
  return body_->make(found, evidence);
}

Quantity median(Select select, RunValue value) {
  return of_ordered(std::move(select), std::move(value), [](auto values) {
    return median(std::move(values));
  });
}

Quantity lowest(Select select, RunValue value) {
  return of_ordered(
      std::move(select), std::move(value), [](const auto& values) {
        return *std::min_element(values.begin(), values.end());
      });
}

Quantity highest(Select select, RunValue value) {
  return of_ordered(
      std::move(select), std::move(value), [](const auto& values) {
        return *std::max_element(values.begin(), values.end());
      });
}

Quantity mean(Select select, RunValue value) {
  return over_runs(std::move(select),
                   std::move(value),
                   [](const std::vector<Sample>& samples) {
                     const auto seeds = seed_means(samples);
                     const auto found = mean_std(seeds);
                     return Measured{.value = found->mean,
                                     .spread = found->std,
                                     .runs = static_cast<Index>(seeds.size())};
                   });
}

Quantity count(Select select,
               RunValue value,
               std::function<bool(double)> test) {
  return of_values(
      std::move(select), std::move(value), [test](const auto& values) {
        return static_cast<double>(
            std::count_if(values.begin(), values.end(), test));
      });
}

Quantity share(Select select,
               RunValue value,
               std::function<bool(double)> test) {
  return of_values(
      std::move(select), std::move(value), [test](const auto& values) {
        return static_cast<double>(
                   std::count_if(values.begin(), values.end(), test)) /
               static_cast<double>(values.size());
      });
}

std::vector<Quantity> medians(const std::vector<Select>& of,
                              const RunValue& value) {
  return each(of, [&](const Select& s) { return median(s, value); });
}

std::vector<Quantity> lowests(const std::vector<Select>& of,
                              const RunValue& value) {
  return each(of, [&](const Select& s) { return lowest(s, value); });
}

Quantity median_ratio(Select a, Select b, RunValue value) {
  const auto pair = [=](const Run& run) -> std::optional<double> {
    const auto other = run.beside(b);
    if (!other) return {};
    const auto x = value(run), y = value(*other);
    if (!x || !y || std::isnan(*x / *y)) return {};
    return *x / *y;
  };
  return depends_on(median(std::move(a), pair), {b});
}

Quantity worst_ratio(Select a, Select b, RunValue value) {
  return depends_on(highest(std::move(a), over(value, beside(b, value))), {b});
}

Quantity median_of_examples(Select select, RunRow row) {
  std::vector<Select> runs = {select};
  return {[=](const Evidence& e) {
            std::vector<double> all;
            const auto found = find_runs(e, select);
            for (const Run& run : found)
              for (const double v : row(run)) all.push_back(v);
            if (all.empty()) return missing(select.text() + " not run");
            for (const double v : all)
              if (std::isnan(v)) return missing("no finite value");
            return Measured{.value = median(std::move(all)),
                            .runs = static_cast<Index>(found.size())};
          },
          std::move(runs)};
}

Quantity share_of_examples(Select select,
                           RunRow row,
                           std::function<bool(double)> test) {
  struct Tally {
    double passed = 0, all = 0;
  };
  std::vector<Select> runs = {select};
  return {[=](const Evidence& e) {
            Tally total;
            std::map<std::uint64_t, Tally> seeds;
            for (const Run& run : find_runs(e, select)) {
              Tally& seed = seeds[run.seed()];
              for (const double v : row(run)) {
                const bool passed = test(v);
                seed.passed += passed, seed.all += 1;
                total.passed += passed, total.all += 1;
              }
            }
            if (total.all == 0) return missing(select.text() + " not run");
            std::vector<double> shares;
            for (const auto& [seed, c] : seeds)
              if (c.all > 0) shares.push_back(c.passed / c.all);
            return Measured{.value = total.passed / total.all,
                            .spread = mean_std(shares)->std,
                            .runs = static_cast<Index>(shares.size())};
          },
          std::move(runs)};
}

Quantity ratio(const Quantity& a, const Quantity& b) {
  return of_two(a, b, [](double x, double y) { return x / y; });
}

Quantity difference(const Quantity& a, const Quantity& b) {
  return of_two(a, b, [](double x, double y) { return x - y; });
}

Quantity times(double factor, const Quantity& a) {
  return {[=](const Evidence& e) {
            Measured m = a(e);
            if (m.value) *m.value *= factor;
            if (m.spread) *m.spread *= factor;
            return m;
          },
          a.runs(),
          a.printed()};
}

Quantity percent(const Quantity& share) { return times(100, share); }

Quantity least(std::vector<Quantity> of) { return extreme(of, false); }
Quantity most(std::vector<Quantity> of) { return extreme(of, true); }
Quantity spread_ratio(const std::vector<Quantity>& of) {
  return ratio(most(of), least(of));
}

Quantity depends_on(const Quantity& a, const std::vector<Select>& others) {
  return {[=](const Evidence& e) { return a(e); },
          joined(a.runs(), others),
          a.printed()};
}

Quantity from_at_least(Index runs, const Quantity& a) {
  return {[=](const Evidence& e) {
            Measured m = a(e);
            if (!m.value || m.runs >= runs) return m;
            return missing(
                fmt::format("{} of {} runs", runs - m.runs, runs) +
                (a.runs().empty() ? "" : " of " + a.runs().front().text()));
          },
          a.runs(),
          a.printed()};
}

std::optional<PublishedValue> find_printed(const Published& published,
                                           const std::string& experiment,
                                           const std::string& name) {
  const auto space = name.find(' ');
  return space == std::string::npos
             ? published.find(experiment, name)
             : published.find(name.substr(0, space), name.substr(space + 1));
}

Quantity printed(std::string quantity) {
  std::vector<std::string> names = {quantity};
  return {[=](const Evidence& e) {
            const auto found =
                find_printed(e.published, e.experiment, quantity);
            if (!found) return missing("printed " + quantity);
            return Measured{.value = found->value, .spread = found->spread};
          },
          {},
          std::move(names)};
}

}  // namespace physinv
