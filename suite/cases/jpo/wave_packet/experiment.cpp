// JPO paper, Sec. 4 "Wave packet localization", Fig. 3, App. D.1: one unknown,
// a loss full of minima, and noise that nobody can explain.
#include <vector>

#include "suite/cases/jpo/common/methods.h"
#include "suite/cases/jpo/common/report.h"
#include "suite/cases/jpo/wave_packet/setting.h"

namespace physinv::jpo::wave_packet {
namespace {

constexpr Index kFitIterations = 3000, kQuickIterations = 1000;

const auto kTrained = trained_methods();

Row trained(std::vector<std::string> methods,
            std::vector<Index> n,
            std::vector<std::uint64_t> seeds,
            Index iterations) {
  return {.methods = std::move(methods),
          .n = std::move(n),
          .seeds = std::move(seeds),
          .iterations = iterations};
}

/// `jpo-long` fits until its estimates have settled.
std::vector<Method> methods() {
  auto all = jpo_methods({.rate = 1e-3, .iterations = kFitIterations});
  all.push_back({"jpo-long",
                 {jpo_fit({.step = AdamOptions{.rate = 1e-3},
                           .iterations = 2 * kFitIterations})}});
  return all;
}

const std::vector<Index> kSizes = {2, 4, 8, 16, 32, 64, 128, 256};
const auto kFirst = first_seeds(5);
/// For claims about BFGS alone.
const Row kPool{.methods = {"bfgs"}, .n = {256}, .seeds = {0, 1}};

}  // namespace

void add_experiments(Registry& r) {
  r.add(Experiment{
      .name = "jpo/wave-packet",
      .title = "Wave packet",
      .citation = {.paper = "jpo", .where = "Sec. 4, Fig. 3, App. D.1"},
      .problem = recipe(),
      .setting = setting(),
      .profiles =
          {{.name = "smoke",
            .rows = {{.methods = {"bfgs"}, .n = {4}, .seeds = {0}},
                     trained({"gd"}, {4}, {0}, 20),
                     trained(kTrained, {4}, {0}, 20),
                     kPool}},
           {.name = "quick",
            .rows =
                {{.methods = {"bfgs", "gd"}, .n = {8, 32}, .seeds = {0, 1, 2}},
                 trained(kTrained, {8, 32}, {0, 1, 2}, kQuickIterations),
                 kPool}},
           {.name = "paper",
            .rows = {{.methods = {"bfgs", "gd"}, .n = kSizes, .seeds = kFirst},
                     trained(kTrained, kSizes, kFirst, kFitIterations),
                     {.methods = {"jpo-long"}, .n = {128}, .seeds = kFirst}}}},
      .methods = methods(),
      .styles = kJpoStyles,
  });
  // With the paper's number of parameters, 13,925, at the price of one unit
  // that everything has to pass.
  r.add(Experiment{
      .name = "jpo/wave-packet-head",
      .title = "Wave packet, head 64-32-1",
      .citation = {.paper = "jpo", .where = "App. C"},
      .problem = recipe(),
      .setting = setting({64, 32, 1}),
      .profiles =
          {{.name = "smoke",
            .rows = {{.methods = {"bfgs"}, .n = {4}, .seeds = {0}},
                     trained({"jpo"}, {4}, {0}, 20)}},
           {.name = "quick",
            .rows = {{.methods = {"bfgs"}, .n = {32}, .seeds = {0, 1, 2}},
                     trained({"jpo"}, {32}, {0, 1, 2}, kQuickIterations)}},
           {.name = "paper",
            .rows = {{.methods = {"bfgs"}, .n = {32, 128}, .seeds = kFirst},
                     trained({"jpo"}, {32, 128}, kFirst, kFitIterations)}}},
      .methods = jpo_methods({.rate = 1e-3, .iterations = kFitIterations}),
      .styles = kJpoStyles,
  });
}

}  // namespace physinv::jpo::wave_packet
