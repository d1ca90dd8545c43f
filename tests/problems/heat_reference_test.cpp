// The vectors of sip-heat that are physics; training is another test's.
#include <complex>

#include "problems/heat/heat.h"
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

void expect_keys(const Json& expected, const std::set<std::string>& known) {
  std::set<std::string> found;
  for (const auto& [key, value] : expected.items()) found.insert(key);
  EXPECT_EQ(found, known);
}

Vector<double> rectangles() {
  const Json in = reference_entries(kHeatId, "rectangles").at(0).at("inputs");
  Vector<double> field = Vector<double>::Zero(64 * 64);
  for (std::size_t i = 0; i < in.at("strengths").size(); ++i)
    add_rectangle({in.at("positions").at(i),
                   in.at("half_sizes").at(i),
                   in.at("strengths").at(i)},
                  64,
                  field.data());
  return field;
}

Vector<double> at_cells(const Vector<double>& field, const Json& cells) {
  Vector<double> out(static_cast<Index>(cells.size()));
  Index i = 0;
  for (const Json& cell : cells)
    out(i++) = field(64 * cell.at(0).get<Index>() + cell.at(1).get<Index>());
  return out;
}

void check_kernel(const Json& entry) {
  const Json& want = entry.at("expected");
  expect_keys(want, {"exponent", "factor"});
  const Heat<double> heat;
  std::size_t i = 0;
  for (const Json& index : entry.at("inputs").at("indices")) {
    const auto folded = [&](int axis) {
      const auto k = index.at(static_cast<std::size_t>(axis)).get<Index>();
      return std::min(k, 64 - k);
    };
    const double s = heat.exponents()(folded(0), folded(1));
    const auto same = tolerance(entry);
    EXPECT_TRUE(same(s, want.at("exponent").at(i).get<double>()));
    EXPECT_TRUE(same(std::exp(-s), want.at("factor").at(i).get<double>()));
    ++i;
  }
}

void check_rectangles(const Json& entry) {
  const Json &in = entry.at("inputs"), &want = entry.at("expected");
  expect_keys(want, {"values", "sum", "norm"});
  const Vector<double> field = rectangles();
  const auto same = tolerance(entry);
  EXPECT_TRUE(same(at_cells(field, in.at("cells")), vector(want.at("values"))));
  EXPECT_TRUE(same(field.sum(), want.at("sum").get<double>()));
  EXPECT_TRUE(same(field.norm(), want.at("norm").get<double>()));
}

template <class T>
void check_forward_in(const Json& entry) {
  const Json &in = entry.at("inputs"), &want = entry.at("expected");
  const Index cells = 64 * 64;
  const auto number_of = [&](const char* key) {
    return in.at(key).get<Index>();
  };
  const Index a = number_of("a"), b = number_of("b"), c = number_of("c"),
              m = number_of("m");
  Batch<T> fields(cells, 2), y(cells, 2), gradient(cells, 1);
  fields.col(0) = rectangles().cast<T>();
  for (Index k = 0; k < cells; ++k)
    fields(k, 1) = static_cast<T>(
        in.at("x0") == "0.3*u"
            ? 0.3 *
                  (2 * double((a * k * k + b * k + c) % m) / double(m - 1) - 1)
            : 0.0);
  const Heat<T> heat;
  Workspace work;
  Tape tape;
  const Batch<T> given(0, 2);
  heat.forward(fields, given, y, work);
  const auto same = tolerance<T>(entry);
  const Vector<double> seen = y.col(0).template cast<double>();
  EXPECT_TRUE(same(at_cells(seen, in.at("cells")), vector(want.at("y"))));
  EXPECT_TRUE(same(seen.sum(), want.at("y_sum").get<double>()));
  EXPECT_TRUE(same(seen.norm(), want.at("y_norm").get<double>()));

  Batch<T> y0(cells, 1), y_bar(cells, 1);
  Vector<double> loss(1);
  heat.linearize(fields.col(1), given.leftCols(1), y0, tape);
  heat.loss(y0, y.col(0), loss);
  heat.loss_gradient(y0, y.col(0), y_bar);
  heat.pullback(tape, y_bar, gradient, work);
  const Vector<double> g = gradient.template cast<double>();
  EXPECT_TRUE(same(loss(0), want.at("loss").get<double>()));
  EXPECT_TRUE(same(at_cells(g, in.at("cells")), vector(want.at("gradient"))));
  EXPECT_TRUE(same(g.norm(), want.at("gradient_norm").get<double>()));
}

void check_forward(const Json& entry) {
  expect_keys(entry.at("expected"),
              {"y", "y_sum", "y_norm", "loss", "gradient", "gradient_norm"});
  check_forward_in<double>(entry);
  check_forward_in<float>(entry);
}

