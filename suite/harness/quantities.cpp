#include "suite/harness/quantities.h"

#include <map>
#include <utility>

namespace physinv {
namespace {

std::map<std::string, Quantities>& all() {
  static std::map<std::string, Quantities> quantities;
  return quantities;
}

}  // namespace

bool register_quantities(const std::string& problem, Quantities quantities) {
  all()[problem] = std::move(quantities);
  return true;
}

const Quantities* find_quantities(const std::string& problem) {
  const auto at = all().find(problem);
  return at == all().end() ? nullptr : &at->second;
}

}  // namespace physinv
