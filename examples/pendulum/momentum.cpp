#include "momentum.h"

#include "suite/core/oracle.h"
#include "suite/core/probe.h"

namespace pendulum {
namespace {

class Momentum final : public Stage {
 public:
  explicit Momentum(const MomentumOptions& options) : options_(options) {}
  std::string name() const override { return "solve"; }
  Needs needs() const override { return Needs::forward | Needs::vjp; }
  Options options() const override { return describe(options_); }
  Index default_iterations() const override { return options_.iterations; }
  Networks networks() const override { return Networks::none; }
  double operations(const CaseSize& size) const override {
    return 3 * size.problem_operations *
           static_cast<double>(size.n * size.iterations);
  }
  /// The oracle hides the solutions and counts; the probe keeps the clock and
  /// measures the curve while it stands still.
  Outcome run(StageRun& run) const override {
    Batch<double> x = run.oracle.start(),
                  v = Batch<double>::Zero(x.rows(), x.cols()),
                  gradient(x.rows(), x.cols());
    Vector<double> loss(x.cols());
    while (run.probe.proceed([&](BatchOut<double> out) { out = x; })) {
      run.oracle.evaluate<double>(run.oracle.all(), x, loss, gradient);
      v = options_.momentum * v - options_.rate * gradient;
      x += v;
      run.probe.trace(x.data(),
                      static_cast<std::size_t>(x.size()) * sizeof(double));
    }
    Outcome out;
    out.x = std::move(x);
    return out;
  }

 private:
  MomentumOptions options_;
};

}  // namespace

std::shared_ptr<const Stage> momentum_solve(const MomentumOptions& options) {
  return std::make_shared<Momentum>(options);
}

}  // namespace pendulum
