#include "optimizers/half_inverse/shared_functions.h"

#include <cmath>

namespace physinv::hig {
namespace {

/// The factor s_c that each function sees its output with; false if functions
/// see other outputs too, or samples differ.
template <class T>
bool seen_alike(const LayerRows<T>& output,
                Index rows,
                std::vector<double>& seen) {
  const Index functions = output.outputs;
  seen.resize(static_cast<std::size_t>(functions));
  for (Index o = 0; o < functions; ++o) {
    const T* b = output.b + o * output.b_stride;
    for (Index c = 0; c < functions; ++c)
      if (c != o && b[c] != T(0)) return false;
    for (Index r = functions; r < rows; ++r)
      if (!(b[r] == b[r - functions])) return false;
    if (!std::isfinite(b[o])) return false;
    seen[static_cast<std::size_t>(o)] = static_cast<double>(b[o]);
  }
  return true;
}

}  // namespace

template <class T>
bool SharedFunctions::triangle(std::span<const LayerRows<T>> layers,
                               VectorIn<T> parameters,
                               VectorIn<double> g,
                               Index per_sample) {
  if (layers.size() != 2) return false;
  const LayerRows<T>&output = layers[0], &hidden = layers[1];
  const Index functions = per_sample, rows = g.size();
  const Index samples = rows / functions;
  const Index units = hidden.outputs, inputs = hidden.inputs;
  const Index shared = units + 1, own = units * (inputs + 1);
  if (output.positions != 1 || hidden.positions != 1) return false;
  if (output.outputs != functions || output.inputs != units) return false;
  if (samples < shared + own + functions) return false;
  if (!seen_alike(output, rows, seen_)) return false;

  // d_k up to a factor from the function that sees unit k best.
  const T* const weights = parameters.data() + output.offset;
  const auto factor = [&](Index c, Index k) {
    return seen_[static_cast<std::size_t>(c)] *
           static_cast<double>(weights[c * units + k]);
  };
  ratio_.resize(static_cast<std::size_t>(functions * units));
  features_.open(samples, shared + own + functions);
  for (Index k = 0; k < units; ++k) {
    const T* a = output.a + k * output.a_stride;
    double* to = features_.column(k);
    for (Index i = 0; i < samples; ++i) to[i] = static_cast<double>(a[i]);
  }
  std::fill_n(features_.column(units), samples, 1.0);
  for (Index k = 0; k < units; ++k) {
    Index best = 0;
    for (Index c = 1; c < functions; ++c)
      if (std::abs(factor(c, k)) > std::abs(factor(best, k))) best = c;
    const double most = factor(best, k);
    for (Index c = 0; c < functions; ++c)
      ratio_[static_cast<std::size_t>(c * units + k)] =
          most == 0 ? 0 : factor(c, k) / most;
    const T* b = hidden.b + k * hidden.b_stride + best;
    double* const d = features_.column(shared + units * inputs + k);
    for (Index i = 0; i < samples; ++i)
      d[i] = static_cast<double>(b[i * functions]);
    for (Index j = 0; j < inputs; ++j) {
      const T* x = hidden.a + j * hidden.a_stride;
      double* to = features_.column(shared + k * inputs + j);
      for (Index i = 0; i < samples; ++i)
        to[i] = d[i] * static_cast<double>(x[i]);
    }
  }
  for (Index c = 0; c < functions; ++c) {
    double* to = features_.column(shared + own + c);
    for (Index i = 0; i < samples; ++i) to[i] = g(i * functions + c);
  }
  top_.resize(shared + own, shared + own + functions);
  triangularize(features_, shared + own, top_);

  // Column order: the output layer's, function by function, then the hidden
  // layer's as its parameters lie.
  const Index outer = functions * shared, p = outer + own;
  r_.setZero(p, p + 1);
  rest_.open(functions * own, own + 1);
  place_.resize(static_cast<std::size_t>(p));
  const auto unit_of = [&](Index e) {
    return e < units * inputs ? e / inputs : e - units * inputs;
  };
  for (Index c = 0; c < functions; ++c) {
    const Index at = c * shared;
    const double s = seen_[static_cast<std::size_t>(c)];
    for (Index k = 0; k < shared; ++k) {
      place_[static_cast<std::size_t>(at + k)] =
          output.offset + (k < units ? c * units + k : functions * units + c);
      for (Index i = 0; i <= k; ++i) r_(at + i, at + k) = s * top_(i, k);
      r_(at + k, p) = top_(k, shared + own + c);
    }
    for (Index e = 0; e < own; ++e) {
      const double q = ratio_[static_cast<std::size_t>(c * units + unit_of(e))];
      for (Index i = 0; i < shared; ++i)
        r_(at + i, outer + e) = q * top_(i, shared + e);
      double* to = rest_.column(e) + c * own;
      for (Index i = 0; i < own; ++i) to[i] = q * top_(shared + i, shared + e);
    }
    double* to = rest_.column(own) + c * own;
    for (Index i = 0; i < own; ++i) to[i] = top_(shared + i, shared + own + c);
  }
  for (Index e = 0; e < own; ++e)
    place_[static_cast<std::size_t>(outer + e)] = hidden.offset + e;
  corner_.resize(own, own + 1);
  triangularize(rest_, own, corner_);
  r_.bottomRightCorner(own, own + 1) = corner_;
  return true;
}

template bool SharedFunctions::triangle<float>(
    std::span<const LayerRows<float>>,
    VectorIn<float>,
    VectorIn<double>,
    Index);
template bool SharedFunctions::triangle<double>(
    std::span<const LayerRows<double>>,
    VectorIn<double>,
    VectorIn<double>,
    Index);

}  // namespace physinv::hig
