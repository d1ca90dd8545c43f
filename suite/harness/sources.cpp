#include "suite/harness/sources.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

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

/// Names what stages leave. It can end a compilation, and moves no number.
constexpr std::string_view kArrayTable = "suite/core/array_table.h";

std::string implementation(std::string_view header) {
  return std::string(header.substr(0, header.size() - 1)) + "cpp";
}

}  // namespace

SourceGraph::SourceGraph(std::string_view foundation,
                         std::span<const SourceFile> files,
                         std::span<const Outside> outsides)
    : foundation_(foundation) {
  add(files);
  for (const Outside& o : outsides) {
    add(o.sources);
    places_.push_back({std::string(o.root), std::string(o.project)});
  }
  std::sort(nodes_.begin(), nodes_.end(), [](const Node& a, const Node& b) {
    return a.path < b.path;
  });
  const auto same = [](const Node& a, const Node& b) {
    return a.path == b.path;  // of a program and a plug-in from one project
  };
  nodes_.erase(std::unique(nodes_.begin(), nodes_.end(), same), nodes_.end());
  for (Node& node : nodes_) {
    for (const auto& header : node.includes)
      node.next.push_back(node_at(header));
    node.implementation = node.path.ends_with(".h")
                              ? node_at(implementation(node.path))
                              : kNowhere;
  }
}

void SourceGraph::add(std::span<const SourceFile> files) {
  for (const SourceFile& file : files) {
    Node node{.path = std::string(file.path), .hash = std::string(file.hash)};
    std::istringstream names{std::string(file.includes)};
    for (std::string name; names >> name;) node.includes.push_back(name);
    nodes_.push_back(std::move(node));
  }
}

std::size_t SourceGraph::node_at(std::string_view path) const {
  const auto at = std::lower_bound(
      nodes_.begin(), nodes_.end(), path, [](const Node& n, auto& p) {
        return n.path < p;
      });
  return at != nodes_.end() && at->path == path
             ? static_cast<std::size_t>(at - nodes_.begin())
             : kNowhere;
}

std::size_t SourceGraph::node_in(const Place& place,
                                 std::string_view path) const {
  const auto root = place.root + '/';
  const auto inside = path.starts_with(root) ? path.substr(root.size()) : path;
  return node_at(fmt::format("{}/{}", place.project, inside));
}

std::set<std::size_t> SourceGraph::candidates(std::string_view path) const {
  std::set<std::size_t> found;
  while (true) {
    found.insert(node_at(path));
    for (const Place& place : places_) found.insert(node_in(place, path));
    found.erase(kNowhere);
    const auto slash = path.find('/');
    if (!found.empty() || slash == std::string_view::npos) return found;
    path.remove_prefix(slash + 1);
  }
}

std::size_t SourceGraph::find_node(std::string_view path) const {
  const auto found = candidates(path);
  return found.size() == 1 ? *found.begin() : kNowhere;
}

/// Why there is no one file of a root.
std::string SourceGraph::why_not(const std::string& root) const {
  std::vector<std::string> names;
  for (const std::size_t at : candidates(root))
    names.push_back(nodes_[at].path);
  if (!names.empty())
    return fmt::format("'{}' is ambiguous: {}; give one of these paths in full",
                       root,
                       fmt::join(names, " or "));
  return fmt::format("there is no source '{}'", root) +
         (places_.empty()
              ? ""
              : "; list its file in SOURCES; the class of a problem is "
                "expected in <name>.h or in the source that its recipe names");
}

std::string SourceGraph::find(std::string_view path) const {
  const std::size_t at = find_node(path);
  return at == kNowhere ? std::string() : nodes_[at].path;
}

void SourceGraph::reach(const Sources& sources,
                        std::vector<bool>& found) const {
  const auto counts = [&](const Node& node, std::size_t k) {
    return std::none_of(
        sources.unused.begin(), sources.unused.end(), [&](const auto& line) {
          return line.first == node.path && line.second == node.includes[k];
        });
  };
  std::vector<bool> seen(nodes_.size());
  std::vector<std::size_t> next;
  for (const auto& root : sources.roots) next.push_back(find_node(root));
  while (!next.empty()) {
    const std::size_t at = next.back();
    next.pop_back();
    if (at == kNowhere || seen[at]) continue;
    seen[at] = found[at] = true;
    const Node& node = nodes_[at];
    for (std::size_t k = 0; k < node.next.size(); ++k)
      if (counts(node, k)) next.push_back(node.next[k]);
    next.push_back(node.implementation);
  }
}

std::set<std::string> SourceGraph::closure(const Sources& sources) const {
  return closure(std::vector<Sources>{sources});
}

std::set<std::string> SourceGraph::closure(
    const std::vector<Sources>& chain) const {
  std::vector<bool> found(nodes_.size());
  for (const Sources& sources : chain) reach(sources, found);
  std::set<std::string> all;
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    if (found[i]) all.insert(nodes_[i].path);
  return all;
}

std::vector<std::string> SourceGraph::errors(const Sources& sources) const {
  std::vector<std::string> wrong;
  for (const auto& root : sources.roots)
    if (find_node(root) == kNowhere) wrong.push_back(why_not(root));
  for (const auto& [file, header] : sources.unused) {
    const std::size_t at = node_at(file);
    if (at == kNowhere ||
        !std::count(
            nodes_[at].includes.begin(), nodes_[at].includes.end(), header))
      wrong.push_back(fmt::format("{} does not include {}", file, header));
  }
  std::vector<bool> found(nodes_.size());
  reach(sources, found);
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    for (std::size_t k = 0; found[i] && k < nodes_[i].next.size(); ++k)
      if (nodes_[i].next[k] == kNowhere && nodes_[i].includes[k] != kArrayTable)
        wrong.push_back(fmt::format(
            "results depend on {}, but changes of {} would not invalidate them",
            nodes_[i].path,
            nodes_[i].includes[k]));
  return wrong;
}

std::string SourceGraph::fingerprint(const std::vector<Sources>& chain) const {
  std::vector<bool> found(nodes_.size());
  for (const Sources& sources : chain) {
    for (const auto& root : sources.roots)
      SUITE_CHECK(find_node(root) != kNowhere, why_not(root));
    reach(sources, found);
  }
  std::string text = foundation_ + '\n';
  for (std::size_t i = 0; i < nodes_.size(); ++i)
    if (found[i])
      text += fmt::format("{} {}\n", nodes_[i].path, nodes_[i].hash);
  return hex128(text);
}

const SourceGraph& project_sources() {
  static const SourceGraph kGraph(
      build_info().foundation, build_info().sources, outsides());
  return kGraph;
}

bool is_from_outside(const Stage& stage) {
  if (outsides().empty()) return false;
  const auto roots = stage.sources().roots;
  if (roots.empty()) return false;
  const std::string& given = roots.front();
  const std::string path = project_sources().find(given);
  return std::any_of(
      outsides().begin(), outsides().end(), [&](const Outside& o) {
        return given.starts_with(fmt::format("{}/", o.root)) ||
               path.starts_with(fmt::format("{}/", o.project));
      });
}

std::string source_name(const std::string& path) {
  if (!path.starts_with('/')) return path;
  for (const Outside& o : outsides())
    if (const auto root = fmt::format("{}/", o.root); path.starts_with(root))
      return fmt::format("{}/{}", o.project, path.substr(root.size()));
  const std::string found = project_sources().find(path);
  return found.empty() ? path.substr(path.rfind('/') + 1) : found;
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
