// JPO paper, Secs. 2-3, Fig. 2: how often do noisy gradients, and the updates
// of a network trained with them, point the right way?
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "optimizers/alignment.h"
#include "problems/noisy_absolute/noise_lanes.h"
#include "suite/cases/alignment_theory.h"
#include "suite/cases/jpo_claims.h"
#include "suite/harness/registry.h"

namespace physinv {
namespace {

constexpr const char* kName = "jpo/gradient-alignment";
constexpr double kWeak = 0.1, kEven = 1;      // signal-to-noise ratios
constexpr Index kJudged = 300, kFull = 1000;  // repetitions a claim needs

constexpr NoisyAbsoluteOptions kSine{};
constexpr NoisyAbsoluteOptions kLinear{
    .solution = Solution::linear, .gamma = 1, .terms = 0};
constexpr NoisyAbsoluteOptions kKnown{
    .solution = Solution::zero, .level = 10, .snr = kWeak};
constexpr NoisyAbsoluteOptions kUnequal{
    .solution = Solution::zero, .level = 10, .decades = 2, .snr = kWeak};

const TinyNetOptions kSineNet{};
const TinyNetOptions kLinearNet{.hidden = {32, 32, 32},
                                .activation = TinyActivation::tanh,
                                .scale = 40,
                                .range = 1};

/// Shares measured for one method and kind of gradient, by n.
struct Measured {
  std::vector<Index> n;
  std::vector<double> share, error;  ///< mean and its standard error
  Index repetitions = 0;             ///< the fewest of any n

  std::optional<double> at(Index size) const {
    const auto found = std::find(n.begin(), n.end(), size);
    if (found == n.end()) return {};
    return share[static_cast<std::size_t>(found - n.begin())];
  }
  std::size_t count() const { return n.size(); }
};

/// Sampling alone explains no more than this.
double band(double p, Index repetitions) {
  return 4 * std::sqrt(p * (1 - p) / static_cast<double>(repetitions)) + 0.004;
}

std::optional<Measured> measured(const Results& results,
                                 std::string_view method,
                                 const std::string& array) {
  Measured out;
  for (const Index n : results.sizes(kName)) {
    std::vector<double> all;  // of all seeds
    for (const auto seed : results.seeds(kName)) {
      const auto* stage = results.find(kName, method, n, seed, "measure");
      if (stage == nullptr) continue;
      const auto found = stage->arrays.find(array);
      if (found == stage->arrays.end()) continue;
      const auto values = found->second.reshaped();
      all.insert(all.end(), values.begin(), values.end());
    }
    const auto mean = mean_std(all);
    if (!mean) continue;
    const auto count = static_cast<Index>(all.size());
    out.n.push_back(n);
    out.share.push_back(mean->mean);
    out.error.push_back(mean->std.value_or(0) /
                        std::sqrt(static_cast<double>(count)));
    out.repetitions =
        out.n.size() == 1 ? count : std::min(out.repetitions, count);
  }
  if (out.n.empty()) return {};
  return out;
}

/// Everything that Fig. 2 shows; what was not measured is empty.
struct Fig2 {
  std::optional<Measured> known_sum, known_vote, unequal_sum, unequal_vote,
      linear, free, sum, vote;
  std::optional<ResponseFit> linear_fit, sine_fit;
  Response paper;  ///< of Fig. 2b

  Fig2(const Results& results, const Response& printed)
      : known_sum(measured(results, "known", "sum")),
        known_vote(measured(results, "known", "vote")),
        unequal_sum(measured(results, "unequal", "sum")),
        unequal_vote(measured(results, "unequal", "vote")),
        linear(measured(results, "linear", "noise_free")),
        free(measured(results, "sine", "noise_free")),
        sum(measured(results, "sine", "sum")),
        vote(measured(results, "sine", "vote")),
        paper(printed) {
    if (linear) linear_fit = fit_response(linear->n, linear->share);
    if (free) sine_fit = fit_response(free->n, free->share);
  }

