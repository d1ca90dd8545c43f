#include "suite/planning/trials.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "suite/core/hash.h"
#include "suite/core/probe.h"
#include "suite/harness/build_info.h"
#include "suite/harness/context.h"
#include "suite/harness/keys.h"
#include "suite/harness/processor.h"
#include "suite/harness/registry.h"
#include "suite/harness/run_case.h"
#include "suite/store/folder.h"
#include "suite/store/json.h"

namespace physinv {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

/// A trial takes about this long where its iterations can be cut.
constexpr double kSeconds = 0.15;
constexpr Index kFirstIterations = 16;
/// Seconds and bytes beyond all reason.
constexpr double kLargest = 1e15;

double bytes(const Batch<double>& b) {
  return 8.0 * static_cast<double>(b.size());
}

/// `cut` ran in place of `c`. A stage that did not end by itself would continue
/// to its last iteration at the same speed.
StageTrial trial_of(const Case& c, const Case& cut, const StageRecord& r) {
  const auto at = static_cast<std::size_t>(r.position);
  const bool ended = r.iterations < cut.stage_iterations[at];
  const double points = std::max(1.0, static_cast<double>(r.curve.points()));
  StageTrial t;
  t.n = static_cast<double>(c.info.n);
  t.seconds = r.clocks.solve.cpu + r.clocks.data.cpu;
  if (!ended) t.seconds *= c.operations(at) / cut.operations(at);
  t.points = ended ? points : curve_points(c.stage_iterations[at]);
  t.setup = r.clocks.setup.cpu + r.clocks.warmup.cpu;
  t.measure = r.clocks.measure.cpu * t.points / points;
  t.memory = static_cast<double>(r.buffer_bytes);
  t.kept = bytes(r.x) + 32.0 * static_cast<double>(r.loss.size()) +
           t.points * 24 +
           (bytes(r.curve.loss) + bytes(r.curve.x)) * t.points / points;
  for (const auto& [name, array] : r.arrays) t.kept += bytes(array);
  return t;
}

/// Fewer stages than the chain has if one failed.
struct Ran {
  Trial trial;
  std::vector<double> each;  ///< seconds of an iteration
};

Ran run_trial(const Case& c, const Case& cut) {
  Ran ran;
  bool good = true;
  Threads threads(1);
  const auto keep = [&](const StageRecord& r) {
    good = good && has_result(r);
    if (!good) return;
    ran.trial.push_back(trial_of(c, cut, r));
    ran.each.push_back(r.clocks.solve.cpu /
                       std::max(1.0, static_cast<double>(r.iterations)));
  };
  run_case(
      cut, {}, {}, &threads, {.started = {}, .progress = {}, .finished = keep});
  return ran;
}

/// Does the counted work of a stage follow its iterations?
bool follows_iterations(const Case& c, std::size_t stage) {
  auto half = c.stage_iterations;
  half[stage] = std::max<Index>(1, half[stage] / 2);
  return resized(c, c.info.n, half).operations(stage) < c.operations(stage);
}

bool trains(const Case& c) {
  for (std::size_t k = 0; k < c.info.stages.size(); ++k)
    if (follows_iterations(c, k)) return true;
  return false;
}

/// Where the work follows the iterations, at most so many.
Case with_fewer_iterations(const Case& c, const std::vector<Index>& most) {
  auto iterations = c.stage_iterations;
  for (std::size_t k = 0; k < iterations.size(); ++k)
    if (follows_iterations(c, k))
      iterations[k] = std::min(iterations[k], most[k]);
  return resized(c, c.info.n, iterations);
}

/// As many iterations as fit into kSeconds, by a first short run.
std::vector<Index> fitting(const std::vector<double>& each) {
  std::vector<Index> most;
  for (const double seconds : each)
    most.push_back(static_cast<Index>(
        std::clamp(kSeconds / std::max(seconds, 1e-9), 1.0, 1e6)));
  return most;
}

Trial measure_trial(const Case& c) {
  const std::size_t stages = c.info.stages.size();
  const std::vector<Index> few(stages, kFirstIterations);
  Ran first = run_trial(c, with_fewer_iterations(c, few));
  if (first.trial.size() < stages || !trains(c)) return first.trial;
  const Case longer = with_fewer_iterations(c, fitting(first.each));
  for (std::size_t k = 0; k < stages; ++k)
    if (follows_iterations(c, k) &&
        longer.stage_iterations[k] > 2 * kFirstIterations)
      return run_trial(c, longer).trial;
  return first.trial;
}

/// The chain up to the last stage whose work follows its iterations.
std::size_t training_stages(const Case& c) {
  std::size_t stages = 0;
  while (stages < c.info.stages.size() && follows_iterations(c, stages))
    ++stages;
  return stages;
}

json to_json(const StageTrial& t) {
  return {t.n, t.seconds, t.setup, t.measure, t.points, t.memory, t.kept};
}

/// std::exception if no trial reaches it.
StageTrial from_json(const json& j) {
  const std::vector<double> v = j;
  for (const double value : v)
    if (!(value >= 0 && value < kLargest))
      throw std::runtime_error("an impossible time or size");
  StageTrial t{v.at(0), v.at(1), v.at(2), v.at(3), v.at(4), v.at(5), v.at(6)};
  if (t.n < 1) throw std::runtime_error("a trial without samples");
  return t;
}

std::string key_of(const Case& c, bool training_only) {
  return hex128(recipe_text(c, c.info.stages.size() - 1)) +
         (training_only ? "-training" : "");
}

/// Named by a variable; a relative one means another place for each start.
fs::path named_directory(const char* name) {
  const fs::path path = variable(name);
  return path.is_absolute() ? path : fs::path();
}

}  // namespace

