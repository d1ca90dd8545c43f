// The vectors of physgrad-scaling: steps through the stages themselves, the
// rest from the problem.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <stdexcept>

#include "optimizers/local_steps.h"
#include "problems/scaling/scaling.h"
#include "suite/core/any_problem.h"
#include "tests/optimizers/scaling_support.h"
#include "tests/support/reference.h"

namespace physinv::test {
namespace {

const std::string kId = "physgrad-scaling";

/// Every number by itself, as T can hold it. In float no closer than 1e-5.
template <class T>
class Expect {
 public:
  explicit Expect(const Json& entry)
      : exact_(EntryTolerance(entry.at("tolerance")).array()) {}

  /// `lost`: what rounding took before, absolute.
  void operator()(double got, double wanted, double lost = 0) const {
    const double rtol = kSingle ? std::max(exact_.rtol(), 1e-5) : exact_.rtol();
    EXPECT_TRUE(Comparator(rtol, exact_.atol() + lost)(
        got, static_cast<double>(static_cast<T>(wanted))));
  }
  void operator()(const Batch<double>& got,
                  const Batch<double>& wanted,
                  const Batch<double>& lost) const {
    ASSERT_EQ(got.rows(), wanted.rows());
    ASSERT_EQ(got.cols(), wanted.cols());
    for (Index j = 0; j < got.cols(); ++j)
      for (Index i = 0; i < got.rows(); ++i) {
        SCOPED_TRACE(testing::Message() << i << ", " << j);
        (*this)(got(i, j), wanted(i, j), lost(i, j));
      }
  }
  void operator()(const Batch<double>& got, const Batch<double>& wanted) const {
    (*this)(got, wanted, Batch<double>::Zero(got.rows(), got.cols()));
  }
  void list(const Vector<double>& got, const Json& numbers) const {
    (*this)(Batch<double>(got), Batch<double>(vector(numbers)));
  }

