#include "suite/diagnostics/work_precision.h"

#include <algorithm>
#include <array>
#include <mutex>
#include <numbers>
#include <vector>

#include "suite/core/check.h"
#include "suite/core/math.h"
#include "suite/core/oracle.h"
#include "suite/core/probe.h"
#include "suite/diagnostics/diagnostic.h"

namespace physinv {

/// What is right at the base's resolution, and the targets at the reference's.
struct Answer {
  Batch<double> base, target;
};

namespace {

Index ratio(Index fine, Index coarse) {
  SUITE_CHECK(coarse == 0 ? fine == 0 : fine % coarse == 0,
              "a setting's size must be a multiple of the base's");
  return coarse == 0 ? 1 : fine / coarse;
}

/// Every row so many times.
Batch<double> repeated(const Batch<double>& rows, Index times) {
  Batch<double> out(rows.rows() * times, rows.cols());
  for (Index r = 0; r < out.rows(); ++r) out.row(r) = rows.row(r / times);
  return out;
}

Batch<double> every(const Batch<double>& rows, Index step) {
  Batch<double> out(rows.rows() / step, rows.cols());
  for (Index r = 0; r < out.rows(); ++r) out.row(r) = rows.row(r * step);
  return out;
}

/// Fields on a periodic grid of an even number of points, on one of so many
/// times as many: the trigonometric interpolation.
Batch<double> refined(const Batch<double>& field, Index times) {
  if (times == 1) return field;
  const Index n = field.rows();
  Batch<double> weight(n * times, n);
  for (Index r = 0; r < weight.rows(); ++r) {
    for (Index j = 0; j < n; ++j) {
      const double t = std::numbers::pi *
                       (double(r) / double(n * times) - double(j) / double(n));
      weight(r, j) = r == j * times   ? 1
                     : r % times == 0 ? 0
                                      : math::sin(double(n) * t) /
                                            (double(n) * math::tan(t));
    }
  }
  return weight.lazyProduct(field);
}

/// Sums of so many rows each.
Batch<double> summed(const Batch<double>& rows, Index count) {
  Batch<double> out = Batch<double>::Zero(rows.rows() / count, rows.cols());
  for (Index r = 0; r < rows.rows(); ++r) out.row(r / count) += rows.row(r);
  return out;
}

/// Column i is column i + 1.
Batch<double> next_of(const Batch<double>& y) {
  Batch<double> out(y.rows(), y.cols());
  for (Index i = 0; i < y.cols(); ++i) out.col(i) = y.col((i + 1) % y.cols());
  return out;
}

/// One setting of the problem and its view of the samples.
template <class T>
class View {
 public:
  View(const ProblemRecipe& recipe, const Samples<double>& drawn)
      : problem_(recipe.make<T>()) {
    const Shape shape = problem_->shape();
    finer_x_ = ratio(shape.unknowns, drawn.x.rows());
    finer_y_ = ratio(shape.observations, drawn.y.rows());
    x_ = repeated(drawn.x, finer_x_).template cast<T>();
    given_ = refined(drawn.given, ratio(shape.given, drawn.given.rows()))
                 .template cast<T>();
    y_.resize(shape.observations, x_.cols());
  }

  /// `wanted` may be of a finer resolution.
  void set_target(const Batch<double>& wanted) {
    target_ = every(wanted, ratio(wanted.rows(), y_.rows())).template cast<T>();
    y_bar_ = y_, x_bar_ = x_;
  }

  void forward(Index first, Index count, Workspace& work) {
    const auto part = [&](auto& all) { return all.middleCols(first, count); };
    problem_->forward({part(x_), part(given_)}, part(y_), work);
  }

  void gradient(Index first, Index count, Tape& tape, Workspace& work) {
    const auto part = [&](auto& all) { return all.middleCols(first, count); };
    const auto& vjp = dynamic_cast<const Vjp<T>&>(*problem_);
    vjp.linearize({part(x_), part(given_)}, part(y_), tape);
    problem_->loss_gradient(part(y_), part(target_), part(y_bar_));
    vjp.pullback(tape, part(y_bar_), part(x_bar_), work);
  }

  /// From y, of the base's resolution, and the problem's start.
  void set_observed(const Batch<double>& y) {
    SUITE_CHECK(finer_x_ == 1 && finer_y_ == 1,
                "inverses can only be compared at the base's resolution");
    y_ = y.template cast<T>();
    start_ = problem_->start().template cast<T>().replicate(1, y.cols());
    x_bar_ = x_;
  }

