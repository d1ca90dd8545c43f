#include "suite/harness/campaign.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "suite/core/clock.h"
#include "suite/harness/columns.h"
#include "suite/harness/context.h"
#include "suite/harness/core_shares.h"
#include "suite/harness/keys.h"
#include "suite/harness/progress.h"
#include "suite/harness/revision.h"
#include "suite/harness/run_case.h"
#include "suite/harness/standstill.h"
#include "suite/harness/stop_signal.h"
#include "suite/harness/workers.h"
#include "suite/store/errors.h"
#include "suite/store/store.h"

namespace physinv {
namespace {

constexpr auto kNobody = std::numeric_limits<std::size_t>::max();

/// How long a signal to stop waits for stages to lay their state down; of a
/// budget of seconds less, as it is to be kept.
constexpr double kPatience = 3, kLeastPatience = 0.2, kPatienceOfBudget = 0.05;

/// How often a case is started whose worker is killed.
constexpr int kTries = 3;

constexpr std::string_view kGoingOn = "resuming {} {} from iteration {}";

/// The beginning of the chain that the store holds. Stages that failed or
/// were skipped are run again. With `among`, only stages that these cases ran.
std::vector<StageRecord> stored_stages(
    const Store& store,
    const Case& c,
    const std::set<std::string>* among = nullptr) {
  std::vector<StageRecord> found;
  for (const auto& key : c.info.keys) {
    auto record = store.find(key, among);
    if (!record || record->stop == Stop::failed ||
        record->stop == Stop::skipped)
      break;
    found.push_back(std::move(*record));
  }
  return found;
}

class Campaign {
 public:
  Campaign(Prepared prepared,
           const CampaignOptions& options,
           const nlohmann::json& options_json,
           const Screen& screen)
      : begin_(now().wall),
        options_(options),
        cases_(std::move(prepared.cases)),
        data_(std::move(prepared.data)),
        errors_(std::move(prepared.errors)),
        revision_(git_revision()),
        store_(options.out, {.break_lock = options.break_lock}),
        progress_(screen, cases_, options.jobs),
        still_(options.still_seconds),
        shares_(options.jobs * options.threads, options.share_seconds) {
    data_cpu_ = result_.data_cpu = prepared.data_cpu;
    context_ = machine_context(revision_);
    context_["options"] = options_json;
    for (const Case& c : cases_) names_.insert(c.info.name);
  }

  CampaignResult run() {
    const StopSignalWatch watch;
    plan();
    if (!store_.warning().empty()) progress_.say(store_.warning());
    say_reused();
    try {
      if (!queue_.empty() && stop_signals() == 0) work();
    } catch (...) {
      store_.commit();  // what has finished is kept
      throw;
    }
    progress_.clear();
    result_.interrupted = stop_signals() != 0;
    for (const std::size_t i : queue_)
      result_.not_run.push_back(cases_[i].info.name);
    finish();
    return std::move(result_);
  }

 private:
  /// Sorts the cases into those to run and those the store already holds.
  void plan() {
    if (!options_.resume) forget();
    std::vector<CaseInfo> infos;
    for (const Case& c : cases_) infos.push_back(c.info);
    store_.set_plan(
        infos,
        context_,
        options_.campaign.empty() ? planned(cases_) : options_.campaign);
    for (std::size_t i = 0; i < cases_.size(); ++i) {
      if (!errors_[i].empty()) {
        lose(i, 0, "data: " + errors_[i]);
        continue;
      }
      const std::size_t stages = take_stored(i).size();
      if (stages == cases_[i].info.stages.size()) continue;
      queue_.push_back(i);
      find_state(i, static_cast<Index>(stages), kGoingOn);
    }
  }

  void forget() {
    store_.forget(names_);
    for (const Case& c : cases_)
      for (const auto& key : c.info.keys) store_.drop_state(key);
  }

