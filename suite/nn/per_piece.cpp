#include "suite/nn/per_piece.h"

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "suite/core/blocks.h"
#include "suite/core/check.h"
#include "suite/nn/chain.h"

namespace physinv::nn {
namespace {

constexpr Index kMostParts = 8;  ///< partial sums of a gradient

template <class T>
class PerPiece final : public Layer<T> {
 public:
  PerPiece(Index pieces, Chain<T> inner)
      : Layer<T>(pieces * inner.inputs(), pieces * inner.outputs()),
        pieces_(pieces),
        inner_(std::move(inner)) {
    SUITE_CHECK(inner_.slots() == inner_.size() && inner_.state_count() == 0,
                "layers applied to pieces must not have a state");
  }

  std::vector<TensorInfo> tensors() const override { return inner_.tensors(); }
  double operations() const override {
    return inner_.operations() * static_cast<double>(pieces_);
  }

  void forward(const Run<T>& at, Rows<const T> x, Rows<T> y) const override {
    for_blocks(*at.work, pieces_, [&](Index piece, Workspace& work) {
      run(within(at, work), part(x, piece), part(y, piece));
    });
  }

  void backward(const Replay<T>& at, const Backward<T>& b) const override {
    const bool first = b.parameters_bar != nullptr;
    const Index size = first ? inner_.parameter_count() : 0;
    sum_pieces(*at.work,
               size,
               b.parameters_bar,
               [&](Index piece, T* own, Workspace& work) {
                 pull(within(at, work),
                      {.x = part(b.x, piece),
                       .y = part(b.y, piece),
                       .y_bar = part(b.y_bar, piece),
                       .parameters_bar = first ? own : nullptr,
                       .x_bar = part(b.x_bar, piece),
                       .gate = {b.gate.activation, part(b.gate.y, piece)}});
               });
  }

  void tangent(const Replay<T>& at, const Tangent<T>& t) const override {
    for_blocks(*at.work, pieces_, [&](Index piece, Workspace& work) {
      const Replay<T> own = within(at, work);
      Tangent<T> some = t;
      some.x = part(t.x, piece), some.y = part(t.y, piece);
      some.x_dot = part(t.x_dot, piece), some.y_dot = part(t.y_dot, piece);
      push(own, run(own, some.x, {}), some);
    });
  }

  void backward_tangent(const Replay<T>& at,
                        const BackwardTangent<T>& b) const override {
    const Index size = inner_.parameter_count();
    const Workspace::Scope scope(*at.work);
    T* const sums = at.work->template take<T>(2 * size, 1).data();
    const bool first = b.parameters_bar != nullptr;
    sum_pieces(
        *at.work, 2 * size, sums, [&](Index piece, T* own, Workspace& work) {
          std::fill_n(own, size, T(0));
          pull_tangent(within(at, work),
                       {.x = part(b.x, piece),
                        .y = part(b.y, piece),
                        .x_dot = part(b.x_dot, piece),
                        .y_dot = part(b.y_dot, piece),
                        .y_bar = part(b.y_bar, piece),
                        .y_bar_dot = part(b.y_bar_dot, piece),
                        .parameters_dot = b.parameters_dot,
                        .dots = b.dots,
                        .parameters_bar = first ? own : nullptr,
                        .parameters_bar_dot = own + size,
                        .x_bar = part(b.x_bar, piece),
                        .x_bar_dot = part(b.x_bar_dot, piece)});
        });
    if (first) std::copy_n(sums, size, b.parameters_bar);
    std::copy_n(sums + size, size, b.parameters_bar_dot);
  }

