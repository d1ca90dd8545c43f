#include "suite/harness/outside.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

namespace physinv {
namespace {

std::vector<Outside>& registered() {
  // Not torn down at exit, like the registry.
  static auto& all = *new std::vector<Outside>;
  return all;
}

}  // namespace

bool register_outside(const Outside& outside) {
  registered().push_back(outside);
  return true;
}

const std::vector<Outside>& outsides() { return registered(); }

const Outside* outside_program() {
  const auto& all = registered();
  const auto at = std::find_if(
      all.begin(), all.end(), [](const Outside& o) { return !o.plugin; });
  return at == all.end() ? nullptr : &*at;
}

std::vector<std::string> outside_problems() {
  std::vector<std::string> wrong;
  std::map<std::string_view, std::pair<std::string_view, std::string_view>>
      seen;
  for (const Outside& o : outsides()) {
    for (const SourceFile& file : o.sources) {
      const auto [at, fresh] =
          seen.emplace(file.path, std::pair(file.hash, o.name));
      if (!fresh && at->second.first != file.hash)
        wrong.push_back(
            fmt::format("{} and {} were built from different versions of {}; "
                        "build both again",
                        at->second.second,
                        o.name,
                        file.path));
    }
  }
  return wrong;
}

}  // namespace physinv
