#include "tests/support/reference.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <stdexcept>

namespace physinv::test {

std::string reference_dir() {
  const char* dir = std::getenv("PHYSINV_REFERENCE_DIR");
  return dir != nullptr && *dir != '\0' ? dir : PHYSINV_REFERENCE_DIR;
}

Json load_reference(const std::string& id) {
  const std::string path = reference_dir() + "/" + id + ".json";
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  return Json::parse(file);
}

std::vector<Json> reference_entries(const std::string& id,
                                    const std::string& name) {
  std::vector<Json> found;
  const Json file = load_reference(id);
  for (const Json& entry : file.at("entries"))
    if (entry.at("name") == name) found.push_back(entry);
  return found;
}

double number(const Json& value) {
  return value.is_null() ? std::numeric_limits<double>::quiet_NaN()
                         : value.get<double>();
}

Vector<double> vector(const Json& list) {
  Vector<double> v(static_cast<Index>(list.size()));
  Index i = 0;
  for (const Json& value : list) v(i++) = number(value);
  return v;
}

Batch<double> columns(const Json& samples) {
  if (samples.empty()) return {};
  Batch<double> batch(static_cast<Index>(samples.front().size()),
                      static_cast<Index>(samples.size()));
  Index i = 0;
  for (const Json& sample : samples) batch.col(i++) = vector(sample);
  return batch;
}

Batch<double> rows(const Json& list) { return columns(list).transpose(); }

EntryTolerance::EntryTolerance(const Json& entry) : entry_(entry) {
  static const std::vector<std::string> known = {"rtol",
                                                 "atol",
                                                 "rtol_first",
                                                 "atol_final_loss",
                                                 "rtol_final_loss",
                                                 "gtol",
                                                 "final_loss_below",
                                                 "tolerance_note"};
  for (const auto& [key, value] : entry.items()) {
    if (key.find("tol") == std::string::npos && key != "final_loss_below")
      continue;
    if (std::find(known.begin(), known.end(), key) == known.end())
      throw std::runtime_error("unknown tolerance form " + key);
  }
}

Comparator EntryTolerance::array(double scale) const {
  if (!entry_.contains("rtol") && !entry_.contains("atol"))
    throw std::runtime_error("entry without rtol or atol");
  return {scale * entry_.value("rtol", 0.0), entry_.value("atol", 0.0)};
}

Comparator EntryTolerance::iterates() const {
  return {entry_.value("rtol_first", entry_.value("rtol", 0.0)),
          entry_.value("atol", 0.0)};
}
bool EntryTolerance::first_only() const {
  return entry_.contains("rtol_first");
}

testing::AssertionResult EntryTolerance::final_loss(double loss,
                                                    double stored,
                                                    double otherwise) const {
  if (entry_.contains("final_loss_below")) {
    const double bound =
        std::max(entry_.at("final_loss_below").get<double>(), 10 * stored);
    if (loss <= bound) return testing::AssertionSuccess();
    return testing::AssertionFailure()
           << "final loss " << loss << " above " << bound;
  }
  if (entry_.contains("atol_final_loss") ||
      entry_.contains("rtol_final_loss")) {
    return Comparator(entry_.value("rtol_final_loss", 0.0),
                      entry_.value("atol_final_loss", 0.0))(loss, stored);
  }
  return Comparator(otherwise, otherwise)(loss, stored);
}

void check_entries(const std::string& id,
                   const std::map<std::string, EntryCheck>& checks,
                   const std::set<std::string>& elsewhere) {
  const Json file = load_reference(id);
  std::size_t seen = 0;
  for (const Json& entry : file.at("entries")) {
    const auto name = entry.at("name").get<std::string>();
    SCOPED_TRACE(name);
    if (elsewhere.contains(name)) continue;
    ASSERT_TRUE(checks.contains(name)) << "no test reads this entry";
    checks.at(name)(entry);
    ++seen;
  }
  EXPECT_GE(seen, checks.size());
}

void expect_known_entries(const std::string& id,
                          const std::vector<std::string>& known) {
  const Json file = load_reference(id);
  for (const Json& entry : file.at("entries")) {
    const auto name = entry.at("name").get<std::string>();
    EXPECT_NE(std::find(known.begin(), known.end(), name), known.end())
        << "no test reads the entry " << name << " of " << id;
  }
}

}  // namespace physinv::test