double curve_points(Index iterations) {
  Index points = 1;
  for (Index i = 0; i < iterations; i = next_measured(i)) ++points;
  return static_cast<double>(points);
}

std::map<std::string, Trial> parse_trials(std::string_view bytes,
                                          const fs::path& path) {
  std::map<std::string, Trial> known;
  json all;
  try {
    all = parse_json(bytes);
  } catch (const std::exception&) {
    return known;
  }
  try {
    for (const auto& [key, stages] : all.at("trials").items()) {
      if (!stages.is_array()) throw std::runtime_error("no list of stages");
      for (const json& stage : stages) known[key].push_back(from_json(stage));
    }
    return known;
  } catch (const std::exception& e) {
    throw StoreError(
        fmt::format("{} contains invalid measurements: {} (delete it: the "
                    "speeds are measured again)",
                    path.string(),
                    e.what()));
  }
}

Trials::Trials(fs::path file) : file_(std::move(file)) {
  std::error_code error;
  const fs::path folder = file_.parent_path();
  if (folder.empty() || !fs::is_directory(folder, error)) return;
  const Folder cache(folder);
  if (cache.has(file_.filename()))
    known_ = parse_trials(cache.read(file_.filename(), kLargestText), file_);
}

fs::path Trials::default_file() {
  const fs::path cache = named_directory("XDG_CACHE_HOME");
  const fs::path home = named_directory("HOME");
  if (cache.empty() && home.empty()) return {};
  const BuildInfo& build = build_info();
  return (cache.empty() ? home / ".cache" : cache) / "physinv" /
         fmt::format("speeds-{}.json",
                     hex64(hash_text(fmt::format("{} {} {} {}",
                                                 processor_name(),
                                                 build.instruction_set,
                                                 build.build_type,
                                                 build.fingerprint))));
}

std::string Trials::warning() const {
  return file_.empty() ? "measured speeds are not saved: neither "
                         "XDG_CACHE_HOME nor HOME is an absolute path"
                       : "";
}

const Trial* Trials::known(const Case& c, bool training_only) const {
  const auto at = known_.find(key_of(c, training_only));
  return at != known_.end() && at->second.size() <= c.info.stages.size()
             ? &at->second
             : nullptr;
}

const Trial& Trials::measured(const Case& c, bool training_only) {
  if (const Trial* found = known(c, training_only)) return *found;
  const std::string key = key_of(c, training_only);
  ++ran_;
  if (!training_only) return known_[key] = measure_trial(c);
  Method part = *c.method;
  const std::size_t stages = training_stages(c);
  part.chain.resize(stages);
  Case shorter = c;
  shorter.method = &part;
  shorter.info.stages.resize(stages);
  shorter.stage_iterations.resize(stages);
  return known_[key] = stages > 0 ? measure_trial(shorter) : Trial{};
}

void Trials::save() const {
  if (ran_ == 0 || file_.empty()) return;
  json all = json::object();
  for (const auto& [key, trial] : known_) {
    all[key] = json::array();
    for (const StageTrial& t : trial) all[key].push_back(to_json(t));
  }
  try {
    // The cache is the user's and may be a link, the folder in it is the
    // suite's and may not.
    const fs::path folder = file_.parent_path();
    make_directory(folder.parent_path());
    Folder(folder.parent_path())
        .make(folder.filename())
        .write(file_.filename(), json{{"trials", std::move(all)}}.dump());
  } catch (const std::exception&) {
  }
}

}  // namespace physinv
