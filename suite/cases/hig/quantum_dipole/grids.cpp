#include "suite/cases/hig/quantum_dipole/grids.h"

#include <fmt/format.h>

#include "suite/cases/hig/common/methods.h"

namespace physinv::dipole {
namespace {

/// `adam` is the one other figures show.
std::vector<AdamPoint> adam_grid(Index batch_of_adam, double rate_of_adam) {
  std::vector<AdamPoint> all;
  for (const Index b : {16, 256, 512, 1024})
    for (const double rate : {1e-4, 2e-4, 5e-4, 1e-3}) {
      const bool main = b == batch_of_adam && rate == rate_of_adam;
      all.push_back({b, rate, main ? "adam" : adam_id(b, rate)});
    }
  return all;
}

/// `hig` is the one other figures show.
std::vector<HigPoint> hig_grid(double rate_of_hig, int digits_of_hig) {
  std::vector<HigPoint> all;
  for (const Index b : {8, 16})
    for (const double rate : {0.5, 0.7, 1.0})
      for (const int digits : {2, 3, 4, 5, 6}) {
        const bool main =
            b == 16 && rate == rate_of_hig && digits == digits_of_hig;
        all.push_back(
            {b,
             rate,
             digits,
             main ? "hig"
                  : fmt::format(
                        "hig-b{}-eta{:02.0f}-tau{}", b, 10 * rate, digits)});
      }
  return all;
}

}  // namespace

std::string adam_id(Index batch, double rate) {
  return fmt::format("adam-b{}-{}", batch, rate_id(rate));
}

std::vector<FloatPoint> in_float() {
  std::vector<FloatPoint> all;
  for (const int digits : {3, 5, 7})
    for (const bool project : {true, false})
      all.push_back(
          {digits,
           project,
           fmt::format("hig-f32-{}tau{}", project ? "" : "raw-", digits)});
  return all;
}

std::vector<AdamPoint> dense_adam() { return adam_grid(16, 1e-4); }
std::vector<HigPoint> dense_hig() { return hig_grid(0.5, 5); }
std::vector<AdamPoint> conv_adam() { return adam_grid(256, 2e-4); }
std::vector<HigPoint> conv_hig() { return hig_grid(0.7, 4); }

}  // namespace physinv::dipole
