#include "tests/support/quadratic.h"

#include <utility>

#include "suite/nn/mlp.h"

namespace physinv::test {

template class GradientQuadratic<float>;
template class GradientQuadratic<double>;
template class Quadratic<float>;
template class Quadratic<double>;

ProblemRecipe quadratic(const QuadraticOptions& options) {
  return problem<Quadratic>("quadratic", options);
}

Setting quadratic_setting(double output_scale) {
  const auto net =
      nn::mlp({.hidden = {16, 16}, .activation = nn::Activation::tanh});
  return {.predictor = {{Field::given, Field::observations}, net},
          .surrogate = {{Field::unknowns, Field::given}, net},
          .output_scale = output_scale,
          .gtol = 1e-7};
}

StageBench::StageBench(const Stage& stage,
                       Index n,
                       Index iterations,
                       const ProblemRecipe& recipe,
                       Setting a_setting)
    : setting(std::move(a_setting)),
      oracle(recipe, n, root, stage.needs()),
      probe(oracle, iterations),
      stage_(stage) {
  probe.set_trace([this](const void* data, std::size_t bytes) {
    const auto* p = static_cast<const char*>(data);
    trace.emplace_back(p, p + bytes);
  });
}

Outcome StageBench::run(const Outcome* previous, Precision precision) {
  StageRun run{.oracle = oracle,
               .probe = probe,
               .setting = setting,
               .previous = previous,
               .network_init = root.child("network/init"),
               .batches = root.child("batches"),
               .method = root.child("method"),
               .iterations = probe.iterations(),
               .precision = precision,
               .threads = nullptr,
               .checkpoint = checkpoint};
  return stage_.run(run);
}

Vector<double> StageBench::loss(const Batch<double>& x) {
  Vector<double> l(x.cols());
  oracle.measure(x, l);
  return l;
}

}  // namespace physinv::test