  static double rho(Index n, const Response& response) {
    return response_curve(n, response).back();
  }
  /// p_N of panels (c) and (d).
  double combined(Index n, double q) const {
    return align_combined(q, rho(n, sine_fit->response));
  }
};

double sum_weak(Index n) { return align_sum(n, kWeak); }
double vote_weak(Index n) { return align_vote(n, kWeak); }
double sum_even(Index n) { return align_sum(n, kEven); }
double vote_even(Index n) { return align_vote(n, kEven); }

// ---- claims ----------------------------------------------------------------

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

// ---- figures ---------------------------------------------------------------

std::vector<double> as_doubles(const std::vector<Index>& n) {
  return {n.begin(), n.end()};
}

/// Mean and two standard errors.
Series points(const char* label,
              const char* method,
              const std::optional<Measured>& m) {
  Series s{.label = label, .method = method, .line = false, .markers = true};
  if (!m) return s;
  s.x = as_doubles(m->n), s.y = m->share;
  for (std::size_t i = 0; i < m->count(); ++i) {
    s.lo.push_back(m->share[i] - 2 * m->error[i]);
    s.hi.push_back(m->share[i] + 2 * m->error[i]);
  }
  return s;
}

template <class F>
Series curve(const char* label,
             const char* method,
             const std::optional<Measured>& m,
             F&& theory) {
  Series s{.label = label, .method = method};
  if (!m) return s;
  s.x = as_doubles(m->n);
  for (const Index n : m->n) s.y.push_back(theory(n));
  return s;
}

Panel panel(const char* title, std::vector<Series> series) {
  return {.title = title,
          .x_label = "N",
          .y_label = "share aligned",
          .x_log = true,
          .series = std::move(series),
          .y_min = 0.45,
          .y_max = 1.02};
}

constexpr const char* kMarks =
    "Marks: mean over repetitions, bars of two standard errors. ";

Figure noise_figure(const Fig2& f) {
  const auto both = [](const char* title, const auto& sum, const auto& vote) {
    return panel(title,
                 {points("sum", "sum", sum),
                  curve("P_sum", "sum", sum, sum_weak),
                  points("vote", "vote", vote),
                  curve("P_vote", "vote", vote, vote_weak)});
  };
  return {.id = "fig2a",
          .title = "Noisy gradients with the same solution",
          .source = "Fig. 2a",
          .panels = {both("equal noise", f.known_sum, f.known_vote),
                     both("noise levels over four decades, equal SNR",
                          f.unequal_sum,
                          f.unequal_vote)},
          .note = fmt::format("{}SNR {}.", kMarks, kWeak)};
}

Figure linear_figure(const Fig2& f) {
  const auto rho = [&](Index n) { return Fig2::rho(n, f.paper); };
  return {.id = "fig2b",
          .title = "Noise-free updates of a network, x* = 10 gamma",
          .source = "Fig. 2b",
          .panels = {panel("",
                           {points("measured", "noise_free", f.linear),
                            curve("rho(6.4, 12.9)", "rho", f.linear, rho)})},
          .columns = 1,
          .note = kMarks};
}

Figure noisy_figure(const Fig2& f,
                    const char* id,
                    const char* source,
                    const char* name,
                    const std::optional<Measured>& m,
                    double (*noise_only)(Index)) {
  Series only = curve("noise only", "noise_only", m, noise_only);
  only.dashed = true;
  const auto combined = [&](Index n) { return f.combined(n, noise_only(n)); };
  const auto response = [&](Index n) {
    return Fig2::rho(n, f.sine_fit->response);
  };
  return {.id = id,
          .title = fmt::format("Updates of a network under noise, {}, x* = "
                               "sin(2 gamma)",
                               name),
          .source = source,
          .panels = {panel(
              "",
              {points(name, name, m),
               curve("model", name, m, combined),
               only,
               points("noise-free", "noise_free", f.free),
               curve("response model", "noise_free", f.free, response)})},
          .columns = 1,
          .note = fmt::format("{}SNR {}.", kMarks, kEven)};
}

// ---- tables ----------------------------------------------------------------

constexpr const char* kNotRun = "not run";

Table shares_table(const Results& results, const Fig2& f) {
  Table table{.id = "alignment",
              .title = "Share of aligned gradients and updates",
              .digits = 3,
              .corner = "N"};
  std::vector<TableRow> rows;
  for (const Index n : results.sizes(kName))
    rows.push_back({.label = fmt::format("{}", n)});
  const auto sizes = results.sizes(kName);
  const auto add =
      [&](const char* name, const std::optional<Measured>& m, auto&& theory) {
        table.columns.emplace_back(name);
        table.columns.push_back(fmt::format("{} theory", name));
        for (std::size_t i = 0; i < rows.size(); ++i) {
          Cell ours{.text = kNotRun}, law{.text = kNotRun};
          if (m && m->at(sizes[i])) {
            const auto at = static_cast<std::size_t>(
                std::find(m->n.begin(), m->n.end(), sizes[i]) - m->n.begin());
            ours = {.ours = m->share[at], .spread = m->error[at]};
            law = {.ours = theory(sizes[i])};
          }
          rows[i].cells.push_back(std::move(ours));
          rows[i].cells.push_back(std::move(law));
        }
      };
  add("known, sum", f.known_sum, sum_weak);
  add("known, vote", f.known_vote, vote_weak);
  add("unequal, sum", f.unequal_sum, sum_weak);
  add("unequal, vote", f.unequal_vote, vote_weak);
  add("linear", f.linear, [&](Index n) { return Fig2::rho(n, f.paper); });
  add("sine, noise-free", f.free, [&](Index n) {
    return Fig2::rho(n, f.sine_fit->response);
  });
  add("sine, sum", f.sum, [&](Index n) { return f.combined(n, sum_even(n)); });
  add("sine, vote", f.vote, [&](Index n) {
    return f.combined(n, vote_even(n));
  });
  table.rows = std::move(rows);
  table.note =
      "Mean over repetitions ± its standard error. Theory of the sum assumes "
      "equal noise, so \"unequal, sum\" must stay below it.";
  return table;
}

Table fits_table(const Fig2& f, const Published& published) {
  Table table{.id = "response",
              .title = "Response model fitted to noise-free updates",
              .source = "Fig. 2b",
              .digits = 3,
              .corner = "network",
              .columns = {"C", "A", "rms"}};
  const auto row = [](const char* label, const auto& fit) {
    TableRow out{.label = label, .cells = std::vector<Cell>(3)};
    for (Cell& cell : out.cells) cell.text = kNotRun;
    if (!fit) return out;
    out.cells = {{.ours = fit->response.complexity},
                 {.ours = fit->response.plasticity},
                 {.ours = fit->rms}};
    return out;
  };
  TableRow linear = row("10 gamma, 1-32-32-32-1 tanh", f.linear_fit);
  const char* quantities[] = {"fig2b/C", "fig2b/A"};
  for (std::size_t i = 0; i < 2; ++i) {
    if (const auto found = published.find(kName, quantities[i]))
      linear.cells[i].paper = found->value;
  }
  table.rows = {std::move(linear),
                row("sin(2 gamma), 1-64-1 ReLU", f.sine_fit)};
  table.note =
      "Least squares over N on a grid of steps 0.25. The paper does not name "
      "its network.";
  return table;
}

/// The normal approximations of the vote beside the exact binomial.
Table vote_table(const std::vector<Index>& sizes) {
  Table table{.id = "vote_theory",
              .title = fmt::format("Majority vote at SNR {}", kWeak),
              .digits = 4,
              .corner = "N",
              .columns = {"P_sum", "exact", "normal", "as printed"}};
  for (const Index n : sizes) {
    table.rows.push_back({.label = fmt::format("{}", n),
                          .cells = {{.ours = sum_weak(n)},
                                    {.ours = vote_weak(n)},
                                    {.ours = align_vote_normal(n, kWeak)},
                                    {.ours = align_vote_printed(n, kWeak)}}});
  }
  table.note =
      "The paper's normal approximation lacks a factor 2 below the root.";
  return table;
}

Section report(const Results& results, const Published& published) {
  const auto printed = [&](const char* quantity, double otherwise) {
    const auto found = published.find(kName, quantity);
    return found ? found->value : otherwise;
  };
  const Fig2 f(results,
               {.complexity = printed("fig2b/C", 6.4),
                .plasticity = printed("fig2b/A", 12.9)});
  return {
      .experiment = kName,
      .title = "Gradient alignment",
      .paper = "jpo",
      .tables = {shares_table(results, f),
                 fits_table(f, published),
                 vote_table(results.sizes(kName))},
      .figures = {noise_figure(f),
                  linear_figure(f),
                  noisy_figure(f, "fig2c", "Fig. 2c", "sum", f.sum, sum_even),
                  noisy_figure(
                      f, "fig2d", "Fig. 2d", "vote", f.vote, vote_even)},
      .claims = {noise_scaling(f),
                 vote_resists(f),
                 response_model(f),
                 response_fit(f),
                 noisy_updates(f)}};
}

// ---- the experiment --------------------------------------------------------

Method measure(std::string id,
               const NoisyAbsoluteOptions& data,
               std::optional<TinyNetOptions> network = {}) {
  return {.id = std::move(id),
          .chain = {std::make_shared<MeasureAlignment<NoiseLanes>>(
              AlignmentOptions<NoiseLanes>{.data = data,
                                           .network = std::move(network),
                                           .repetitions = kFull})}};
}

Profile profile(std::string name, std::vector<Index> n, Index repetitions) {
  return {.name = std::move(name),
          .rows = {{.methods = {"known", "unequal", "linear", "sine"},
                    .n = std::move(n),
                    .seeds = {0},
                    .iterations = repetitions}}};
}

const std::vector<Index> kSizes{1, 2, 4, 8, 16, 32, 64, 128, 256};

Experiment experiment() {
  Experiment e;
  e.name = kName;
  e.title = "Gradient alignment";
  e.source = {.paper = "jpo", .where = "Secs. 2-3, Fig. 2, Apps. A, B"};
  e.problem = problem<NoisyAbsolute>("noisy_absolute", kSine);
  e.profiles = {profile("smoke", {1, 2, 4, 8}, 20),
                profile("quick", kSizes, kJudged),
                profile("paper", kSizes, kFull)};
  e.methods = {measure("known", kKnown),
               measure("unequal", kUnequal),
               measure("linear", kLinear, kLinearNet),
               measure("sine", kSine, kSineNet)};
  e.report = report;
  return e;
}

const auto kRegistered = register_experiment(experiment());

}  // namespace
}  // namespace physinv