  /// Is the next stage of a case half done? `words` say so. What is damaged is
  /// removed.
  void find_state(std::size_t i, Index position, std::string_view words) {
    const CaseInfo& info = cases_[i].info;
    const auto stage = static_cast<std::size_t>(position);
    if (stage >= info.stages.size()) return;
    try {
      const auto state = store_.state(info.keys[stage]);
      if (!state) return;
      progress_.say(fmt::format(fmt::runtime(words),
                                info.name,
                                info.stages[stage],
                                state->iteration));
      restored_[i] = static_cast<Index>(stage);
    } catch (const StoreError& error) {
      progress_.say(error.what());
      store_.drop_state(info.keys[stage]);
    }
  }

  /// What the store has of a case; a stage that another case ran is entered
  /// for this one too.
  std::vector<StageRecord> take_stored(std::size_t i) {
    auto found =
        stored_stages(store_, cases_[i], options_.resume ? nullptr : &names_);
    for (std::size_t k = 0; k < found.size(); ++k) {
      StageRecord& record = found[k];
      note_end(i, record);
      if (counted_.insert({i, k}).second) {
        ++result_.stages_reused;
        ++result_.origins[{record.finished.substr(0, 10), record.revision}];
        progress_.reused(i, static_cast<Index>(k));
        if (record.case_name != cases_[i].info.name) {
          record.case_name = cases_[i].info.name;
          store_.add(cases_[i].info, data_[i], record);
        }
      }
    }
    return found;
  }

  void say_reused() {
    if (result_.stages_reused > 0)
      progress_.say(fmt::format(
          "reusing {} finished stages: {} (--fresh runs them again)",
          result_.stages_reused,
          to_text(result_.origins)));
  }

  void work() {
    const auto count = std::min<std::size_t>(
        static_cast<std::size_t>(options_.jobs), queue_.size());
    const int used =
        options_.share_cores ? options_.jobs : static_cast<int>(count);
    Workers workers(cases_,
                    count,
                    options_.threads,
                    {.crowded = used * options_.threads > available_cores(),
                     .trace = options_.trace,
                     .disturb = options_.disturb,
                     .revision = revision_,
                     .checkpoints = {.store = options_.out,
                                     .seconds = options_.checkpoint_seconds}});
    if (count > 1 && !options_.order)
      queue_ = largest_first(std::move(queue_), work_left());
    while (stop_signals() == 0) {
      hand_out(workers);
      if (running_.empty()) break;
      // Workers are at work meanwhile.
      if (store_.is_due(std::min(kCommitSeconds, options_.checkpoint_seconds)))
        store_.commit();
      for (auto& event : workers.wait(0.1)) handle(event);
      resume_left(workers);
      share_cores(workers);
      name_still(workers);
      progress_.draw();
    }
    if (stop_signals() != 0) wind_up(workers);
    for (const auto& [worker, index] : running_) queue_.push_back(index);
  }

  /// Declared operations of the stages that are left of each case.
  std::vector<double> work_left() const {
    std::vector<double> left(cases_.size());
    for (const std::size_t i : queue_) {
      const Case& c = cases_[i];
      for (std::size_t k = c.info.stages.size();
           k-- > 0 && !counted_.contains({i, k});)
        left[i] += c.operations(k);
    }
    return left;
  }

  /// What arrives is kept. A second signal does not wait.
  void wind_up(Workers& workers) {
    const auto under_way = running_;
    workers.dismiss();
    const double patience =
        options_.time_budget > 0
            ? std::clamp(kPatienceOfBudget * options_.time_budget,
                         kLeastPatience,
                         kPatience)
            : kPatience;
    const double end = now().wall + patience;
    do {
      for (auto& event : workers.wait(0.1)) handle(event);
    } while (workers.busy() && now().wall < end && stop_signals() == 1);
    for (const auto& [worker, index] : under_way)
      find_state(index, positions_[worker], "saved {} {} at iteration {}");
  }

  bool out_of_time() const {
    return options_.time_budget > 0 && spent() > options_.time_budget;
  }

  double spent() const { return now().wall - begin_; }

  /// Would a case that starts now end within the budget?
  bool fits(std::size_t i) const {
    return options_.time_budget <= 0 || options_.expected_seconds.empty() ||
           spent() + options_.expected_seconds[i] <= options_.time_budget;
  }

