#include "python/module/results.h"

#include <pybind11/stl.h>

#include <algorithm>

#include "python/module/arrays.h"
#include "suite/results/results.h"
#include "suite/results/tidy.h"
#include "suite/store/catalog.h"
#include "suite/store/missing_work.h"
#include "suite/store/repetitions.h"
#include "suite/store/results_file.h"

namespace physinv::python {
namespace {

/// What a directory held when it was opened.
struct Campaign {
  explicit Campaign(const std::string& directory)
      : catalog(Catalog::read(directory)), results(checked_cases(catalog)) {}
  Catalog catalog;
  Results results;
};

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
  row["seconds"] = timed ? py::object(py::float_(solving_time(s).wall))
                         : py::object(py::none());
  row["cpu_seconds"] = timed ? py::object(py::float_(solving_time(s).cpu))
                             : py::object(py::none());
  return row;
}

const CaseRecord& case_named(const Results& results, const std::string& name) {
  for (const CaseRecord& c : results.cases())
    if (c.info.name == name) return c;
  throw py::value_error("there is no case '" + name +
                        "'; stages() lists the existing ones");
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
  for (const auto& [key, array] : s.arrays)  // of one row, as in the file
    arrays[py::str(key)] = array.rows() == 1
                               ? to_array(Vector<double>(array.reshaped()))
                               : to_array(array);
  all["arrays"] = arrays;
  return all;
}

py::dict curve(const Results& results,
               const std::string& name,
               const std::string& stage) {
  const StageRecord& s = stage_named(case_named(results, name), stage);
  const Curve& k = s.curve;
  const auto axis = [](const std::vector<double>& values) {
    return Array<double>(static_cast<py::ssize_t>(values.size()),
                         values.data());
  };
  py::dict all;
  all["iteration"] = axis(k.iteration);
  all["seconds"] = axis(k.seconds);
  all["evaluations"] = axis(k.evaluations);
  all["loss"] = to_array(k.loss);  // points x examples
  // points x examples x unknowns
  const Index unknowns = std::max<Index>(1, s.x.rows());
  Array<double> x({k.x.cols(), k.x.rows() / unknowns, unknowns});
  std::copy_n(k.x.data(), x.size(), x.mutable_data());
  all["x"] = x;
  return all;
}

/// Of a column in a row; None where it is missing.
struct Value {
  const TidyRow& row;
  py::object operator()(TidyColumn::Text f) const { return py::str(f(row)); }
  template <class T>
  py::object operator()(std::optional<T> (*f)(const TidyRow&)) const {
    return py::cast(f(row));
  }
};

py::dict tidy(const Campaign& campaign) {
  std::vector<py::list> values(tidy_columns().size());
  const auto& cases = campaign.results.cases();
  for_each_tidy_row(
      campaign.catalog,
      cases,
      missing_work(campaign.catalog, cases),
      [&](const TidyRow& row) {
        for (std::size_t k = 0; k < values.size(); ++k)
          values[k].append(std::visit(Value{row}, tidy_columns()[k].value));
      });
  py::dict columns;
  for (std::size_t k = 0; k < values.size(); ++k)
    columns[py::str(std::string(tidy_columns()[k].name))] = values[k];
  return columns;
}

}  // namespace

/// What the suite's stages leave, a dict each.
py::list known_arrays() {
  py::list all;
  for (const ArrayInfo& info : kArrays) {
    py::dict one;
    one["name"] = info.name;
    one["axes"] = info.axes;
    one["unit"] = info.unit;
    one["meaning"] = info.meaning;
    one["beside"] = info.beside;
    all.append(one);
  }
  return all;
}

void define_results(py::module_& module) {
  module.def("arrays", &known_arrays);
  py::class_<Campaign>(module, "Results")
      .def("_stages", [](const Campaign& c) { return stages(c.results); })
      .def(
          "_examples",
          [](const Campaign& c,
             const std::string& name,
             const std::string& stage) {
            return examples(c.results, name, stage);
          },
          py::arg("case"),
          py::arg("stage"))
      .def(
          "_curve",
          [](const Campaign& c,
             const std::string& name,
             const std::string& stage) {
            return curve(c.results, name, stage);
          },
          py::arg("case"),
          py::arg("stage"))
      .def("_tidy", &tidy);
  module.def(
      "load_results",
      [](const std::string& directory) { return Campaign(directory); },
      py::arg("directory"));
}

}  // namespace physinv::python
