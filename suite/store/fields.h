/// What records hold, member by member: of these lists JSON is made and read
/// (field_json.h), the messages between workers and parent, case files, hashes
/// and checks.
#pragma once

#include <array>
#include <concepts>
#include <stdexcept>
#include <string>
#include <string_view>

#include "suite/store/record.h"

namespace physinv {

/// The values of an enumeration; `to_string` has their words.
template <class E>
inline constexpr std::array<E, 0> kValues{};
template <>
inline constexpr std::array kValues<Status> = kStatuses;
template <>
inline constexpr std::array kValues<Stop>{Stop::converged,
                                          Stop::iterations,
                                          Stop::diverged,
                                          Stop::failed,
                                          Stop::skipped};
template <>
inline constexpr std::array kValues<Precision>{Precision::f32, Precision::f64};

/// std::runtime_error for the word of none.
template <class E>
E value_of(std::string_view word) {
  for (const E e : kValues<E>)
    if (to_string(e) == word) return e;
  throw std::runtime_error("unknown word '" + std::string(word) + "'");
}

template <class T, class Record>
concept MaybeConst = std::same_as<std::remove_const_t<T>, Record>;

/// Calls f(name, member) for each; f(name, member, true) where records of older
/// versions may lack it; an empty text or list of these is not written.
template <class F>
void each_field(MaybeConst<RunContext> auto& run, F&& f) {
  f("profile", run.profile);
  f("host", run.host);
  f("processor", run.processor);
  f("instruction_set", run.instruction_set);
  f("threads", run.threads);
  f("jobs", run.jobs);
  f("thread_changes", run.thread_changes, true);
}

template <class F>
void each_field(MaybeConst<Clocks> auto& clocks, F&& f) {
  f("setup", clocks.setup);
  f("warmup", clocks.warmup);
  f("data", clocks.data, true);
  f("solve", clocks.solve);
  f("measure", clocks.measure);
}

/// All but its arrays and repetitions.
template <class F>
void each_field(MaybeConst<StageRecord> auto& r, F&& f) {
  f("case", r.case_name);
  f("stage", r.stage);
  f("key", r.key);
  f("position", r.position);
  f("options", r.options);
  f("stop", r.stop);
  f("message", r.message);
  f("iterations", r.iterations);
  f("clocks", r.clocks);
  f("counts", r.counts);
  f("buffer_bytes", r.buffer_bytes);
  f("rss_bytes", r.rss_bytes);
  f("crowded", r.crowded);
  f("finished", r.finished);
  f("revision", r.revision);
  f("trajectory", r.trajectory);
  f("run", r.run, true);
}

/// All but `about`, which only the case file has.
template <class F>
void each_field(MaybeConst<CaseInfo> auto& info, F&& f) {
  f("name", info.name);
  f("experiment", info.experiment);
  f("method", info.method);
  f("profile", info.profile);
  f("n", info.n);
  f("seed", info.seed);
  f("precision", info.precision);
  f("stages", info.stages);
  f("keys", info.keys);
}

/// An array of a stage in the case file.
struct ArrayPlace {
  std::string_view name;  ///< "loss", or of the curve "curve/loss"
  std::string_view axes;  ///< what they count, the slowest first
  std::string_view unit;  ///< "1" for none, kUnknowns for that of the unknowns

  std::string name_text() const { return std::string(name); }
};
inline constexpr std::string_view kUnknowns = "unknowns";

/// Calls f(place, array) for each array in the order of their hash; after them
/// come the findings, under names of their own.
template <class F>
void each_array(MaybeConst<StageRecord> auto& r, F&& f) {
  using P = ArrayPlace;
  auto& c = r.curve;
  f(P{"x", "samples,unknowns", kUnknowns}, r.x);
  f(P{"loss", "samples", "1"}, r.loss);
  f(P{"status", "samples", ""}, r.status);
  f(P{"iterations", "samples", "1"}, r.example_iterations);
  f(P{"evaluations", "samples", "1"}, r.example_evaluations);
  f(P{"curve/iteration", "points", "1"}, c.iteration);
  f(P{"curve/seconds", "points", "s"}, c.seconds);
  f(P{"curve/evaluations", "points", "1"}, c.evaluations);
  f(P{"curve/loss", "points,samples", "1"}, c.loss);
  f(P{"curve/x", "points,samples,unknowns", kUnknowns}, c.x);
}

}  // namespace physinv
