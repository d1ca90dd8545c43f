#include "suite/cases/jpo/wave_packet/quantities.h"

#include <vector>

namespace physinv::jpo::wave_packet {

RunRow distances_in(double unit) {
  return [=](const Run& run) {
    const auto d =
        unit * (run.stage->x.row(0) - run.record->data.x.row(0)).array().abs();
    std::vector<double> out;
    for (Index i = 0; i < d.size(); ++i) out.push_back(d(i));
    return out;
  };
}

RunRow farther_than_bfgs_in(double unit) {
  return [from = distances_in(unit)](const Run& run) {
    const auto other = bfgs_beside(run);
    if (!other) return std::vector<double>{};
    auto d = from(run);
    const auto of_bfgs = from(*other);
    for (std::size_t i = 0; i < d.size(); ++i) d[i] -= of_bfgs[i];
    return d;
  };
}

RunRow first_steps_in(double unit) {
  return [=](const Run& run) {
    const auto& steps = run.stage->arrays.at("first_step");
    std::vector<double> out;
    for (Index i = 0; i < steps.cols(); ++i) out.push_back(unit * steps(0, i));
    return out;
  };
}

}  // namespace physinv::jpo::wave_packet
