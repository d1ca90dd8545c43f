// The vectors of sip-heat that are physics; training is another test's.
#include <algorithm>
#include <array>
#include <complex>
#include <map>
#include <regex>
#include <stdexcept>
#include <string>

#include "problems/heat/heat.h"
#include "suite/core/any_problem.h"
#include "tests/support/physics.h"
#include "tests/support/reference.h"

namespace physinv::test {
namespace {

const std::string kHeatId = "sip-heat";

Comparator tolerance(const Json& entry) {
  return EntryTolerance(entry.at("tolerance")).array();
}
/// Single precision has its own rounding to lose.
template <class T>
Comparator tolerance(const Json& entry) {
  const Comparator exact = tolerance(entry);
  if (std::is_same_v<T, double>) return exact;
  return {std::max(exact.rtol(), 1e-5), std::max(exact.atol(), 1e-6)};
}

/// Cells per side and diffusivity times time as the description states them
/// ("16x16 field, amount 8"), else those of the specification.
HeatOptions options_of(const Json& entry, double noise_floor = 0) {
  static const std::regex form("([0-9]+)x([0-9]+) (?:grid|field)");
  HeatOptions o{.noise_floor = noise_floor};
  const std::string said = entry.value("description", "");
  std::smatch found;
  if (std::regex_search(said, found, form)) {
    if (found[1] != found[2])
      throw std::runtime_error("the test has no grid of " + found.str());
    o.resolution = std::stol(found[1]);
  }
  o.end_time = setting(entry, "amount", "amount ", o.end_time);
  return o;
}

/// The field that several entries speak about.
Vector<double> rectangles_of(const Json& in, Index side) {
  Vector<double> field = Vector<double>::Zero(side * side);
  for (std::size_t i = 0; i < in.at("strengths").size(); ++i)
    add_rectangle({in.at("positions").at(i),
                   in.at("half_sizes").at(i),
                   in.at("strengths").at(i)},
                  side,
                  field.data());
  return field;
}
Vector<double> field_of(const Json& entry, Index side) {
  const Json in = entry.at("inputs");
  if (in.at("field").is_array()) return field(in.at("field"), side, side);
  expect_formula(in, "field", "rectangles");
  return rectangles_of(spoken_of(kHeatId, "rectangles").at("inputs"), side);
}

Vector<double> at_cells(const Vector<double>& field,
                        Index side,
                        const Json& cells) {
  Vector<double> out(static_cast<Index>(cells.size()));
  for (Index i = 0; i < out.size(); ++i) {
    const std::array<Index, 2> cell = cells[i];
    if (std::min(cell[0], cell[1]) < 0 || std::max(cell[0], cell[1]) >= side)
      throw std::runtime_error(cells[i].path() + " is " + cells[i].dump() +
                               ", outside of the grid");
    out(i) = field(side * cell[0] + cell[1]);
  }
  return out;
}

void check_kernel(const Json& entry) {
  const Json want = entry.at("expected");
  const HeatOptions options = options_of(entry);
  const HeatModes heat(options);
  const std::vector<std::array<Index, 2>> indices =
      entry.at("inputs").at("indices");
  const auto count = static_cast<Index>(indices.size());
  const Vector<double> exponents = vector(want.at("exponent"), count),
                       factors = vector(want.at("factor"), count);
  const auto same = tolerance(entry);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const auto folded = [&](Index k) {
      if (k < 0 || k >= options.resolution)
        throw std::runtime_error("no index " + std::to_string(k) + " here");
      return std::min(k, options.resolution - k);
    };
    const double s =
        heat.exponents()(folded(indices[i][0]), folded(indices[i][1]));
    EXPECT_TRUE(same(s, exponents(Index(i))));
    EXPECT_TRUE(same(std::exp(-s), factors(Index(i))));
  }
}

void check_rectangles(const Json& entry) {
  const Json in = entry.at("inputs"), want = entry.at("expected");
  const Index side = options_of(entry).resolution;
  const Vector<double> field = rectangles_of(in, side);
  const auto same = tolerance(entry);
  EXPECT_TRUE(
      same(at_cells(field, side, in.at("cells")), vector(want.at("values"))));
  EXPECT_TRUE(same(field.sum(), number(want.at("sum"))));
  EXPECT_TRUE(same(field.norm(), number(want.at("norm"))));
}

/// x0 of an entry: numbers, zero, or a multiple of u(k) in words.
Vector<double> start_of(const Json& in, Index cells) {
  static const std::regex form("(?:([0-9.eE+-]+) ?\\*? ?)?u");
  const auto scaled_u = [&](double factor) {
    const Recurrence u(in);
    return Vector<double>(Vector<double>::NullaryExpr(
        cells, [&](Index k) { return factor * u(k); }));
  };
  if (in.contains("a")) scaled_u(0);  // read, even where it is not needed
  if (!in.contains("x0") || in.at("x0") == "zero" || in.at("x0") == "zeros" ||
      in.at("x0") == "0" || in.at("x0") == 0)
    return Vector<double>::Zero(cells);
  const Json x0 = in.at("x0");
  const auto side = static_cast<Index>(std::lround(std::sqrt(double(cells))));
  if (x0.is_array()) return field(x0, side, side);
  const std::string said = x0;
  std::smatch found;
  if (!std::regex_match(said, found, form))
    throw std::runtime_error("inputs.x0 is " + said +
                             ", expected numbers, zero or a multiple of u");
  return scaled_u(found[1].matched ? std::stod(found[1]) : 1);
}

template <class T>
void check_forward(const Json& entry) {
  const Json in = entry.at("inputs"), want = entry.at("expected");
  const HeatOptions options = options_of(entry);
  const Index side = options.resolution, cells = side * side;
  Batch<T> fields(cells, 2);
  fields.col(0) = field_of(entry, side).cast<T>();
  fields.col(1) = start_of(in, cells).cast<T>();
  Physics heat{AnyProblem<T>(problems::heat(options))};
  const Batch<T> given(0, 2), y = heat.forward(fields, given);
  const auto same = tolerance<T>(entry);
  const Vector<double> seen = y.col(0).template cast<double>();
  const Json at = in.at("cells");
  EXPECT_TRUE(same(at_cells(seen, side, at), vector(want.at("y"))));
  EXPECT_TRUE(same(seen.sum(), number(want.at("y_sum"))));
  EXPECT_TRUE(same(seen.norm(), number(want.at("y_norm"))));

  const auto start = heat.losses(fields.col(1), given.leftCols(1), y.col(0));
  const Vector<double> g = start.x_bar.template cast<double>();
  EXPECT_TRUE(same(start.loss(0), number(want.at("loss"))));
  EXPECT_TRUE(same(at_cells(g, side, at), vector(want.at("gradient"))));
  EXPECT_TRUE(same(g.norm(), number(want.at("gradient_norm"))));
}

/// Both what the closed form says and what the steps lead to; the rate is 1.
template <class T>
void check_gd(const Json& entry) {
  const Json want = entry.at("expected");
  const HeatOptions options = options_of(entry);
  const AnyProblem<T> heat(problems::heat(options));
  const HeatModes modes(options);
  Workspace work;
  const Batch<double> exact = field_of(entry, options.resolution);
  const Batch<T> truth = exact.cast<T>(), given(0, 1);
  Batch<T> y(truth), x = Batch<T>::Zero(truth.rows(), 1), seen(y), step(y);
  heat.forward(truth, given, y, work);
  const auto same = tolerance<T>(entry);
  const auto error = [&](const Batch<T>& at) {
    return (exact - at.template cast<double>()).cwiseAbs().sum();
  };
  EXPECT_TRUE(same(error(x), number(want.at("x_l1_initial"))));
  std::map<Index, double> after;
  for (const auto& [steps, stored] : want.at("x_l1").items())
    after[std::stol(steps)] = stored;
  ASSERT_FALSE(after.empty());
  Index n = 0;
  for (const auto& [steps, stored] : after) {
    for (; n < steps; ++n) {
      heat.forward(x, given, seen, work);
      seen = y - seen;
      heat.forward(seen, given, step, work);
      x += step;
    }
    EXPECT_TRUE(same(error(x), stored)) << n;
    modes.filter<T>(y, heat_gradient_descent(modes.exponents(), n), step, work);
    EXPECT_TRUE(same(error(step), stored)) << n;
    EXPECT_TRUE(same(x, step));
  }
}

template <class T>
void check_iteration(const Json& entry) {
  // Section 2: the floor of the direct runs.
  const HeatOptions options = options_of(
      entry, setting(entry, "uncertainty_floor", "\\*1e-6\\+", 1e-8));
  const AnyProblem<T> heat(problems::heat(options));
  Workspace work;
  const Batch<double> exact = field_of(entry, options.resolution);
  const Batch<T> truth = exact.cast<T>(), given(0, 1);
  Batch<T> y(truth), x = Batch<T>::Zero(truth.rows(), 1);
  heat.forward(truth, given, y, work);
  for (const Json& stored : entry.at("expected").at("x_l1")) {
    heat.invert(y, given, x, x, work);
    const double error = (exact - x.template cast<double>()).cwiseAbs().sum();
    // What single precision left of y* is not only what diffusion left of x*.
    const auto same =
        std::is_same_v<T, double> ? tolerance(entry) : Comparator(0.02, 0);
    EXPECT_TRUE(same(error, number(stored)));
  }
}

/// The transform by its definition.
Eigen::MatrixXcd spectrum(const Batch<double>& field) {
  const Index n = field.rows();
  Eigen::MatrixXcd f(n, n);
  for (Index k = 0; k < n; ++k)
    for (Index i = 0; i < n; ++i)
      f(k, i) = std::polar(1.0, -2 * M_PI * double(k * i % n) / double(n));
  return f * field * f;
}

template <class T>
Batch<T> step_of(const Batch<double>& dy, const HeatOptions& options) {
  const AnyProblem<T> heat(problems::heat(options));
  Workspace work;
  Batch<T> dx(dy.rows(), 1);
  heat.invert(
      dy.cast<T>(), Batch<T>(0, 1), Batch<T>::Zero(dy.rows(), 1), dx, work);
  return dx;
}

/// Probability and gain of every mode.
struct TakenModes {
  TakenModes(const Batch<double>& dy, const HeatOptions& options)
      : z(spectrum(dy)), probability(dy), gain(dy) {
    const HeatModes heat(options);
    uncertainty =
        (dy.array().abs() * 1e-6 + options.noise_floor).matrix().norm();
    const Index n = dy.rows();
    for (Index k = 0; k < n; ++k)
      for (Index l = 0; l < n; ++l) {
        const double s =
            heat.exponents()(std::min(k, n - k), std::min(l, n - l));
        const auto mode = HeatMode::of(
            std::abs(z(k, l)), s, double(n) * std::exp(-s), uncertainty);
        probability(k, l) = mode.probability, gain(k, l) = mode.gain;
      }
  }
  /// More than the rounding of a transform.
  bool counts(Index mode) const {
    return std::abs(z(mode)) > 1e-10 * z.cwiseAbs().maxCoeff();
  }

