// What the SIP paper says of its experiments together (App. A.2, B, Fig. 15).
#include <string>
#include <vector>

#include "suite/cases/sip/overview/step_time_figures.h"
#include "suite/evidence/training.h"
#include "suite/harness/registry.h"
#include "suite/results/record.h"

namespace physinv::sip::overview {
namespace {

Condition update(const std::string& what,
                 const std::string& experiment,
                 const std::string& sip,
                 const std::string& adam) {
  return of_stages(within(what + ", CPU time of SIP over Adam",
                          median_ratio(Select{sip}.in(experiment),
                                       Select{adam}.in(experiment),
                                       seconds_per_update()),
                          0.9,
                          1.1));
}

/// Of runs with ten updates looked at or more.
std::vector<double> update_cosines(const Run& run) {
  const auto found = run.stage->arrays.find("update_cosine");
  if (found == run.stage->arrays.end() || found->second.size() < 10) return {};
  return {found->second.data(), found->second.data() + found->second.size()};
}

Condition same_way(const std::string& what,
                   const std::string& experiment,
                   const std::string& method) {
  return above(what,
               share_of_examples(Select{method}.in(experiment),
                                 update_cosines,
                                 [](double cosine) { return cosine > 0; }),
               0.5);
}

const std::vector<Claim> kClaims = {
    {.id = "P1",
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
     .note = "The paper's batches are of 128, its clock that of a GPU; ours is "
             "CPU time, of stages that shared no core.",
     .cause = contradiction(
         "App. B.1 has more than 50,000 updates in ten minutes, about "
         "15,000 of SIP: 3.3 times the time, Fig. 15 less than 1.1"),
     .gates = false},
    {.id = "P2",
     .where = "App. A.2",
     .from = "standard",
     .says =
         "Updates of the weights do not systematically distort the direction "
         "in x",
     .conditions = {same_way("sine", "sip/sine-xi32-phi45", "sip-cosines"),
                    same_way("exponential", "sip/exponential", "norm-cosines"),
                    same_way(
                        "Poisson, batch 8", "sip/poisson", "sip-cosines-b8"),
                    same_way("heat, batch 8", "sip/heat", "sip-cosines-b8")},
     .note = "The mean change of a batch's estimates by its update, and the "
             "mean that the inverse asks for: the share of the updates with an "
             "acute angle between them."}};

}  // namespace

void add_claims(Registry& r) {
  r.add(Overview{.paper = "sip",
                 .title = "Scale-invariant learning",
                 .profiles = {"smoke", "quick", "standard", "paper"},
                 .claims = kClaims,
                 .report = step_times});
}

}  // namespace physinv::sip::overview
