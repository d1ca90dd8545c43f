// SIP paper, App. C.1: where in a noisy series is the packet? A network trained
// on all of them, against L-BFGS-B on each. No released program has this
// experiment. Chosen where the text leaves it open: samples at t = 1 .. 256,
// 0.1 as the noise's deviation, dense layers of 64, 32 and 1, fresh samples for
// every update, Glorot's initial weights. Padding, normalisation, the order of
// pooling and convolutions, and the initial weights are options of the network.
#include <string>
#include <vector>

#include "baselines/prior_guess.h"
#include "optimizers/classical.h"
#include "optimizers/jpo.h"
#include "suite/cases/sip/wave_packet/setting.h"
#include "suite/harness/registry.h"

namespace physinv::sip_wave_packet {
namespace {

constexpr Index kQuick = 1000, kPaper = 3000;

std::vector<Method> methods() {
  return {{"lbfgs", {lbfgsb_solve()}},
          {"random", {prior_guess()}},
          trained(kQuick)};
}

const std::vector<std::string> kWithoutNetwork = {"lbfgs", "random"};

}  // namespace

void add_experiments(Registry& r) {
  r.add(Experiment{
      .name = "sip/wave-packet",
      .title = "Wave packet",
      .citation = {.paper = "sip", .where = "App. C.1, Fig. 16"},
      .problem = recipe(),
      .setting = setting(),
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
      .citation = {.paper = "sip", .where = "App. C.1"},
      .problem = recipe(),
      .setting = setting(),
      .profiles = {{.name = "smoke", .rows = {row({"fit"}, 2, 1, 5)}},
                   {.name = "paper",
                    .rows = {row({"fit"}, 50, 5, kQuick),
                             row({"fit"}, 1, 50, kQuick)}}},
      .methods = {{"fit", {jpo_fit({.step = kAdam, .iterations = kQuick})}}},
  });
}

}  // namespace physinv::sip_wave_packet