  Eigen::MatrixXcd z;
  Batch<double> probability, gain;
  double uncertainty;
};

void check_step(const Json& entry) {
  const Json in = entry.at("inputs"), want = entry.at("expected");
  const auto side = static_cast<Index>(in.at("dy").size());
  const Batch<double> dy = rows(in.at("dy"), side, side);
  HeatOptions options = options_of(entry, in.at("uncertainty_floor"));
  options.resolution = dy.rows();
  const auto flat = [](const Batch<double>& field) {
    return Batch<double>(Batch<double>(field.transpose()).reshaped());
  };
  const Batch<double> dx = field(want.at("dx"));
  const auto same = tolerance(entry);
  EXPECT_TRUE(same(step_of<double>(flat(dy), options), dx));
  // A dy in single precision is another one; its step is as good.
  const Batch<double> rounded = dy.cast<float>().cast<double>(),
                      single =
                          step_of<float>(flat(rounded), options).cast<double>();
  EXPECT_TRUE(
      Comparator(1e-7, 0)(single, step_of<double>(flat(rounded), options)));

  const TakenModes modes(dy, options);
  EXPECT_TRUE(same(modes.uncertainty, number(want.at("uncertainty"))));
  const Batch<double> p = rows(want.at("probability"), side, side),
                      gain = rows(want.at("kernel"), side, side);
  Batch<double> p_seen = p, gain_seen = gain;
  Index compared = 0;
  for (Index k = 0; k < dy.size(); ++k) {
    if (!modes.counts(k)) continue;
    ++compared;
    p_seen(k) = modes.probability(k), gain_seen(k) = modes.gain(k);
  }
  EXPECT_TRUE(same(p_seen, p));
  EXPECT_TRUE(same(gain_seen, gain));
  EXPECT_GE(compared, 1);
  // And nearly the same one, where no mode is taken for the other kind.
  const TakenModes close(rounded, options);
  const auto amplified = [](const Batch<double>& g) {
    return (g.array() > 1).eval();
  };
  if ((amplified(close.gain) == amplified(modes.gain)).all()) {
    EXPECT_TRUE(Comparator(0.02, 0)(single, dx));
  }
}

// Training: tests/optimizers/sip_heat_reference_test.cpp.
TEST(HeatReference, Physics) {
  check_entries(
      kHeatId,
      {{"kernel", check_kernel},
       {"rectangles", check_rectangles},
       {"forward", in_both(check_forward<float>, check_forward<double>)},
       {"gd-closed-form", in_both(check_gd<float>, check_gd<double>)},
       {"inverse-physics-iteration",
        in_both(check_iteration<float>, check_iteration<double>)},
       {"inverse-step-*", check_step}},
      {"training-gradient-*", "two-steps-*"});
}

}  // namespace
}  // namespace physinv::test
