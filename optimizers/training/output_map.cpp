#include "optimizers/training/output_map.h"

#include <algorithm>

#include "suite/core/math.h"
#include "suite/core/oracle.h"

namespace physinv {
namespace {

/// f(all numbers as one vector) where they lie side by side, so that registers
/// are filled however short a column is; else f(the batch).
template <class T, class F>
void in_whole_registers(BatchOut<T> x, F&& f) {
  if (x.outerStride() == x.rows()) {
    Eigen::Map<Vector<T>> flat(x.data(), x.size());
    f(flat);
  } else {
    f(x);
  }
}

/// Added to every column.
template <class T>
class Start {
 public:
  explicit Start(const Vector<double>& start)
      : start_(start.template cast<T>()),
        level_((start_.array() == start_(0)).all()) {}

  void add_to(BatchOut<T> x) const {
    if (level_) {
      in_whole_registers<T>(x, [&](auto& all) { all.array() += start_(0); });
    } else {
      x.colwise() += start_;
    }
  }
  const Vector<T>& operator*() const { return start_; }

 private:
  Vector<T> start_;
  bool level_;  ///< all of its numbers are equal
};

template <class T>
class Linear final : public OutputMap<T> {
 public:
  Linear(double scale, const Vector<double>& start)
      : scale_(static_cast<T>(scale)), start_(start) {}

  void operator()(BatchIn<T> out, BatchIn<T>, BatchOut<T> x) override {
    if (out.outerStride() == out.rows() && x.outerStride() == x.rows()) {
      std::copy_n(out.data(), out.size(), x.data());
    } else {
      x = out;
    }
    scale(x);
    start_.add_to(x);
  }
  void pull_back(BatchOut<T> bar) const override { scale(bar); }
  void pull_back_rows(BatchOut<T> jacobian) const override {
    pull_back(jacobian);
  }
  Batch<T> outputs_of(BatchIn<T> x) const override {
    return (x.colwise() - *start_) / scale_;
  }

 private:
  void scale(BatchOut<T> x) const {
    if (scale_ != T(1))
      in_whole_registers<T>(x, [&](auto& all) { all *= scale_; });
  }

  T scale_;
  Start<T> start_;
};

template <class T>
class Box final : public OutputMap<T> {
 public:
  Box(double scale, const Vector<double>& start)
      : scale_(static_cast<T>(scale)), start_(start) {}

  void operator()(BatchIn<T> out, BatchIn<T>, BatchOut<T> x) override {
    tanh_ = out.unaryExpr([](T o) { return math::tanh(o); });
    x = scale_ * tanh_;
    start_.add_to(x);
  }
  void pull_back(BatchOut<T> bar) const override {
    bar.array() *= scale_ * (T(1) - tanh_.array().square());
  }
  void bend(BatchIn<T> bar,
            BatchIn<T> dot,
            BatchOut<T> bar_dot) const override {
    bar_dot.array() -= T(2) * tanh_.array() * dot.array() * bar.array();
  }
  void pull_back_rows(BatchOut<T> jacobian) const override {
    const Index rows = jacobian.rows() / tanh_.rows();
    for (Index i = 0; i < jacobian.cols(); ++i) {
      Eigen::Map<Batch<T>> s(jacobian.col(i).data(), rows, tanh_.rows());
      s.array().rowwise() *=
          (scale_ * (T(1) - tanh_.col(i).array().square())).transpose();
    }
  }

 private:
  T scale_;
  Start<T> start_;
  Batch<T> tanh_;
};

template <class T>
class MeanOfObservations final : public OutputMap<T> {
 public:
  explicit MeanOfObservations(double scale) : scale_(static_cast<T>(scale)) {}

  void operator()(BatchIn<T> out, BatchIn<T> y, BatchOut<T> x) override {
    unknowns_ = out.rows();
    for (Index i = 0; i < out.cols(); ++i)
      x.col(i).array() =
          scale_ * (out.col(i).array() - mean(out.col(i))) + mean(y.col(i));
  }
  void pull_back(BatchOut<T> bar) const override {
    for (Index i = 0; i < bar.cols(); ++i)
      bar.col(i) = scale_ * (bar.col(i).array() - mean(bar.col(i)));
  }
  void pull_back_rows(BatchOut<T> jacobian) const override {
    const Index rows = jacobian.rows() / unknowns_;
    for (Index i = 0; i < jacobian.cols(); ++i) {
      Eigen::Map<Batch<T>> s(jacobian.col(i).data(), rows, unknowns_);
      const Vector<T> means = s.rowwise().mean();
      s = scale_ * (s.colwise() - means);
    }
  }

 private:
  static T mean(VectorIn<T> v) {
    return static_cast<T>(v.template cast<double>().mean());
  }

  T scale_;
  Index unknowns_ = 0;
};

}  // namespace

template <class T>
Batch<T> OutputMap<T>::outputs_of(BatchIn<T>) const {
  SUITE_CHECK(false, "labels need an output form with an inverse");
  return {};
}

template <class T>
std::unique_ptr<OutputMap<T>> output_map(OutputForm form,
                                         double scale,
                                         const Vector<double>& start) {
  switch (form) {
    case OutputForm::box:
      return std::make_unique<Box<T>>(scale, start);
    case OutputForm::mean_of_observations:
      return std::make_unique<MeanOfObservations<T>>(scale);
    case OutputForm::linear:
      break;
  }
  return std::make_unique<Linear<T>>(scale, start);
}

template <class T>
std::unique_ptr<OutputMap<T>> output_map(const Setting& setting,
                                         const Oracle& oracle) {
  return output_map<T>(
      setting.output_form, setting.output_scale, oracle.inspect().start());
}

template class OutputMap<float>;
template class OutputMap<double>;
template std::unique_ptr<OutputMap<float>> output_map(OutputForm,
                                                      double,
                                                      const Vector<double>&);
template std::unique_ptr<OutputMap<double>> output_map(OutputForm,
                                                       double,
                                                       const Vector<double>&);
template std::unique_ptr<OutputMap<float>> output_map(const Setting&,
                                                      const Oracle&);
template std::unique_ptr<OutputMap<double>> output_map(const Setting&,
                                                       const Oracle&);

}  // namespace physinv
