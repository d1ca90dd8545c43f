/// Records whose fields are listed (fields.h) as JSON objects.
#pragma once

#include <nlohmann/json.hpp>
#include <type_traits>

#include "suite/store/fields.h"
#include "suite/store/json.h"

namespace physinv {

struct AnyField {
  void operator()(const auto&...) const {}
};
template <class T>
concept HasFields = requires(const T& record) {
  each_field(record, AnyField());
};

nlohmann::json to_json(const Counts& counts);

template <HasFields Record>
nlohmann::json to_object(const Record& record) {
  auto object = nlohmann::json::object();
  const auto add = [&]<class T>(
                       const char* name, const T& value, bool optional = {}) {
    if constexpr (requires { value.empty(); })
      if (optional && value.empty()) return;
    if constexpr (HasFields<T>) {
      object[name] = to_object(value);
    } else if constexpr (std::is_enum_v<T>) {
      object[name] = to_string(value);
    } else if constexpr (requires { to_json(value); }) {
      object[name] = to_json(value);
    } else {
      object[name] = value;
    }
  };
  each_field(record, add);
  return object;
}

/// Counts are whole and not negative; threads and jobs at most 1,000,000.
/// std::exception for what is not.
void read_json(const nlohmann::json& json, Index& number);
void read_json(const nlohmann::json& json, std::uint64_t& count);
void read_json(const nlohmann::json& json, int& workers);
void read_json(const nlohmann::json& json, Seconds& seconds);
void read_json(const nlohmann::json& json, Counts& counts);

/// std::exception for what `to_object` does not write.
template <HasFields Record>
Record from_object(const nlohmann::json& object) {
  Record record;
  const auto read = [&]<class T>(const char* name, T& to, bool optional = {}) {
    if (optional && !object.contains(name)) return;
    const auto& from = object.at(name);
    if constexpr (HasFields<T>) {
      to = from_object<T>(from);
    } else if constexpr (std::is_enum_v<T>) {
      to = value_of<T>(from.template get<std::string>());
    } else if constexpr (requires { read_json(from, to); }) {
      read_json(from, to);
    } else {
      to = from.template get<T>();
    }
  };
  each_field(record, read);
  return record;
}

}  // namespace physinv
