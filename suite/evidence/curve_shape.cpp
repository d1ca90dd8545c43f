#include "suite/evidence/curve_shape.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "suite/core/math.h"
#include "suite/evidence/failures.h"
#include "suite/evidence/statistics.h"

namespace physinv {

RunValue steepness(int before) {
  return [=](const Run& run) -> std::optional<double> {
    const double end =
        run.stage->curve.iteration.back() / math::exp2(double(before));
    const auto loss = loss_at(*run.stage, end),
               half = loss_at(*run.stage, end / 2);
    if (!loss || !half) return {};
    return math::log2(*half / *loss);
  };
}

RunValue log_fall(const Clock& clock, double from, double to) {
  return [=](const Run& run) -> std::optional<double> {
    const auto a = loss_at(clock, from)(run), b = loss_at(clock, to)(run);
    if (!a || !b) return {};
    return math::log(*a / *b);
  };
}

RunValue plateau(const Clock& clock, double lowest, double highest) {
  return [=](const Run& run) -> std::optional<double> {
    const CurveRow loss{*run.stage};
    double longest = 0, since = -1;
    for (Index k = 0; k < loss.points(); ++k) {
      const auto now = clock.time(run, loss_point(*run.stage, k));
      if (!now) return {};
      const bool inside = loss(k) >= lowest && loss(k) <= highest;
      if (!inside) since = -1;
      if (inside && since < 0) since = *now;
      if (inside) longest = std::max(longest, *now - since);
    }
    return longest;
  };
}

RunValue scatter() {
  return [](const Run& run) -> std::optional<double> {
    if (run.stage->stop == Stop::diverged) return kInfinite;
    const CurveRow loss{*run.stage};
    double sum = 0;
    const Index last = loss.points() - 1, first = last / 2;
    if (last < 2) return {};
    for (Index k = first; k < last; ++k)
      sum += std::abs(math::log(loss(k + 1) / loss(k)));
    return sum / static_cast<double>(last - first);
  };
}

RunValue settled_loss() {
  return [](const Run& run) -> std::optional<double> {
    const CurveRow loss{*run.stage};
    const Index last = loss.points() - 1;
    if (last < 2) return {};
    return median({loss(last), loss(last - 1), loss(last - 2)});
  };
}

Quantity lead(const Select& select, const std::vector<Select>& others) {
  const auto share = [=](const Run& run) -> std::optional<double> {
    const double end = run.stage->curve.iteration.back();
    double ahead = 0;
    for (double u = 1; u <= end; ++u) {
      bool below = true;
      for (const Select& other : others) {
        const auto theirs = beside(other, loss_after(u))(run);
        if (!theirs) return {};
        below = below && *loss_at(*run.stage, u) < *theirs;
      }
      ahead += below;
    }
    return ahead / end;
  };
  return depends_on(median(select, share), others);
}

Quantity spread_of_seeds(const std::vector<Select>& of, const RunValue& value) {
  const RunValue spread = [=](const Run& run) -> std::optional<double> {
    double lowest = kInfinite, highest = 0;
    for (const Select& other : of) {
      const auto one = beside(other, value)(run);
      if (!one) return {};
      lowest = std::min(lowest, *one), highest = std::max(highest, *one);
    }
    return highest / lowest;
  };
  return depends_on(median(of.front(), spread), of);
}

Quantity highest_along(const Select& curve,
                       double first,
                       std::function<Quantity(double updates)> of) {
  return {[=](const Evidence& e) {
            const auto runs = find_runs(e, curve);
            if (runs.empty()) return missing(curve.text() + " not run");
            Measured highest;
            for (const double at : runs.front().stage->curve.iteration) {
              if (at < first) continue;
              const Measured m = of(at)(e);
              if (!m.value) return m;
              if (!highest.value || *m.value > *highest.value) highest = m;
            }
            return highest.value ? highest : missing("runs long enough");
          },
          of(first).runs()};
}

namespace {

/// Of the ascending values the one at this place.
Quantity ordered_value(const Select& select,
                       const RunValue& value,
                       std::size_t (*place)(std::size_t count)) {
  return {[=](const Evidence& e) {
            auto values = values_of(sample(e, select, value));
            if (values.empty()) return missing(why_no_value(e, select));
            for (const double v : values)
              if (std::isnan(v)) return missing("no finite value");
            std::sort(values.begin(), values.end());
            return Measured{.value = values[place(values.size())],
                            .runs = static_cast<Index>(values.size())};
          },
          {select}};
}

std::size_t most_of(std::size_t count) {
  return std::max<std::size_t>(1, 4 * count / 5);
}

}  // namespace

Quantity most_stay_above(const Select& select, const RunValue& value) {
  return ordered_value(
      select, value, [](std::size_t count) { return count - most_of(count); });
}
Quantity most_stay_below(const Select& select, const RunValue& value) {
  return ordered_value(
      select, value, [](std::size_t count) { return most_of(count) - 1; });
}

}  // namespace physinv
