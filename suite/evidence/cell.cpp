#include "suite/evidence/cell.h"

#include <fmt/format.h>

#include <cmath>

#include "suite/evidence/failures.h"
#include "suite/evidence/statistics.h"
#include "suite/results/crowded.h"

namespace physinv {
namespace {

std::string why_missing(const Measured& measured) {
  const std::string failed = failed_part(measured.missing);
  return failed.empty() ? kNotRun : failed;
}

}  // namespace

Cell cell_of(std::optional<double> value, const char* otherwise) {
  if (!value) return {.text = otherwise};
  return {.ours = value};
}

Cell cell_of(std::span<const double> values, const char* otherwise) {
  const auto found = mean_std(values);
  if (!found) return {.text = otherwise};
  return {.ours = found->mean, .spread = found->std};
}

Cell cell_of(const Measured& measured) {
  if (!measured.value) return {.text = why_missing(measured)};
  return {.ours = measured.value, .spread = measured.spread};
}

Cell written(std::optional<double> value,
             const char* format,
             const char* otherwise) {
  if (!value) return {.text = otherwise};
  if (!std::isfinite(*value)) return {.text = "not finite"};
  return {.ours = value, .text = fmt::format(fmt::runtime(format), *value)};
}

Cell written(const Measured& measured, const char* format) {
  return written(measured.value, format, why_missing(measured).c_str());
}

Cell beside_printed(Cell cell,
                    const Evidence& evidence,
                    const std::string& quantity) {
  if (const auto found =
          find_printed(evidence.published, evidence.experiment, quantity))
    cell.paper = found->value, cell.paper_spread = found->spread;
  return cell;
}

std::optional<double> TimedStages::seconds(const StageRecord& stage) {
  ++stages_;
  const bool changed = !stage.run.thread_changes.empty();
  changed_ += changed;
  crowded_ += stage.crowded && !changed;
  return seconds_to_tell(stage);
}

std::string TimedStages::note() const {
  std::string text =
      "Times are CPU times of solving, or wall times if several threads ran.";
  if (crowded_ > 0)
    text += fmt::format(
        " {} of {} stages shared their cores (crowded); those with several "
        "threads are left out.",
        crowded_,
        stages_);
  if (changed_ > 0)
    text += fmt::format(
        " {} of {} stages changed their number of threads; their times are CPU "
        "times.",
        changed_,
        stages_);
  return text;
}

}  // namespace physinv
