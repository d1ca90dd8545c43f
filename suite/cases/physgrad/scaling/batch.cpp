
#include "problems/scaling/trajectories.h"
#include "suite/cases/physgrad/scaling/scaling.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"
#include "suite/diagnostics/diagnostic.h"

namespace physinv::scaling {
namespace {

class BatchOfTrajectories final : public Diagnostic {
 public:
  BatchOfTrajectories(std::string name, const ScalingFlow& flow, Index n)
      : name_(std::move(name)), flow_(flow), n_(n) {}

  std::string name() const override { return name_; }
  double operations(const CaseSize&) const override {
    return 4 * static_cast<double>(flow_.steps * n_);
  }

 protected:
  std::string kind() const override { return "trajectories"; }
  Options settings() const override {
    return chained({{"trajectories", text_of(n_)}}, describe(flow_));
  }
  /// What the first call pays for, memory above all, is not timed.
  void diagnose(StageRun& run, Outcome& out) const override {
    const auto [alpha, start1, start2] = draw(run.network_init);
    Vector<double> x1(n_), x2(n_);
    run.probe.begin_warmup();
    advance<double>(flow_, alpha, start1, start2, x1, x2, run.threads);
    run.probe.begin();
    advance<double>(flow_, alpha, start1, start2, x1, x2, run.threads);
    run.probe.end();
    out.arrays["batch"] =
        Vector<double>{{static_cast<double>(n_), double(flow_.steps)}};
    out.arrays["ends"] = ends(x1, x2);
    out.bytes = static_cast<std::size_t>(5 * n_) * sizeof(double);
    const Index examples = run.oracle.count();
    out.status.assign(static_cast<std::size_t>(examples), Status::gtol);
    out.iterations.setZero(examples), out.evaluations.setZero(examples);
  }

 private:
  struct Start {
    Vector<double> alpha, x1, x2;
  };
  /// alpha in [1, 5), x in [0, 1)^2; for the squared one alpha = 1 and x in
  /// [0.5, 3.5)^2. The same for all steps.
  Start draw(const Rng& rng) const {
    const bool squared = flow_.power == 2;
    Start s{Vector<double>::Ones(n_), Vector<double>(n_), Vector<double>(n_)};
    const double from = squared ? 0.5 : 0, to = squared ? 3.5 : 1;
    Stream stream = rng.child("trajectories").stream();
    for (Index i = 0; i < n_; ++i) {
      if (!squared) s.alpha(i) = stream.uniform(1, 5);
      s.x1(i) = stream.uniform(from, to);
      s.x2(i) = stream.uniform(from, to);
    }
    return s;
  }
  /// Mean and largest |x1|, then |x2|; the mean summed in order.
  static Batch<double> ends(const Vector<double>& x1,
                            const Vector<double>& x2) {
    Batch<double> found(2, 2);
    for (const auto* x : {&x1, &x2}) {
      double sum = 0, largest = 0;
      for (const double v : *x)
        sum += std::abs(v), largest = std::max(largest, std::abs(v));
      found.col(x == &x1 ? 0 : 1) << sum / static_cast<double>(x->size()),
          largest;
    }
    return found;
  }

  std::string name_;
  ScalingFlow flow_;
  Index n_;
};

}  // namespace

Method batch(std::string id, int power, Index n) {
  const bool squared = power == 2;
  const Index steps = squared ? 10 : 50;
  Method method{.id = std::move(id), .chain = {}};
  const auto add = [&](const char* name, ScalingStep step, double rate) {
    method.chain.push_back(std::make_shared<BatchOfTrajectories>(
        name, ScalingFlow{step, power, rate, steps}, n));
  };
  add("gd", ScalingStep::gradient, squared ? 0.01 : 0.03);
  add("newton", ScalingStep::newton, squared ? 1.0 / 3 : kRate);
  add("ig", ScalingStep::inverse_gradient, kRate);
  add("pg", ScalingStep::inverse_simulator, kRate);
  return method;
}

}  // namespace physinv::scaling
