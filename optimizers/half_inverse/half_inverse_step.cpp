#include "optimizers/half_inverse/half_inverse_step.h"

#include <algorithm>
#include <limits>
#include <type_traits>

#include "optimizers/half_inverse/units.h"
#include "suite/core/simd/finite.h"
#include "suite/core/unit_of.h"

namespace physinv {
namespace {

/// J by columns.
template <class T>
void write_out(const std::vector<LayerRows<T>>& layers,
               Index per_sample,
               linalg::TallColumns& columns) {
  const Index rows = columns.rows();
  for (const LayerRows<T>& l : layers) {
    for (Index o = 0; o < l.outputs; ++o) {
      double* const bias = columns.column(l.offset + l.inputs * l.outputs + o);
      std::fill_n(bias, rows, 0.0);
      for (Index p = 0; p < l.positions; ++p) {
        const T* b = l.b + (p * l.b_step + o) * l.b_stride;
        for (Index r = 0; r < rows; ++r) bias[r] += double(b[r]);
      }
      for (Index i = 0; i < l.inputs; ++i) {
        double* const to = columns.column(l.offset + l.weight(i, o));
        std::fill_n(to, rows, 0.0);
        for (Index p = 0; p < l.positions; ++p) {
          const T* a = l.a + (p * l.a_step + i) * l.a_stride;
          const T* b = l.b + (p * l.b_step + o) * l.b_stride;
          for (Index r = 0; r < rows; ++a) {
            const auto input = double(*a);
            for (const Index end = r + per_sample; r < end; ++r)
              to[r] += double(b[r]) * input;
          }
        }
      }
    }
  }
}

/// out = J^T u, in double whatever J was rounded to: the small singular values
/// are found by it.
template <class T>
void pull_back(const std::vector<LayerRows<T>>& layers,
               Index per_sample,
               BatchIn<double> u,
               BatchOut<double> out) {
  out.setZero();
  for (Index c = 0; c < u.cols(); ++c) {
    for (const LayerRows<T>& l : layers) {
      double* const to = out.col(c).data() + l.offset;
      const Index weights = l.inputs * l.outputs;
      for (Index r = 0; r < u.rows(); r += per_sample) {
        for (Index p = 0; p < l.positions; ++p) {
          const T* a = l.a + p * l.a_step * l.a_stride + r / per_sample;
          const T* b = l.b + p * l.b_step * l.b_stride + r;
          for (Index o = 0; o < l.outputs; ++o) {
            double bar = 0;
            for (Index k = 0; k < per_sample; ++k)
              bar += double(b[o * l.b_stride + k]) * u(r + k, c);
            for (Index i = 0; i < l.inputs; ++i)
              to[l.weight(i, o)] += bar * double(a[i * l.a_stride]);
            to[weights + o] += bar;
          }
        }
      }
    }
  }
}

}  // namespace

template <class T>
void HalfInverseStep<T>::power_of_gram(const Network<T>& network,
                                       VectorIn<T> parameters,
                                       const Tape& tape,
                                       Index samples,
                                       Workspace& work) {
  const Index rows = g_.size(), per = rows / samples;
  gram_.resize(rows, rows);
  form_gram_.template operator()<T>(
      layers_, samples, per, gram_, work.threads());

  out_bar_.resize(rows_.rows(), samples);
  column_.resize(parameters.size());
  const hig::Pullback pullback = [&](BatchIn<double> u, BatchOut<double> out) {
    if (std::is_same_v<T, float>) return pull_back(layers_, per, u, out);
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
void HalfInverseStep<T>::power_of_jacobian(VectorIn<T> parameters,
                                           Index samples) {
  const Index rows = g_.size(), p = update_.rows();
  auto update = update_.col(0);
  hig::PowerReport& report = report_;
  report_ = {};
  const bool shared =
      shared_.template triangle<T>(layers_, parameters, g_, rows / samples);
  if (!shared) {
    columns_.open(rows, p + 1);
    write_out(layers_, rows / samples, columns_);
    std::copy_n(g_.data(), rows, columns_.column(p));
  }
  if (shared) {
    reordered_.resize(p);
    report = tall_.of_triangle(shared_.result(), options_.power, reordered_);
    for (Index j = 0; j < p; ++j)
      update(shared_.place()[static_cast<std::size_t>(j)]) = reordered_(j);
  } else {
    report = tall_(columns_, options_.power, update);
  }
  report_.path = hig::Path::explicit_jacobian;
  report_.spared = tall_.spared();
  report_.abandoned = tall_.abandoned();
  report_.proven = hig::proven(report_, options_.numerics.tolerance);
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
  const Workspace::Scope scope(work);
  rows_.resize(solver.rows() / per, samples * per);
  for (Index i = 0; i < samples; ++i) {
    const T* from = solver.col(i).data();
    T* to = rows_.col(i * per).data();
    for (Index c = 0; c < per; ++c)
      for (Index u = 0; u < rows_.rows(); ++u) *to++ = from[u * per + c];
  }
  // J is linear in S.
  const T unit = unit_of(solver.cwiseAbs().maxCoeff());
  if (unit != 1) rows_ /= unit;
  layers_.clear();
  by_rows(network).jacobian_rows(parameters, tape, rows_, layers_, work);
  g_.resize(samples * per);
  for (Index i = 0; i < samples; ++i)
    for (Index c = 0; c < per; ++c)
      g_(i * per + c) = static_cast<double>(g(c, i));
  update_.resize(parameters.size(), 1);
  const hig::Power power = options_.power;
  options_.power = hig::in_units(power, double(unit));
  if (parameters.size() < g_.size()) {
    power_of_jacobian(parameters, samples);
  } else {
    power_of_gram(network, parameters, tape, samples, work);
  }
  options_.power = power;
  work.counts[Counter::skipped_levels] += report_.spared;
  work.counts[Counter::abandoned_levels] +=
      static_cast<std::uint64_t>(report_.abandoned);
  hig::leave_units(power, double(unit), report_, update_.col(0));
  column_ = parameters - (options_.rate * update_.col(0)).template cast<T>();
  const bool finite = all_finite(column_.data(), column_.size());
  if (finite) parameters = column_;
  return finite;
}

template <class T>
std::size_t HalfInverseStep<T>::bytes() const {
  const auto bytes = [](const auto& m) {
    return static_cast<std::size_t>(m.size()) * sizeof(m.data()[0]);
  };
  return bytes(rows_) + bytes(out_bar_) + bytes(gram_) + form_gram_.bytes() +
         power_.bytes() + bytes(g_) + bytes(update_) + bytes(column_) +
         columns_.bytes() + shared_.bytes() + tall_.bytes();
}

template class HalfInverseStep<float>;
template class HalfInverseStep<double>;

}  // namespace physinv