  void inverse(Index first, Index count, Workspace& work) {
    const auto part = [&](auto& all) { return all.middleCols(first, count); };
    dynamic_cast<const Inverse<T>&>(*problem_).invert(
        {part(start_), part(given_)}, part(y_), part(x_bar_), work);
  }

  Batch<double> found() const { return x_bar_.template cast<double>(); }
  Batch<double> y() const { return y_.template cast<double>(); }
  Batch<double> base_y() const { return every(y(), finer_y_); }
  Batch<double> base_gradient() const {
    return summed(x_bar_.template cast<double>(), finer_x_) /
           static_cast<double>(finer_y_);
  }

 private:
  std::unique_ptr<Problem<T>> problem_;
  Index finer_x_ = 1, finer_y_ = 1;
  Batch<T> x_, given_, target_, y_, y_bar_, x_bar_, start_;
};

Answer fine_answer(const ProblemRecipe& reference,
                   const Samples<double>& drawn,
                   bool gradient) {
  View<double> view(reference, drawn);
  Workspace work;
  Tape tape;
  const Index n = drawn.x.cols();
  view.forward(0, n, work);
  if (!gradient) return {view.base_y(), {}};
  const Batch<double> target = next_of(view.y());
  view.set_target(target);
  view.gradient(0, n, tape, work);
  return {view.base_gradient(), target};
}

Answer exact_answer(const ClosedForm& f,
                    const Problem<double>& base,
                    const Samples<double>& drawn,
                    bool gradient) {
  const Index n = drawn.x.cols();
  const auto at = [&](Index i, Index moved) {
    std::vector<Exact> x, y(static_cast<std::size_t>(drawn.y.rows()));
    for (Index k = 0; k < drawn.x.rows(); ++k)
      x.emplace_back(drawn.x(k, i), k == moved ? 1 : 0);
    const Vector<double> given = drawn.given.col(i);
    f.forward(x, {given.data(), static_cast<std::size_t>(given.size())}, y);
    return y;
  };
  Batch<double> y(drawn.y.rows(), n);
  for (Index i = 0; i < n; ++i) {
    const auto column = at(i, -1);
    for (Index j = 0; j < y.rows(); ++j)
      y(j, i) = double(column[static_cast<std::size_t>(j)].value);
  }
  if (!gradient) return {y, {}};
  Answer out{Batch<double>(drawn.x.rows(), n), next_of(y)};
  Batch<double> y_bar = y;
  base.loss_gradient(y, out.target, y_bar);
  for (Index i = 0; i < n; ++i) {
    for (Index k = 0; k < drawn.x.rows(); ++k) {
      const auto moved = at(i, k);
      DoubleDouble sum;
      for (Index j = 0; j < y.rows(); ++j)
        sum += moved[static_cast<std::size_t>(j)].slope * y_bar(j, i);
      out.base(k, i) = double(sum);
    }
  }
  return out;
}

}  // namespace

class Answers {
 public:
  /// That to these samples, by `make` if it is not the one at hand.
  template <class F>
  Answer find(const Samples<double>& drawn, bool gradient, F&& make) {
    const std::scoped_lock lock(mutex_);
    const std::uint64_t asked = content_hash(drawn);
    Found& found = found_[gradient ? 1 : 0];
    if (!found.made || found.asked != asked)
      found = {.made = true, .asked = asked, .answer = make()};
    return found.answer;
  }

 private:
  struct Found {
    bool made = false;
    std::uint64_t asked = 0;
    Answer answer;
  };
  std::mutex mutex_;
  std::array<Found, 2> found_;
};

const char* to_string(WorkOf what) {
  constexpr const char* names[] = {"forward", "gradient", "inverse"};
  return names[static_cast<std::size_t>(what)];
}

std::vector<ProblemRecipe> WorkPrecisionOptions::problems() const {
  std::vector<ProblemRecipe> all = {problem, base};
  if (!exact.forward) all.push_back(reference);
  return all;
}

std::shared_ptr<Answers> no_answers_yet() {
  return std::make_shared<Answers>();
}

namespace {

Counter counter_of(WorkOf of) {
  constexpr Counter all[] = {Counter::forward, Counter::vjp, Counter::inverse};
  return all[static_cast<std::size_t>(of)];
}

class WorkPrecision final : public Diagnostic {
 public:
  explicit WorkPrecision(WorkPrecisionOptions options)
      : options_(std::move(options)) {
    if (!options_.answers) options_.answers = no_answers_yet();
  }

