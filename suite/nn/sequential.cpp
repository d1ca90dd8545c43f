#include "suite/nn/sequential.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "suite/core/check.h"
#include "suite/nn/activation.h"

namespace physinv::nn {
namespace {

/// Rows from `first` on, by `step`, whose samples are all equal.
template <class T>
Index constant_rows(Lanes<const T> x, Index first, Index step) {
  Index count = 0;
  for (Index i = first; i >= 0 && i < x.rows; i += step, ++count) {
    const T* row = x.row(i);
    if (!std::all_of(row, row + x.samples, [&](T v) { return v == row[0]; }))
      break;
  }
  return count;
}

double bound_of(Init init, const TensorInfo& t) {
  if (init == Init::glorot)
    return std::sqrt(6.0 / static_cast<double>(t.fan_in + t.fan_out));
  const double gain = init == Init::he ? std::sqrt(6.0) : 1.0;
  return gain / std::sqrt(static_cast<double>(t.fan_in));
}

/// Matrices and kernels always are, biases by `Init::uniform` alone.
bool is_drawn(Init init, char kind) {
  return kind == 'm' || kind == 'k' || (kind == 'b' && init == Init::uniform);
}

}  // namespace

std::string_view to_string(Init init) {
  constexpr std::string_view kNames[] = {"fan_in", "glorot", "uniform", "he"};
  return kNames[static_cast<std::size_t>(init)];
}

/// Slot 0: what a later call must know about the last forward pass.
template <class T>
struct Sequential<T>::Header {
  Index samples = 0, training = 0, fixed = 0;
  Index measured = 0;  ///< constant rows were looked for
  Index leading = 0, trailing = 0;

