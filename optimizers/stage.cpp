#include "optimizers/stage.h"

#include <iterator>

namespace physinv {
namespace {

class FactualStage final : public Stage {
 public:
  FactualStage(StageFacts facts, RunStage in_float, RunStage in_double)
      : Stage(facts.source),
        facts_(std::move(facts)),
        in_float_(std::move(in_float)),
        in_double_(std::move(in_double)) {}

  std::string name() const override { return facts_.name; }
  Needs needs() const override { return facts_.needs; }
  Options options() const override { return facts_.options(); }
  Index default_iterations() const override { return facts_.iterations; }
  bool takes_row_iterations() const override { return !facts_.own_length; }
  bool has_precision() const override { return in_float_ != nullptr; }
  Networks networks() const override { return facts_.networks; }
  Sources sources() const override {
    Sources all = Stage::sources();
    Sources own = facts_.sources();
    std::move(
        own.roots.begin(), own.roots.end(), std::back_inserter(all.roots));
    all.unused = std::move(own.unused);
    return all;
  }
  double operations(const CaseSize& size) const override {
    return facts_.operations(size);
  }
  Outcome run(StageRun& run) const override {
    const bool single = has_precision() && run.precision == Precision::f32;
    return single ? in_float_(run) : in_double_(run);
  }

 private:
  StageFacts facts_;
  RunStage in_float_, in_double_;
};

}  // namespace

std::shared_ptr<const Stage> make_stage(StageFacts facts,
                                        RunStage in_float,
                                        RunStage in_double) {
  return std::make_shared<FactualStage>(
      std::move(facts), std::move(in_float), std::move(in_double));
}

}  // namespace physinv