  void hand_out(Workers& workers) {
    for (std::size_t w = 0; w < workers.count() && !out_of_time(); ++w) {
      if (!workers.idle(w)) continue;
      if (options_.order) queue_ = options_.order(std::move(queue_), finished_);
      const auto next =
          std::find_if(queue_.begin(), queue_.end(), [&](std::size_t i) {
            return !shares_running(i) && fits(i);
          });
      if (next == queue_.end()) return;
      const std::size_t i = *next;
      queue_.erase(next);
      const auto earlier = take_stored(i);
      if (earlier.size() == cases_[i].info.stages.size()) {
        --w;  // another case has meanwhile run all of it
        continue;
      }
      running_[w] = i;
      positions_[w] = static_cast<Index>(earlier.size());
      submit(workers, w, earlier, options_.threads);
    }
  }

  /// The worker's case from here on.
  void submit(Workers& workers,
              std::size_t w,
              const std::vector<StageRecord>& earlier,
              int threads) {
    iterations_[w] = 0;
    shares_.submitted(w, threads);
    workers.submit(w, running_[w], earlier, threads);
    still_.moved(w, now().wall);
  }

  /// Does a case wait for a core?
  bool some_wait() const {
    return !out_of_time() &&
           std::any_of(queue_.begin(), queue_.end(), [&](std::size_t i) {
             return fits(i);
           });
  }

  /// Asks stages to save their state and leave, where cores are free for them.
  void share_cores(Workers& workers) {
    if (!options_.share_cores || some_wait()) return;
    for (const auto& [w, i] : running_) shares_.set_work_left(w, work_left(w));
    for (const std::size_t w : shares_.to_ask(now().wall))
      workers.ask_to_leave(w);
  }

  /// Cases that were left continue, in as many threads as there are cores for.
  void resume_left(Workers& workers) {
    for (const std::size_t w : std::exchange(left_, {})) {
      const std::size_t i = running_[w];
      const int threads = shares_.threads_for(w, now().wall);
      find_state(i,
                 positions_[w],
                 fmt::format("resuming {{}} {{}} from iteration {{}} in {} "
                             "threads",
                             threads));
      submit(workers, w, take_stored(i), threads);
    }
  }

  /// Declared operations of what is left of a worker's case.
  double work_left(std::size_t w) const {
    const Case& c = cases_[running_.at(w)];
    const auto at = static_cast<std::size_t>(positions_.at(w));
    const std::size_t stages = c.info.stages.size();
    if (at >= stages) return 0;
    double left = 0;
    for (std::size_t k = at; k < stages; ++k) left += c.operations(k);
    const auto all = static_cast<double>(c.stage_iterations[at]);
    const auto done = static_cast<double>(iterations_.at(w));
    return left - c.operations(at) * done / std::max(all, 1.0);
  }

  /// Two cases with the same first stages do not run them at the same time.
  bool shares_running(std::size_t i) const {
    return std::any_of(running_.begin(), running_.end(), [&](const auto& r) {
      return cases_[r.second].info.keys.front() == cases_[i].info.keys.front();
    });
  }

  void handle(WorkerEvent& event) {
    using Kind = WorkerEvent::Kind;
    still_.moved(event.worker, now().wall);
    switch (event.kind) {
      case Kind::stage_started:
        positions_[event.worker] = event.position;
        iterations_[event.worker] = 0;
        if (!stays_.contains(event.case_index))
          shares_.started(event.worker, now().wall);
        progress_.started(event.worker, event.case_index, event.position);
        break;
      case Kind::progress:
        iterations_[event.worker] = event.iteration;
        progress_.report(event.worker, event.iteration, event.loss);
        break;
      case Kind::stage_done:
        positions_[event.worker] = event.position + 1;
        progress_.finished(event.worker, event.case_index, event.record);
        keep(event.case_index, event.record);
        break;
      case Kind::case_done:
        overhead_ += event.overhead;
        end_case(event.worker);
        break;
      case Kind::left:
        left_.push_back(event.worker);
        break;
      case Kind::died:
        progress_.idle(event.worker);
        end_case(event.worker);
        stays_.insert(event.case_index);  // more threads take more memory
        if (stop_signals() != 0) {
          queue_.push_back(event.case_index);
        } else if (starts_again(event)) {
          // In the queue, without its state.
        } else if (event.killed && ++tries_[event.case_index] < kTries) {
          try_again(event);
        } else {
          lose(event.case_index, positions_[event.worker], event.message);
        }
        break;
    }
  }

