#include "python/module/user_problem.h"

#include <atomic>
#include <deque>
#include <limits>
#include <utility>
#include <vector>

#include "python/module/words.h"
#include "python/module/worker.h"
#include "suite/core/threads.h"

namespace physinv::python {
namespace {

using Shared = std::shared_ptr<const Functions>;

/// Libraries compute with as many threads as the case has.
void limit_threads(const Threads* threads) {
  static int last = 0;
  const int count = threads == nullptr ? 1 : threads->count();
  if (!in_worker() || count == last) return;
  py::module_::import("physinv._threads").attr("limit")(count);
  last = count;
}

/// f() with the lock of the interpreter; what Python raises is of `function`.
template <class F>
auto call(const Functions& of,
          const char* function,
          const Threads* threads,
          F&& f) {
  const py::gil_scoped_acquire held;
  try {
    limit_threads(threads);
    return f();
  } catch (const py::error_already_set& error) {
    throw std::runtime_error(
        fmt::format("{} of {}: {}", function, of.name, words_of(error)));
  } catch (const py::builtin_exception& error) {
    throw std::runtime_error(
        fmt::format("{} of {}: {}", function, of.name, error.what()));
  }
}

template <class T>
Array<double> in_double(BatchIn<T> batch) {
  auto array = make_array<double>(batch.cols(), batch.rows());
  writable(array) = batch.template cast<double>();
  return array;
}

/// Columns that are not finite.
template <class T>
std::vector<Index> lost_of(BatchIn<T> x) {
  std::vector<Index> lost;
  if (x.allFinite()) return lost;
  for (Index i = 0; i < x.cols(); ++i)
    if (!x.col(i).allFinite()) lost.push_back(i);
  return lost;
}

template <class T>
struct Seen {
  Seen(const Functions& of, Point<T> at)
      : x(in_double<T>(at.x)),
        given(in_double<T>(at.given)),
        lost(lost_of<T>(at.x)) {
    for (const Index i : lost) writable(x).col(i) = of.start;
  }
  Array<double> x, given;
  std::vector<Index> lost;
};

/// What a function returned.
template <class T>
void put(const py::object& result,
         const char* name,
         const std::vector<Index>& lost,
         BatchOut<T> out) {
  if (result.is_none()) throw py::value_error(fmt::format("{} is None", name));
  const auto array = taken<double>(result, name);
  out = view<double>(array, name, out.cols(), out.rows()).template cast<T>();
  for (const Index i : lost)
    out.col(i).setConstant(std::numeric_limits<T>::quiet_NaN());
}

template <class T>
class Body : public Problem<T> {
 public:
  explicit Body(Shared of) : of_(std::move(of)) {}

  Shape shape() const override { return of_->shape; }
  Vector<double> start() const override { return of_->start; }
  double operations() const override { return of_->operations; }

  void draw(Stream& stream, SampleOut& sample) const override {
    const std::uint64_t seed = stream.bits() >> 1;  // as NumPy takes it
    call(*of_, "sample", nullptr, [&] {
      const auto both = of_->sample(seed, 1).template cast<py::tuple>();
      put<double>(both[0], "x", {}, sample.x);
      put<double>(both[1], "given", {}, sample.given);
      if (!sample.x.allFinite() || !sample.given.allFinite())
        throw py::value_error("it drew values that are not finite");
    });
    drawn_ = true;
  }

  void forward(Point<T> at, BatchOut<T> y, Workspace& work) const override {
    call(*of_, "forward", work.threads(), [&] {
      const Seen<T> seen(*of_, at);
      put<T>(of_->forward(seen.x, seen.given), "its y", seen.lost, y);
      if (std::exchange(drawn_, false) && !y.allFinite())
        throw py::value_error(
            "its y is not finite for drawn samples, so there is nothing to "
            "solve; sample must draw where y is finite");
    });
  }