  std::string name() const override { return options_.name; }
  Index default_iterations() const override { return options_.repetitions; }
  bool takes_row_iterations() const override { return true; }
  bool has_precision() const override { return true; }
  Needs needs() const override {
    switch (options_.of) {
      case WorkOf::forward:
        break;
      case WorkOf::gradient:
        return Needs::forward | Needs::vjp;
      case WorkOf::inverse:
        return Needs::forward | Needs::inverse;
    }
    return Needs::forward;
  }
  Sources sources() const override {
    Sources all = Diagnostic::sources();
    if (options_.exact.forward) all.roots.emplace_back(options_.exact.source);
    return all;
  }
  double operations(const CaseSize& size) const override {
    const Index n = options_.samples > 0 ? options_.samples : size.n;
    double passes = static_cast<double>(size.iterations + 1) *
                    options_.problem.make<double>()->operations();
    if (!options_.exact.forward)
      passes += options_.reference.make<double>()->operations();
    return static_cast<double>(n) * (options_.of == WorkOf::gradient ? 3 : 1) *
           passes;
  }

 protected:
  std::string kind() const override { return "work_precision"; }
  std::vector<ProblemRecipe> problems() const override {
    return options_.problems();
  }
  Options settings() const override { return describe(options_); }
  void diagnose(StageRun& run, Outcome& out) const override {
    run.precision == Precision::f32 ? measure<float>(run, out)
                                    : measure<double>(run, out);
  }

 private:
  Answer right_for(const Problem<double>& base,
                   const Samples<double>& drawn) const {
    if (options_.of == WorkOf::inverse) return {drawn.x, {}};
    const bool gradient = options_.of == WorkOf::gradient;
    return options_.answers->find(drawn, gradient, [&] {
      return options_.exact.forward
                 ? exact_answer(options_.exact, base, drawn, gradient)
                 : fine_answer(options_.reference, drawn, gradient);
    });
  }

  template <class T>
  void measure(StageRun& run, Outcome& out) const {
    const Index n =
        options_.samples > 0 ? options_.samples : run.oracle.count();
    const auto base = options_.base.make<double>();
    const Samples<double> drawn =
        base->sample_labelled(0, n, run.batches.child("work_precision"));
    const WorkOf of = options_.of;
    const Answer right = right_for(*base, drawn);

    View<T> view(options_.problem, drawn);
    if (of == WorkOf::gradient) view.set_target(right.target);
    if (of == WorkOf::inverse) view.set_observed(drawn.y);
    Workspace work(run.threads);
    Tape tape(run.threads);
    const Index block = options_.block > 0 ? options_.block : n;
    const auto pass = [&] {
      for (Index first = 0; first < n; first += block) {
        const Index some = std::min(block, n - first);
        switch (of) {
          case WorkOf::forward:
            view.forward(first, some, work);
            break;
          case WorkOf::gradient:
            view.gradient(first, some, tape, work);
            break;
          case WorkOf::inverse:
            view.inverse(first, some, work);
            break;
        }
      }
    };
    run.probe.begin_warmup();
    pass();
    run.probe.begin();
    while (run.probe.proceed([&](BatchOut<double> x) { x = out.x; })) {
      pass();
      run.oracle.add(counter_of(of), n);
    }

    const Batch<double> found = of == WorkOf::gradient  ? view.base_gradient()
                                : of == WorkOf::inverse ? view.found()
                                                        : view.base_y();
    Batch<double> error(1, n);
    for (Index i = 0; i < n; ++i)
      error(0, i) =
          number_or_none(relative_distance(found.col(i), right.base.col(i)));
    out.arrays["error"] = error;
    out.bytes = work.bytes() + tape.bytes();
  }

  WorkPrecisionOptions options_;
};

}  // namespace

std::shared_ptr<const Stage> work_precision(WorkPrecisionOptions options) {
  return std::make_shared<WorkPrecision>(std::move(options));
}

double fastest_repetition(const Curve& curve) {
  double fastest = 0;
  for (std::size_t k = 1; k < curve.seconds.size(); ++k) {
    const double one = (curve.seconds[k] - curve.seconds[k - 1]) /
                       (curve.iteration[k] - curve.iteration[k - 1]);
    if (k == 1 || one < fastest) fastest = one;
  }
  return fastest;
}

}  // namespace physinv
