// Bookkeeping: what a campaign costs in addition to its stages.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <filesystem>
#include <string>

#include "suite/harness/keys.h"
#include "suite/harness/registry.h"
#include "suite/store/json.h"
#include "suite/store/store.h"

namespace physinv {
namespace {

/// A record of the size a network fit of 128 examples leaves.
StageRecord typical_record() {
  const Index n = 128, points = 64;
  StageRecord r;
  r.case_name = "jpo/billiards/jpo/n=128/seed=0";
  r.stage = "fit";
  r.key = std::string(32, 'a');
  r.x = Batch<double>::Random(2, n);
  r.loss = Vector<double>::Random(n);
  r.status.assign(n, Status::maxiter);
  r.example_iterations = r.example_evaluations = Vector<double>::Ones(n);
  r.curve.iteration.assign(points, 1.0);
  r.curve.seconds = r.curve.evaluations = r.curve.iteration;
  r.curve.loss = Batch<double>::Random(n, points);
  r.curve.x = Batch<double>::Random(8, points);
  return r;
}

void bm_wire(benchmark::State& state) {
  const StageRecord record = typical_record();
  for (auto _ : state) benchmark::DoNotOptimize(from_wire(to_wire(record)));
}
BENCHMARK(bm_wire)->Name("harness/record_over_pipe");

/// A finished stage on disk: arrays, journal line, three flushes.
void bm_append(benchmark::State& state) {
  const PassingStore passing(std::filesystem::temp_directory_path());
  Store store(passing.path());
  StageRecord record = typical_record();
  CaseInfo info{.name = record.case_name,
                .experiment = "jpo/billiards",
                .method = "jpo",
                .profile = "quick",
                .n = 128,
                .stages = {"fit"},
                .keys = {record.key}};
  CaseData data{.hash = "0", .x = record.x, .y = record.x, .given = record.x};
  int i = 0;
  for (auto _ : state) {
    record.key = info.keys[0] = fmt::format("{:032x}", i++);
    record.case_name = info.name = "case-" + record.key;
    store.append(info, data, record);
  }
}
BENCHMARK(bm_append)->Name("harness/store_append")->Iterations(200);

void bm_expand(benchmark::State& state) {
  if (registry().experiments().empty()) register_all(registry());
  for (auto _ : state) {
    for (const Case& c : registry().expand("quick"))
      benchmark::DoNotOptimize(content_keys(c, "data", numerics_of_build));
  }
}
BENCHMARK(bm_expand)->Name("harness/expand_and_keys");

}  // namespace
}  // namespace physinv
