/// A value of a reference file that remembers which of its keys were asked
/// for, so that a test can fail on those that nothing reads. Numbers that JSON
/// lacks are null (NaN) or the words "nan", "inf" and "-inf".
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

namespace physinv::test {

namespace json {
template <class T>
inline constexpr bool kList = false;
template <class T>
inline constexpr bool kList<std::vector<T>> = true;
template <class T, std::size_t n>
inline constexpr bool kList<std::array<T, n>> = true;

/// What a value can be read as.
template <class T>
concept Readable =
    std::is_arithmetic_v<T> || std::same_as<T, std::string> || kList<T>;
}  // namespace json

/// A view: copies share the document and what was read of it. What is asked
/// for in vain throws, and the message names key and value.
class Json {
 public:
  using Raw = nlohmann::json;

  Json() : Json(Raw()) {}
  explicit Json(Raw document);

  bool is_null() const { return node_->is_null(); }
  bool is_array() const { return node_->is_array(); }
  bool is_object() const { return node_->is_object(); }
  bool is_number() const { return node_->is_number(); }
  bool is_string() const { return node_->is_string(); }
  std::size_t size() const { return node_->size(); }
  bool empty() const { return node_->empty(); }
  std::string dump() const { return node_->dump(); }

  bool contains(const std::string& key) const;
  Json at(const std::string& key) const;
  Json at(std::size_t item) const;
  Json operator[](const char* key) const { return at(std::string(key)); }
  Json operator[](const std::string& key) const { return at(key); }
  template <std::integral I>
  Json operator[](I item) const {
    return at(static_cast<std::size_t>(item));
  }
  Json front() const { return at(std::size_t{0}); }
  Json back() const { return at(size() - 1); }

  /// Of an object, without reading what they stand for.
  std::vector<std::string> keys() const;
  /// Key and value of an object's members.
  std::vector<std::pair<std::string, Json>> items() const;

  template <json::Readable T>
  T get() const;
  template <json::Readable T>
  operator T() const {  // NOLINT(google-explicit-constructor)
    return get<T>();
  }
  template <json::Readable T>
  T value(const std::string& key, T otherwise) const {
    return contains(key) ? at(key).get<T>() : otherwise;
  }
  std::string value(const std::string& key, const char* otherwise) const {
    return value(key, std::string(otherwise));
  }

  class Iterator {
   public:
    Iterator(const Json* of, std::size_t item) : of_(of), item_(item) {}
    Json operator*() const { return of_->at(item_); }
    Iterator& operator++() { return ++item_, *this; }
    bool operator!=(const Iterator& other) const {
      return item_ != other.item_;
    }

   private:
    const Json* of_;
    std::size_t item_;
  };
  Iterator begin() const { return {this, 0}; }
  Iterator end() const { return {this, is_array() ? size() : 0}; }

  /// Keys below this value that were not read; words for the reader of the file
  /// (description, why, ...) do not count.
  std::vector<std::string> unread() const;
  /// The path of this value: expected.steps[2].loss
  std::string path() const;

  friend bool operator==(const Json& a, const Json& b) {
    return *a.node_ == *b.node_;
  }
  template <class T>
  friend bool operator==(const Json& a, const T& b) {
    return *a.node_ == b;
  }
  friend std::ostream& operator<<(std::ostream& out, const Json& value) {
    return out << value.dump();
  }

 private:
  struct Document;
  Json(std::shared_ptr<Document> document, const Raw* node)
      : document_(std::move(document)), node_(node) {}

  double as_number() const;
  std::int64_t as_integer() const;
  bool as_bool() const;
  std::string as_string() const;
  [[noreturn]] void refuse(const std::string& wanted) const;

  std::shared_ptr<Document> document_;
  const Raw* node_;
};

template <json::Readable T>
T Json::get() const {
  if constexpr (std::same_as<T, bool>) {
    return as_bool();
  } else if constexpr (std::integral<T>) {
    return static_cast<T>(as_integer());
  } else if constexpr (std::floating_point<T>) {
    return static_cast<T>(as_number());
  } else if constexpr (std::same_as<T, std::string>) {
    return as_string();
  } else {
    if (!is_array()) refuse("a list");
    T all{};
    if constexpr (requires { all.resize(0); }) all.resize(size());
    if (all.size() != size()) refuse("a list of " + std::to_string(all.size()));
    for (std::size_t i = 0; i < size(); ++i)
      all[i] = at(i).template get<typename T::value_type>();
    return all;
  }
}

}  // namespace physinv::test