  void end_case(std::size_t worker) {
    running_.erase(worker);
    still_.idle(worker);
    shares_.ended(worker);
  }

  /// A worker that waits for what never comes is not waited for in silence.
  void name_still(const Workers& workers) {
    const double t = now().wall;
    for (const auto& [worker, index] : running_) {
      const pid_t process = workers.process(worker);
      if (!still_.found(worker, t, cpu_seconds(process))) continue;
      const CaseInfo& info = cases_[index].info;
      const auto stage = static_cast<std::size_t>(positions_[worker]);
      progress_.say(
          fmt::format("{} {}: its worker made no progress and used no CPU time "
                      "for {:g} s; it waits for another program, or hangs in a "
                      "lock (kill -ABRT {} fails the stage)",
                      info.name,
                      info.stages[std::min(stage, info.stages.size() - 1)],
                      still_.seconds(),
                      process));
    }
  }

  void try_again(const WorkerEvent& event) {
    progress_.say(fmt::format("{}: {}; trying again",
                              cases_[event.case_index].info.name,
                              event.message));
    find_state(event.case_index, positions_[event.worker], kGoingOn);
    queue_.insert(queue_.begin(), event.case_index);
  }

  RunContext run_context(std::size_t i) const {
    return {.profile = cases_[i].info.profile,
            .host = context_.value("host_name", ""),
            .processor = context_.value("cpu_model", ""),
            .instruction_set = context_.value("instruction_set", ""),
            .threads = options_.threads,
            .jobs = options_.jobs};
  }

  void keep(std::size_t i, StageRecord& record) {
    std::string changes = std::move(record.run.thread_changes);
    record.run = run_context(i);
    record.run.thread_changes = std::move(changes);
    store_.add(cases_[i].info, data_[i], record);
    counted_.insert({i, static_cast<std::size_t>(record.position)});
    ++result_.stages_run;
    note_end(i, record);
    result_.stage_cpu += record.clocks.total().cpu;
    result_.evaluation += record.clocks.measure.cpu;
    result_.data_cpu += record.clocks.data.cpu;
    if (record.stop == Stop::failed)
      result_.failed.push_back(fmt::format(
          "{} {}: {}", record.case_name, record.stage, record.message));
  }

  void note_end(std::size_t i, const StageRecord& record) {
    const auto stages = static_cast<Index>(cases_[i].info.stages.size());
    if (record.position + 1 == stages && has_result(record))
      finished_[i] = median_finite(record.loss);
  }

  /// A stage that crashed when it went on from a state tries without, once.
  bool starts_again(const WorkerEvent& event) {
    const std::size_t i = event.case_index;
    const auto at = restored_.find(i);
    if (at == restored_.end() || !event.crashed ||
        at->second != positions_[event.worker])
      return false;
    const CaseInfo& info = cases_[i].info;
    const auto stage = static_cast<std::size_t>(at->second);
    progress_.say(fmt::format(
        "{} {} cannot resume from its checkpoint ({}); it starts again",
        info.name,
        info.stages[stage],
        event.message));
    store_.drop_state(info.keys[stage]);
    restored_.erase(at);
    queue_.push_back(i);
    return true;
  }

  /// The stage at `position` failed without a record; those after it are
  /// skipped.
  void lose(std::size_t i, Index position, const std::string& message) {
    const Case& c = cases_[i];
    const auto stages = static_cast<Index>(c.info.stages.size());
    for (Index k = position; k < stages; ++k) {
      const bool first = k == position;
      const auto& cause = c.info.stages[static_cast<std::size_t>(position)];
      auto record = lost_stage(c,
                               k,
                               first ? Stop::failed : Stop::skipped,
                               first ? message : cause + " failed",
                               revision_);
      progress_.finished(kNobody, i, record);
      keep(i, record);
    }
  }

