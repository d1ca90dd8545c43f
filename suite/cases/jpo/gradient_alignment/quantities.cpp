#include "suite/cases/jpo/gradient_alignment/quantities.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "suite/core/math.h"
#include "suite/store/record.h"

namespace physinv::alignment {
namespace {

using Number = std::optional<double>;

/// f(i) of all N in [first, last].
template <class F>
void for_sizes(const Aligned& m, Index first, Index last, F f) {
  for (std::size_t i = 0; i < m.count(); ++i)
    if (m.n[i] >= first && m.n[i] <= last) f(i);
}

/// The largest of value(Fig. 2, N, share) over N in [first, last].
template <class F>
Quantity largest(const Shares& shares,
                 F value,
                 Index first = 1,
                 Index last = kEvery,
                 Index repetitions = kJudged) {
  return fig2(
      shares.method,
      [=](const Fig2& f) {
        const Aligned& m = shares.of(f);
        Number out;
        for_sizes(m, first, last, [&](std::size_t i) {
          const double v = value(f, m.n[i], m.share[i]);
          out = std::max(out.value_or(v), v);
        });
        return out;
      },
      repetitions);
}

/// (a - b) at the largest N over its standard error.
double errors_apart(const Aligned& a, const Aligned& b) {
  return (a.share.back() - b.share.back()) /
         math::hypot(a.error.back(), b.error.back());
}

/// Of log(share - 1/2) over log N, share(i) of the N that were measured.
template <class F>
std::optional<Line> excess_line(const Aligned& m,
                                Index first,
                                Index last,
                                F share) {
  std::vector<double> x, y;
  for_sizes(m, first, last, [&](std::size_t i) {
    x.push_back(math::log(static_cast<double>(m.n[i])));
    y.push_back(math::log(share(i) - 0.5));
  });
  return fit_line(x, y);
}
std::optional<Line> excess(const Aligned& m, Index first, Index last) {
  return excess_line(m, first, last, [&](std::size_t i) { return m.share[i]; });
}
std::optional<Line> excess(const Fig2& f,
                           const Aligned& m,
                           Index first,
                           Index last,
                           const Theory& theory) {
  return excess_line(
      m, first, last, [&](std::size_t i) { return theory(f, m.n[i]); });
}

}  // namespace

Theory measured(const Shares& shares) {
  return [=](const Fig2& f, Index n) { return *shares.of(f).at(n); };
}

Quantity fig2(const char* method,
              std::function<Number(const Fig2&)> number,
              Index repetitions) {
  const Select runs{method, "measure"};
  return {
      [=](const Evidence& e) {
        const Fig2 f(e);
        Index fewest = repetitions;
        for (const auto* m : {&f.known_sum, &f.unequal_sum, &f.linear, &f.free})
          if (*m) fewest = std::min(fewest, (*m)->repetitions);
        const Number found = f.has(method) ? number(f) : std::nullopt;
        if (!found) return missing(runs.text() + " not run");
        if (fewest < repetitions)
          return missing(fmt::format("{} repetitions", repetitions));
        return Measured{.value = found, .runs = fewest};
      },
      {runs}};
}

// ---- over N -----------------------------------------------------------------

Quantity largest_excess(const Shares& shares,
                        const Theory& theory,
                        Index first) {
  return largest(
      shares,
      [=](const Fig2& f, Index n, double share) {
        return share - theory(f, n);
      },
      first);
}

Quantity largest_distance(const Shares& shares,
                          const Theory& theory,
                          Index first,
                          Index last) {
  return largest(
      shares,
      [=](const Fig2& f, Index n, double share) {
        return std::abs(share - theory(f, n));
      },
      first,
      last);
}

Quantity off_by(const Shares& shares,
                const Theory& theory,
                Index repetitions,
                Index first,
                double more) {
  return largest(
      shares,
      [=](const Fig2& f, Index n, double share) {
        const double p = theory(f, n);
        const auto times = static_cast<double>(shares.of(f).repetitions);
        return std::abs(share - p) /
               (4 * std::sqrt(p * (1 - p) / times) + more);
      },
      first,
      kEvery,
      repetitions);
}

Quantity largest_rise_of_doubling(const Shares& shares, Index last) {
  return largest(
      shares,
      [=](const Fig2& f, Index n, double share) {
        const auto before = shares.of(f).at(n / 2);
        return before ? share - *before : -1.0;
      },
      2,
      last);
}

Quantity largest_outside(const Shares& shares, double lowest, double highest) {
  return largest(shares, [=](const Fig2&, Index, double share) {
    return std::max(lowest - share, share - highest);
  });
}

Quantity highest_share(const Shares& shares, Index first) {
  return largest(
      shares, [](const Fig2&, Index, double share) { return share; }, first);
}
Quantity lowest_share(const Shares& shares, Index first) {
  return times(-1,
               largest(
                   shares,
                   [](const Fig2&, Index, double share) { return -share; },
                   first));
}

Quantity mean_excess(const Shares& a, const Shares& b, Index repetitions) {
  return fig2(
      a.method,
      [=](const Fig2& f) {
        const Aligned &ours = a.of(f), &theirs = b.of(f);
        double sum = 0;
        for (std::size_t i = 0; i < ours.count(); ++i)
          sum += ours.share[i] - theirs.share[i];
        return Number(sum / static_cast<double>(ours.count()));
      },
      repetitions);
}

// ---- at one N ---------------------------------------------------------------

Quantity share_at(const Shares& shares, Index n) {
  return fig2(shares.method, [=](const Fig2& f) { return shares.of(f).at(n); });
}
Quantity fall(const Shares& shares, Index from, Index to) {
  return fig2(shares.method, [=](const Fig2& f) -> Number {
    const auto before = shares.of(f).at(from), after = shares.of(f).at(to);
    if (!before || !after) return {};
    return *before - *after;
  });
}
Quantity last_share(const Shares& shares) {
  return fig2(shares.method,
              [=](const Fig2& f) { return Number(shares.of(f).share.back()); });
}

Quantity end_distance(const Shares& a, const Shares& b) {
  return fig2(a.method, [=](const Fig2& f) {
    return Number(std::abs(a.of(f).share.back() - b.of(f).share.back()));
  });
}
Quantity end_in_errors(const Shares& a, const Shares& b, Index repetitions) {
  return fig2(
      a.method,
      [=](const Fig2& f) { return Number(errors_apart(a.of(f), b.of(f))); },
      repetitions);
}
Quantity end_distance_in_errors(const Shares& a, const Shares& b) {
  return fig2(a.method, [=](const Fig2& f) {
    return Number(std::abs(errors_apart(a.of(f), b.of(f))));
  });
}

// ---- slopes -----------------------------------------------------------------

Quantity slope(const Shares& shares, Index first, Index last) {
  return fig2(shares.method, [=](const Fig2& f) {
    const auto line = excess(shares.of(f), first, last);
    return line ? Number(line->slope) : std::nullopt;
  });
}

Quantity slope_off(const Shares& shares,
                   const Theory& theory,
                   Index first,
                   Index last,
                   Index repetitions) {
  return fig2(
      shares.method,
      [=](const Fig2& f) -> Number {
        const Aligned& m = shares.of(f);
        const auto ours = excess(m, first, last),
                   law = excess(f, m, first, last, theory);
        if (!ours || !law) return {};
        return std::abs(ours->slope - law->slope);
      },
      repetitions);
}

namespace {

template <class F>
Quantity slope_off_by(const Shares& shares, Index last, F other) {
  return fig2(
      shares.method,
      [=](const Fig2& f) -> Number {
        const auto line = excess(shares.of(f), 1, last);
        const std::optional<Line> to = other(f);
        if (!line || !to) return {};
        return std::abs(line->slope - to->slope) /
               (2 * math::hypot(line->slope_error, to->slope_error));
      },
      kFull);
}

}  // namespace

Quantity slope_in_errors(const Shares& shares, double other, Index last) {
  return slope_off_by(
      shares, last, [=](const Fig2&) { return Line{.slope = other}; });
}
Quantity slope_in_errors(const Shares& shares, const Theory& law, Index last) {
  return slope_off_by(shares, last, [=](const Fig2& f) {
    auto line = excess(f, shares.of(f), 1, last, law);
    if (line) line->slope_error = 0;
    return line;
  });
}
Quantity slope_in_errors(const Shares& shares,
                         const Shares& other,
                         Index last) {
  return slope_off_by(shares, last, [=](const Fig2& f) {
    return excess(other.of(f), 1, last);
  });
}

// ---- single repetitions -----------------------------------------------------

RunValue apart_from_vote(ArrayKey way) {
  return [=](const Run& run) -> Number {
    const auto& arrays = run.stage->arrays;
    const auto ours = arrays.find(way), vote = arrays.find("vote");
    if (ours == arrays.end() || vote == arrays.end()) return {};
    return static_cast<double>(
        (ours->second.array() != vote->second.array()).count());
  };
}

}  // namespace physinv::alignment
