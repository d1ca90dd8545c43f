// What Python calls a problem with: arrays in, arrays out, without the lock of
// the interpreter while it computes.
#include <utility>
#include <vector>

#include "python/module/problem.h"

namespace physinv::python {
namespace {

using Object = const py::object&;

/// An argument, as a batch; `array` keeps what it may have been converted to.
template <class T>
struct Input {
  Array<T> array;
  View<T> batch;
};

/// A result of (samples, features), and as a batch.
template <class T>
struct Output {
  explicit Output(const std::vector<Index>& shape)
      : array(shape),
        batch(array.mutable_data(),
              shape[0] == 0 ? 0 : array.size() / shape[0],
              shape[0]) {}
  Array<T> array;
  Eigen::Map<Batch<T>> batch;
};

/// One call in T. Its first array says how many samples there are.
template <class T>
class Call {
 public:
  explicit Call(const PyProblem& problem)
      : shape(problem.shape()),
        self_(problem),
        side_(problem.sides()->of<T>()) {}

  Input<T> first(Object argument, const char* name, Index features) {
    const auto array = taken<T>(argument, name);
    samples = array.ndim() > 0 ? array.shape(0) : 0;
    return {array, view<T>(array, name, samples, features)};
  }
  Input<T> next(Object argument, const char* name, Index features) const {
    const auto array = taken<T>(argument, name);
    return {array, view<T>(array, name, samples, features)};
  }
  Input<T> given(Object argument) const {
    if (!argument.is_none()) return next(argument, "given", shape.given);
    if (shape.given > 0)
      throw py::value_error(
          fmt::format("{} needs given, (samples, features) = ({}, {})",
                      self_.name(),
                      samples,
                      shape.given));
    return {{}, {nullptr, 0, samples}};
  }
  template <class... Sizes>
  Output<T> out(Sizes... features) const {
    return Output<T>({samples, features...});
  }

  template <template <class> class Ability>
  const Ability<T>& need(const char* ability) const {
    return self_.sides()->template need<Ability, T>(ability);
  }
  const Problem<T>& problem() const { return *side_.problem; }
  auto linearization() const {
    return std::make_shared<Linearization<T>>(self_.sides(), samples);
  }
  /// f(scratch), while other threads of Python can run; nothing without
  /// samples.
  template <class F>
  void compute(F&& f) const {
    if (samples == 0) return;
    const py::gil_scoped_release released;
    const auto work = side_.work.take();
    f(*work);
  }

  const Shape shape;
  Index samples = 0;