 private:
  static constexpr bool kSingle = sizeof(T) == 4;
  Comparator exact_;
};

/// Whether T holds all numbers of the inputs and their squares. Float has
/// nothing to say about the others; double must do what it can.
template <class T>
bool holds(const Json& in) {
  if (sizeof(T) == 8) return true;
  const double low = std::sqrt(double(std::numeric_limits<T>::min())),
               high = std::sqrt(double(std::numeric_limits<T>::max()));
  const auto look = [&](const auto& self, const Json& value) -> bool {
    for (const Json& item : value)
      if (!self(self, item)) return false;
    if (!value.is_number()) return true;
    const double size = std::abs(number(value));
    return size == 0 || (low < size && size < high);
  };
  for (const std::string& key : in.keys())
    if (!look(look, in.at(key))) return false;
  return true;
}

LocalStep step_of(const std::string& method) {
  static const std::map<std::string, LocalStep> kSteps = {
      {"gd", LocalStep::gradient},
      {"newton", LocalStep::newton},
      {"ig", LocalStep::inverse_gradient},
      {"pg", LocalStep::inverse_simulator}};
  if (!kSteps.contains(method))
    throw std::runtime_error("no test knows the method " + method);
  return kSteps.at(method);
}

/// What `key` says, one of two words.
bool is_second(const std::string& key,
               const std::string& said,
               const char* first,
               const char* second) {
  if (said != first && said != second)
    throw std::runtime_error("inputs." + key + " is " + said +
                             ", the test knows " + first + " and " + second);
  return said == second;
}

/// The specification's scale is 1, its loss the square, its target 0.
AimedOptions problem_of(const Json& in, const char* start, double alpha) {
  const std::string problem = in.at("problem"),
                    loss = in.value("loss", "square");
  AimedOptions o;
  o.scaling = {
      .scales = {alpha},
      .power = is_second("problem", problem, "scaling", "comparison") ? 2 : 1,
      .half = is_second("loss", loss, "square", "half"),
      .start = in.at(start)};
  if (in.contains("y_target")) o.target = in.at("y_target");
  return o;
}

template <class T>
void check_step(const Json& entry) {
  const Json in = entry.at("inputs"), want = entry.at("expected");
  if (!holds<T>(in)) return;
  const Expect<T> expect(entry);
  const AimedOptions options = problem_of(in, "x", in.value("alpha", 1.0));
  const AnyProblem<T> problem(physinv::problem<Aimed>("scaling", options));
  const auto data = problem.sample(0, 1, Rng::root("", 0)).template cast<T>();
  const Batch<T> x = problem.start().template cast<T>();
  Batch<T> y(2, 1), y_bar(2, 1), g(2, 1), m(4, 1);
  Vector<double> loss(1);
  Workspace work;
  Tape tape;
  const auto matrix = [&] {
    return Batch<double>(m.template cast<double>().reshaped(2, 2));
  };
  problem.linearize(x, data.given, y, tape);
  problem.loss(y, data.y, loss);
  problem.loss_gradient(y, data.y, y_bar);
  problem.pullback(tape, y_bar, g, work);
  expect.list(y.template cast<double>(), want.at("y"));
  expect(loss(0), number(want.at("loss")));
  expect.list(g.template cast<double>(), want.at("gradient"));
  problem.hessian(x, data.given, data.y, m, work);
  expect(matrix(), columns(want.at("hessian")));
  problem.jacobian(x, data.given, m, work);
  expect(matrix(), columns(want.at("jacobian")));

  const double eta = in.at("eta");
  for (const std::string method : {"gd", "newton", "ig", "pg"}) {
    SCOPED_TRACE(method);
    const Batch<double> path = path_of<T>(options, step_of(method), eta, 1);
    // A difference has lost what x was rounded by.
    const Batch<double> lost = std::numeric_limits<T>::epsilon() *
                               path.cwiseAbs().rowwise().maxCoeff();
    expect(path.col(1) - path.col(0),
           Batch<double>(vector(want.at("step_" + method))),
           lost);
  }
}

/// x, and y, loss, distance and the first update where they are stored.
template <class T>
void expect_path(const Json& entry,
                 const AimedOptions& options,
                 const Batch<double>& x) {
  const Json in = entry.at("inputs"), want = entry.at("expected");
  const Expect<T> expect(entry);
  Batch<double> stored = x;
  if (in.contains("stored_steps")) {
    const std::vector<Index> kept = in.at("stored_steps");
    for (const Index k : kept) ASSERT_TRUE(0 <= k && k < x.cols()) << k;
    stored = x(Eigen::all, kept);
  }
  expect(stored, columns(want.at("x")));
  if (!want.contains("y")) return;
  const ScalingOptions& o = options.scaling;
  Batch<double> y = x;
  y.row(1) = o.scales[0] * x.row(1).array().pow(o.power).matrix();
  expect(y, columns(want.at("y")));
  const Batch<double> off =
      y.colwise() - Eigen::Vector2d(options.target[0], options.target[1]);
  expect.list((o.half ? 0.5 : 1) * off.colwise().squaredNorm().transpose(),
              want.at("loss"));
  expect.list(x.colwise().stableNorm().transpose(), want.at("distance"));
  const Vector<double> u = x.col(0) - x.col(1);
  const double length = u.stableNorm(),
               diagonal = number(want.at("diagonal_length_first_update"));
  // Too small for T, u has no direction; else it has lost what x was rounded
  // by.
  if (std::numeric_limits<T>::min() > length && sizeof(T) == 4) return;
  expect(u.sum() / length,
         diagonal,
         2 * std::numeric_limits<T>::epsilon() *
             x.leftCols(2).cwiseAbs().maxCoeff() / length);
}

template <class T>
void check_trajectory(const Json& entry) {
  const Json in = entry.at("inputs");
  if (!holds<T>(in)) return;
  std::vector<double> alphas = {1};
  if (in.contains("alpha")) {
    const Json alpha = in.at("alpha");
    alphas = alpha.is_array() ? alpha.get<std::vector<double>>()
                              : std::vector<double>{alpha};
  }
  const std::vector<std::string> methods =
      in.contains("methods") ? in.at("methods").get<std::vector<std::string>>()
                             : std::vector<std::string>{in.at("method")};
  ASSERT_FALSE(alphas.empty() || methods.empty());
  for (const double alpha : alphas)
    for (const std::string& method : methods) {
      SCOPED_TRACE(testing::Message() << method << " alpha " << alpha);
      const AimedOptions options = problem_of(in, "start", alpha);
      expect_path<T>(
          entry,
          options,
          path_of<T>(options, step_of(method), in.at("eta"), in.at("steps")));
    }
}

/// The root of z^2 = y.
template <class T>
void check_local_inverse(const Json& entry) {
  const Json in = entry.at("inputs");
  if (!holds<T>(in)) return;
  const Vector<double> y = vector(in.at("y")),
                       x0 = vector(in.at("x0"), y.size());
  const AnyProblem<T> problem(problems::scaling({.power = 2}));
  Batch<T> at(2, y.size()), guess(2, y.size()), x(2, y.size());
  at << y.transpose().cast<T>(), y.transpose().cast<T>();
  guess << x0.transpose().cast<T>(), x0.transpose().cast<T>();
  Workspace work;
  problem.invert(at, Batch<T>::Ones(1, y.size()), guess, x, work);
  Expect<T>(entry).list(x.row(1).transpose().template cast<double>(),
                        entry.at("expected").at("x"));
}

/// L = alpha x2 is what the second observation is.
template <class T>
void check_linear_loss(const Json& entry) {
  const Json in = entry.at("inputs"), want = entry.at("expected");
  if (!holds<T>(in)) return;
  const Expect<T> expect(entry);
  const Vector<double> alphas = vector(in.at("alpha"));
  const T eta = in.at("eta"), wanted = in.at("delta_loss");
  const AnyProblem<T> problem(problems::scaling());
  const Index n = alphas.size();
  const Batch<T> given = alphas.transpose().cast<T>();
  const Batch<T> zero = Batch<T>::Zero(2, n);
  Batch<T> one = zero, goal = zero, y = zero, gradient = zero, dx = zero;
  one.row(1).setOnes(), goal.row(1).setConstant(wanted);
  Workspace work;
  Tape tape;
  const auto check = [&](const std::string& method) {
    problem.forward(dx, given, y, work);
    expect.list(dx.row(1).transpose().template cast<double>(),
                want.at("step_" + method));
    expect.list(y.row(1).transpose().template cast<double>(),
                want.at("loss_change_" + method));
  };
  problem.linearize(zero, given, y, tape);
  problem.pullback(tape, one, gradient, work);
  dx = -eta * gradient;
  check("gd");
  problem.inverse_gradient_step(zero, given, goal, dx);
  check("ig");
}

void check_numeric_inverse(const Json& entry) {
  const Json in = entry.at("inputs");
  for (const double h : {1e-8, 0.0}) {
    NumericInverse search(counted_scaling({.power = 2}), {.difference = h});
    Batch<double> x(2, 1);
    search.invert(vector(in.at("target"), 2),
                  Batch<double>::Ones(1, 1),
                  vector(in.at("start"), 2),
                  x);
    Expect<double>(entry).list(x, entry.at("expected").at("x"));
  }
}

TEST(PhysgradScalingReference, EveryEntryInBothPrecisions) {
  const auto trajectory =
      in_both(check_trajectory<float>, check_trajectory<double>);
  check_entries(
      kId,
      {{"step-*", in_both(check_step<float>, check_step<double>)},
       {"gd-trajectory-*", trajectory},
       {"inverted-trajectory-*", trajectory},
       {"comparison-*", trajectory},
       {"figure1-*", trajectory},
       {"local-inverse",
        in_both(check_local_inverse<float>, check_local_inverse<double>)},
       {"linear-loss",
        in_both(check_linear_loss<float>, check_linear_loss<double>)},
       {"numeric-inverse", check_numeric_inverse}});
}

}  // namespace
}  // namespace physinv::test
