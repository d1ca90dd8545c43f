/// Which sources the numbers of a stage come from, and their fingerprint: the
/// part of a content key that makes a stage stale when its code changes, and
/// no other stage.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "suite/harness/build_info.h"
#include "suite/harness/case.h"
#include "suite/harness/outside.h"

namespace physinv {

/// Sources and what they include. From a root one reaches what it includes, and
/// from a header x.h its implementation x.cpp in the same folder. A header
/// whose implementation has another name must be a root itself; a test lists
/// sources that nothing reaches.
class SourceGraph {
 public:
  /// `foundation` enters every fingerprint. Sources from outside are added to
  /// the suite's, under the names of their projects.
  SourceGraph(std::string_view foundation,
              std::span<const SourceFile> files,
              std::span<const Outside> outsides = {});

  /// The file that a path ends in, "" if there is none; compilers name files
  /// in full. A project's own files are named by their path inside it, too.
  std::string find(std::string_view path) const;

  /// Everything that the roots reach; of a chain, what any of its stages do.
  std::set<std::string> closure(const Sources& sources) const;
  std::set<std::string> closure(const std::vector<Sources>& chain) const;

  /// Roots that are no files, lines without effect that are not in the file,
  /// and included headers of the project that the graph does not have: one text
  /// each.
  std::vector<std::string> errors(const Sources& sources) const;

  /// 32 hexadecimal digits over path and content of a chain's closure.
  std::string fingerprint(const std::vector<Sources>& chain) const;

 private:
  struct Node {
    std::string path, hash;
    std::vector<std::string> includes;
    std::vector<std::size_t> next;  ///< of each include; kNowhere: no node
    std::size_t implementation;     ///< of a header
  };
  static constexpr std::size_t kNowhere = ~std::size_t{0};

  /// Where the files of a project are, and what their paths begin with.
  struct Place {
    std::string root, project;
  };

  void add(std::span<const SourceFile> files);
  std::size_t node_at(std::string_view path) const;
  /// In full, or by its path inside of a project that is not the suite.
  std::size_t node_in(const Place& place, std::string_view path) const;
  /// More than one if projects have files of one name.
  std::set<std::size_t> candidates(std::string_view path) const;
  std::string why_not(const std::string& root) const;
  std::size_t find_node(std::string_view path) const;
  /// Marks what the roots reach.
  void reach(const Sources& sources, std::vector<bool>& found) const;

  std::string foundation_;
  std::vector<Node> nodes_;  ///< ascending in their paths
  std::vector<Place> places_;
};

/// Of this build.
const SourceGraph& project_sources();

/// Is a stage of a program or plug-in that uses the installed suite?
bool is_from_outside(const Stage& stage);

/// A file as a compiler names it, by its path from the root of the suite's
/// sources or of the project that it is of; of others, its name alone.
std::string source_name(const std::string& path);

/// What the stages of a method up to `position` come from, each its problem,
/// the networks that it may use, and what it names itself.
std::vector<Sources> chain_sources(const Experiment& experiment,
                                   const Method& method,
                                   std::size_t position);

}  // namespace physinv
