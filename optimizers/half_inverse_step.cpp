#include "optimizers/half_inverse_step.h"

#include <fmt/format.h>

namespace physinv {
namespace {

/// J^T (p x rows) written out.
template <class T>
void write_out(const std::vector<LayerRows<T>>& layers,
               Index per_sample,
               Batch<double>& transposed) {
  for (const LayerRows<T>& l : layers) {
    for (Index r = 0; r < transposed.cols(); ++r) {
      double* to = transposed.col(r).data() + l.offset;
      const T* a = l.a + r / per_sample;
      const T* b = l.b + r;
      for (Index o = 0; o < l.outputs; ++o)
        for (Index i = 0; i < l.inputs; ++i)
          *to++ = double(b[o * l.b_stride]) * double(a[i * l.a_stride]);
      for (Index o = 0; o < l.outputs; ++o) *to++ = double(b[o * l.b_stride]);
    }
  }
}

}  // namespace

Options describe(const HalfInverseStepOptions& o) {
  return {{"step", "half_inverse"},
          {"kappa", fmt::format("{}", o.power.kappa)},
          {"tau", fmt::format("{}", o.power.tau)},
          {"beta", fmt::format("{}", o.power.beta)},
          {"cut", o.power.absolute ? "absolute" : "relative"},
          {"rate", fmt::format("{}", o.rate)},
          {"tolerance", fmt::format("{}", o.numerics.tolerance)}};
}

template <class T>
void HalfInverseStep<T>::power_of_gram(const Network<T>& network,
                                       VectorIn<T> parameters,
                                       const Tape& tape,
                                       Index samples,
                                       Workspace& work) {
  const Index rows = g_.size(), per = rows / samples;
  blocks_.clear();
  for (const LayerRows<T>& l : layers_)
    blocks_.push_back({.a = l.a,
                       .inputs = l.inputs,
                       .a_stride = l.a_stride,
                       .b = l.b,
                       .outputs = l.outputs,
                       .b_stride = l.b_stride});
  gram_.resize(rows, rows);
  form_gram_.template operator()<T>(
      blocks_, samples, per, gram_, work.threads());
  gram_time_ += now() - begun_;

  out_bar_.resize(rows_.rows(), samples);
  column_.resize(parameters.size());
  const hig::Pullback pullback = [&](BatchIn<double> u, BatchOut<double> out) {
    for (Index c = 0; c < u.cols(); ++c) {
      for (Index i = 0; i < samples; ++i)
        out_bar_.col(i).noalias() =
            rows_.middleCols(i * per, per) *
            u.col(c).segment(i * per, per).template cast<T>();
      VectorOut<T> bar(column_);
      network.backward(parameters, tape, out_bar_, &bar, nullptr, work);
      out.col(c) = column_.template cast<double>();
    }
  };
  report_ =
      power_(gram_, g_, pullback, std::span(&options_.power, 1), update_)[0];
}

template <class T>
void HalfInverseStep<T>::power_of_jacobian(Index samples) {
  transposed_.resize(update_.rows(), g_.size());
  write_out(layers_, g_.size() / samples, transposed_);
  gram_time_ += now() - begun_;
  update_.setZero();
  explicit_.factor(transposed_.transpose(), g_);
  static_cast<hig::PowerReport&>(report_) =
      explicit_.apply(options_.power, update_.col(0));
  report_.path = hig::Path::explicit_jacobian;
  report_.proven = report_.ending == hig::Ending::zero ||
                   report_.error <= options_.numerics.tolerance;
  if (report_.ending != hig::Ending::ok && report_.ending != hig::Ending::zero)
    update_.setConstant(std::numeric_limits<double>::quiet_NaN());
}

template <class T>
bool HalfInverseStep<T>::operator()(const Network<T>& network,
                                    VectorOut<T> parameters,
                                    const Tape& tape,
                                    BatchIn<T> solver,
                                    BatchIn<T> g,
                                    Workspace& work) {
  const Index samples = g.cols(), per = g.rows();
  begun_ = now();
  const Workspace::Scope scope(work);
  rows_.resize(solver.rows() / per, samples * per);
  for (Index i = 0; i < samples; ++i)
    rows_.middleCols(i * per, per) =
        Eigen::Map<const Batch<T>>(solver.col(i).data(), per, rows_.rows())
            .transpose();
  layers_.clear();
  network.jacobian_rows(parameters, tape, rows_, layers_, work);
  g_.resize(samples * per);
  for (Index i = 0; i < samples; ++i)
    g_.segment(i * per, per) = g.col(i).template cast<double>();
  update_.resize(parameters.size(), 1);
  if (parameters.size() < g_.size()) {
    power_of_jacobian(samples);
  } else {
    power_of_gram(network, parameters, tape, samples, work);
  }
  time_ += now() - begun_;
  const bool finite = update_.allFinite();
  if (finite) parameters -= (options_.rate * update_.col(0)).template cast<T>();
  return finite && parameters.allFinite();
}

template <class T>
std::size_t HalfInverseStep<T>::bytes() const {
  const auto bytes = [](const auto& m) {
    return static_cast<std::size_t>(m.size()) * sizeof(m.data()[0]);
  };
  // The factorisation holds one more matrix of the Gram matrix's size.
  return bytes(rows_) + bytes(out_bar_) + 2 * bytes(gram_) + bytes(g_) +
         bytes(update_) + bytes(column_) + bytes(transposed_);
}

template class HalfInverseStep<float>;
template class HalfInverseStep<double>;

}  // namespace physinv
