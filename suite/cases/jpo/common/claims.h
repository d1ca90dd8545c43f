/// Building blocks of claims.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "suite/cases/jpo/common/metrics.h"
#include "suite/evidence/runs.h"
#include "suite/results/report_model.h"

namespace physinv {

/// Collects conditions and the numbers behind them; a number that is not there
/// makes the claim "not run", unless another condition already fails.
class Judge {
 public:
  /// `label value` must hold against the bounds, each optional.
  Judge& at_least(const std::string& label,
                  std::optional<double> value,
                  double bound) {
    return put(label, value, ">=", bound, value && *value >= bound);
  }
  Judge& at_most(const std::string& label,
                 std::optional<double> value,
                 double bound) {
    return put(label, value, "<=", bound, value && *value <= bound);
  }
  Judge& below(const std::string& label,
               std::optional<double> value,
               double bound) {
    return put(label, value, "<", bound, value && *value < bound);
  }
  Judge& above(const std::string& label,
               std::optional<double> value,
               std::optional<double> other) {
    if (!value || !other) return missing(label);
    return put(label, value, ">", *other, *value > *other);
  }
  /// A number without a condition.
  Judge& report(const std::string& label, std::optional<double> value) {
    if (!value) return missing(label);
    return say(fmt::format("{} {}", label, text(*value)));
  }
  /// A condition that could not be evaluated.
  Judge& missing(const std::string& what) {
    missing_ = true;
    return say(what + " not run");
  }

  ClaimResult result(std::string id,
                     std::string says,
                     std::string from,
                     bool gates = true) && {
    const Verdict verdict = !holds_    ? Verdict::not_reproduced
                            : missing_ ? Verdict::not_judged
                                       : Verdict::reproduced;
    return {.id = std::move(id),
            .says = std::move(says),
            .from = std::move(from),
            .gates = gates,
            .verdict = verdict,
            .evidence = std::move(evidence_)};
  }

 private:
  Judge& put(const std::string& label,
             std::optional<double> value,
             const char* relation,
             double bound,
             bool holds) {
    if (!value) return missing(label);
    holds_ = holds_ && holds;
    return say(fmt::format("{} {} ({} {}{})",
                           label,
                           text(*value),
                           relation,
                           text(bound),
                           holds ? "" : ": no"));
  }
  Judge& say(const std::string& words) {
    evidence_ += (evidence_.empty() ? "" : "; ") + words;
    return *this;
  }
  /// Shares need three digits, losses an exponent.
  static std::string text(double value) {
    const double size = std::abs(value);
    const bool plain = size == 0 || (size >= 1e-3 && size < 1e5);
    return plain ? fmt::format("{:.3f}", value) : fmt::format("{:.2e}", value);
  }

  bool holds_ = true, missing_ = false;
  std::string evidence_;
};

/// a / b, if both are there.
inline std::optional<double> ratio(std::optional<double> a,
                                   std::optional<double> b) {
  return a && b ? std::optional(*a / *b) : std::nullopt;
}

/// The sizes of a campaign within [first, last].
inline std::vector<Index> sizes_between(const JpoMetrics& metrics,
                                        Index first,
                                        Index last = kEvery) {
  std::vector<Index> out;
  for (const Index n : metrics.sizes())
    if (n >= first && n <= last) out.push_back(n);
  return out;
}

}  // namespace physinv
