#include "suite/nn/sequential.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "suite/core/check.h"
#include "suite/nn/activation.h"
#include "suite/nn/chain.h"
#include "suite/nn/layer_rows.h"

namespace physinv::nn {
namespace {

/// Slots of a network's tape: a header, the input, the chain's.
enum Slot : std::size_t { kHeader, kInput, kChain };

/// Rows from `first` on, by `step`, whose samples are all equal.
template <class T>
Index constant_rows(Rows<const T> x, Index first, Index step) {
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

template <class T>
Layers<T> with_activations_taken_in(Layers<T> layers) {
  Layers<T> fused;
  for (auto& layer : layers) {
    const Activation* a = layer->pure_activation();
    const bool fits = fused.empty() ||  // else the chain refuses them
                      fused.back()->outputs() == layer->inputs();
    if (a != nullptr && !fused.empty() && fits && fused.back()->fuse(*a))
      continue;
    fused.push_back(std::move(layer));
  }
  return fused;
}

/// What a later call needs of the last forward pass.
struct Header {
  Index samples = 0, training = 0, fixed = 0;
  Index measured = 0;  ///< constant rows were looked for
  Index leading = 0, trailing = 0;

  static constexpr Index kSize = 6;
  static Header read(const Tape& tape) {
    const auto s = tape.view<Index>(kHeader);
    SUITE_CHECK(s.size() == kSize, "the tape contains no pass of a network");
    return {s(0), s(1), s(2), s(3), s(4), s(5)};
  }
  void write(Tape& tape) const {
    tape.slot<Index>(kHeader, kSize, 1) << samples, training, fixed, measured,
        leading, trailing;
  }
  template <class T>
  void measure(Rows<const T> x) {
    measured = 1;
    leading = constant_rows(x, 0, 1);
    trailing = leading == x.rows ? 0 : constant_rows(x, x.rows - 1, -1);
  }
  /// Constant rows are left to the code that folds them.
  template <class T>
  Replay<T> replay(VectorIn<T> parameters,
                   const Tape& tape,
                   Workspace& work) const {
    return {.parameters = parameters.data(),
            .tape = &tape,
            .slot = kChain,
            .work = &work,
            .training = training != 0};
  }
  template <class T>
  Replay<T> folded(Replay<T> at) const {
    if (fixed != 0) at.leading = leading, at.trailing = trailing;
    return at;
  }
};

template <class T>
class Sequential final : public Network<T>, public RowJacobian<T> {
 public:
  Sequential(Layers<T> layers, Init init)
      : chain_(with_activations_taken_in(std::move(layers))),
        init_(init),
        prefix_(chain_.prefix()),
        tensors_(chain_.tensors()) {
    std::array<int, 128> number{};
    Index offset = 0;
    for (TensorInfo& t : tensors_) {
      t.offset = offset;
      t.name =
          t.kind + std::to_string(++number[static_cast<std::size_t>(t.kind)]);
      offset += t.size;
    }
  }

  Index inputs() const override { return chain_.inputs(); }
  Index outputs() const override { return chain_.outputs(); }
  Index parameter_count() const override { return chain_.parameter_count(); }
  Index state_count() const override { return chain_.state_count(); }
  const std::vector<TensorInfo>& tensors() const override { return tensors_; }
  double operations() const override { return chain_.operations(); }

  void initialize(const Rng& rng,
                  VectorOut<T> parameters,
                  VectorOut<T> state) const override {
    check_sizes(parameters.size(), state.size());
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
    chain_.initialize_state(state.data());
  }

  void forward(VectorIn<T> parameters,
               VectorIn<T> state,
               BatchIn<T> in,
               BatchOut<T> out,
               Tape& tape,
               Workspace& work,
               Pass pass) const override {
    const Index n = in.cols();
    SUITE_CHECK(
        in.rows() == inputs() && out.rows() == outputs() && out.cols() == n,
        "a network's batch has the wrong shape");
    check_sizes(parameters.size(), state.size());
    work.counts[Counter::network_forward] += static_cast<std::uint64_t>(n);
    Header header;
    if (pass.same_input) {
      header = Header::read(tape);
      SUITE_CHECK(header.samples == n,
                  "the input must be the one of the last pass");
      if (prefix_ > 0)
        work.counts[Counter::skipped_features] += static_cast<std::uint64_t>(n);
    }
    header.samples = n;
    header.training = pass.training;
    header.fixed = pass.fixed_input && prefix_ < chain_.size() &&
                   chain_[prefix_].folds_constants();
    const auto y = chain_.opened(tape, kChain, n);
    const Replay<T> at = header.replay<T>(parameters, tape, work);
    if (!pass.same_input) {
      const Rows<T> x = open_rows<T>(tape, kInput, inputs(), n);
      to_rows<T>(in, x);
      chain_.forward({at, tape, state.data()}, x, 0, prefix_, y);
    }
    const Rows<const T> x = input(tape, prefix_, n);
    if (header.fixed != 0) {
      if (header.measured == 0) header.measure(x);
      work.counts[Counter::skipped_rows] +=
          static_cast<std::uint64_t>((header.leading + header.trailing) * n);
    }
    header.write(tape);
    chain_.forward(
        {header.folded(at), tape, state.data()}, x, prefix_, chain_.size(), y);
    from_rows<T>(input(tape, chain_.size(), n), out);
  }

  void backward(VectorIn<T> parameters,
                const Tape& tape,
                BatchIn<T> out_bar,
                VectorOut<T>* parameters_bar,
                BatchOut<T>* in_bar,
                Workspace& work) const override {
    if (parameters_bar == nullptr && in_bar == nullptr) return;
    const Header header = Header::read(tape);
    const Index n = header.samples;
    check_cotangent(out_bar, n);
    work.counts[Counter::network_backward] += static_cast<std::uint64_t>(n);
    const Workspace::Scope scope(work);
    const Bars<T> bars(chain_, n, work);
    const Rows<T> y_bar = bars(chain_.size());
    to_rows<T>(out_bar, y_bar);
    apply_gate<T>(last_gate(input(tape, chain_.size(), n)), y_bar);
    Backward<T> b{.x = input(tape, 0, n), .y_bar = y_bar};
    if (parameters_bar != nullptr) b.parameters_bar = parameters_bar->data();
    if (in_bar != nullptr) b.x_bar = bars(0);
    chain_.backward(header.folded(header.replay<T>(parameters, tape, work)),
                    b,
                    in_bar != nullptr ? 0 : prefix_,
                    chain_.kept(tape, kChain, n),
                    bars);
    if (in_bar != nullptr) from_rows<T>(b.x_bar, *in_bar);
  }

  void tangent(VectorIn<T> parameters,
               const Tape& tape,
               VectorIn<T> parameters_dot,
               BatchIn<T> in_dot,
               BatchOut<T> out_dot,
               Tape& dots,
               Workspace& work) const override {
    const Header header = Header::read(tape);
    const Index n = header.samples;
    SUITE_CHECK(parameters_dot.size() == parameter_count() &&
                    out_dot.rows() == outputs() && out_dot.cols() == n,
                "a direction has the wrong shape");
    work.counts[Counter::network_forward] += static_cast<std::uint64_t>(n);
    const std::size_t first = in_dot.cols() > 0 ? 0 : prefix_;
    const Rows<const T> x = input(tape, first, n);
    const Rows<T> x_dot = open_rows<T>(dots, kInput + first, x.rows, n);
    if (in_dot.cols() > 0) {
      SUITE_CHECK(in_dot.rows() == inputs() && in_dot.cols() == n,
                  "a direction has the wrong shape");
      to_rows<T>(in_dot, x_dot);
    } else {
      std::fill_n(x_dot.data, x_dot.rows * x_dot.stride, T(0));
    }
    chain_.tangent(header.replay<T>(parameters, tape, work),
                   {.x = x,
                    .x_dot = x_dot,
                    .parameters_dot = parameters_dot.data(),
                    .dots = &dots},
                   first,
                   chain_.size(),
                   chain_.kept(tape, kChain, n),
                   chain_.opened(dots, kChain, n));
    from_rows<T>(input(dots, chain_.size(), n), out_dot);
  }

  void backward_tangent(VectorIn<T> parameters,
                        const Tape& tape,
                        VectorIn<T> parameters_dot,
                        const Tape& dots,
                        BatchIn<T> out_bar,
                        BatchIn<T> out_bar_dot,
                        VectorOut<T>* parameters_bar,
                        VectorOut<T> parameters_bar_dot,
                        Workspace& work) const override {
    const Header header = Header::read(tape);
    const Index n = header.samples;
    check_cotangent(out_bar, n);
    check_cotangent(out_bar_dot, n);
    SUITE_CHECK(parameters_bar_dot.size() == parameter_count(),
                "a network's product has the wrong size");
    work.counts[Counter::network_backward] += 2 * static_cast<std::uint64_t>(n);
    const Workspace::Scope scope(work);
    const Bars<T> bars(chain_, n, work), bars_dot(chain_, n, work);
    const std::size_t last = chain_.size();
    to_rows<T>(out_bar, bars(last));
    to_rows<T>(out_bar_dot, bars_dot(last));
    apply_gate_tangent<T>(last_gate(input(tape, last, n)),
                          input(dots, last, n),
                          bars(last),
                          bars_dot(last));
    BackwardTangent<T> b{.y_bar = bars(last),
                         .y_bar_dot = bars_dot(last),
                         .parameters_dot = parameters_dot.data(),
                         .dots = &dots,
                         .parameters_bar_dot = parameters_bar_dot.data()};
    if (prefix_ == 0) b.x = input(tape, 0, n), b.x_dot = input(dots, 0, n);
    if (parameters_bar != nullptr) b.parameters_bar = parameters_bar->data();
    chain_.backward_tangent(header.replay<T>(parameters, tape, work),
                            b,
                            prefix_,
                            chain_.kept(tape, kChain, n),
                            chain_.kept(dots, kChain, n),
                            bars,
                            bars_dot);
  }

  void jacobian_rows(VectorIn<T> parameters,
                     const Tape& tape,
                     BatchIn<T> out_bar,
                     std::vector<LayerRows<T>>& layers,
                     Workspace& work) const override {
    const Header header = Header::read(tape);
    const Index n = header.samples, rows = out_bar.cols(), per = rows / n;
    SUITE_CHECK(out_bar.rows() == outputs() && per * n == rows,
                "every sample must have the same number of rows");
    work.counts[Counter::network_backward] += static_cast<std::uint64_t>(rows);
    // One block, as the workspace grows by doubling.
    const std::size_t last = chain_.size() - 1;
    Index all = 2 * outputs();
    for (std::size_t i = prefix_ + 1; i <= last; ++i)
      all += 2 * chain_[i].inputs();
    const bool looks_back = chain_[last].fused() != Activation::identity ||
                            chain_[last].tensors().empty();
    if (!looks_back) all -= outputs();
    Rows<T> free = take_rows<T>(work, all, rows);
    const auto take = [&](Index features) {
      const Rows<T> taken(free.data, features, rows);
      free.data = free.row(features);
      return taken;
    };
    // What a layer remembers is one column per sample; its rows share it.
    const auto spread = [&](std::size_t i) {
      const Rows<const T> from = input(tape, i, n);
      const Rows<T> to = take(from.rows);
      for (Index f = 0; f < from.rows; ++f) {
        for (Index s = 0; s < n; ++s)
          std::fill_n(to.row(f) + s * per, per, from.row(f)[s]);
        std::fill(to.row(f) + rows, to.row(f) + to.width, T(0));
      }
      return to;
    };
    Rows<T> y_bar = take(outputs()), y;
    to_rows<T>(out_bar, y_bar);
    // Layers that give rows do not look at their output in `backward`.
    if (looks_back) y = spread(last + 1);
    apply_gate<T>(last_gate(y), y_bar);
    const Replay<T> at =
        header.folded(header.replay<T>(parameters, tape, work));
    for (std::size_t i = last + 1; i-- > prefix_;) {
      chain_[i].add_rows(
          input(tape, i, n), y_bar, chain_.parameters(i), layers);
      if (i == prefix_) break;
      const Rows<T> x = spread(i);
      const Backward<T> b{.x = x,
                          .y = y,
                          .y_bar = y_bar,
                          .x_bar = take(x.rows),
                          .gate = {chain_[i - 1].fused(), x}};
      chain_[i].backward(chain_.within(at, i), b);
      y_bar = b.x_bar, y = x;
    }
  }

  void update_state(const Tape& tape, VectorOut<T> state) const override {
    if (state_count() == 0) return;
    SUITE_CHECK(Header::read(tape).training != 0,
                "the last pass had no batch statistics");
    chain_.update_state(tape, kChain, state.data());
  }

  bool evaluate_plainly(VectorIn<double> parameters,
                        VectorIn<double> in,
                        Vector<double>& out) const override {
    out = in;
    for (std::size_t i = 0; i < chain_.size(); ++i) {
      Vector<double> y(chain_[i].outputs());
      if (!chain_[i].evaluate_plainly(
              parameters.data() + chain_.parameters(i), out, y))
        return false;
      out = std::move(y);
    }
    return true;
  }

 private:
  void check_sizes(Index parameters, Index state) const {
    SUITE_CHECK(parameters == parameter_count() && state == state_count(),
                "parameters or state have the wrong size");
  }
  void check_cotangent(BatchIn<T> out_bar, Index samples) const {
    SUITE_CHECK(out_bar.rows() == outputs() && out_bar.cols() == samples,
                "a network's cotangent has the wrong shape");
  }
  /// Of layer i, on this tape; that of layer size() is the output.
  Rows<T> input(const Tape& tape, std::size_t i, Index samples) const {
    const Index rows = i == 0 ? inputs() : chain_[i - 1].outputs();
    return kept_rows<T>(tape, kInput + i, rows, samples);
  }
  Gate<T> last_gate(Rows<const T> y) const {
    return {chain_[chain_.size() - 1].fused(), y};
  }

  Chain<T> chain_;
  Init init_;
  std::size_t prefix_;
  std::vector<TensorInfo> tensors_;
};

}  // namespace

std::string_view to_string(Init init) {
  constexpr std::string_view kNames[] = {"fan_in", "glorot", "uniform", "he"};
  return kNames[static_cast<std::size_t>(init)];
}

template <class T>
std::unique_ptr<Network<T>> sequential(Layers<T> layers, Init init) {
  return std::make_unique<Sequential<T>>(std::move(layers), init);
}

template decltype(sequential<float>) sequential<float>;
template decltype(sequential<double>) sequential<double>;

}  // namespace physinv::nn
