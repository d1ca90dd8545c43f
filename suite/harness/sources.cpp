#include "suite/harness/sources.h"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "suite/core/check.h"
#include "suite/core/hash.h"

namespace physinv {
namespace {

void add_network(Sources& all, const NetworkRole& role) {
  const NetworkRecipe& recipe = role.recipe;
  if (!recipe.make_double) return;
  all.roots.emplace_back(recipe.source);
  all.unused.insert(
      all.unused.end(), recipe.unused.begin(), recipe.unused.end());
}

std::string implementation(std::string_view header) {
  return std::string(header.substr(0, header.size() - 1)) + "cpp";
}

}  // namespace

SourceGraph::SourceGraph(std::string_view foundation,
                         std::span<const SourceFile> files)
    : foundation_(foundation) {
  for (const SourceFile& file : files) {
    Node& node = nodes_[std::string(file.path)];
    node.hash = file.hash;
    std::istringstream names{std::string(file.includes)};
    for (std::string name; names >> name;) node.includes.push_back(name);
  }
}

std::string SourceGraph::find(std::string_view path) const {
  while (true) {
    if (const auto at = nodes_.find(path); at != nodes_.end()) return at->first;
    const auto slash = path.find('/');
    if (slash == std::string_view::npos) return {};
    path.remove_prefix(slash + 1);
  }
}

std::set<std::string> SourceGraph::closure(const Sources& sources) const {
  std::set<std::string> found;
  std::vector<std::string> next;
  for (const auto& root : sources.roots) next.push_back(find(root));
  while (!next.empty()) {
    const std::string file = std::move(next.back());
    next.pop_back();
    const auto at = nodes_.find(file);
    if (at == nodes_.end() || !found.insert(file).second) continue;
    for (const auto& header : at->second.includes) {
      const std::pair line(file, header);
      if (std::find(sources.unused.begin(), sources.unused.end(), line) ==
          sources.unused.end())
        next.push_back(header);
    }
    if (file.ends_with(".h")) next.push_back(implementation(file));
  }
  return found;
}

std::set<std::string> SourceGraph::closure(
    const std::vector<Sources>& chain) const {
  std::set<std::string> all;
  for (const Sources& sources : chain) all.merge(closure(sources));
  return all;
}

std::vector<std::string> SourceGraph::errors(const Sources& sources) const {
  std::vector<std::string> wrong;
  for (const auto& root : sources.roots)
    if (find(root).empty())
      wrong.push_back(fmt::format("no source of numbers '{}'", root));
  for (const auto& [file, header] : sources.unused) {
    const auto at = nodes_.find(file);
    if (at == nodes_.end() ||
        !std::count(
            at->second.includes.begin(), at->second.includes.end(), header))
      wrong.push_back(fmt::format("{} does not include {}", file, header));
  }
  for (const auto& file : closure(sources))
    for (const auto& header : nodes_.find(file)->second.includes)
      if (!nodes_.contains(header))
        wrong.push_back(fmt::format(
            "numbers come from {}, but changes of {} go unseen", file, header));
  return wrong;
}

std::string SourceGraph::fingerprint(const std::vector<Sources>& chain) const {
  for (const Sources& sources : chain)
    for (const auto& root : sources.roots)
      SUITE_CHECK(!find(root).empty(), "no source of numbers '" + root + "'");
  std::string text = foundation_ + '\n';
  for (const auto& file : closure(chain))
    text += fmt::format("{} {}\n", file, nodes_.find(file)->second.hash);
  return hex128(text);
}

const SourceGraph& project_sources() {
  static const SourceGraph kGraph(build_info().foundation,
                                  build_info().sources);
  return kGraph;
}

std::vector<Sources> chain_sources(const Experiment& experiment,
                                   const Method& method,
                                   std::size_t position) {
  std::vector<Sources> chain;
  for (std::size_t i = 0; i <= position; ++i) {
    const Stage& stage = *method.chain[i];
    Sources all = stage.sources();
    all.roots.push_back(experiment.problem.source);
    if (contains(stage.networks(), Networks::predictor))
      add_network(all, experiment.setting.predictor);
    if (contains(stage.networks(), Networks::surrogate))
      add_network(all, experiment.setting.surrogate);
    chain.push_back(std::move(all));
  }
  return chain;
}

}  // namespace physinv
