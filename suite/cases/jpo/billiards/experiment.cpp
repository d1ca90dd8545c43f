// JPO paper, Sec. 4 "Billiards", Fig. 4, App. D.2: joint optimization against
// BFGS where a fifth of all problems start on a plateau.
#include <algorithm>
#include <array>
#include <string>

#include "problems/billiards/billiards.h"
#include "suite/cases/jpo/common/claims.h"
#include "suite/cases/jpo/common/methods.h"
#include "suite/cases/jpo/common/report.h"
#include "suite/harness/registry.h"
#include "suite/nn/mlp.h"

namespace physinv {
namespace {

constexpr double kSolved = 1e-6;

/// Loss of any miss: the other ball stays where it is.
Vector<double> plateau_loss(const CaseRecord& record) {
  return 0.5 * (record.data.given - record.data.y).colwise().squaredNorm();
}

/// Problems whose start misses (|h - 0.5| >= 0.4): the largest numbers of
/// iterations and evaluations BFGS spends on one of them.
std::pair<double, double> work_on_plateau_starts(const Results& results,
                                                 const JpoMetrics& metrics,
                                                 const std::string& name) {
  double iterations = 0, evaluations = 0;
  for (const Index n : metrics.sizes()) {
    for (const std::uint64_t seed : metrics.seeds()) {
      const StageRecord* bfgs = metrics.stage("bfgs", n, seed, "solve");
      if (bfgs == nullptr) continue;
      const Batch<double>& given =
          results.find_case(name, "bfgs", n, seed)->data.given;
      for (Index i = 0; i < given.cols(); ++i) {
        if (std::abs(given(1, i) - 0.5) < 0.4) continue;
        iterations = std::max(iterations, bfgs->example_iterations(i));
        evaluations = std::max(evaluations, bfgs->example_evaluations(i));
      }
    }
  }
  return {iterations, evaluations};
}

ClaimResult bfgs_on_the_plateau(const Results& results,
                                const JpoMetrics& metrics,
                                const std::string& name) {
  Judge judge;
  const auto sizes = metrics.sizes();
  const auto p = sizes.empty()
                     ? std::nullopt
                     : metrics.plateau(sizes.back(), kSolved, plateau_loss);
  if (!p || p->problems < 256) {
    judge.missing("BFGS on 256 problems of one n");
  } else {
    const auto [iterations, evaluations] =
        work_on_plateau_starts(results, metrics, name);
    judge.at_least("plateau share", p->share(), 0.42)
        .at_most("plateau share", p->share(), 0.62)
        .at_most("unsolved elsewhere", static_cast<double>(p->elsewhere()), 0)
        .at_most("iterations where the start misses", iterations, 0)
        .at_most("evaluations there", evaluations, 1);
  }
  return std::move(judge).result(
      "R2",
      "BFGS from (1, 0) ends on the no-collision plateau for about half of the "
      "problems and solves all others",
      "smoke");
}

ClaimResult jpo_solves(const JpoMetrics& metrics) {
  std::optional<double> close, solved;  // the lowest shares of any n and seed
  const auto lower = [](std::optional<double>& lowest,
                        std::optional<double> share) {
    if (share) lowest = std::min(lowest.value_or(1), *share);
  };
  for (const Index n : sizes_between(metrics, 64)) {
    for (const std::uint64_t seed : metrics.seeds()) {
      lower(close, metrics.solved_share("jpo", n, seed, false, 1e-2));
      lower(solved, metrics.solved_share("jpo", n, seed, true, kSolved));
    }
  }
  Judge judge;
  judge.at_least("lowest share with L < 1e-2", close, 0.95)
      .at_least("lowest share with refined L < 1e-6", solved, 0.97);
  return std::move(judge).result(
      "R3",
      "For n >= 64, JPO brings at least 95 % of the problems below 1e-2 and, "
      "refined, at least 97 % below 1e-6, for every seed",
      "quick");
}

ClaimResult jpo_rescues(const JpoMetrics& metrics) {
  const auto rate = [&](Index first, Index last) -> std::optional<double> {
    const auto found =
        metrics.rescue("jpo", sizes_between(metrics, first, last), kSolved);
    if (!found) return {};
    return found->rate();
  };
  const std::array<Index, 1> largest = {128};
  const auto f = metrics.mean_shares("jpo", largest, true);
  Judge judge;
  judge.at_least("rescue rate n>=64", rate(64, kEvery), 0.97)
      .above("rescue rate n>=64 over n<=8", rate(64, kEvery), rate(0, 8))
      .at_least("f(JPO refined) at n=128", f_of(f), 0.70)
      .at_least("share of decrease at n=128",
                metrics.share_of_decrease("jpo", 128),
                0.95);
  return std::move(judge).result(
      "R4",
      "Refined JPO solves what BFGS left unsolved, more of it for n >= 64 than "
      "for n <= 8, and the network makes nearly all of the decrease",
      "quick");
}

ClaimResult jpo_beats_samples(const JpoMetrics& metrics) {
  const auto sizes = sizes_between(metrics, 16);
  const auto better = [&](const char* method) -> std::optional<double> {
    const auto s = metrics.mean_shares(method, sizes, false);
    if (!s) return {};
    return s->mean.better;
  };
  const auto solved = [&](const char* method) {
    return metrics.pooled_solved_share(method, sizes, true, kSolved);
  };
  Judge judge;
  for (const char* other : {"supervised", "na"}) {
    judge.above(fmt::format("better: jpo over {}", other),
                better("jpo"),
                better(other));
    judge.above(fmt::format("solved, refined: jpo over {}", other),
                solved("jpo"),
                solved(other));
  }
  return std::move(judge).result(
      "R5",
      "For n >= 16, JPO is better than BFGS more often than supervised "
      "learning and the neural adjoint, and refined solves more problems",
      "quick");
}

ClaimResult samples_share_plateaus(const JpoMetrics& metrics) {
  const auto sizes = sizes_between(metrics, 32);
  const auto equal = [&](const char* method,
                         bool refined) -> std::optional<double> {
    const auto s = metrics.mean_shares(method, sizes, refined);
    if (!s) return {};
    return s->mean.equal;
  };
  Judge judge;
  judge.at_most("equal: jpo refined", equal("jpo", true), 0.02);
  for (const char* method : {"supervised", "na"}) {
    for (const bool refined : {false, true}) {
      judge.at_least(
          fmt::format("equal: {}{}", method, refined ? " refined" : ""),
          equal(method, refined),
          0.05);
    }
  }
  return std::move(judge).result(
      "R6",
      "For n >= 32, refined JPO ends on BFGS's plateaus hardly ever, while "
      "supervised learning and the neural adjoint share them",
      "quick");
}

/// Fig. 4a: the loss over the cue ball's velocity, for one position.
Figure landscape() {
  const Billiards<double> billiards;
  const std::array<double, 2> ball = {1.0, 0.3};
  constexpr Index kColumns = 161, kRows = 121;
  Field2D field{
      .x = {}, .y = {}, .values = {}, .log_scale = true, .label = "loss"};
  for (Index i = 0; i < kColumns; ++i)
    field.x.push_back(3.0 * static_cast<double>(i) / (kColumns - 1));
  for (Index j = 0; j < kRows; ++j)
    field.y.push_back(-1.5 + 2.5 * static_cast<double>(j) / (kRows - 1));
  const Index n = kColumns * kRows;
  Batch<double> v(2, n), given(2, n), y(2, n), target(2, n);
  given.colwise() = Eigen::Vector2d(ball[0], ball[1]);
  target.colwise() = Eigen::Vector2d(billiards.options().target[0],
                                     billiards.options().target[1]);
  for (Index i = 0; i < n; ++i) {
    v(0, i) = field.x[static_cast<std::size_t>(i % kColumns)];
    v(1, i) = field.y[static_cast<std::size_t>(i / kColumns)];
  }
  Vector<double> loss(n);
  Workspace work;
  billiards.forward(v, given, y, work);
  billiards.loss(y, target, loss);
  field.values.assign(loss.begin(), loss.end());

  const auto exact = exact_velocity(ball);
  const auto mark =
      [](std::string label, std::string method, double x, double at) {
        return Series{.label = std::move(label),
                      .method = std::move(method),
                      .x = {x},
                      .y = {at},
                      .line = false,
                      .markers = true};
      };
  return {
      .id = "fig4a",
      .title = "Loss over the initial velocity, ball at (1, 0.3)",
      .source = "Fig. 4a",
      .panels = {{.title = "",
                  .x_label = "v1",
                  .y_label = "v2",
                  .series = {mark("start", "bfgs", 1, 0),
                             mark("solution", "solution", exact[0], exact[1])},
                  .field = std::move(field)}},
      .columns = 1,
      .note =
          "The even region is the plateau: the cue ball misses or "
          "stops short, and the gradient is exactly zero."};
}

Section report(const Results& results, const Published& published) {
  const JpoReportOptions options{
      .experiment = "jpo/billiards",
      .title = "Billiards",
      .paper = "jpo",
      .unknowns = {"v1", "v2"},
      .tensors = {"m1", "b1", "m2", "b2", "m3", "b3", "m4", "b4"}};
  Section section = jpo_section(options, results, published);
  section.figures.insert(section.figures.begin(), landscape());
  const JpoMetrics metrics(results, options.experiment);
  section.claims = {bfgs_on_the_plateau(results, metrics, options.experiment),
                    jpo_solves(metrics),
                    jpo_rescues(metrics),
                    jpo_beats_samples(metrics),
                    samples_share_plateaus(metrics)};
  return section;
}

const auto kTrained = trained_methods();

const auto kRegistered = register_experiment({
    .name = "jpo/billiards",
    .title = "Billiards",
    .source = {.paper = "jpo", .where = "Sec. 4, Fig. 4, App. D.2"},
    .problem = problem<Billiards>("billiards"),
    .setting =
        {.predictor = {{Field::given, Field::observations},
                       nn::mlp({.hidden = {128, 128, 128}, .frequencies = 4})},
         .surrogate = {{Field::unknowns, Field::given},
                       nn::mlp({.hidden = {128, 128, 128}, .frequencies = 4})},
         .output_scale = 1.0,
         .gtol = 1e-5},
    .profiles =
        {{.name = "smoke",
          .rows =
              {{.methods = {"bfgs"}, .n = {4}, .seeds = {0}},
               {.methods = {"gd"}, .n = {4}, .seeds = {0}, .iterations = 50},
               {.methods = kTrained, .n = {4}, .seeds = {0}, .iterations = 50},
               {.methods = {"bfgs"}, .n = {128}, .seeds = {0, 1, 2, 3}}}},
         {.name = "quick",
          .rows =
              {{.methods = {"bfgs", "gd"}, .n = {8, 32, 128}, .seeds = {0, 1}},
               {.methods = kTrained,
                .n = {8, 32, 128},
                .seeds = {0, 1},
                .iterations = 3000}}},
         {.name = "paper",
          .rows = {{.methods = {"bfgs", "gd"},
                    .n = {2, 4, 8, 16, 32, 64, 128},
                    .seeds = {0, 1, 2, 3}},
                   {.methods = kTrained,
                    .n = {2, 4, 8, 16, 32, 64, 128},
                    .seeds = {0, 1, 2, 3},
                    .iterations = 3000}}}},
    .methods = jpo_methods(),
    .report = report,
});

}  // namespace
}  // namespace physinv
