#include <fmt/format.h>

#include <utility>

#include "suite/cases/jpo/gradient_alignment/shares.h"
#include "suite/evidence/cell.h"
#include "suite/harness/registry.h"
#include "suite/results/published.h"
#include "suite/results/results.h"

namespace physinv::alignment {
namespace {

std::vector<double> as_doubles(const std::vector<Index>& n) {
  return {n.begin(), n.end()};
}

/// Mean and two standard errors.
Series points(const char* label,
              const char* method,
              const std::optional<Aligned>& m) {
  Series s{.label = label, .method = method, .line = false, .markers = true};
  if (!m) return s;
  s.x = as_doubles(m->n), s.y = m->share;
  for (std::size_t i = 0; i < m->count(); ++i) {
    s.lo.push_back(m->share[i] - 2 * m->error[i]);
    s.hi.push_back(m->share[i] + 2 * m->error[i]);
  }
  return s;
}

template <class F>
Series curve(const char* label,
             const char* method,
             const std::optional<Aligned>& m,
             F&& theory) {
  Series s{.label = label, .method = method};
  if (!m) return s;
  s.x = as_doubles(m->n);
  for (const Index n : m->n) s.y.push_back(theory(n));
  return s;
}

Panel panel(const char* title, std::vector<Series> series) {
  return {.title = title,
          .x_label = "N",
          .y_label = "share aligned",
          .x_log = true,
          .series = std::move(series),
          .y_min = 0.45,
          .y_max = 1.02};
}

constexpr const char* kMarks =
    "Marks: mean over repetitions, bars of two standard errors. ";

Figure noise_figure(const Fig2& f) {
  const auto both = [](const char* title, const auto& sum, const auto& vote) {
    return panel(title,
                 {points("sum", "sum", sum),
                  curve("P_sum", "sum", sum, sum_weak),
                  points("vote", "vote", vote),
                  curve("P_vote", "vote", vote, vote_weak)});
  };
  return {.id = "fig2a",
          .title = "Noisy gradients with the same solution",
          .where = "Fig. 2a",
          .panels = {both("equal noise", f.known_sum, f.known_vote),
                     both("noise levels over four decades, equal SNR",
                          f.unequal_sum,
                          f.unequal_vote)},
          .note = fmt::format("{}SNR {}.", kMarks, kWeak)};
}

Figure linear_figure(const Fig2& f) {
  const auto rho = [&](Index n) { return Fig2::rho(n, f.paper); };
  return {.id = "fig2b",
          .title = "Noise-free updates of a network, x* = 10 gamma",
          .where = "Fig. 2b",
          .panels = {panel("",
                           {points("measured", "noise_free", f.linear),
                            curve("rho(6.4, 12.9)", "rho", f.linear, rho)})},
          .columns = 1,
          .note = kMarks};
}

Figure noisy_figure(const Fig2& f,
                    const char* id,
                    const char* where,
                    const char* name,
                    const std::optional<Aligned>& m,
                    double (*noise_only)(Index)) {
  Series only = curve("noise only", "noise_only", m, noise_only);
  only.dashed = true;
  const auto combined = [&](Index n) { return f.combined(n, noise_only(n)); };
  const auto response = [&](Index n) {
    return Fig2::rho(n, f.sine_fit->response);
  };
  return {.id = id,
          .title = fmt::format("Updates of a network under noise, {}, x* = "
                               "sin(2 gamma)",
                               name),
          .where = where,
          .panels = {panel(
              "",
              {points(name, name, m),
               curve("model", name, m, combined),
               only,
               points("noise-free", "noise_free", f.free),
               curve("response model", "noise_free", f.free, response)})},
          .columns = 1,
          .note = fmt::format("{}SNR {}.", kMarks, kEven)};
}

Table shares_table(const std::vector<Index>& sizes, const Fig2& f) {
  Table table{.id = "alignment",
              .title = "Share of aligned gradients and updates",
              .digits = 3,
              .corner = "N"};
  std::vector<TableRow> rows;
  for (const Index n : sizes) rows.push_back({.label = fmt::format("{}", n)});
  const auto add =
      [&](const char* name, const std::optional<Aligned>& m, auto&& theory) {
        table.columns.emplace_back(name);
        table.columns.push_back(fmt::format("{} theory", name));
        for (std::size_t i = 0; i < rows.size(); ++i) {
          Cell ours{.text = kNotRun}, law{.text = kNotRun};
          if (const auto at = m ? m->find(sizes[i]) : std::nullopt) {
            ours = {.ours = m->share[*at], .spread = m->error[*at]};
            law = {.ours = theory(sizes[i])};
          }
          rows[i].cells.push_back(std::move(ours));
          rows[i].cells.push_back(std::move(law));
        }
      };
  add("known, sum", f.known_sum, sum_weak);
  add("known, vote", f.known_vote, vote_weak);
  add("unequal, sum", f.unequal_sum, sum_weak);
  add("unequal, vote", f.unequal_vote, vote_weak);
  add("linear", f.linear, [&](Index n) { return Fig2::rho(n, f.paper); });
  add("sine, noise-free", f.free, [&](Index n) {
    return Fig2::rho(n, f.sine_fit->response);
  });
  add("sine, sum", f.sum, [&](Index n) { return f.combined(n, sum_even(n)); });
  add("sine, vote", f.vote, [&](Index n) {
    return f.combined(n, vote_even(n));
  });
  table.rows = std::move(rows);
  table.note =
      "Mean over repetitions ± its standard error. Theory of the sum assumes "
      "equal noise, so \"unequal, sum\" must stay below it.";
  return table;
}

Table fits_table(const Fig2& f, const Published& published) {
  Table table{.id = "response",
              .title = "Response model fitted to noise-free updates",
              .where = "Fig. 2b",
              .digits = 3,
              .corner = "network",
              .columns = {"C", "A", "rms"}};
  const auto row = [](const char* label, const auto& fit) {
    TableRow out{.label = label, .cells = std::vector<Cell>(3)};
    for (Cell& cell : out.cells) cell.text = kNotRun;
    if (!fit) return out;
    out.cells = {{.ours = fit->response.complexity},
                 {.ours = fit->response.plasticity},
                 {.ours = fit->rms}};
    return out;
  };
  TableRow linear = row("10 gamma, 1-32-32-32-1 tanh", f.linear_fit);
  const char* quantities[] = {"fig2b/C", "fig2b/A"};
  for (std::size_t i = 0; i < 2; ++i) {
    if (const auto found = published.find(kName, quantities[i]))
      linear.cells[i].paper = found->value;
  }
  table.rows = {std::move(linear),
                row("sin(2 gamma), 1-64-1 ReLU", f.sine_fit)};
  table.note =
      "Least squares over N on a grid of steps 0.25. The paper does not name "
      "its network.";
  return table;
}

/// The normal approximations of the vote next to the exact binomial.
Table vote_table(const std::vector<Index>& sizes) {
  Table table{.id = "vote_theory",
              .title = fmt::format("Majority vote at SNR {}", kWeak),
              .digits = 4,
              .corner = "N",
              .columns = {"P_sum", "exact", "normal", "as printed"}};
  for (const Index n : sizes) {
    table.rows.push_back({.label = fmt::format("{}", n),
                          .cells = {{.ours = sum_weak(n)},
                                    {.ours = vote_weak(n)},
                                    {.ours = align_vote_normal(n, kWeak)},
                                    {.ours = align_vote_printed(n, kWeak)}}});
  }
  table.note =
      "The paper's normal approximation lacks a factor 2 below the root.";
  return table;
}

Section report(const Evidence& e) {
  const Fig2 f(e);
  const auto sizes = e.results.sizes(kName);
  return {.tables = {shares_table(sizes, f),
                     fits_table(f, e.published),
                     vote_table(sizes)},
          .figures = {
              noise_figure(f),
              linear_figure(f),
              noisy_figure(f, "fig2c", "Fig. 2c", "sum", f.sum, sum_even),
              noisy_figure(f, "fig2d", "Fig. 2d", "vote", f.vote, vote_even)}};
}

}  // namespace

void add_reports(Registry& r) { r.add_report(kName, report); }

}  // namespace physinv::alignment
