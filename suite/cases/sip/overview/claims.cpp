// What the SIP paper says of its experiments together (App. A.2, B, Fig. 15).
#include <string>
#include <vector>

#include "suite/evidence/training.h"
#include "suite/harness/registry.h"

namespace physinv {
namespace {

Condition update(const std::string& what,
                 const std::string& experiment,
                 const std::string& sip,
                 const std::string& adam) {
  return within(what + ", SIP over Adam",
                median_ratio(Select{sip}.in(experiment),
                             Select{adam}.in(experiment),
                             seconds_per_update()),
                0.9,
                1.1);
}

const std::vector<Claim> kClaims = {
    {.id = "P1",
     .origin = Origin::paper,
     .where = "Fig. 15",
     .from = "quick",
     .says = "The choice of the gradient changes the time of training by less "
             "than 10 %",
     .conditions = {update(
                        "Poisson, batch 8", "sip/poisson", "sip-b8", "adam-b8"),
                    update("heat, batch 8", "sip/heat", "sip-b8", "adam-b8"),
                    update(
                        "fluid, batch 16", "sip/fluid", "sip-b16", "adam-b16"),
                    update("sine", "sip/sine-xi32-phi45", "sip", "adam")},
     .note = "The paper's batches are of 128, its clock that of a GPU.",
     .gates = false},
    {.id = "P2",
     .origin = Origin::paper,
     .where = "App. A.2",
     .from = "paper",
     .says =
         "Updates of the weights do not systematically distort the direction "
         "in x",
     .conditions = {},
     .note =
         "Needs single updates from sampled states, which no profile runs."}};

const bool kRegistered =
    register_overview({.paper = "sip",
                       .title = "Scale-invariant learning",
                       .profiles = {"smoke", "quick", "standard", "paper"},
                       .claims = kClaims});

}  // namespace
}  // namespace physinv
