#include "python/module/results.h"

#include <pybind11/stl.h>

#include "python/module/arrays.h"
#include "suite/results/results.h"
#include "suite/results/shortfall.h"

namespace physinv::python {
namespace {

/// NaN where a stage has no such number.
py::dict stage_row(const CaseRecord& c, const StageRecord& s) {
  py::dict row;
  row["case"] = c.info.name;
  row["experiment"] = c.info.experiment;
  row["method"] = c.info.method;
  row["n"] = c.info.n;
  row["seed"] = c.info.seed;
  row["stage"] = s.stage;
  row["profile"] = profile_of(c, s);
  row["precision"] = std::string(to_string(c.info.precision));
  row["stop"] = std::string(to_string(s.stop));
  row["message"] = s.message;
  row["iterations"] = s.iterations;
  row["key"] = s.key;
  row["revision"] = s.revision;
  const bool timed = has_time(s);
  row["seconds"] = timed ? py::object(py::float_(s.clocks.solve.wall))
                         : py::object(py::none());
  row["cpu_seconds"] = timed ? py::object(py::float_(s.clocks.solve.cpu))
                             : py::object(py::none());
  return row;
}

const CaseRecord& case_named(const Results& results, const std::string& name) {
  for (const CaseRecord& c : results.cases())
    if (c.info.name == name) return c;
  throw py::value_error("there is no case '" + name +
                        "'; stages() lists those that are there");
}

const StageRecord& stage_named(const CaseRecord& c, const std::string& name) {
  for (const StageRecord& s : c.stages)
    if (name.empty() ? &s == &c.stages.back() : s.stage == name) return s;
  throw py::value_error(c.info.name + " has no finished stage '" + name + "'");
}

py::list stages(const Results& results) {
  py::list all;
  for (const CaseRecord& c : results.cases())
    for (const StageRecord& s : c.stages) all.append(stage_row(c, s));
  return all;
}

py::dict examples(const Results& results,
                  const std::string& name,
                  const std::string& stage) {
  const CaseRecord& c = case_named(results, name);
  const StageRecord& s = stage_named(c, stage);
  py::dict all;
  all["loss"] = to_array(s.loss);
  py::list status;
  for (const Status one : s.status) status.append(std::string(to_string(one)));
  all["status"] = status;
  all["iterations"] = to_array(s.example_iterations);
  all["evaluations"] = to_array(s.example_evaluations);
  all["x"] = to_array(s.x);
  py::dict data;
  data["x"] = to_array(c.data.x);
  data["y"] = to_array(c.data.y);
  data["given"] = to_array(c.data.given);
  all["problem"] = data;
  py::dict arrays;
  for (const auto& [key, array] : s.arrays)
    arrays[py::str(key)] = to_array(array);
  all["arrays"] = arrays;
  return all;
}

py::dict curve(const Results& results,
               const std::string& name,
               const std::string& stage) {
  const Curve& k = stage_named(case_named(results, name), stage).curve;
  const auto axis = [](const std::vector<double>& values) {
    return Array<double>(static_cast<py::ssize_t>(values.size()),
                         values.data());
  };
  py::dict all;
  all["iteration"] = axis(k.iteration);
  all["seconds"] = axis(k.seconds);
  all["evaluations"] = axis(k.evaluations);
  all["loss"] = to_array(k.loss);  // points x examples
  all["x"] = to_array(k.x);
  return all;
}

}  // namespace

void define_results(py::module_& module) {
  py::class_<Results>(module, "Results")
      .def("_stages", &stages)
      .def("_examples", &examples, py::arg("case"), py::arg("stage"))
      .def("_curve", &curve, py::arg("case"), py::arg("stage"));
  module.def(
      "load_results",
      [](const std::string& directory) { return load_results(directory); },
      py::arg("directory"));
}

}  // namespace physinv::python
