// What a program is over: all folders of experiments.def, or the one that CMake
// names as PHYSINV_FOLDER, which then links none of the others.
#include <sstream>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "suite/cases/common/folders.h"
#include "suite/harness/registry_errors.h"

#ifndef PHYSINV_FOLDER
#define PHYSINV_FOLDER ""
#endif

namespace physinv {

#define FOLDER(path, layers, names, space, ...) \
  namespace space {                             \
  Add __VA_ARGS__;                              \
  }
#include "suite/cases/common/experiments.def"
#undef FOLDER

namespace {

constexpr bool takes(std::string_view path) {
  constexpr std::string_view kOnly = PHYSINV_FOLDER;
  return kOnly.empty() || path == kOnly;
}

void append(std::vector<CaseFolder>& all,
            const char* path,
            const char* names,
            const std::vector<Add*>& adds) {
  if (all.empty() || all.back().path != path) all.push_back({.path = path});
  CaseFolder& folder = all.back();
  folder.adds.insert(folder.adds.end(), adds.begin(), adds.end());
  std::istringstream words(names);
  for (std::string name; words >> name;) folder.experiments.push_back(name);
}

/// Of a folder that the program lacks only the names: nothing asks the linker
/// for what a branch names that `if constexpr` discards.
std::vector<CaseFolder> listed() {
  std::vector<CaseFolder> all;
#define FOLDER(path, layers, names, space, ...) \
  if constexpr (takes(path)) {                  \
    using namespace space;                      \
    append(all, path, names, {__VA_ARGS__});    \
  } else {                                      \
    append(all, path, names, {});               \
  }
#include "suite/cases/common/experiments.def"
#undef FOLDER
  return all;
}

}  // namespace

std::vector<CaseFolder> folders() {
  std::vector<CaseFolder> all = listed();
  std::erase_if(all, [](const CaseFolder& f) { return f.adds.empty(); });
  return all;
}

void register_all(Registry& r) {
  std::vector<std::string> elsewhere;
  for (const CaseFolder& folder : listed())
    if (folder.adds.empty())
      elsewhere.insert(elsewhere.end(),
                       folder.experiments.begin(),
                       folder.experiments.end());
  name_elsewhere(std::move(elsewhere));
  for (const CaseFolder& folder : folders()) folder.add(r);
}

}  // namespace physinv
