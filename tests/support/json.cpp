#include "tests/support/json.h"

#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

namespace physinv::test {

struct Json::Document {
  Raw root;
  std::set<const Raw*> read;
};

namespace {

/// Keys whose text is for people.
bool is_words(const std::string& key) {
  static const std::set<std::string> kWords = {"name",
                                               "description",
                                               "definition",
                                               "definitions",
                                               "why",
                                               "reason",
                                               "rule",
                                               "note",
                                               "tolerance_note"};
  return kWords.contains(key);
}

std::string joined(const std::string& path, const std::string& key) {
  return path.empty() ? key : path + "." + key;
}
std::string joined(const std::string& path, std::size_t item) {
  return path + "[" + std::to_string(item) + "]";
}

/// visit(node, its path, its key) of everything below `at`, depth first, until
/// it says false.
template <class F>
bool walk(const nlohmann::json& at, const std::string& path, F&& visit) {
  if (at.is_object())
    for (const auto& [key, value] : at.items()) {
      const std::string here = joined(path, key);
      if (!visit(value, here, key) || !walk(value, here, visit)) return false;
    }
  if (at.is_array())
    for (std::size_t i = 0; i < at.size(); ++i) {
      const std::string here = joined(path, i);
      if (!visit(at[i], here, "") || !walk(at[i], here, visit)) return false;
    }
  return true;
}

}  // namespace

Json::Json(Raw document)
    : document_(std::make_shared<Document>(Document{std::move(document), {}})),
      node_(&document_->root) {}

bool Json::contains(const std::string& key) const {
  return node_->contains(key);
}

Json Json::at(const std::string& key) const {
  if (!contains(key)) {
    const std::string here = path();
    throw std::runtime_error("no key " + key + (here.empty() ? "" : " in ") +
                             here);
  }
  const Raw* member = &(*node_)[key];
  document_->read.insert(member);
  return {document_, member};
}

Json Json::at(std::size_t item) const {
  if (!is_array() || item >= size())
    refuse("a list of more than " + std::to_string(item));
  return {document_, &(*node_)[item]};
}

std::vector<std::string> Json::keys() const {
  std::vector<std::string> all;
  if (!is_object()) refuse("an object");
  for (const auto& [key, value] : node_->items()) all.push_back(key);
  return all;
}

std::vector<std::pair<std::string, Json>> Json::items() const {
  std::vector<std::pair<std::string, Json>> all;
  for (const std::string& key : keys()) all.emplace_back(key, at(key));
  return all;
}

double Json::as_number() const {
  if (is_number()) return node_->get<double>();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  if (is_null() || *node_ == "nan")
    return std::numeric_limits<double>::quiet_NaN();
  if (*node_ == "inf") return kInf;
  if (*node_ == "-inf") return -kInf;
  refuse("a number");
}

std::int64_t Json::as_integer() const {
  if (node_->is_number_integer()) return node_->get<std::int64_t>();
  constexpr double kExact = 9007199254740992;  // 2^53
  const double value = is_number() ? node_->get<double>() : 0.5;
  if (value != std::floor(value) || std::abs(value) > kExact)
    refuse("an integer");
  return static_cast<std::int64_t>(value);
}

bool Json::as_bool() const {
  if (!node_->is_boolean()) refuse("true or false");
  return node_->get<bool>();
}

std::string Json::as_string() const {
  if (!is_string()) refuse("a text");
  return node_->get<std::string>();
}

void Json::refuse(const std::string& wanted) const {
  std::string seen = dump();
  constexpr std::size_t kShown = 60;
  if (seen.size() > kShown) seen = seen.substr(0, kShown) + "...";
  throw std::runtime_error(path() + " is " + seen + ", expected " + wanted);
}

std::vector<std::string> Json::unread() const {
  std::vector<std::string> all;
  const auto look = [&](const auto& self, const Json& at) -> void {
    for (const Json& item : at) self(self, item);
    if (!at.is_object()) return;
    for (const std::string& key : at.keys()) {
      const Json member{document_, &(*at.node_)[key]};
      if (is_words(key)) continue;
      if (document_->read.contains(member.node_))
        self(self, member);
      else
        all.push_back(member.path());
    }
  };
  look(look, *this);
  return all;
}

std::string Json::path() const {
  std::string found;
  walk(document_->root,
       "",
       [&](const Raw& value, const std::string& here, const std::string&) {
         if (&value != node_) return true;
         found = here;
         return false;
       });
  return found;
}

}  // namespace physinv::test
