// SIP paper, App. C.1: where in a noisy series is the packet? A network trained
// on all of them, against L-BFGS-B on each. No released program has this
// experiment. Chosen where the text leaves it open: samples at t = 1 .. 256,
// 0.1 as the noise's deviation, dense layers of 64, 32 and 1, fresh samples for
// every update, Glorot's initial weights. Padding, normalisation, the order of
// pooling and convolutions, and the initial weights are options of the network.
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "baselines/prior_guess.h"
#include "optimizers/classical.h"
#include "optimizers/jpo.h"
#include "optimizers/training.h"
#include "problems/wave_packet/wave_packet.h"
#include "suite/cases/sip/wave_packet/metrics.h"
#include "suite/harness/registry.h"
#include "suite/nn/pooled_cnn.h"

namespace physinv::sip_wave_packet {
namespace {

constexpr Index kExamples = 500, kBatch = 100;
constexpr Index kQuick = 1000, kPaper = 3000;

/// The unknown is t0 - 76.8, in samples, of which line searches know nothing.
const ProblemRecipe kProblem =
    problem<WavePacket>("wave_packet",
                        {.frequency = kFrequency,
                         .phase = -std::numbers::pi / 2,
                         .width = 20,
                         .centre = 76.8,
                         .scale = 1,
                         .noise = 0.1,
                         .range = {25.6, 128},
                         .half_loss = false});

/// t0 = 76.8 + 51.2 tanh(z / 2) = 25.6 + 102.4 sigmoid(z)
const Setting kSetting{
    .predictor = {{Field::observations},
                  nn::pooled_cnn({.positions = 256,
                                  .features = {16, 16, 16, 16, 16},
                                  .hidden = {64, 32},
                                  .output = nn::Activation::half_tanh})},
    .surrogate = {},
    .output_scale = 51.2};

constexpr AdamOptions kAdam{.rate = 1e-3, .eps = 1e-8};

std::vector<Method> methods() {
  return {{"lbfgs", {lbfgsb_solve()}},
          {"random", {prior_guess()}},
          {"net",
           {train({.rule = kAdam,
                   .batch = kBatch,
                   .iterations = kQuick,
                   .gradient_scale = double(kBatch),
                   .fresh = true,
                   .metrics = metrics()})}}};
}

const std::vector<std::string> kWithoutNetwork = {"lbfgs", "random"};

}  // namespace

void add_experiments(Registry& r) {
  r.add(Experiment{
      .name = "sip/wave-packet",
      .title = "Wave packet",
      .source = {.paper = "sip", .where = "App. C.1, Fig. 16"},
      .problem = kProblem,
      .setting = kSetting,
      .profiles = {{.name = "smoke",
                    .rows = {row({"lbfgs"}, 50, 1),
                             row({"random"}, kExamples, 1),
                             row({"net"}, 50, 1, 20)}},
                   {.name = "quick",
                    .rows = {row(kWithoutNetwork, kExamples, 3),
                             row({"net"}, kExamples, 3, kQuick)}},
                   {.name = "paper",
                    .rows = {row(kWithoutNetwork, kExamples, 5),
                             row({"net"}, kExamples, 5, kPaper)}}},
      .methods = methods(),
  });
  // One network for many examples, and one for each of as many.
  r.add(Experiment{
      .name = "sip/wave-packet-joint",
      .title = "Wave packet, examples together and alone",
      .source = {.paper = "sip", .where = "App. C.1"},
      .problem = kProblem,
      .setting = kSetting,
      .profiles = {{.name = "smoke", .rows = {row({"fit"}, 2, 1, 5)}},
                   {.name = "paper",
                    .rows = {row({"fit"}, 50, 5, kQuick),
                             row({"fit"}, 1, 50, kQuick)}}},
      .methods = {{"fit", {jpo_fit({.step = kAdam, .iterations = kQuick})}}},
  });
}

}  // namespace physinv::sip_wave_packet
