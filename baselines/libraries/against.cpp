#include "against.h"

#include "suite/evidence/guests.h"
#include "suite/harness/registry.h"

namespace libraries {

double better(const physinv::Shares& s) { return s.better; }
double equal(const physinv::Shares& s) { return s.equal; }
double f(const physinv::Shares& s) { return s.f(); }

std::vector<std::string> solvers_of(const physinv::Evidence& e) {
  const auto experiment = physinv::registry().find(e.experiment);
  std::vector<std::string> all;
  for (const auto& method : experiment->methods)
    if (method.chain.front()->name() == "solve") all.push_back(method.id);
  for (const auto& id : physinv::guests(e)) all.push_back(id);
  std::erase_if(all, [&](const std::string& solver) {
    return !mean(refined(), physinv::against({solver}, f))(e).value;
  });
  return all;
}

}  // namespace libraries