  void finish() {
    store_.commit();
    note_bookkeeping();
    context_["bookkeeping_ms"] = 1e3 * result_.bookkeeping;
    context_["data_ms"] = 1e3 * result_.data_cpu;
    context_["waiting_ms"] = 1e3 * result_.waiting;
    context_["evaluation_ms"] = 1e3 * result_.evaluation;
    context_["stages_cpu_ms"] = 1e3 * result_.stage_cpu;
    context_["wall_ms"] = 1e3 * (now().wall - begin_);
    context_["stages_run"] = result_.stages_run;
    context_["stages_reused"] = result_.stages_reused;
    store_.set_context(context_);
    result_.cases = store_.finish();
    note_bookkeeping();
    result_.seconds = now().wall - begin_;
  }

  /// Bookkeeping is what this process does, except drawing data, and what the
  /// workers do outside of stages. Waiting for the disk costs no CPU, and the
  /// workers nothing unless they have nothing to do.
  void note_bookkeeping() {
    const Seconds commits = store_.commit_time();
    result_.bookkeeping = now().cpu - data_cpu_ + overhead_;
    result_.cpu = result_.bookkeeping + data_cpu_ + result_.stage_cpu;
    result_.waiting = commits.wall - commits.cpu;
  }

  double begin_;
  const CampaignOptions& options_;
  std::vector<Case> cases_;
  std::vector<CaseData> data_;
  std::vector<std::string> errors_;
  std::string revision_;
  std::set<std::string> names_;  // of the cases
  Store store_;
  Progress progress_;
  Standstill still_;
  CoreShares shares_;
  nlohmann::json context_;
  CampaignResult result_;
  std::vector<std::size_t> queue_;              // cases not handed out yet
  std::map<std::size_t, std::size_t> running_;  // worker -> case
  std::map<std::size_t, Index> positions_;      // worker -> stage
  std::map<std::size_t, Index> iterations_;     // worker -> done of the stage
  std::vector<std::size_t> left_;               // workers whose case was left
  std::set<std::size_t> stays_;                 // cases that keep their threads
  std::map<std::size_t, Index> restored_;       // case -> stage with a state
  std::set<std::pair<std::size_t, std::size_t>> counted_;  // reused stages
  std::map<std::size_t, int> tries_;        // of cases whose worker was killed
  std::map<std::size_t, double> finished_;  // final median loss of a case
  double data_cpu_ = 0;  // CPU seconds of drawing the cases' data
  double overhead_ = 0;  // CPU seconds of workers outside of stages
};

}  // namespace

void dry_run(const Prepared& prepared,
             const CampaignOptions& options,
             const Screen& screen) {
  std::optional<Store> store;
  if (options.resume && Store::exists(options.out))
    store.emplace(Store::read_only(options.out));
  double all = 0, left = 0;
  std::size_t run = 0, reused = 0;
  Columns table({"<", "<case", "<stage", "operations", "<has run"});
  for (const Case& c : prepared.cases) {
    const auto found =
        store ? stored_stages(*store, c) : std::vector<StageRecord>();
    for (std::size_t k = 0; k < c.info.stages.size(); ++k) {
      const bool have = k < found.size();
      all += c.operations(k);
      have ? ++reused : (left += c.operations(k), ++run);
      table.add({have ? "reuse" : "run",
                 c.info.name,
                 c.info.stages[k],
                 fmt::format("{:.2g}", c.operations(k)),
                 have ? fmt::format("{} at {}, profile {}",
                                    found[k].finished,
                                    found[k].revision,
                                    profile_of({.info = c.info}, found[k]))
                      : ""});
    }
  }
  fmt::print(screen.stream,
             "{}{} cases: {} stages to run, {} to reuse; {:.3g} of {:.3g} "
             "declared operations left\n",
             table.text(screen.room()),
             prepared.cases.size(),
             run,
             reused,
             left,
             all);
}

std::vector<std::size_t> largest_first(std::vector<std::size_t> queue,
                                       const std::vector<double>& work) {
  std::stable_sort(queue.begin(), queue.end(), [&](auto a, auto b) {
    return work[a] > work[b];
  });
  return queue;
}

CampaignResult run_campaign(Prepared prepared,
                            const CampaignOptions& options,
                            const nlohmann::json& options_json,
                            const Screen& screen) {
  return Campaign(std::move(prepared), options, options_json, screen).run();
}

}  // namespace physinv