/// Both what the closed form says and what the steps lead to.
template <class T>
void check_gd_in(const Json& entry) {
  const Json& want = entry.at("expected");
  const Heat<T> heat;
  Workspace work;
  const Batch<double> exact = rectangles();
  const Batch<T> truth = exact.cast<T>(), given(0, 1);
  Batch<T> y(truth), x = Batch<T>::Zero(truth.rows(), 1), seen(y), step(y);
  heat.forward(truth, given, y, work);
  const auto same = tolerance<T>(entry);
  const auto error = [&](const Batch<T>& at) {
    return (exact - at.template cast<double>()).cwiseAbs().sum();
  };
  EXPECT_TRUE(same(error(x), want.at("x_l1_initial").get<double>()));
  for (Index n = 1; n <= 1000; ++n) {
    heat.forward(x, given, seen, work);
    seen = y - seen;
    heat.forward(seen, given, step, work);
    x += step;
    const auto key = std::to_string(n);
    if (!want.at("x_l1").contains(key)) continue;
    const double stored = want.at("x_l1").at(key);
    EXPECT_TRUE(same(error(x), stored)) << n;
    heat.filter(y, heat_gradient_descent(heat.exponents(), n), step, work);
    EXPECT_TRUE(same(error(step), stored)) << n;
    EXPECT_TRUE(tolerance<T>(entry)(x, step));
  }
}

void check_gd(const Json& entry) {
  expect_keys(entry.at("expected"), {"x_l1", "x_l1_initial"});
  EXPECT_EQ(entry.at("expected").at("x_l1").size(), 4U);
  check_gd_in<double>(entry);
  check_gd_in<float>(entry);
}

template <class T>
void check_iteration_in(const Json& entry) {
  const Heat<T> heat({.noise_floor = 1e-8});
  Workspace work;
  const Batch<double> exact = rectangles();
  const Batch<T> truth = exact.cast<T>(), given(0, 1);
  Batch<T> y(truth), x = Batch<T>::Zero(truth.rows(), 1);
  heat.forward(truth, given, y, work);
  for (const Json& stored : entry.at("expected").at("x_l1")) {
    heat.invert(y, given, x, x, work);
    const double error = (exact - x.template cast<double>()).cwiseAbs().sum();
    // What single precision left of y* is not only what diffusion left of x*.
    if (std::is_same_v<T, double>) {
      EXPECT_TRUE(tolerance(entry)(error, stored.get<double>()));
    } else {
      EXPECT_TRUE(Comparator(0.02, 0)(error, stored.get<double>()));
    }
  }
}

void check_iteration(const Json& entry) {
  expect_keys(entry.at("expected"), {"x_l1"});
  check_iteration_in<double>(entry);
  check_iteration_in<float>(entry);
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
Batch<T> step_of(const Batch<double>& dy, double floor) {
  const Heat<T> heat({.resolution = 16, .noise_floor = floor});
  Workspace work;
  Batch<T> dx(256, 1);
  heat.invert(dy.cast<T>(), Batch<T>(0, 1), Batch<T>::Zero(256, 1), dx, work);
  return dx;
}

void check_step_of(const Json& entry) {
  const Json &in = entry.at("inputs"), &want = entry.at("expected");
  const double floor = in.at("uncertainty_floor");
  const Batch<double> dy = rows(in.at("dy"));
  const auto flat = [](const Batch<double>& field) {
    return Batch<double>(Batch<double>(field.transpose()).reshaped());
  };
  const Batch<double> dx = flat(rows(want.at("dx")));
  const auto same = tolerance(entry);
  EXPECT_TRUE(same(step_of<double>(flat(dy), floor), dx));
  // A dy in single precision is another one; its step is as good.
  const Batch<double> rounded = flat(dy).cast<float>().cast<double>(),
                      single = step_of<float>(rounded, floor).cast<double>();
  EXPECT_TRUE(Comparator(1e-7, 0)(single, step_of<double>(rounded, floor)));
  EXPECT_TRUE(Comparator(0.02, 0)(single, dx));

  const double uncertainty = (dy.array().abs() * 1e-6 + floor).matrix().norm();
  EXPECT_TRUE(same(uncertainty, want.at("uncertainty").get<double>()));
  const Heat<double> heat({.resolution = 16});
  const Eigen::MatrixXcd z = spectrum(dy);
  const Batch<double> p = rows(want.at("probability")),
                      gain = rows(want.at("kernel"));
  Batch<double> p_seen = p, gain_seen = gain;
  Index compared = 0;
  for (Index k = 0; k < 16; ++k)
    for (Index l = 0; l < 16; ++l) {
      const double amplitude = std::abs(z(k, l));
      if (amplitude <= 1e-10 * z.cwiseAbs().maxCoeff()) continue;
      ++compared;
      const double s =
          heat.exponents()(std::min(k, 16 - k), std::min(l, 16 - l));
      const auto mode =
          HeatMode::of(amplitude, s, 16 * std::exp(-s), uncertainty);
      p_seen(k, l) = mode.probability, gain_seen(k, l) = mode.gain;
    }
  EXPECT_TRUE(same(p_seen, p));
  EXPECT_TRUE(same(gain_seen, gain));
  EXPECT_GE(compared, 50);
}

void check_step(const Json& entry) {
  expect_keys(entry.at("expected"),
              {"dx", "probability", "kernel", "uncertainty"});
  check_step_of(entry);
}

TEST(HeatReference, Physics) {
  check_entries(kHeatId,
                {{"kernel", check_kernel},
                 {"rectangles", check_rectangles},
                 {"forward", check_forward},
                 {"gd-closed-form", check_gd},
                 {"inverse-physics-iteration", check_iteration},
                 {"inverse-step-random", check_step},
                 {"inverse-step-diffused", check_step},
                 {"inverse-step-diffused-floor", check_step}},
                {"training-gradient-l2",
                 "training-gradient-sip",
                 "two-steps-sgd",
                 "two-steps-adam",
                 "two-steps-sip"});
}

}  // namespace
}  // namespace physinv::test
