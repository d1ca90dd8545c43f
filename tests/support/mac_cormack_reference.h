/// The check of a `mac_cormack` entry: one component carried by a velocity
/// that is given at its points.
#pragma once

#include <gtest/gtest.h>

#include "problems/fluid/mac_cormack.h"
#include "tests/support/planes.h"
#include "tests/support/reference.h"

namespace physinv::test {

template <class P>
struct GivenVelocity {
  const P *x, *y;
  P *x_bar, *y_bar;
  fluid::Velocity<P> operator()(Index at) const { return {x[at], y[at]}; }
  void add(Index at, P a, P b) const { x_bar[at] += a, y_bar[at] += b; }
};

/// Everything that MacCormack makes of one field.
template <class T, fluid::Edge kEdge>
struct Advected {
  using P = fluid::Samples8<T>;

  Advected(const Batch<double>& field,
           const Batch<double>& x,
           const Batch<double>& y,
           double lambda,
           const Batch<double>& cotangent)
      : g{field.rows(), field.cols()},
        scheme(g, lambda),
        f(to_plane<P>(g, field)),
        s(blank<P>(g)),
        out(s),
        f_bar(s),
        x_bar(s),
        y_bar(s),
        decisions(static_cast<std::size_t>(scheme.decisions())) {
    const auto vx = to_plane<P>(g, x), vy = to_plane<P>(g, y);
    const auto g_out = to_plane<P>(g, cotangent);
    auto memory = scratch<P>(g);
    if (kEdge == fluid::Edge::periodic) wrap(g, f.data());
    const GivenVelocity<P> v{vx.data(), vy.data(), x_bar.data(), y_bar.data()};
    scheme.advect(
        f.data(), v, s.data(), out.data(), decisions.data(), memory.data());
    scheme.pull(f.data(),
                s.data(),
                v,
                decisions.data(),
                g_out.data(),
                f_bar.data(),
                memory.data());
  }

  Batch<double> of(const Packs<P>& plane) const { return from_plane(g, plane); }
  Batch<double> limited() const {
    Batch<double> l(g.rows, g.columns);
    std::size_t k = 0;
    for (Index i = 0; i < g.rows; ++i)
      for (Index j = 0; j < g.columns; ++j, k += fluid::kWidth<T>)
        l(i, j) = decisions[k] != 0;
    return l;
  }

  fluid::Plane g;
  fluid::MacCormack<kEdge, P> scheme;
  Packs<P> f, s, out, f_bar, x_bar, y_bar;
  std::vector<std::uint8_t> decisions;
};

/// |a - b| <= abs + rel |b|, number by number.
inline void expect_near(const Batch<double>& got,
                        const Batch<double>& expected,
                        double rel,
                        double abs,
                        const char* what) {
  ASSERT_EQ(got.rows(), expected.rows()) << what;
  ASSERT_EQ(got.cols(), expected.cols()) << what;
  for (Index j = 0; j < got.cols(); ++j)
    for (Index i = 0; i < got.rows(); ++i)
      ASSERT_TRUE(Comparator(rel, abs)(got(i, j), expected(i, j)))
          << what << " (" << i << ", " << j << ")";
}

/// What the file allows in double, and float's own rounding.
template <class T>
struct FileTolerance {
  explicit FileTolerance(const Json& entry, double single = 2e-5)
      : rel(number(entry.at("tolerance").at("rel"))),
        abs(number(entry.at("tolerance").at("abs"))) {
    if (sizeof(T) == 4) rel = abs = single;
  }
  void operator()(const Batch<double>& got,
                  const Batch<double>& expected,
                  const char* what) const {
    expect_near(got, expected, rel, abs, what);
  }
  void operator()(double got, const Json& expected, const char* what) const {
    (*this)(Vector<double>::Constant(1, got),
            Vector<double>::Constant(1, number(expected)),
            what);
  }
  double rel, abs;
};

template <class T, fluid::Edge kEdge>
void check_mac_cormack(const Json& entry) {
  const Json in = entry.at("inputs"), out = entry.at("outputs");
  const FileTolerance<T> near(entry);
  const Batch<double> f = rows(in.at("field"));
  const auto alike = [&](const Json& list) {
    return rows(list, f.rows(), f.cols());
  };
  const Advected<T, kEdge> a(f,
                             alike(in.at("vx")),
                             alike(in.at("vy")),
                             in.at("lambda_"),
                             alike(in.at("cotangent")));
  EXPECT_EQ(a.limited(), alike(out.at("limited")));
  near(a.of(a.out), rows(out.at("value")), "value");
  near(a.of(a.s), rows(out.at("semi_lagrangian")), "semi_lagrangian");
  near(a.of(a.f_bar), rows(out.at("field_bar")), "field_bar");
  near(a.of(a.x_bar), rows(out.at("vx_bar")), "vx_bar");
  near(a.of(a.y_bar), rows(out.at("vy_bar")), "vy_bar");
  // r need not be kept: the free output is s + (f - r) / 2.
  const Batch<double> r = alike(out.at("back_and_forth"));
  const Batch<double> free = a.of(a.s) + 0.5 * (f - r);
  near((a.limited().array() == 0).select(a.of(a.out), free), free, "r");
}

}  // namespace physinv::test
