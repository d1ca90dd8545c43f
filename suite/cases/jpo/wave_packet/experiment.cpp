// JPO paper, Sec. 4 "Wave packet localization", Fig. 3, App. D.1: one unknown,
// a loss full of minima, and noise that nobody can explain.
#include <string>
#include <vector>

#include "problems/wave_packet/wave_packet.h"
#include "suite/cases/jpo/common/methods.h"
#include "suite/cases/jpo/common/report.h"
#include "suite/cases/jpo/wave_packet/claims.h"
#include "suite/cases/jpo/wave_packet/figures.h"
#include "suite/harness/registry.h"
#include "suite/nn/unet.h"
#include "suite/nn/vgg.h"

namespace physinv::packet {
namespace {

constexpr Index kFitIterations = 3000, kQuickIterations = 1000;

const auto kTrained = trained_methods();

JpoReportOptions report_options(const std::string& name,
                                const std::string& title) {
  return {.experiment = name,
          .title = title,
          .paper = "jpo",
          .solved = within_of_truth(kBasin / WavePacketOptions{}.scale),
          .curve_sizes = {},
          .trajectory_size = 128,
          .unknowns = {"xi"},
          .tensors = {},
          .fraction = {"fig3d", "Fig. 3d"},
          .improvement = {"fig7", "Fig. 7"},
          .curves = {"fig8", "Fig. 8"},
          .trajectories = {"fig9", "Fig. 9"},
          .weight_change = {"fig10", "Fig. 10"}};
}

/// Kernel, bias, scale and offset of every block, then the dense layers.
std::vector<std::string> tensor_names(int blocks, int hidden) {
  std::vector<std::string> names;
  int bias = 0, norm = 0;
  const auto put = [&](char kind, int number) {
    names.push_back(kind + std::to_string(number));
  };
  const auto normalised = [&](char kind, int number) {
    put(kind, number), put('b', ++bias);
    put('s', ++norm), put('o', norm);
  };
  for (int i = 1; i <= blocks; ++i) normalised('k', i);
  for (int i = 1; i <= hidden; ++i) normalised('m', i);
  put('m', hidden + 1), put('b', ++bias);
  return names;
}

/// Fig. 3c: gradient descent beside BFGS and JPO, at the largest n.
Figure three_curves(JpoReportOptions options,
                    const Results& results,
                    const Published& published) {
  options.methods = {"gd", "jpo"};
  options.curves = {"fig3c", "Fig. 3c"};
  const JpoReport report(options, results, published);
  const Index n = report.largest_size();
  options.curve_sizes = {n};
  Figure figure = report.curves();
  figure.columns = 1;
  return figure;
}

Section report(const Results& results, const Published& published) {
  JpoReportOptions options = report_options(kName, "Wave packet");
  options.tensors = tensor_names(5, 2);
  Section section = jpo_section(options, results, published);
  std::vector<Figure> first = figures();
  first.push_back(three_curves(options, results, published));
  section.figures.insert(section.figures.begin(), first.begin(), first.end());
  section.claims = claims(results);
  return section;
}

Section report_head(const Results& results, const Published& published) {
  JpoReportOptions options =
      report_options("jpo/wave-packet-head", "Wave packet, head 64-32-1");
  options.methods = {"jpo"};
  options.tensors = tensor_names(5, 3);
  Section section = jpo_section(options, results, published);
  // The paper's numbers stand with the other network.
  for (Table& table : section.tables) table.source.clear();
  for (Figure& figure : section.figures) figure.source.clear();
  return section;
}

constexpr nn::Grid kGrid{.columns = 256};

NetworkRole predictor(const std::vector<Index>& hidden) {
  return {{Field::observations},
          nn::vgg({.channels = 1,
                   .grid = kGrid,
                   .features = {16, 16, 16, 16, 16},
                   .hidden = hidden})};
}

const Setting kSetting{
    .predictor = predictor({64, 32}),
    .surrogate = {{Field::unknowns, Field::given},
                  nn::unet(
                      {.grid = kGrid, .channels = 1, .scalars_before = 1})},
    .output_scale = 1.0,
    .gtol = 1e-5};

Row trained(std::vector<std::string> methods,
            std::vector<Index> n,
            std::vector<std::uint64_t> seeds,
            Index iterations) {
  return {.methods = std::move(methods),
          .n = std::move(n),
          .seeds = std::move(seeds),
          .iterations = iterations};
}

const std::vector<Index> kSizes = {2, 4, 8, 16, 32, 64, 128, 256};
const auto kSeeds = first_seeds(5);
/// For claims about BFGS alone.
const Row kPool{.methods = {"bfgs"}, .n = {256}, .seeds = {0, 1}};

const auto kRegistered = register_experiment({
    .name = kName,
    .title = "Wave packet",
    .source = {.paper = "jpo", .where = "Sec. 4, Fig. 3, App. D.1"},
    .problem = problem<WavePacket>("wave_packet"),
    .setting = kSetting,
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
          .rows = {{.methods = {"bfgs", "gd"}, .n = kSizes, .seeds = kSeeds},
                   trained(kTrained, kSizes, kSeeds, kFitIterations)}}},
    .methods = jpo_methods({.rate = 1e-3, .iterations = kFitIterations}),
    .report = report,
});

/// With the paper's number of parameters, 13,925, at the price of one unit
/// that everything has to pass.
const auto kRegisteredHead = register_experiment({
    .name = "jpo/wave-packet-head",
    .title = "Wave packet, head 64-32-1",
    .source = {.paper = "jpo", .where = "App. C"},
    .problem = problem<WavePacket>("wave_packet"),
    .setting = {.predictor = predictor({64, 32, 1}),
                .surrogate = kSetting.surrogate,
                .output_scale = kSetting.output_scale,
                .gtol = kSetting.gtol},
    .profiles =
        {{.name = "smoke",
          .rows = {{.methods = {"bfgs"}, .n = {4}, .seeds = {0}},
                   trained({"jpo"}, {4}, {0}, 20)}},
         {.name = "quick",
          .rows = {{.methods = {"bfgs"}, .n = {32}, .seeds = {0, 1, 2}},
                   trained({"jpo"}, {32}, {0, 1, 2}, kQuickIterations)}},
         {.name = "paper",
          .rows = {{.methods = {"bfgs"}, .n = {32, 128}, .seeds = kSeeds},
                   trained({"jpo"}, {32, 128}, kSeeds, kFitIterations)}}},
    .methods = jpo_methods({.rate = 1e-3, .iterations = kFitIterations}),
    .report = report_head,
});

}  // namespace
}  // namespace physinv::packet
