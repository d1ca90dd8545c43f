#include "suite/cases/jpo/gradient_alignment/claims.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "suite/cases/jpo/common/claims.h"

namespace physinv::alignment {
namespace {

/// Sampling alone explains no more than this.
double band(double p, Index repetitions) {
  return 4 * std::sqrt(p * (1 - p) / static_cast<double>(repetitions)) + 0.004;
}

/// The largest of value(n, share) over n in [first, last]; nothing if no such
/// n was measured often enough to judge.
template <class F>
std::optional<double> largest(const std::optional<Measured>& m,
                              F&& value,
                              Index first = 1,
                              Index last = 1 << 30) {
  std::optional<double> out;
  if (!m || m->repetitions < kJudged) return out;
  for (std::size_t i = 0; i < m->count(); ++i) {
    if (m->n[i] < first || m->n[i] > last) continue;
    const double v = value(m->n[i], m->share[i]);
    out = std::max(out.value_or(v), v);
  }
  return out;
}

/// |measured - theory| in units of what sampling explains.
template <class F>
std::optional<double> off_by(const std::optional<Measured>& m, F&& theory) {
  return largest(m, [&](Index n, double share) {
    const double p = theory(n);
    return std::abs(share - p) / band(p, m->repetitions);
  });
}

template <class F>
std::optional<double> distance(const std::optional<Measured>& m,
                               F&& theory,
                               Index first = 1) {
  return largest(
      m,
      [&](Index n, double share) { return std::abs(share - theory(n)); },
      first);
}

/// Of log(share - 1/2) over log n, least squares for n = 4 .. 64.
template <class F>
std::optional<double> slope(const Measured& m, F&& share) {
  double count = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (std::size_t i = 0; i < m.count(); ++i) {
    if (m.n[i] < 4 || m.n[i] > 64) continue;
    const double u = std::log(static_cast<double>(m.n[i]));
    const double v = std::log(share(i) - 0.5);
    count += 1, x += u, y += v, xx += u * u, xy += u * v;
  }
  if (count < 2) return {};
  return (count * xy - x * y) / (count * xx - x * x);
}

ClaimResult noise_scaling(const Fig2& f) {
  Judge judge;
  judge
      .at_most(
          "sum: |measured - theory| / band", off_by(f.known_sum, sum_weak), 1)
      .at_most("vote: |measured - theory| / band",
               off_by(f.known_vote, vote_weak),
               1)
      .at_most("largest vote - sum, N >= 16",
               largest(
                   f.known_vote,
                   [&](Index n, double v) { return v - *f.known_sum->at(n); },
                   16),
               0.03);
  if (f.known_sum && f.known_sum->repetitions >= kFull) {
    const Measured& m = *f.known_sum;
    const auto ours = slope(m, [&](std::size_t i) { return m.share[i]; });
    const auto law = slope(m, [&](std::size_t i) { return sum_weak(m.n[i]); });
    judge.report("slope of the sum", ours);
    if (ours && law)
      judge.at_most("its distance from theory", std::abs(*ours - *law), 0.15);
  }
  return std::move(judge).result(
      "R2",
      "With a common solution, the sum of the gradients and the majority of "
      "their signs are right as often as P_sum and P_vote say: sqrt(N)",
      "quick");
}

ClaimResult vote_resists(const Fig2& f) {
  Judge judge;
  judge
      .at_most("vote: |measured - theory| / band",
               off_by(f.unequal_vote, vote_weak),
               1)
      .at_most(
          "largest sum - vote, N >= 64",
          largest(
              f.unequal_sum,
              [&](Index n, double s) { return s - *f.unequal_vote->at(n); },
              64),
          -0.05);
  return std::move(judge).result(
      "R3",
      "Where noise levels differ but not their ratio to the signal, the "
      "majority keeps P_vote and the sum falls at least 0.05 below it",
      "quick");
}

ClaimResult response_model(const Fig2& f) {
  const auto& m = f.linear;
  const auto rise = largest(
      m,
      [&](Index n, double share) {
        const auto before = m->at(n / 2);
        return before ? share - *before : -1.0;
      },
      2,
      32);
  Judge judge;
  judge
      .at_least(
          "rho(1)", m && m->repetitions >= kJudged ? m->at(1) : std::nullopt, 1)
      .at_most("largest |measured - rho(6.4, 12.9)|",
               distance(m, [&](Index n) { return Fig2::rho(n, f.paper); }),
               0.07)
      .at_most("largest rise up to N = 32", rise, 0.015)
      .at_most(
          "outside [0.5, 1]",
          largest(m, [](Index, double s) { return std::max(0.5 - s, s - 1); }),
          0);
  return std::move(judge).result(
      "R4",
      "A network's noise-free updates follow the response model of the paper's "
      "C = 6.4, A = 12.9",
      "quick");
}

ClaimResult response_fit(const Fig2& f) {
  Judge judge;
  if (!f.free || f.free->repetitions < kJudged) {
    judge.missing("noise-free updates");
  } else {
    const Response& r = f.sine_fit->response;
    judge.at_most("rms", f.sine_fit->rms, 0.02)
        .at_least("C", r.complexity, 2.5)
        .at_most("C", r.complexity, 5.5)
        .at_least("A", r.plasticity, 2.5)
        .at_most("A", r.plasticity, 5.5);
  }
  const auto high = largest(
      f.free, [](Index, double s) { return s; }, 64);
  const auto low = largest(
      f.free, [](Index, double s) { return -s; }, 64);
  judge.at_least("lowest, N >= 64", low ? std::optional(-*low) : low, 0.64)
      .at_most("highest, N >= 64", high, 0.72);
  return std::move(judge).result(
      "R5",
      "Noise-free updates for sin(2x) follow the response model, rms at most "
      "0.02, and end on a plateau at 0.64 to 0.72",
      "quick");
}

void judge_noisy(Judge& judge,
                 const Fig2& f,
                 const char* label,
                 const std::optional<Measured>& m,
                 double (*noise_only)(Index)) {
  const auto model = [&](Index n) { return f.combined(n, noise_only(n)); };
  const auto say = [&](const char* words) {
    return fmt::format("{}: {}", label, words);
  };
  std::optional<double> fall;
  if (m && m->repetitions >= kJudged && m->at(1) && m->at(64))
    fall = *m->at(1) - *m->at(64);
  judge.at_most(say("largest |measured - p_N|"), distance(m, model), 0.07)
      .at_most(say("the same, N >= 32"), distance(m, model, 32), 0.03)
      .at_least(say("fall from N = 1 to 64"), fall, 0.2)
      .at_most(say("largest distance from noise-free, N >= 64"),
               distance(
                   m, [&](Index n) { return *f.free->at(n); }, 64),
               0.03)
      .at_most(say("largest measured - noise-only theory, N >= 64"),
               largest(
                   m, [&](Index n, double s) { return s - noise_only(n); }, 64),
               -0.25);
}

ClaimResult noisy_updates(const Fig2& f) {
  Judge judge;
  judge_noisy(judge, f, "sum", f.sum, sum_even);
  judge_noisy(judge, f, "vote", f.vote, vote_even);
  return std::move(judge).result(
      "R6",
      "Updates along noisy gradients follow the combined model: more examples "
      "mean fewer aligned updates, down to the noise-free plateau",
      "quick");
}

}  // namespace

std::vector<ClaimResult> claims(const Fig2& f) {
  return {noise_scaling(f),
          vote_resists(f),
          response_model(f),
          response_fit(f),
          noisy_updates(f)};
}

}  // namespace physinv::alignment
