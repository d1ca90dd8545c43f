#include "suite/cases/jpo/kuramoto_sivashinsky/figures.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "suite/cases/jpo/kuramoto_sivashinsky/claims.h"

namespace physinv::ks {
namespace {

/// Lowest and highest mean number of iterations of any n.
std::optional<std::pair<double, double>> iterations_over_n(
    const JpoMetrics& metrics, const char* method, bool refined) {
  std::optional<std::pair<double, double>> range;
  for (const Index n : metrics.sizes()) {
    std::vector<double> means;
    for (const std::uint64_t seed : metrics.seeds())
      if (const auto* end = metrics.ending(method, n, seed, refined))
        means.push_back(end->example_iterations.mean());
    const auto mean = mean_std(means);
    if (!mean) continue;
    if (!range) range = {mean->mean, mean->mean};
    range->first = std::min(range->first, mean->mean);
    range->second = std::max(range->second, mean->mean);
  }
  return range;
}

/// The first problem of seed 0.
Samples<double> example(const KuramotoSivashinsky<double>& physics) {
  return physics.sample(0, 1, Rng::root(kName, 0).child("data/test"));
}

}  // namespace

Figure trajectory(const KuramotoSivashinskyOptions& options) {
  const KuramotoSivashinsky<double> physics(options);
  const Samples<double> s = example(physics);
  const Batch<double> u = physics.trajectory(s.x.col(0), s.given.col(0));
  Field2D field{.label = "u"};
  for (Index k = 0; k < u.cols(); ++k)
    field.x.push_back(static_cast<double>(k) * options.time_step);
  for (Index j = 0; j < u.rows(); ++j) {
    field.y.push_back((static_cast<double>(j) + 0.5) * options.box /
                      static_cast<double>(options.cells));
    for (Index k = 0; k < u.cols(); ++k) field.values.push_back(u(j, k));
  }
  return {
      .id = "fig5a",
      .title = "A trajectory u(x, t)",
      .source = "Fig. 5a",
      .panels = {{.x_label = "t", .y_label = "x", .field = std::move(field)}},
      .columns = 1,
      .note = fmt::format("Problem 0 of seed 0: alpha = {:.3f}, beta = "
                          "{:.3f}.",
                          s.x(0, 0),
                          s.x(1, 0))};
}

Figure landscape(const KuramotoSivashinskyOptions& options) {
  constexpr Index kPoints = 401;
  const KuramotoSivashinsky<double> physics(options);
  const Samples<double> s = example(physics);
  Batch<double> x(2, kPoints), y(s.y.rows(), kPoints);
  x.row(0).setConstant(s.x(0, 0));
  x.row(1).setLinSpaced(0.5, 1.5);
  Vector<double> loss(kPoints);
  Workspace work;
  physics.forward(x, s.given.replicate(1, kPoints).eval(), y, work);
  physics.loss(y, s.y.replicate(1, kPoints).eval(), loss);
  return {
      .id = "fig5b",
      .title = "Loss over beta at the true alpha",
      .source = "Fig. 5b",
      .panels = {{.x_label = "beta",
                  .y_label = "loss",
                  .series = {{.method = "bfgs",
                              .x = {x.row(1).begin(), x.row(1).end()},
                              .y = {loss.begin(), loss.end()}},
                             {.label = "solution",
                              .method = "truth",
                              .x = {s.x(1, 0)},
                              .y = {0},
                              .line = false,
                              .markers = true}}}},
      .columns = 1,
      .note = fmt::format("Problem 0 of seed 0, alpha = {:.3f}.", s.x(0, 0))};
}

Table in_words(const JpoMetrics& metrics, const Published& published) {
  Table table{.id = "text",
              .title = "Numbers of the text",
              .source = "Sec. 4, App. D.3",
              .digits = 1,
              .columns = {"value"},
              .note =
                  "Solved: both unknowns within 1e-3. Iterations: lowest and "
                  "highest mean of any n. Better: than BFGS."};
  const auto add =
      [&](const char* label, const char* quantity, std::optional<double> ours) {
        Cell cell{.ours = ours};
        if (const auto found = published.find(kName, quantity))
          cell.paper = found->value;
        if (!ours) cell.text = "not run";
        table.rows.push_back({label, {cell}});
      };
  const auto percent = [](std::optional<double> share) {
    return share ? std::optional(100 * *share) : std::nullopt;
  };
  const auto solved_by = [&](const char* method, bool refined) {
    return percent(metrics.pooled_solved_share(
        method, sizes_between(metrics, kMany), refined, solved()));
  };
  const auto better_at =
      [&](const char* method, bool refined, Index first, Index last = kEvery) {
        return percent(better(metrics, method, refined, first, last));
      };
  add("BFGS solves, n >= 32, %", "text/bfgs/solved", solved_by("bfgs", false));
  add("JPO refined solves, n >= 32, %",
      "text/jpo/solved",
      solved_by("jpo", true));
  const auto bfgs = iterations_over_n(metrics, "bfgs", false);
  const auto refine = iterations_over_n(metrics, "jpo", true);
  using Range = std::optional<std::pair<double, double>>;
  const auto low = [](const Range& r) {
    return r ? std::optional(r->first) : std::nullopt;
  };
  const auto high = [](const Range& r) {
    return r ? std::optional(r->second) : std::nullopt;
  };
  add("BFGS iterations, lowest", "text/bfgs/iterations_low", low(bfgs));
  add("BFGS iterations, highest", "text/bfgs/iterations_high", high(bfgs));
  add("refinement iterations, lowest", "text/jpo/iterations_low", low(refine));
  add("refinement iterations, highest",
      "text/jpo/iterations_high",
      high(refine));
  add("JPO refined better, n = 256, %",
      "text/jpo/better/n=256",
      better_at("jpo", true, 256, 256));
  add("supervised refined better, %",
      "text/supervised/refined",
      better_at("supervised", true, 0));
  add("supervised refined better, n = 2, %",
      "text/supervised/refined/n=2",
      better_at("supervised", true, 2, 2));
  add("supervised refined better, n >= 64, %",
      "text/supervised/refined/n>=64",
      better_at("supervised", true, 64));
  add("supervised better, n = 2, %",
      "text/supervised/better/n=2",
      better_at("supervised", false, 2, 2));
  add("supervised better, n >= 64, %",
      "text/supervised/better/n>=64",
      better_at("supervised", false, 64));
  return table;
}

}  // namespace physinv::ks