 private:
  const PyProblem& self_;
  Side<T>& side_;
};

template <std::size_t>
using Another = Object;

template <class F, std::size_t... I>
auto in_its_precision(F f, std::index_sequence<I...>) {
  return [f](const PyProblem& p, Object first, Another<I>... others) {
    if (py::isinstance<py::array_t<float>>(first)) {
      Call<float> call(p);
      return py::object(f(call, first, others...));
    }
    Call<double> call(p);
    return py::object(f(call, first, others...));
  };
}

/// f(call, arguments...): in single precision where the first one is, else in
/// double. `about` is what help() shows, after a line of the signature.
template <class F, class... Args>
void define(py::class_<PyProblem>& c,
            const char* name,
            const char* about,
            F f,
            const py::arg& first,
            const Args&... others) {
  c.def(name,
        in_its_precision(f, std::index_sequence_for<Args...>{}),
        first,
        others...,
        about);
}

void define_passes(py::class_<PyProblem>& c) {
  const py::arg x("x");
  const auto given = py::arg("given") = py::none();
  define(
      c,
      "forward",
      "forward($self, x, given=None)\n--\n\n"
      "Observations y = F(x | given): x (samples, unknowns), given (samples, "
      "side input)\nwhere the problem has some, to (samples, observations).",
      [](auto& call, Object a, Object b) {
        const auto at = call.first(a, "x", call.shape.unknowns);
        const auto side = call.given(b);
        auto y = call.out(call.shape.observations);
        call.compute([&](Workspace& work) {
          call.problem().forward({at.batch, side.batch}, y.batch, work);
        });
        return y.array;
      },
      x,
      given);
  define(
      c,
      "linearize",
      "linearize($self, x, given=None)\n--\n\n"
      "y = F(x | given), with the bits of `forward`, and a tape: its "
      "`pullback` "
      "and\n`pushforward` are products with the Jacobian at x. Needs vjp.",
      [](auto& call, Object a, Object b) {
        const auto& vjp = call.template need<Vjp>("vjp, which linearize needs");
        const auto at = call.first(a, "x", call.shape.unknowns);
        const auto side = call.given(b);
        auto y = call.out(call.shape.observations);
        const auto point = call.linearization();
        call.compute([&](Workspace&) {
          vjp.linearize({at.batch, side.batch}, y.batch, point->tape());
        });
        return py::make_tuple(y.array, point);
      },
      x,
      given);
}

void define_pushforward(py::class_<PyProblem>& c) {
  define(
      c,
      "pushforward",
      "pushforward($self, x, x_dot, given=None)\n--\n\n"
      "J x_dot at x: how y moves with x along x_dot, (samples, observations). "
      "Many\ndirections at one x take `linearize` and its tape. Needs jvp.",
      [](auto& call, Object a, Object b, Object g) {
        const auto& vjp = call.template need<Vjp>("vjp");
        const auto& jvp =
            call.template need<Jvp>("jvp, which pushforward needs");
        const auto at = call.first(a, "x", call.shape.unknowns);
        const auto x_dot = call.next(b, "x_dot", call.shape.unknowns);
        const auto side = call.given(g);
        auto y_dot = call.out(call.shape.observations);
        const auto point = call.linearization();
        call.compute([&](Workspace& work) {
          vjp.linearize({at.batch, side.batch}, y_dot.batch, point->tape());
          jvp.pushforward(point->tape(), x_dot.batch, y_dot.batch, work);
        });
        return y_dot.array;
      },
      py::arg("x"),
      py::arg("x_dot"),
      py::arg("given") = py::none());
}

void define_matrices(py::class_<PyProblem>& c) {
  const auto given = py::arg("given") = py::none();
  define(
      c,
      "jacobian",
      "jacobian($self, x, given=None)\n--\n\n"
      "J = dy / dx at x: (samples, observations, unknowns). Needs jacobian.",
      [](auto& call, Object a, Object b) -> py::object {
        const auto& jacobian = call.template need<Jacobian>("jacobian");
        const auto at = call.first(a, "x", call.shape.unknowns);
        const auto side = call.given(b);
        auto j = call.out(call.shape.unknowns, call.shape.observations);
        call.compute([&](Workspace& work) {
          jacobian.jacobian({at.batch, side.batch}, j.batch, work);
        });
        return j.array.attr("transpose")(0, 2, 1);
      },
      py::arg("x"),
      given);
  define(
      c,
      "hessian",
      "hessian($self, x, target, given=None)\n--\n\n"
      "Second derivative by x of loss(F(x | given), target): (samples, "
      "unknowns,\nunknowns). Needs hessian.",
      [](auto& call, Object a, Object t, Object g) {
        const auto& hessian = call.template need<Hessian>("hessian");
        const auto at = call.first(a, "x", call.shape.unknowns);
        const auto target = call.next(t, "target", call.shape.observations);
        const auto side = call.given(g);
        auto h = call.out(call.shape.unknowns, call.shape.unknowns);
        call.compute([&](Workspace& work) {
          hessian.hessian({at.batch, side.batch}, target.batch, h.batch, work);
        });
        return h.array;
      },
      py::arg("x"),
      py::arg("target"),
      given);
}

void define_inverse(py::class_<PyProblem>& c) {
  define(
      c,
      "invert",
      "invert($self, y, given=None, guess=None)\n--\n\n"
      "x near `guess` (samples, unknowns), by default the start, with F(x | "
      "given) near\ny (samples, observations). Needs inverse.",
      [](auto& call, Object a, Object g, Object near) {
        const auto& inverse = call.template need<Inverse>("inverse");
        const auto y = call.first(a, "y", call.shape.observations);
        const auto side = call.given(g);
        auto from = call.out(call.shape.unknowns);
        if (near.is_none())
          from.batch.colwise() =
              call.problem()
                  .start()
                  .template cast<typename decltype(from.batch)::Scalar>();
        else
          from.batch = call.next(near, "guess", call.shape.unknowns).batch;
        auto x = call.out(call.shape.unknowns);
        call.compute([&](Workspace& work) {
          inverse.invert({from.batch, side.batch}, y.batch, x.batch, work);
        });
        return x.array;
      },
      py::arg("y"),
      py::arg("given") = py::none(),
      py::arg("guess") = py::none());
}

void define_losses(py::class_<PyProblem>& c) {
  define(
      c,
      "loss",
      "loss($self, y, target)\n--\n\n"
      "Loss of each sample, (samples,), in double: half the squared error of y "
      "against\ntarget, both (samples, observations), in their units, unless "
      "the paper has another.",
      [](auto& call, Object a, Object t) {
        const auto y = call.first(a, "y", call.shape.observations);
        const auto target = call.next(t, "target", call.shape.observations);
        Array<double> loss(call.samples);
        Eigen::Map<Vector<double>> out(loss.mutable_data(), call.samples);
        call.compute([&](Workspace&) {
          call.problem().loss(y.batch, target.batch, out);
        });
        return loss;
      },
      py::arg("y"),
      py::arg("target"));
  define(
      c,
      "loss_gradient",
      "loss_gradient($self, y, target)\n--\n\n"
      "d loss / d y of each sample, (samples, observations): what `pullback` "
      "takes.",
      [](auto& call, Object a, Object t) {
        const auto y = call.first(a, "y", call.shape.observations);
        const auto target = call.next(t, "target", call.shape.observations);
        auto y_bar = call.out(call.shape.observations);
        call.compute([&](Workspace&) {
          call.problem().loss_gradient(y.batch, target.batch, y_bar.batch);
        });
        return y_bar.array;
      },
      py::arg("y"),
      py::arg("target"));
}

}  // namespace

void define_calls(py::class_<PyProblem>& c) {
  py::options signatures;
  signatures.disable_function_signatures();
  define_passes(c);
  define_pushforward(c);
  define_matrices(c);
  define_inverse(c);
  define_losses(c);
}

}  // namespace physinv::python
