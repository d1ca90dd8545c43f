#include "suite/harness/revision.h"

#include <map>

#include "suite/harness/outside.h"

namespace physinv {
namespace {

auto& told() {
  // Not torn down at exit, like the registry.
  static auto& all = *new std::map<std::string_view, std::string_view>;
  return all;
}

}  // namespace

bool register_revision(std::string_view name, std::string_view revision) {
  told()[name] = revision;
  return true;
}

std::string revision_of(std::string_view name) {
  const auto at = told().find(name);
  return at == told().end() ? "unknown" : std::string(at->second);
}

std::string git_revision() {
  const Outside* own = outside_program();
  return revision_of(own == nullptr ? "" : own->name);
}

}  // namespace physinv
