// The exponential: from where it underflows to where it overflows.
#include "problems/exponential/exponential.h"
#include "suite/cases/numerics/common/atlas.h"
#include "suite/cases/numerics/exponential/closed_form.h"
#include "suite/evidence/series.h"

namespace physinv::numerics::exponential {
namespace {

const SweepAxis kPlace{"x", spaced(-760, 720, 75), false};
const SweepAxis kOffset{"offset", spaced(-1, 1, 9), false};

}  // namespace

void add_experiments(Registry& r) {
  add_atlas(
      r,
      {.name = "numerics/exponential",
       .title = "Numerics of the exponential",
       .citation = {.paper = "sip", .where = "App. C.2"},
       .sweeps = {{.id = "places",
                   .title = "The unknown, coarse and fine",
                   .x = kPlace,
                   .y = kOffset,
                   .point =
                       [](double place, double offset) {
                         return Vector<double>::Constant(1, place + offset);
                       },
                   .problems = {problems::exponential()}}},
       .parameters = {batch_parameter(
           problems::exponential(), 4096, {}, exponential_closed_form())}});
}

}  // namespace physinv::numerics::exponential
