// SIP paper, App. C.1: the packet's width is printed ambiguously; batch norm,
// order of pooling and initial weights of the network are not printed. An
// experiment for each setting.
#include "optimizers/classical.h"
#include "suite/cases/sip/packet_width/settings.h"
#include "suite/cases/sip/wave_packet/setting.h"
#include "suite/harness/registry.h"
#include "suite/harness/study.h"

namespace physinv::packet_width {
namespace {

constexpr Index kUpdates = 5000;

Experiment experiment(const Choice& choice) {
  nn::PooledCnnOptions net = sip_wave_packet::network();
  net.batch_norm = choice.net.norm;
  net.pool_first = !choice.net.pool_last;
  if (choice.net.uniform) net.init = nn::Init::uniform;
  return {
      .name = choice.name(),
      .title = "Wave packet, variance " + choice.title(),
      .citation = {.paper = "sip", .where = "App. C.1"},
      .problem = sip_wave_packet::recipe(choice.width()),
      .setting = sip_wave_packet::setting(net),
      .profiles =
          {{.name = "study",
            .rows = {row({"lbfgs"}, sip_wave_packet::kExamples, 1),
                     row({"net"}, sip_wave_packet::kExamples, 1, kUpdates)}}},
      .methods = {{"lbfgs", {lbfgsb_solve()}},
                  sip_wave_packet::trained(kUpdates)}};
}

}  // namespace

void add_experiments(Registry& r) {
  for (const Choice& choice : choices()) {
    register_study(choice.name(), "sip/wave-packet");
    r.add(experiment(choice));
  }
}

}  // namespace physinv::packet_width
