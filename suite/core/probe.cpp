#include "suite/core/probe.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "suite/core/oracle.h"

namespace physinv {
namespace {

/// Stands for what was never measured: an example without a usable start.
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

}  // namespace

Index next_measured(Index iteration) {
  return std::max(iteration + 1, iteration + iteration / 7);
}

Probe::Probe(Oracle& oracle, Index iterations, Index tracked)
    : oracle_(oracle),
      iterations_(iterations),
      tracked_(std::min(tracked, oracle.count())),
      x_(Batch<double>::Constant(
          oracle.shape().unknowns, oracle.count(), kNan)),
      loss_(Vector<double>::Constant(oracle.count(), kNan)) {
  setup_.start();
}

void Probe::begin_warmup() {
  setup_.stop();
  warmup_.start();
}

void Probe::begin() {
  setup_.stop();
  warmup_.stop();
  begun_ = true;
  solve_.start();
}

void Probe::end() {
  solve_.stop();
  measure_.start();
  stopped_ = true;
}

bool Probe::due() const {
  return iteration_ >= next_ || iteration_ >= iterations_ || stopped_;
}

void Probe::measure() {
  y_.resize(oracle_.shape().observations, x_.cols());
  oracle_.measure(x_, y_, loss_);
  measured_ = true;
  append(iteration_, x_, loss_);
}

bool Probe::knows_losses(BatchIn<double> x, VectorOut<double> loss) const {
  if (!measured_ || x.rows() != x_.rows() || x.cols() != x_.cols())
    return false;
  for (Index i = 0; i < x.cols(); ++i)  // bit by bit
    if (std::memcmp(x.col(i).data(),
                    x_.col(i).data(),
                    static_cast<std::size_t>(x.rows()) * sizeof(double)) != 0)
      return false;
  loss = loss_;
  return true;
}

void Probe::append(Index iteration, BatchIn<double> x, VectorIn<double> loss) {
  const Index point = open_point(iteration);
  for (Index i = 0; i < loss.size(); ++i)
    put(point, i, x.col(i).data(), loss(i));
  if (observer_) observer_(iteration, loss);
}

Index Probe::open_point(Index iteration) {
  const Index point = curve_.points();
  if (point >= curve_.loss.cols()) {
    const Index room = std::max<Index>(64, 2 * point);
    curve_.loss.conservativeResize(loss_.size(), room);
    curve_.x.conservativeResize(tracked_ * x_.rows(), room);
  }
  curve_.iteration.push_back(static_cast<double>(iteration));
  curve_.seconds.push_back(solve_.total().wall);
  const Counts& counts = oracle_.counts();
  curve_.evaluations.push_back(
      static_cast<double>(counts[Counter::forward] + counts[Counter::vjp]));
  next_ = next_measured(iteration);
  return point;
}

void Probe::put(Index point, Index example, const double* x, double loss) {
  curve_.loss(example, point) = loss;
  if (example >= tracked_) return;
  const Index d = x_.rows();
  std::copy_n(x, d, &curve_.x(example * d, point));
}

void Probe::accept(Index example,
                   Index iteration,
                   const double* x,
                   double loss) {
  if (reached_.empty()) reached_.assign(static_cast<std::size_t>(x_.cols()), 0);
  Index& reached = reached_[static_cast<std::size_t>(example)];
  std::copy_n(x, x_.rows(), x_.col(example).data());
  loss_(example) = loss;
  measured_ = false;  // but given by the caller
  iteration_ = std::max(iteration_, iteration);
  if (iteration >= next_) {
    const Aside aside = measuring();
    open_point(iteration);
    if (observer_) observer_(iteration, loss_);
  }
  if (reached < curve_.points() &&
      curve_.iteration[static_cast<std::size_t>(reached)] ==
          static_cast<double>(iteration))
    put(reached++, example, x, loss);
}

void Probe::finish() {
  end();
  if (curve_.points() == 0 || curve_.iteration.back() < iteration_)
    open_point(iteration_);
  for (Index i = 0; i < x_.cols(); ++i)
    for (Index k = reached_.empty() ? 0 : reached_[static_cast<std::size_t>(i)];
         k < curve_.points();
         ++k)
      put(k, i, x_.col(i).data(), loss_(i));
}

const Curve& Probe::curve() {
  curve_.loss.conservativeResize(curve_.loss.rows(), curve_.points());
  curve_.x.conservativeResize(curve_.x.rows(), curve_.points());
  return curve_;
}

void Probe::serialize(Archive& archive) {
  curve();  // the points alone, without room for more
  archive(iteration_, next_, trajectory_, curve_);
  const auto points = static_cast<std::size_t>(curve_.points());
  SUITE_CHECK(iteration_ >= 0 && iteration_ <= iterations_ &&
                  next_ <= next_measured(iteration_) &&
                  curve_.seconds.size() == points &&
                  curve_.evaluations.size() == points,
              "the checkpoint belongs to another stage");
  if (points > 0) {
    check_size(curve_.loss, loss_.size(), curve_.points());
    check_size(curve_.x, tracked_ * x_.rows(), curve_.points());
  }
  archive(setup_, warmup_, data_, solve_, measure_);
}

Clocks Probe::clocks() const {
  return {.setup = setup_.total(),
          .warmup = warmup_.total(),
          .data = data_.total(),
          .solve = solve_.total(),
          .measure = measure_.total()};
}

}  // namespace physinv
