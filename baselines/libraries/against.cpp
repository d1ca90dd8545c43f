#include "against.h"

#include <optional>

#include "suite/harness/registry.h"
#include "suite/results/results.h"

namespace libraries {

double better(const physinv::Shares& s) { return s.better; }
double equal(const physinv::Shares& s) { return s.equal; }
double f(const physinv::Shares& s) { return s.f(); }

physinv::RunValue against(const std::string& solver,
                          Share share,
                          physinv::Equality equality) {
  return [=](const physinv::Run& run) -> std::optional<double> {
    const auto other = run.beside({solver});
    if (!other) return {};
    return share(
        physinv::compare_losses(run.stage->loss, other->stage->loss, equality));
  };
}

std::vector<std::string> solvers_of(const physinv::Evidence& e) {
  const auto experiment = physinv::registry().find(e.experiment);
  std::vector<std::string> all;
  for (const auto& method : experiment->methods)
    if (method.chain.front()->name() == "solve") all.push_back(method.id);
  for (const auto& id : e.results.methods(e.experiment))
    if (physinv::find_method(*experiment, id) == nullptr) all.push_back(id);
  std::erase_if(all, [&](const std::string& solver) {
    return !mean(refined(), against(solver, f))(e).value;
  });
  return all;
}

}  // namespace libraries