 private:
  Shared of_;
  mutable bool drawn_ = false;  ///< the next batch is what was drawn
};

enum Slot : std::size_t { kSerial, kX, kGiven };

/// The point of a tape, as the function sees it.
template <class T>
Seen<double> point_of(const Functions& of, const Tape& tape) {
  Seen<double> seen(of, {tape.view<double>(kX), tape.view<double>(kGiven)});
  return seen;
}

/// Pullbacks of the last points stay; of an older one the function is asked
/// again.
template <class T>
class VjpPart : public Vjp<T> {
 public:
  explicit VjpPart(Shared of) : of_(std::move(of)) {}
  VjpPart(const VjpPart&) = delete;
  VjpPart& operator=(const VjpPart&) = delete;
  ~VjpPart() override {
    if (kept_.empty()) return;
    const py::gil_scoped_acquire held;
    kept_.clear();
  }

  void linearize(Point<T> at, BatchOut<T> y, Tape& tape) const override {
    call(*of_, "vjp", tape.threads(), [&] {
      tape.slot<double>(kX, at.x.rows(), at.x.cols()) =
          at.x.template cast<double>();
      tape.slot<double>(kGiven, at.given.rows(), at.given.cols()) =
          at.given.template cast<double>();
      const Seen<T> seen(*of_, at);
      const py::tuple both = asked(seen.x, seen.given);
      put<T>(both[0], "its y", seen.lost, y);
      tape.slot<std::int64_t>(kSerial, 1, 1)(0) = keep(both[1]);
    });
  }

  void pullback(const Tape& tape,
                BatchIn<T> y_bar,
                BatchOut<T> x_bar,
                Workspace& work) const override {
    call(*of_, "the pullback of vjp", work.threads(), [&] {
      const auto lost = lost_of<double>(tape.view<double>(kX));
      auto slope = in_double<T>(y_bar);
      for (const Index i : lost) writable(slope).col(i).setZero();
      put<T>(found(tape)(slope), "its x_bar", lost, x_bar);
    });
  }

 private:
  static constexpr std::size_t kMost = 4;

  py::tuple asked(const Array<double>& x, const Array<double>& given) const {
    const py::object both = of_->vjp(x, given);
    if (!py::isinstance<py::tuple>(both) || py::len(both) != 2)
      throw py::value_error("it must return y and a function, the pullback");
    return both.cast<py::tuple>();
  }

  std::int64_t keep(py::object pullback) const {
    static std::atomic<std::int64_t> last = 0;
    kept_.emplace_back(++last, std::move(pullback));
    if (kept_.size() > kMost) kept_.pop_front();
    return kept_.back().first;
  }

  py::object found(const Tape& tape) const {
    const std::int64_t serial = tape.view<std::int64_t>(kSerial)(0);
    for (const auto& [number, pullback] : kept_)
      if (number == serial) return pullback;
    const Seen<double> seen = point_of<T>(*of_, tape);
    return asked(seen.x, seen.given)[1];
  }

  Shared of_;
  mutable std::deque<std::pair<std::int64_t, py::object>> kept_;
};

template <class T>
class JvpPart : public Jvp<T> {
 public:
  explicit JvpPart(Shared of) : of_(std::move(of)) {}

  void pushforward(const Tape& tape,
                   BatchIn<T> x_dot,
                   BatchOut<T> y_dot,
                   Workspace& work) const override {
    call(*of_, "jvp", work.threads(), [&] {
      const Seen<double> seen = point_of<T>(*of_, tape);
      put<T>(of_->jvp(seen.x, seen.given, in_double<T>(x_dot)),
             "its y_dot",
             seen.lost,
             y_dot);
    });
  }

 private:
  Shared of_;
};

template <class T>
class JacobianPart : public Jacobian<T> {
 public:
  explicit JacobianPart(Shared of) : of_(std::move(of)) {}