 private:
  /// Rows of a piece; none of none.
  template <class U>
  Rows<U> part(Rows<U> x, Index piece) const {
    const Index rows = x.rows / pieces_;
    return x ? Rows<U>(x.data + piece * rows * x.stride, rows, x.samples) : x;
  }
  static Replay<T> within(Replay<T> at, Workspace& work) {
    at.work = &work;
    return at;
  }
  /// Room for the outputs of all layers but the last, which is given.
  std::vector<Rows<T>> room(Rows<T> last,
                            Index samples,
                            Workspace& work) const {
    std::vector<Rows<T>> outputs;
    for (std::size_t i = 0; i + 1 < inner_.size(); ++i)
      outputs.push_back(take_rows<T>(work, inner_[i].outputs(), samples));
    outputs.push_back(last);
    return outputs;
  }
  std::size_t layers_before(const Rows<T>& last) const {
    return inner_.size() - (last ? 0 : 1);
  }
  /// Outputs of all layers for one piece; without y, of all but the last.
  std::vector<Rows<T>> run(const Replay<T>& at,
                           Rows<const T> x,
                           Rows<T> y) const {
    Tape nothing;
    auto outputs = room(y, x.samples, *at.work);
    inner_.forward(
        {at, nothing, nullptr}, x, 0, layers_before(y), [&](std::size_t i) {
          return outputs[i];
        });
    return outputs;
  }
  /// y(i) and y_dot(i) as a chain asks for them, the last one's from outside.
  static auto reader(const std::vector<Rows<T>>& outputs, Rows<const T> last) {
    return [&outputs, last](std::size_t i) {
      return i + 1 < outputs.size() ? Rows<const T>(outputs[i]) : last;
    };
  }
  /// Derivatives of all layers' outputs, the last one's in t.y_dot; without
  /// it, of all but the last. `outputs` are those of `run`.
  std::vector<Rows<T>> push(const Replay<T>& at,
                            const std::vector<Rows<T>>& outputs,
                            const Tangent<T>& t) const {
    auto dots = room(t.y_dot, t.x.samples, *at.work);
    inner_.tangent(at,
                   t,
                   0,
                   layers_before(t.y_dot),
                   reader(outputs, t.y),
                   [&](std::size_t i) { return dots[i]; });
    return dots;
  }
  void pull(const Replay<T>& at, const Backward<T>& b) const {
    const Workspace::Scope scope(*at.work);
    const auto outputs = run(at, b.x, {});
    const Bars<T> bars(inner_, b.x.samples, *at.work);
    inner_.backward(at, b, 0, reader(outputs, b.y), bars);
  }
  void pull_tangent(const Replay<T>& at, const BackwardTangent<T>& b) const {
    const Workspace::Scope scope(*at.work);
    const Index n = b.x.samples;
    Tape nothing;
    const auto outputs = run(at, b.x, {});
    const auto dots = push(at,
                           outputs,
                           {.x = b.x,
                            .y = b.y,
                            .x_dot = b.x_dot,
                            .parameters_dot = b.parameters_dot,
                            .dots = &nothing});
    const Bars<T> bars(inner_, n, *at.work), bars_dot(inner_, n, *at.work);
    inner_.backward_tangent(
        at, b, 0, reader(outputs, b.y), reader(dots, b.y_dot), bars, bars_dot);
  }
  /// step(piece, bars, workspace) for every piece; bars, one after the other,
  /// are what it leaves in its array of the same size, summed.
  template <class F>
  void sum_pieces(Workspace& work, Index size, T* bars, F&& step) const {
    const Workspace::Scope scope(work);
    const Index parts = std::min(kMostParts, pieces_);
    T* const sums = work.take<T>(size, parts).data();
    std::fill_n(sums, size * parts, T(0));
    for_blocks(work, parts, [&](Index part, Workspace& some) {
      T* const own = some.take<T>(size, 1).data();
      const Index end = pieces_ * (part + 1) / parts;
      for (Index piece = pieces_ * part / parts; piece < end; ++piece) {
        step(piece, own, some);
        for (Index i = 0; i < size; ++i) sums[part * size + i] += own[i];
      }
    });
    if (size == 0) return;
    std::copy_n(sums, size, bars);
    for (Index part = 1; part < parts; ++part)
      for (Index i = 0; i < size; ++i) bars[i] += sums[part * size + i];
  }

  Index pieces_;
  Chain<T> inner_;
};

}  // namespace

template <class T>
LayerPointer<T> per_piece(Index pieces, Layers<T> inner) {
  return std::make_unique<PerPiece<T>>(pieces, Chain<T>(std::move(inner)));
}

template decltype(per_piece<float>) per_piece<float>;
template decltype(per_piece<double>) per_piece<double>;

}  // namespace physinv::nn
