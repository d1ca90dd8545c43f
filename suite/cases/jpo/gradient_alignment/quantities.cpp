#include "suite/cases/jpo/gradient_alignment/quantities.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "suite/core/math.h"
#include "suite/evidence/statistics.h"
#include "suite/store/record.h"

namespace physinv::alignment {
namespace {

using Number = std::optional<double>;

double sampling_error(double p, Index repetitions) {
  return std::sqrt(p * (1 - p) / static_cast<double>(repetitions));
}

/// f(i) of all N in [first, last].
template <class F>
void for_sizes(const Aligned& m, Index first, Index last, F f) {
  for (std::size_t i = 0; i < m.count(); ++i)
    if (m.n[i] >= first && m.n[i] <= last) f(i);
}

template <class F>
Number largest_of(const Aligned& m, F value, Index first, Index last = kEvery) {
  Number out;
  for_sizes(m, first, last, [&](std::size_t i) {
    const double v = value(m.n[i], m.share[i]);
    out = std::max(out.value_or(v), v);
  });
  return out;
}

/// (a - b) at the largest N over its standard error.
double errors_apart_of(const Aligned& a, const Aligned& b) {
  return (a.share.back() - b.share.back()) /
         math::hypot(a.error.back(), b.error.back());
}

}  // namespace

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

Quantity largest(const char* method,
                 AlignedOf shares,
                 OfShare value,
                 Index first,
                 Index last) {
  return fig2(method, [=](const Fig2& f) {
    return largest_of(
        *(f.*shares),
        [&](Index n, double share) { return value(f, n, share); },
        first,
        last);
  });
}

Quantity distance(const char* method,
                  AlignedOf shares,
                  TheoryOfFig2 theory,
                  Index first,
                  Index last) {
  return largest(
      method,
      shares,
      [theory = std::move(theory)](const Fig2& f, Index n, double share) {
        return std::abs(share - theory(f, n));
      },
      first,
      last);
}

Quantity off_by(const char* method,
                AlignedOf shares,
                Theory theory,
                Index repetitions,
                Index first,
                double more) {
  return fig2(
      method,
      [=](const Fig2& f) {
        const Aligned& m = *(f.*shares);
        return largest_of(
            m,
            [&](Index n, double share) {
              const double p = theory(n);
              return std::abs(share - p) /
                     (4 * sampling_error(p, m.repetitions) + more);
            },
            first);
      },
      repetitions);
}

Quantity at_largest(const char* method, AlignedOf shares) {
  return fig2(method,
              [=](const Fig2& f) { return Number((f.*shares)->share.back()); });
}

Quantity errors_apart(const char* method,
                      AlignedOf a,
                      AlignedOf b,
                      Index repetitions) {
  return fig2(
      method,
      [=](const Fig2& f) { return Number(errors_apart_of(*(f.*a), *(f.*b))); },
      repetitions);
}

std::optional<Line> excess(const Aligned& m,
                           Index first,
                           Index last,
                           Theory theory) {
  std::vector<double> x, y;
  for_sizes(m, first, last, [&](std::size_t i) {
    x.push_back(math::log(static_cast<double>(m.n[i])));
    y.push_back(math::log((theory ? theory(m.n[i]) : m.share[i]) - 0.5));
  });
  return fit_line(x, y);
}

Quantity slope(const char* method, AlignedOf shares, Index first, Index last) {
  return fig2(method, [=](const Fig2& f) {
    const auto line = excess(*(f.*shares), first, last);
    return line ? Number(line->slope) : std::nullopt;
  });
}

Quantity apart_from_vote(const char* method, ArrayKey array) {
  const RunValue differ = [=](const Run& run) -> Number {
    const auto& arrays = run.stage->arrays;
    const auto ours = arrays.find(array), vote = arrays.find("vote");
    if (ours == arrays.end() || vote == arrays.end()) return {};
    return static_cast<double>(
        (ours->second.array() != vote->second.array()).count());
  };
  return highest({method, "measure"}, differ);
}

namespace {

Quantity gap(const Noisy& noisy, Index first, Index last = kEvery) {
  return distance(
      "sine",
      noisy.measured,
      [noisy](const Fig2& f, Index n) {
        return f.combined(n, noisy.noise_only(n));
      },
      first,
      last);
}

std::string say(const Noisy& noisy, const char* words) {
  return fmt::format("{}: {}", noisy.label, words);
}

}  // namespace

std::vector<Condition> follows_the_model(const Noisy& noisy) {
  const auto fall = fig2("sine", [noisy](const Fig2& f) -> Number {
    const Aligned& m = *(f.*noisy.measured);
    if (!m.at(1) || !m.at(64)) return {};
    return *m.at(1) - *m.at(64);
  });
  const auto from_noise_free = distance(
      "sine",
      noisy.measured,
      [](const Fig2& f, Index n) { return *f.free->at(n); },
      64);
  const auto over_noise_only = largest(
      "sine",
      noisy.measured,
      [noisy](const Fig2&, Index n, double share) {
        return share - noisy.noise_only(n);
      },
      64);
  return {at_most(say(noisy, "largest |measured - p_N|"), gap(noisy, 1), 0.07),
          at_most(say(noisy, "the same, N >= 32"), gap(noisy, 32), 0.03),
          at_least(say(noisy, "fall from N = 1 to 64"), fall, 0.2),
          at_most(say(noisy, "largest distance from noise-free, N >= 64"),
                  from_noise_free,
                  0.03),
          at_most(say(noisy, "largest measured - noise-only theory, N >= 64"),
                  over_noise_only,
                  -0.25)};
}

std::vector<Condition> fits_well(const Noisy& noisy) {
  const auto fall = fig2("sine", [noisy](const Fig2& f) {
    const Aligned& m = *(f.*noisy.measured);
    return Number(m.share.front() - m.share.back());
  });
  return {
      at_most(say(noisy, "largest |measured - p_N|"), gap(noisy, 1), 0.1),
      below(say(noisy, "the same, N >= 32"), gap(noisy, 32), gap(noisy, 1, 31)),
      above(say(noisy, "fall from N = 1 to the largest"), fall, 0)};
}

std::vector<Condition> keeps_the_limit(const Noisy& noisy) {
  const auto apart = fig2("sine", [noisy](const Fig2& f) {
    return Number(
        std::abs((f.*noisy.measured)->share.back() - f.free->share.back()));
  });
  const auto errors = fig2("sine", [noisy](const Fig2& f) {
    return Number(std::abs(errors_apart_of(*(f.*noisy.measured), *f.free)));
  });
  return {either(
      at_most(
          say(noisy, "distance from noise-free at the largest N"), apart, 0.03),
      at_most("the same in standard errors", errors, 2))};
}

std::vector<Condition> both(std::vector<Condition> (*of)(const Noisy&)) {
  return joined({of({"sum", &Fig2::sum, sum_even}),
                 of({"vote", &Fig2::vote, vote_even})});
}

}  // namespace physinv::alignment
