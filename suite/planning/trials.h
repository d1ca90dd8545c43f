/// How fast this machine is: short runs of the chains that are to be planned,
/// kept in the user's cache directory for this processor and build.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace physinv {

struct Case;

/// What a short run says of one stage. Times are of the processor, so that
/// other load has little effect.
struct StageTrial {
  double n = 0;        ///< samples of the trial
  double seconds = 0;  ///< of solving; of a stage that was cut, as its counted
                       ///< operations continue
  double setup = 0;    ///< seconds, warm-up included
  double measure = 0;  ///< seconds, of the whole curve
  double points = 0;   ///< of the curve
  double memory = 0;   ///< bytes of buffers
  double kept = 0;     ///< bytes of estimates, curve and findings
};

/// Of the curve of so many iterations.
double curve_points(Index iterations);

/// The stages of one chain; fewer if the chain was not run to its end.
using Trial = std::vector<StageTrial>;

/// What a cache holds, by recipe: nothing if it is not JSON, StoreError with
/// `path` if it is of other types or values.
std::map<std::string, Trial> parse_trials(std::string_view bytes,
                                          const std::filesystem::path& path);

class Trials {
 public:
  /// Reads what is known, see parse_trials. Without a file all is forgotten.
  explicit Trials(std::filesystem::path file = default_file());
  /// In $XDG_CACHE_HOME or ~/.cache, by processor and build; empty if neither
  /// is named by an absolute path.
  static std::filesystem::path default_file();
  /// That there is no file, and why; else empty.
  std::string warning() const;

  /// Runs the chain of `c` for a moment, unless it has already. Stages whose
  /// work does not follow their iterations run whole, on few samples; with
  /// `training_only` they and all after them are left out.
  const Trial& measured(const Case& c, bool training_only);

  /// What is known of the same; null if nothing is.
  const Trial* known(const Case& c, bool training_only) const;

  /// Of those that ran now, not those known.
  std::size_t ran() const { return ran_; }
  /// Keeps what is new. A cache that cannot be written is not an error.
  void save() const;

 private:
  std::filesystem::path file_;
  std::map<std::string, Trial> known_;
  std::size_t ran_ = 0;
};

}  // namespace physinv
