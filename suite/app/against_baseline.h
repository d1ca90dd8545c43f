/// The part of `gate` that holds cases against a baseline.
#pragma once

#include <vector>

#include "suite/app/gate_flags.h"
#include "suite/gate/gate_report.h"
#include "suite/harness/select.h"

namespace physinv {

class AgainstBaseline {
 public:
  /// Throws if there is no such baseline, or nothing of it to judge.
  explicit AgainstBaseline(const GateFlags& flags);

  /// Runs the cases, or reads a campaign that did.
  void judge_stages(GateReport& report);
  /// Where the baseline has them and this build can count.
  void judge_instructions(GateReport& report);
  /// The new lines in the place of the old ones; what is gone goes. Counts
  /// that were not made anew, as on another processor, stay with their build.
  void renew();

  const Baseline& before() const { return before_; }
  const std::vector<Case>& cases() const { return cases_; }

 private:
  bool same_bits() const { return before_.bits == bits_text(); }
  bool same_build() const {
    return same_bits() && before_.build == build_text();
  }
  void require_something() const;
  std::vector<CountLine> countable() const;
  /// What the report says of counts that nobody compares.
  void leave_counts(const std::vector<CountLine>& lines,
                    const std::string& verdict,
                    const std::string& why,
                    GateReport& report) const;
  CountTable renewed_counts() const;

  const GateFlags& flags_;
  NameFilter filter_;
  Baseline before_;
  std::vector<Case> cases_;
  std::vector<StageLine> lines_, now_;  ///< of the baseline that match; of now
  CountTable counts_;
};

}  // namespace physinv
