// JPO paper, Sec. 4 "Wave packet localization", Fig. 3, App. D.1: one unknown,
// a loss full of minima, and noise that no parameter explains.
#include <vector>

#include "suite/cases/jpo/common/methods.h"
#include "suite/cases/jpo/common/report.h"
#include "suite/cases/jpo/wave_packet/setting.h"

namespace physinv::jpo::wave_packet {
namespace {

constexpr Index kFitIterations = 3000, kQuickIterations = 1000;

/// `jpo-long` fits until its estimates have settled.
std::vector<Method> methods() {
  auto all = jpo_methods({.rate = 1e-3, .iterations = kFitIterations});
  all.push_back({"jpo-long",
                 {jpo_fit({.step = AdamOptions{.rate = 1e-3},
                           .iterations = 2 * kFitIterations})}});
  return all;
}

/// For claims about BFGS alone.
const Row kPool = row({"bfgs"}, 256, 2);

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
            .rows = {row({"bfgs"}, 4, 1),
                     row({"gd"}, 4, 1, 20),
                     row(trained_methods(), 4, 1, 20),
                     kPool}},
           {.name = "quick",
            .rows = joined(jpo_rows({8, 32}, 3, kQuickIterations), {kPool})},
           {.name = "paper",
            .rows = joined(
                jpo_rows({2, 4, 8, 16, 32, 64, 128, 256}, 5, kFitIterations),
                {row({"jpo-long"}, 128, 5)})}},
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
      .profiles = {{.name = "smoke",
                    .rows = {row({"bfgs"}, 4, 1), row({"jpo"}, 4, 1, 20)}},
                   {.name = "quick",
                    .rows = {row({"bfgs"}, 32, 3),
                             row({"jpo"}, 32, 3, kQuickIterations)}},
                   {.name = "paper",
                    .rows = {{.methods = {"bfgs"},
                              .n = {32, 128},
                              .seeds = first_seeds(5)},
                             {.methods = {"jpo"},
                              .n = {32, 128},
                              .seeds = first_seeds(5),
                              .iterations = kFitIterations}}}},
      .methods = jpo_methods({.rate = 1e-3, .iterations = kFitIterations}),
      .styles = kJpoStyles,
  });
}

}  // namespace physinv::jpo::wave_packet
