// Experiments `libraries/landscape-<name>`: one function each, on which the
// solvers of all libraries run once.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "ends.h"
#include "landscape.h"
#include "solvers.h"
#include "suite/harness/registry.h"

namespace libraries {
namespace {

struct Landscape {
  std::string name, title;
  LandscapeOptions problem = {};
  Task task = {};
};

const std::vector<double> kWallStart = {0.8};

std::vector<Landscape> all() {
  return {{"valley", "Rosenbrock's valley"},
          {"zero-gradient",
           "Start on a saddle",
           {.function = "double_well", .start = {0, 0}}},
          {"minimum",
           "Start in the minimum",
           {.function = "bowl", .start = {0, 0}}},
          {"plateau",
           "Start on a plateau",
           {.function = "plateau", .start = {0.5}}},
          {"kink", "|x| + |y - 0.3|", {.function = "kink", .start = {1, 1}}},
          {"scale-1e-20", "Rosenbrock's valley times 1e-20", {.scale = 1e-20}},
          {"scale-1e20", "Rosenbrock's valley times 1e20", {.scale = 1e20}},
          {"infinite-wall",
           "Infinite beyond a wall",
           {.function = "infinite_wall", .start = kWallStart}},
          {"nan-wall",
           "NaN beyond a wall",
           {.function = "nan_wall", .start = kWallStart}},
          {"nan-gradient",
           "The gradient is NaN near the minimum",
           {.function = "lost_slope", .start = {1, 1}}},
          {"wrong-gradient",
           "The gradient has the wrong sign",
           {.function = "uphill", .start = {1, 1}}},
          {"exception", "The fifth evaluation throws", {}, {.throws_at = 5}},
          {"one-iteration", "One iteration at most", {}, {.iterations = 1}},
          {"one-evaluation", "One evaluation at most", {}, {.evaluations = 1}},
          {"box",
           "The minimum is outside of the box",
           {.lower = {-2, -2}, .upper = {0.5, 2}}},
          {"box-corner",
           "Start in the minimum, a corner of the box",
           {.function = "corner",
            .start = {0, 0},
            .lower = {0, 0},
            .upper = {1, 1}}},
          {"box-outside",
           "Start outside of the box",
           {.function = "bowl",
            .start = {5, 5},
            .lower = {1, 1},
            .upper = {2, 2}}}};
}

/// Solvers that know of bounds, and of the libraries' alone what an evaluation
/// can be taken from.
bool takes(const physinv::Method& method, const Task& task) {
  const auto begins = [&](const char* with) {
    return method.id.starts_with(with);
  };
  if (!task.lower.empty())
    return method.id == "lbfgsb" || begins("nlopt-") || begins("dlib-");
  const Task none;
  const bool own = method.id == "bfgs" || method.id == "lbfgsb";
  return !own || (task.throws_at == none.throws_at &&
                  task.evaluations == none.evaluations);
}

void add(Landscape landscape) {
  Task& task = landscape.task;
  task.lower = landscape.problem.lower, task.upper = landscape.problem.upper;
  auto methods = solvers(task);
  std::erase_if(methods, [&](const auto& m) { return !takes(m, task); });
  const std::vector<physinv::Row> once = {
      physinv::row(ids(methods), 1, 1, task.iterations)};
  physinv::register_experiment(
      {.name = "libraries/landscape-" + landscape.name,
       .title = landscape.title + ", other libraries",
       .citation = {.where = "docs/solvers.md"},
       .problem = libraries::landscape(landscape.problem),
       .profiles = {{"smoke", once}, {"quick", once}},
       .methods = std::move(methods),
       .report = [](const physinv::Evidence& e) {
         return physinv::Section{.tables = {ends_table(e)}};
       }});
}

const bool kRegistered = [] {
  for (Landscape& landscape : all()) add(std::move(landscape));
  return true;
}();

}  // namespace
}  // namespace libraries