  static constexpr Index kSize = 6;
  static Header read(const Tape& tape) {
    const auto s = tape.view<Index>(0);
    SUITE_CHECK(s.size() == kSize, "the tape holds no pass of a network");
    return {s(0), s(1), s(2), s(3), s(4), s(5)};
  }
  void write(Tape& tape) const {
    tape.slot<Index>(0, kSize, 1) << samples, training, fixed, measured,
        leading, trailing;
  }
  void measure(Lanes<const T> x) {
    measured = 1;
    leading = constant_rows(x, 0, 1);
    trailing = leading == x.rows ? 0 : constant_rows(x, x.rows - 1, -1);
  }
};

template <class T>
Sequential<T>::Sequential(Layers layers, Init init) : init_(init) {
  SUITE_CHECK(!layers.empty(), "a network has at least one layer");
  for (auto& layer : layers) {
    SUITE_CHECK(layers_.empty() || layers_.back()->outputs() == layer->inputs(),
                "neighbouring layers differ in size");
    const Activation* a = layer->pure_activation();
    if (a != nullptr && !layers_.empty() && layers_.back()->fuse(*a)) continue;
    layers_.push_back(std::move(layer));
  }
  place_layers();
}

template <class T>
void Sequential<T>::place_layers() {
  std::array<int, 128> number{};
  std::size_t slot = 2 + layers_.size();
  widest_ = inputs();
  bool leading = true;
  for (const auto& layer : layers_) {
    places_.push_back({parameter_count_, state_count_, slot});
    for (TensorInfo t : layer->tensors()) {
      t.offset = parameter_count_;
      t.name =
          t.kind + std::to_string(++number[static_cast<std::size_t>(t.kind)]);
      parameter_count_ += t.size;
      tensors_.push_back(std::move(t));
    }
    state_count_ += layer->state_count();
    slot += layer->slots();
    widest_ = std::max(widest_, layer->outputs());
    leading = leading && parameter_count_ == 0 && state_count_ == 0;
    if (leading) ++prefix_;
  }
}

template <class T>
void Sequential<T>::initialize(const Rng& rng,
                               VectorOut<T> parameters,
                               VectorOut<T> state) const {
  SUITE_CHECK(
      parameters.size() == parameter_count_ && state.size() == state_count_,
      "parameters or state have the wrong size");
  for (const TensorInfo& t : tensors_) {
    auto part = parameters.segment(t.offset, t.size);
    part.setConstant(t.kind == 's' ? T(1) : T(0));
    const bool own = t.up_to > 0;
    if (!own && !is_drawn(init_, t.kind)) continue;
    Stream stream = rng.child(t.name).stream();
    const double bound = own ? t.up_to : bound_of(init_, t);
    const double least = own ? 0 : -bound;
    for (T& w : part) w = static_cast<T>(stream.uniform(least, bound));
  }
  for (std::size_t i = 0; i < layers_.size(); ++i)
    layers_[i]->initialize_state(state.data() + places_[i].state);
}

template <class T>
Lanes<T> Sequential<T>::open(Tape& tape, std::size_t i, Index samples) const {
  const Index rows = i == 0 ? inputs() : layers_[i - 1]->outputs();
  Lanes<T> x(nullptr, rows, samples);
  x.data = tape.slot<T>(1 + i, x.stride, rows).data();
  return x;
}

template <class T>
Lanes<T> Sequential<T>::features(const Tape& tape,
                                 std::size_t i,
                                 Index samples) const {
  const Index rows = i == 0 ? inputs() : layers_[i - 1]->outputs();
  return {tape.view<T>(1 + i).data(), rows, samples};
}

template <class T>
LayerArgs<T> Sequential<T>::args(std::size_t layer,
                                 const Header& header,
                                 Tape& tape,
                                 Workspace& work) const {
  LayerArgs<T> at{.tape = &tape,
                  .slot = places_[layer].slot,
                  .work = &work,
                  .training = header.training != 0};
  if (layer == prefix_ && header.fixed != 0)
    at.leading = header.leading, at.trailing = header.trailing;
  return at;
}

template <class T>
void Sequential<T>::run_prefix(BatchIn<T> in,
                               const Header& header,
                               Tape& tape,
                               Workspace& work) const {
  to_lanes<T>(in, open(tape, 0, header.samples));
  for (std::size_t i = 0; i < prefix_; ++i)
    layers_[i]->forward(args(i, header, tape, work),
                        features(tape, i, header.samples),
                        open(tape, i + 1, header.samples));
}

template <class T>
void Sequential<T>::forward(VectorIn<T> parameters,
                            VectorIn<T> state,
                            BatchIn<T> in,
                            BatchOut<T> out,
                            Tape& tape,
                            Workspace& work,
                            Pass pass) const {
  const Index n = in.cols();
  SUITE_CHECK(
      in.rows() == inputs() && out.rows() == outputs() && out.cols() == n,
      "a network's batch has the wrong shape");
  SUITE_CHECK(
      parameters.size() == parameter_count_ && state.size() == state_count_,
      "parameters or state have the wrong size");
  work.counts[Counter::network_forward] += static_cast<std::uint64_t>(n);
  Header header;
  if (pass.same_input) {
    header = Header::read(tape);
    SUITE_CHECK(header.samples == n, "not the input of the last pass");
    if (prefix_ > 0)
      work.counts[Counter::skipped_features] += static_cast<std::uint64_t>(n);
  }
  header.samples = n;
  header.training = pass.training;
  header.fixed = pass.fixed_input && prefix_ < layers_.size() &&
                 layers_[prefix_]->folds_constants();
  if (!pass.same_input) run_prefix(in, header, tape, work);
  if (header.fixed != 0) {
    if (header.measured == 0) header.measure(features(tape, prefix_, n));
    work.counts[Counter::skipped_rows] +=
        static_cast<std::uint64_t>((header.leading + header.trailing) * n);
  }
  header.write(tape);
  for (std::size_t i = prefix_; i < layers_.size(); ++i) {
    LayerArgs<T> at = args(i, header, tape, work);
    at.parameters = parameters.data() + places_[i].parameters;
    at.state = state.data() + places_[i].state;
    const Lanes<T> y = open(tape, i + 1, n);
    layers_[i]->forward(at, features(tape, i, n), y);
  }
  from_lanes<T>(features(tape, layers_.size(), n), out);
}

template <class T>
void Sequential<T>::backward(VectorIn<T> parameters,
                             const Tape& tape,
                             BatchIn<T> out_bar,
                             VectorOut<T>* parameters_bar,
                             BatchOut<T>* in_bar,
                             Workspace& work) const {
  if (parameters_bar == nullptr && in_bar == nullptr) return;
  const Header header = Header::read(tape);
  const Index n = header.samples;
  SUITE_CHECK(out_bar.rows() == outputs() && out_bar.cols() == n,
              "a network's cotangent has the wrong shape");
  work.counts[Counter::network_backward] += static_cast<std::uint64_t>(n);
  const Workspace::Scope scope(work);
  const Index stride = Lanes<T>(nullptr, widest_, n).stride;
  T* free = work.take<T>(stride, widest_).data();
  Lanes<T> y_bar(work.take<T>(stride, widest_).data(), outputs(), n);
  to_lanes<T>(out_bar, y_bar);
  apply_gate<T>({layers_.back()->fused(), features(tape, layers_.size(), n)},
                y_bar);

  const std::size_t end = in_bar != nullptr ? 0 : prefix_;
  for (std::size_t i = layers_.size(); i-- > end;) {
    const Layer<T>& layer = *layers_[i];
    Backward<T> b{.x = features(tape, i, n),
                  .y = features(tape, i + 1, n),
                  .y_bar = y_bar};
    if (parameters_bar != nullptr)
      b.parameters_bar = parameters_bar->data() + places_[i].parameters;
    if (i > end) {
      b.gate = {layers_[i - 1]->fused(), b.x};
    }
    if (i > end || in_bar != nullptr) b.x_bar = {free, layer.inputs(), n};
    // Layers read the tape here; the interface they share also writes it.
    LayerArgs<T> at = args(i, header, const_cast<Tape&>(tape), work);
    at.parameters = parameters.data() + places_[i].parameters;
    layer.backward(at, b);
    free = y_bar.data;
    y_bar = b.x_bar;
  }
  if (in_bar != nullptr) from_lanes<T>(y_bar, *in_bar);
}

template <class T>
void Sequential<T>::jacobian_rows(VectorIn<T> parameters,
                                  const Tape& tape,
                                  BatchIn<T> out_bar,
                                  std::vector<LayerRows<T>>& layers,
                                  Workspace& work) const {
  const Header header = Header::read(tape);
  const Index n = header.samples, rows = out_bar.cols(), per = rows / n;
  SUITE_CHECK(out_bar.rows() == outputs() && per * n == rows,
              "as many rows for each sample");
  work.counts[Counter::network_backward] += static_cast<std::uint64_t>(rows);
  // One block, as the workspace grows by doubling.
  Index all = 2 * outputs();
  for (std::size_t i = prefix_ + 1; i < layers_.size(); ++i)
    all += 2 * layers_[i]->inputs();
  const bool looks_back = layers_.back()->fused() != Activation::identity ||
                          layers_.back()->tensors().empty();
  if (!looks_back) all -= outputs();
  const Index stride = Lanes<T>(nullptr, 1, rows).stride;
  T* free = work.take<T>(stride, all).data();
  const auto take = [&](Index features) {
    const Lanes<T> lanes(free, features, rows);
    free += features * stride;
    return lanes;
  };
  // What a layer remembers is one column per sample; its rows share it.
  const auto spread = [&](std::size_t i) {
    const Lanes<T> from = features(tape, i, n), to = take(from.rows);
    for (Index f = 0; f < from.rows; ++f) {
      for (Index s = 0; s < n; ++s)
        std::fill_n(to.row(f) + s * per, per, from.row(f)[s]);
      std::fill(to.row(f) + rows, to.row(f) + to.width, T(0));
    }
    return to;
  };
  Lanes<T> y_bar = take(outputs()), y;
  to_lanes<T>(out_bar, y_bar);
  // Layers that give rows do not look at their output in `backward`.
  if (looks_back) y = spread(layers_.size());
  apply_gate<T>({layers_.back()->fused(), y}, y_bar);
  for (std::size_t i = layers_.size(); i-- > prefix_;) {
    const Layer<T>& layer = *layers_[i];
    layer.add_rows(features(tape, i, n), y_bar, places_[i].parameters, layers);
    if (i == prefix_) break;
    const Lanes<T> x = spread(i);
    const Backward<T> b{.x = x,
                        .y = y,
                        .y_bar = y_bar,
                        .x_bar = take(layer.inputs()),
                        .gate = {layers_[i - 1]->fused(), x}};
    LayerArgs<T> at = args(i, header, const_cast<Tape&>(tape), work);
    at.parameters = parameters.data() + places_[i].parameters;
    layer.backward(at, b);
    y_bar = b.x_bar, y = x;
  }
}

template <class T>
void Sequential<T>::tangent(VectorIn<T> parameters,
                            const Tape& tape,
                            VectorIn<T> parameters_dot,
                            BatchIn<T> in_dot,
                            BatchOut<T> out_dot,
                            Tape& dots,
                            Workspace& work) const {
  const Header header = Header::read(tape);
  const Index n = header.samples;
  SUITE_CHECK(parameters_dot.size() == parameter_count_ &&
                  out_dot.rows() == outputs() && out_dot.cols() == n,
              "a direction has the wrong shape");
  work.counts[Counter::network_forward] += static_cast<std::uint64_t>(n);
  const std::size_t first = in_dot.cols() > 0 ? 0 : prefix_;
  const Lanes<T> start = open(dots, first, n);
  if (in_dot.cols() > 0) {
    SUITE_CHECK(in_dot.rows() == inputs() && in_dot.cols() == n,
                "a direction has the wrong shape");
    to_lanes<T>(in_dot, start);
  } else {
    std::fill_n(start.data, start.rows * start.stride, T(0));
  }
  for (std::size_t i = first; i < layers_.size(); ++i) {
    const LayerArgs<T> at =
        tangent_args(i, header, parameters, tape, parameters_dot, dots, work);
    layers_[i]->tangent(at,
                        {.x = features(tape, i, n),
                         .y = features(tape, i + 1, n),
                         .x_dot = features(dots, i, n),
                         .y_dot = open(dots, i + 1, n)});
  }
  from_lanes<T>(features(dots, layers_.size(), n), out_dot);
}

template <class T>
LayerArgs<T> Sequential<T>::tangent_args(std::size_t i,
                                         const Header& header,
                                         VectorIn<T> parameters,
                                         const Tape& tape,
                                         VectorIn<T> parameters_dot,
                                         const Tape& dots,
                                         Workspace& work) const {
  LayerArgs<T> at = args(i, header, const_cast<Tape&>(tape), work);
  at.leading = at.trailing = 0;
  at.parameters = parameters.data() + places_[i].parameters;
  at.parameters_dot = parameters_dot.data() + places_[i].parameters;
  at.dots = const_cast<Tape*>(&dots);
  return at;
}

template <class T>
void Sequential<T>::backward_tangent(VectorIn<T> parameters,
                                     const Tape& tape,
                                     VectorIn<T> parameters_dot,
                                     const Tape& dots,
                                     BatchIn<T> out_bar,
                                     BatchIn<T> out_bar_dot,
                                     VectorOut<T>* parameters_bar,
                                     VectorOut<T> parameters_bar_dot,
                                     Workspace& work) const {
  const Header header = Header::read(tape);
  const Index n = header.samples;
  SUITE_CHECK(out_bar.rows() == outputs() && out_bar.cols() == n &&
                  out_bar_dot.rows() == outputs() && out_bar_dot.cols() == n,
              "a network's cotangent has the wrong shape");
  SUITE_CHECK(parameters_bar_dot.size() == parameter_count_,
              "a network's product has the wrong size");
  work.counts[Counter::network_backward] += 2 * static_cast<std::uint64_t>(n);
  const Workspace::Scope scope(work);
  // Cotangent and derivative of the layer at hand, and of the one below.
  std::array<Lanes<T>, 4> bars;
  for (Lanes<T>& bar : bars) {
    bar = {nullptr, widest_, n};
    bar.data = work.take<T>(bar.stride, bar.rows).data();
  }
  auto& [y_bar, y_bar_dot, x_bar, x_bar_dot] = bars;
  y_bar.rows = y_bar_dot.rows = outputs();
  to_lanes<T>(out_bar, y_bar);
  to_lanes<T>(out_bar_dot, y_bar_dot);
  const auto gate = [&](std::size_t i, Lanes<T> bar, Lanes<T> bar_dot) {
    apply_gate_tangent<T>({layers_[i]->fused(), features(tape, i + 1, n)},
                          features(dots, i + 1, n),
                          bar,
                          bar_dot);
  };
  gate(layers_.size() - 1, y_bar, y_bar_dot);
  for (std::size_t i = layers_.size(); i-- > prefix_;) {
    x_bar.rows = x_bar_dot.rows = layers_[i]->inputs();
    BackwardTangent<T> b{.x = features(tape, i, n),
                         .y = features(tape, i + 1, n),
                         .x_dot = features(dots, i, n),
                         .y_dot = features(dots, i + 1, n),
                         .y_bar = y_bar,
                         .y_bar_dot = y_bar_dot};
    const Index place = places_[i].parameters;
    if (parameters_bar != nullptr)
      b.parameters_bar = parameters_bar->data() + place;
    b.parameters_bar_dot = parameters_bar_dot.data() + place;
    if (i > prefix_) b.x_bar = x_bar, b.x_bar_dot = x_bar_dot;
    layers_[i]->backward_tangent(
        tangent_args(i, header, parameters, tape, parameters_dot, dots, work),
        b);
    if (i > prefix_) gate(i - 1, x_bar, x_bar_dot);
    std::swap(y_bar, x_bar), std::swap(y_bar_dot, x_bar_dot);
  }
}

template <class T>
void Sequential<T>::update_state(const Tape& tape, VectorOut<T> state) const {
  if (state_count_ == 0) return;
  SUITE_CHECK(Header::read(tape).training != 0,
              "the last pass had no batch statistics");
  for (std::size_t i = 0; i < layers_.size(); ++i)
    layers_[i]->update_state(
        tape, places_[i].slot, state.data() + places_[i].state);
}

template <class T>
bool Sequential<T>::evaluate_plainly(VectorIn<double> parameters,
                                     VectorIn<double> in,
                                     Vector<double>& out) const {
  out = in;
  for (std::size_t i = 0; i < layers_.size(); ++i) {
    Vector<double> y(layers_[i]->outputs());
    if (!layers_[i]->evaluate_plainly(
            parameters.data() + places_[i].parameters, out, y))
      return false;
    out = std::move(y);
  }
  return true;
}

template <class T>
double Sequential<T>::operations() const {
  double sum = 0;
  for (const auto& layer : layers_) sum += layer->operations();
  return sum;
}

template class Sequential<float>;
template class Sequential<double>;

}  // namespace physinv::nn
