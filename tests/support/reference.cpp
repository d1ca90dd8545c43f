#include "tests/support/reference.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <regex>
#include <sstream>
#include <stdexcept>

namespace physinv::test {

namespace {

constexpr const char* kOwnDir = PHYSINV_REFERENCE_DIR;

std::string path_of(const std::string& id) {
  return reference_dir() + "/" + id + ".json";
}

Json::Raw load(const std::string& id) {
  const std::string path = path_of(id);
  std::ifstream file(path);
  if (!file) throw std::runtime_error("cannot read " + path);
  return Json::Raw::parse(file);
}

/// None, and a failure, where there is no such file.
std::vector<Json> entries_or_failure(const std::string& id) {
  try {
    return all_entries(id);
  } catch (const std::exception& e) {
    ADD_FAILURE() << e.what();
    return {};
  }
}

std::string name_of(const Json& entry) { return entry.at("name"); }

/// `pattern` is a name, or the beginning of names and *.
bool fits(const std::string& name, const std::string& pattern) {
  if (!pattern.ends_with('*')) return name == pattern;
  return name.starts_with(pattern.substr(0, pattern.size() - 1));
}

bool fits(const std::string& name, const std::set<std::string>& patterns) {
  return std::any_of(patterns.begin(), patterns.end(), [&](const auto& one) {
    return fits(name, one);
  });
}

std::string description(const Json& entry) {
  return entry.value("description", "");
}

/// Where the inputs of an entry are.
Json inputs_of(const Json& entry) {
  for (const char* key : {"inputs", "input"})
    if (entry.contains(key)) return entry.at(key);
  return entry;
}

std::vector<Index> numbers_in(const std::string& list) {
  static const std::regex form("[0-9]+");
  std::vector<Index> all;
  for (std::sregex_iterator at(list.begin(), list.end(), form), end; at != end;
       ++at)
    all.push_back(std::stol(at->str()));
  return all;
}

}  // namespace

std::string reference_dir() {
  const char* dir = std::getenv("PHYSINV_REFERENCE_DIR");
  return dir != nullptr && *dir != '\0' ? dir : kOwnDir;
}

bool has_reference(const std::string& id) {
  return std::ifstream(path_of(id)).good();
}

std::vector<Json> all_entries(const std::string& id) {
  std::vector<Json> all;
  const Json::Raw file = load(id);
  for (const Json::Raw& entry : file.at("entries")) all.emplace_back(entry);
  return all;
}

std::vector<Json> reference_entries(const std::string& id,
                                    const std::string& name) {
  std::vector<Json> found;
  for (const Json& entry : all_entries(id))
    if (name_of(entry) == name) found.push_back(entry);
  return found;
}

Json spoken_of(const std::string& id, const std::string& name) {
  const auto exact = reference_entries(id, name);
  if (!exact.empty()) return exact.front();
  for (const Json& entry : all_entries(id))
    if (name_of(entry).starts_with(name)) return entry;
  throw std::runtime_error(id + " has no entry " + name);
}

double number(const Json& value) { return value; }

namespace {
void expect_size(const Json& list,
                 Index found,
                 Index wanted,
                 const char* what) {
  if (wanted == kAny || found == wanted) return;
  throw std::runtime_error(list.path() + " has " + std::to_string(found) + " " +
                           what + ", expected " + std::to_string(wanted));
}
}  // namespace

Vector<double> vector(const Json& list, Index size) {
  const std::vector<double> values = list;
  expect_size(list, Index(values.size()), size, "numbers");
  return Eigen::Map<const Vector<double>>(values.data(),
                                          static_cast<Index>(values.size()));
}

Batch<double> columns(const Json& samples, Index features, Index count) {
  const auto n = static_cast<Index>(samples.size());
  expect_size(samples, n, count, "items");
  if (n == 0) return Batch<double>(std::max<Index>(features, 0), 0);
  if (features == kAny) features = static_cast<Index>(samples.front().size());
  Batch<double> batch(features, n);
  Index i = 0;
  for (const Json& sample : samples) batch.col(i++) = vector(sample, features);
  return batch;
}

Batch<double> rows(const Json& list, Index count, Index row) {
  return columns(list, row, count).transpose();
}

Vector<double> field(const Json& list, Index count, Index row) {
  return columns(list, row, count).reshaped();
}

Batch<double> fields(const Json& list) {
  const auto count = static_cast<Index>(list.front().size()),
             row = static_cast<Index>(list.front().front().size());
  Batch<double> all(count * row, static_cast<Index>(list.size()));
  Index i = 0;
  for (const Json& one : list) all.col(i++) = field(one, count, row);
  return all;
}

double setting(const Json& entry,
               const std::string& key,
               const std::string& words,
               double specified) {
  const Json in = inputs_of(entry);
  if (in.contains(key)) return in.at(key);
  static const std::string kNumber =
      "[ =]*([-+]?[0-9]+(?:\\.[0-9]+)?(?:e[-+]?[0-9]+)?)";
  const std::string said = description(entry);
  std::smatch found;
  if (std::regex_search(said, found, std::regex(words + kNumber)))
    return std::stod(found[1]);
  return specified;
}

std::vector<Index> layer_sizes(const Json& entry,
                               std::vector<Index> specified) {
  static const std::regex form("MLP (?:\\[([0-9, ]+)\\]|([0-9]+(?:-[0-9]+)+))");
  const std::string said = description(entry);
  std::smatch found;
  if (!std::regex_search(said, found, form)) return specified;
  return numbers_in(found[1].matched ? found[1].str() : found[2].str());
}

void expect_parameters(const Json& entry, Index found) {
  static const std::regex form("([0-9][0-9,]*) parameters");
  const std::string said = description(entry);
  std::smatch stated;
  if (!std::regex_search(said, stated, form)) return;
  std::string digits = stated[1];
  std::erase(digits, ',');
  EXPECT_EQ(found, std::stol(digits)) << "parameters";
}

double formula_shift(const std::string& id, const Json& entry) {
  if (entry.contains("shift")) return entry.at("shift");
  double shift = 0;
  for (const Json& earlier : all_entries(id)) {
    if (earlier == entry) break;
    shift = earlier.value("shift", shift);
  }
  return shift;
}

Json batch_of(const std::string& id,
              const Json& batch,
              const std::string& key) {
  if (!batch.is_string()) return batch;
  static const std::regex form("(?:the batch of|as) (\\S+)");
  const std::string said = batch;
  std::smatch found;
  if (!std::regex_match(said, found, form))
    throw std::runtime_error(batch.path() + " is \"" + said +
                             "\", expected numbers or \"the batch of NAME\"");
  return spoken_of(id, found[1]).at("inputs").at(key);
}

void expect_formula(const Json& in,
                    const std::string& key,
                    const std::string& formula) {
  EXPECT_EQ(in.at(key).get<std::string>(), formula)
      << "no test carries out this formula of " << in.at(key).path();
}

Recurrence::Recurrence(const Json& rule)
    : a_(rule.at("a")), b_(rule.at("b")), c_(rule.at("c")), m_(rule.at("m")) {}

Vector<double> recurrence_weights(const Json& rule,
                                  const std::vector<TensorInfo>& tensors) {
  const Recurrence u(rule);
  const double s = rule.value("s", 1.0);
  if (rule.contains("order")) {
    EXPECT_EQ(rule.at("order").size(), tensors.size()) << "tensors";
  }
  if (rule.contains("shapes")) {
    EXPECT_EQ(rule.at("shapes").size(), tensors.size()) << "tensors";
  }
  Vector<double> all(tensors.back().offset + tensors.back().size);
  for (std::size_t number = 0; number < tensors.size(); ++number) {
    const TensorInfo& t = tensors[number];
    if (rule.contains("shapes")) {
      Index size = 1;
      for (const Json& extent : rule.at("shapes").at(number))
        size *= extent.get<Index>();
      EXPECT_EQ(t.size, size) << rule.at("shapes").at(number).path();
    }
    for (Index k = t.offset; k < t.offset + t.size; ++k)
      all(k) = t.kind == 's'   ? 1 + 0.1 * u(k)
               : t.kind == 'o' ? 0.1 * u(k)
               : t.kind == 'f' ? u(k) / 64
                               : s * u(k) / std::sqrt(double(t.fan_in));
  }
  return all;
}

Vector<double> tensor_norms(const std::vector<TensorInfo>& tensors,
                            const Vector<double>& gradient) {
  Vector<double> norms(static_cast<Index>(tensors.size()));
  Index i = 0;
  for (const TensorInfo& t : tensors)
    norms(i++) = gradient.segment(t.offset, t.size).stableNorm();
  return norms;
}

EntryTolerance::EntryTolerance(const Json& entry) : entry_(entry) {
  static const std::set<std::string> known = {"rtol",
                                              "atol",
                                              "rtol_first",
                                              "atol_final_loss",
                                              "rtol_final_loss",
                                              "gtol",
                                              "final_loss_below",
                                              "tolerance_note"};
  for (const std::string& key : entry.keys()) {
    if (key.find("tol") == std::string::npos && key != "final_loss_below")
      continue;
    if (!known.contains(key))
      throw std::runtime_error("unknown tolerance form " + key);
  }
}

Comparator EntryTolerance::array(double scale) const {
  if (!entry_.contains("rtol") && !entry_.contains("atol"))
    throw std::runtime_error("entry without rtol or atol");
  return {scale * entry_.value("rtol", 0.0), entry_.value("atol", 0.0)};
}

Comparator EntryTolerance::iterates() const {
  const double rtol = entry_.value("rtol", 0.0);
  return {entry_.value("rtol_first", rtol), entry_.value("atol", 0.0)};
}
bool EntryTolerance::first_only() const {
  return entry_.contains("rtol_first");
}

testing::AssertionResult EntryTolerance::final_loss(double loss,
                                                    double stored,
                                                    double otherwise) const {
  if (entry_.contains("final_loss_below")) {
    const double bound =
        std::max(number(entry_.at("final_loss_below")), 10 * stored);
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

void check_entry(const Json& entry, const EntryCheck& check) {
  try {
    check(entry);
  } catch (const std::exception& e) {
    ADD_FAILURE() << e.what();
    return;  // what follows it was not reached
  }
  if (testing::Test::HasFatalFailure()) return;
  for (const std::string& key : entry.unread())
    ADD_FAILURE() << "no test reads " << key;
}

void check_entries(const std::string& id,
                   const std::map<std::string, EntryCheck>& checks,
                   const std::set<std::string>& elsewhere) {
  std::set<std::string> used;
  for (const Json& entry : entries_or_failure(id)) {
    const std::string name = name_of(entry);
    SCOPED_TRACE(id + " " + name);
    auto found = checks.find(name);
    if (found == checks.end())
      found = std::find_if(checks.begin(), checks.end(), [&](const auto& one) {
        return fits(name, one.first);
      });
    if (found == checks.end()) {
      EXPECT_TRUE(fits(name, elsewhere)) << "no test reads this entry";
      continue;
    }
    used.insert(found->first);
    check_entry(entry, found->second);
  }
  EXPECT_FALSE(used.empty()) << id << " has no entry for this test";
  if (reference_dir() != kOwnDir) return;
  for (const auto& [name, check] : checks)
    EXPECT_TRUE(used.contains(name)) << id << " has no entry " << name;
}

void check_entries_named(const std::string& id,
                         const std::string& name,
                         const EntryCheck& check) {
  check_entries(id, {{name, check}}, {"*"});
}

void expect_known_entries(const std::string& id,
                          const std::set<std::string>& known) {
  for (const Json& entry : entries_or_failure(id))
    EXPECT_TRUE(fits(name_of(entry), known))
        << "no test reads the entry " << name_of(entry) << " of " << id;
}

}  // namespace physinv::test
