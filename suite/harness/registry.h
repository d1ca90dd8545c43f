/// What is registered, and the cases it expands to.
///
///   void register_all(Registry& r) {
///     r.add(Experiment{.name = "jpo/billiards", ...});
///     r.add_claims("jpo/billiards", paper_claims());
///   }
///
/// Registering stores a recipe and judges nothing. A test and `list --validate`
/// call `validate`; a run looks at its own experiments (registry_errors.h).
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "suite/harness/case.h"

namespace physinv {

/// Keys of the rows that the command line replaces.
struct Overrides {
  std::optional<std::vector<std::string>> methods;
  std::optional<std::vector<Index>> n;
  std::optional<std::vector<std::uint64_t>> seeds;
  std::optional<Index> iterations;
  std::optional<Precision> precision;
};

class Registry {
 public:
  using Experiments = std::vector<std::shared_ptr<const Experiment>>;

  void add(Experiment experiment);
  void add(Overview overview);
  /// What is registered in other files than its experiment, in either order.
  void add_claims(const std::string& experiment, std::vector<Claim> claims);
  void add_report(const std::string& experiment, Report report);
  const Experiments& experiments() const { return experiments_; }
  const std::vector<Overview>& overviews() const { return overviews_; }
  /// Null if there is none of this name.
  std::shared_ptr<const Experiment> find(std::string_view name) const;

  /// Everything wrong with what is registered, one line each: names, rows that
  /// name unknown methods, methods that need what a problem does not provide,
  /// claims that name what is not there or never runs.
  std::vector<std::string> problems() const;
  /// Printed values that claims name and the papers' files lack.
  std::vector<std::string> unknown_printed(const Published& published) const;
  /// Throws std::logic_error with the lines of `problems`, if any.
  void validate() const;

  /// Names of all profiles, in the order that experiments have them, as far as
  /// they agree.
  std::vector<std::string> profiles() const;

  /// The cases of a profile in declared order (experiment, row, n, method,
  /// seed), duplicates once. Content keys are still empty. Throws UsageError
  /// for an unknown profile or method and for a value that cannot be.
  std::vector<Case> expand(std::string_view profile,
                           const Overrides& overrides = {}) const;

 private:
  /// To add what other files register; null if none has this name.
  Experiment* registered(const std::string& name);

  Experiments experiments_;
  std::vector<Overview> overviews_;
  /// Of experiments that are not there yet.
  std::map<std::string, std::vector<Claim>> claims_;
  std::map<std::string, Report> reports_;
};

/// The program's registry; safe to use while statics are initialised.
Registry& registry();

/// What a program is over: every program defines it, the suite's in
/// suite/cases/common, and its main calls it once for `registry()`.
void register_all(Registry& registry);

/// For sources of others, which register when the program or plug-in is loaded;
/// returns true:
///
///   const bool kRegistered = register_experiment({.name = "pendulum", ...});
bool register_experiment(Experiment experiment);

/// "forward|vjp"
std::string to_text(Needs needs);

}  // namespace physinv