  void jacobian(Point<T> at, BatchOut<T> j, Workspace& work) const override {
    call(*of_, "jacobian", work.threads(), [&] {
      const Seen<T> seen(*of_, at);
      const Shape s = of_->shape;
      const auto all = taken<double>(of_->jacobian(seen.x, seen.given), "it");
      if (all.ndim() != 3 || all.shape(0) != j.cols() ||
          all.shape(1) != s.observations || all.shape(2) != s.unknowns)
        throw py::value_error(fmt::format(
            "expected (samples, observations, unknowns) = ({}, {}, {})",
            j.cols(),
            s.observations,
            s.unknowns));
      // A column is a matrix by columns; NumPy's are by rows.
      const View<double> by_rows(all.data(), j.rows(), j.cols());
      for (Index i = 0; i < j.cols(); ++i)
        j.col(i) = by_rows.col(i)
                       .reshaped(s.unknowns, s.observations)
                       .transpose()
                       .reshaped()
                       .template cast<T>();
      for (const Index i : seen.lost)
        j.col(i).setConstant(std::numeric_limits<T>::quiet_NaN());
    });
  }

 private:
  Shared of_;
};

template <class T>
class InversePart : public Inverse<T> {
 public:
  explicit InversePart(Shared of) : of_(std::move(of)) {}

  void invert(Point<T> near,
              BatchIn<T> y,
              BatchOut<T> x,
              Workspace& work) const override {
    call(*of_, "inverse", work.threads(), [&] {
      const Seen<T> seen(*of_, near);
      put<T>(of_->inverse(in_double<T>(y), seen.given, seen.x),
             "its x",
             seen.lost,
             x);
    });
  }

 private:
  Shared of_;
};

/// In the place of a part that is not there.
template <int>
struct None {
  explicit None(const Shared&) {}
};

template <class Part, int at, bool has>
using If = std::conditional_t<has, Part, None<at>>;

template <class T, bool vjp, bool jvp, bool jacobian, bool inverse>
class UserProblem final : public Body<T>,
                          public If<VjpPart<T>, 0, vjp>,
                          public If<JvpPart<T>, 1, jvp>,
                          public If<JacobianPart<T>, 2, jacobian>,
                          public If<InversePart<T>, 3, inverse> {
 public:
  explicit UserProblem(const Shared& of)
      : Body<T>(of),
        If<VjpPart<T>, 0, vjp>(of),
        If<JvpPart<T>, 1, jvp>(of),
        If<JacobianPart<T>, 2, jacobian>(of),
        If<InversePart<T>, 3, inverse>(of) {}
};

template <class T, bool... has>
std::unique_ptr<Problem<T>> make(const Shared& of) {
  if constexpr (sizeof...(has) == 4) {
    return std::make_unique<UserProblem<T, has...>>(of);
  } else {
    return of->can()[sizeof...(has)] ? make<T, has..., true>(of)
                                     : make<T, has..., false>(of);
  }
}

Needs provided_by(const Functions& of) {
  constexpr std::array kEach = {
      Needs::vjp, Needs::jvp, Needs::jacobian, Needs::inverse};
  Needs all = Needs::forward | Needs::labels;
  for (std::size_t k = 0; k < kEach.size(); ++k)
    if (of.can()[k]) all = all | kEach[k];
  return all;
}

}  // namespace

Shared shared(Functions functions) {
  return {new Functions(std::move(functions)), [](const Functions* old) {
            if (Py_IsInitialized() == 0) return;
            const py::gil_scoped_acquire held;
            delete old;
          }};
}

ProblemRecipe recipe_of(const Shared& functions,
                        const std::string& name,
                        Options options,
                        Quantities quantities) {
  return {.name = name,
          .options = std::move(options),
          .provided = provided_by(*functions),
          .make_float = [functions] { return make<float>(functions); },
          .make_double = [functions] { return make<double>(functions); },
          .source = "suite/core/problem.h",
          .quantities = std::move(quantities)};
}

}  // namespace physinv::python
