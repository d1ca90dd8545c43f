/// What the user sees while a campaign runs: on a terminal a bar and a live
/// table, redrawn at most ten times a second; elsewhere one line per stage,
/// under heads. The time left is estimated from declared operations and the
/// rate measured so far, not from a count of cases.
#pragma once

#include <deque>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "suite/harness/case.h"
#include "suite/harness/screen.h"

namespace physinv {

/// Operations per second, by stage name, from what has finished.
class Rates {
 public:
  void add(const std::string& stage, double operations, double seconds);
  /// Expected seconds; negative if nothing is known yet.
  double seconds(const std::string& stage, double operations) const;

 private:
  struct Sum {
    double operations = 0, seconds = 0;
  };
  std::map<std::string, Sum> by_stage_;
  Sum all_;
};

class Progress {
 public:
  Progress(const Screen& screen, const std::vector<Case>& cases, int jobs);
  ~Progress() { clear(); }

  /// A stage that need not run.
  void reused(std::size_t case_index, Index position);
  void started(std::size_t worker, std::size_t case_index, Index position);
  void report(std::size_t worker, Index iteration, double loss);
  void finished(std::size_t worker,
                std::size_t case_index,
                const StageRecord& record);
  void idle(std::size_t worker);
  /// A line that stays.
  void say(const std::string& line);

  /// Redraws if it is time to.
  void draw();
  /// Removes the live part.
  void clear();

  /// Seconds left, negative if unknown.
  double remaining() const;

 private:
  struct Running {
    bool active = false;
    std::size_t case_index = 0;
    Index position = 0, iteration = 0;
    double loss = 0, since = 0;
    bool has_loss = false;
  };
  std::string bar() const;
  std::string running_row(const Running& r, double now) const;
  std::string finished_row(const StageRecord& record, const Case& c) const;
  std::string head(std::string_view loss) const;
  /// A line of a finished stage, where nothing is redrawn; heads before the
  /// first.
  void put_line(const std::string& row, const StageRecord& record);
  std::size_t name_width() const;
  /// A campaign does not end because its progress cannot be written: an error
  /// stays in the stream, for the code that prints the result.
  void put(const std::string& text) const;

  Screen screen_;
  const std::vector<Case>& cases_;
  int jobs_;
  Rates rates_;
  std::vector<std::vector<bool>> done_;
  std::size_t stages_ = 0, stages_done_ = 0;
  double operations_ = 0, operations_done_ = 0;
  std::vector<Running> running_;
  std::deque<std::string> recent_;
  double begin_, drawn_ = 0;
  int lines_ = 0;
  bool headed_ = false;
};

/// How a stage ended, for its line: `stationary` if it converged at a loss
/// above kSolvedByDefault, for example on a plateau; else the word of `stop`.
std::string_view end_of(Stop stop, double loss);

/// "3.4 s", "2 min 5 s", "1 h 10 min"; "?" if it is not finite.
std::string duration_text(double seconds);

}  // namespace physinv
