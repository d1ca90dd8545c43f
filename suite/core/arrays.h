/// Arrays by name, what a stage leaves in addition to estimates and losses.
///
///   out.arrays["mean_loss"] = loss;                    // array_table.h has it
///   out.arrays[ArrayKey::own("my_angles")] = angles;  // a stage of yours
///
/// A name in quotes that the table lacks does not compile.
#pragma once

#include <cstddef>
#include <functional>
#include <initializer_list>
#include <map>
#include <string>
#include <string_view>
#include <utility>

#include "suite/core/array_table.h"
#include "suite/core/batch.h"

namespace physinv {

/// The name of an array. It refers to its characters and owns none.
class ArrayKey {
 public:
  /// Of the table, in quotes.
  consteval ArrayKey(const char* name) : name_(name) {
    if (find_array(name_) == nullptr) unknown_see_array_table();
  }
  /// A name that the table need not have: of others' stages and of files.
  static constexpr ArrayKey own(std::string_view name) {
    return ArrayKey(name, nullptr);
  }

  constexpr std::string_view name() const { return name_; }
  std::string text() const { return std::string(name_); }

 private:
  constexpr ArrayKey(std::string_view name, std::nullptr_t) : name_(name) {}
  static void unknown_see_array_table() {}  // no constant: ends a compilation

  std::string_view name_;
};

/// A map of arrays by their keys; in the order of their names.
class Arrays {
 public:
  using Map = std::map<std::string, Batch<double>, std::less<>>;
  struct Entry {
    ArrayKey key;
    Batch<double> value;
  };

  Arrays() = default;
  Arrays(std::initializer_list<Entry> entries) {
    for (const Entry& e : entries) (*this)[e.key] = e.value;
  }

  Batch<double>& operator[](ArrayKey key) { return map_[key.text()]; }
  /// Throws std::out_of_range where there is none.
  Batch<double>& at(ArrayKey key) { return map_.at(key.text()); }
  const Batch<double>& at(ArrayKey key) const { return map_.at(key.text()); }
  bool contains(ArrayKey key) const { return map_.contains(key.name()); }
  Map::const_iterator find(ArrayKey key) const { return map_.find(key.name()); }
  Map::node_type extract(ArrayKey key) { return map_.extract(key.text()); }
  void clear() { map_.clear(); }

  Map::iterator begin() { return map_.begin(); }
  Map::iterator end() { return map_.end(); }
  Map::const_iterator begin() const { return map_.begin(); }
  Map::const_iterator end() const { return map_.end(); }
  std::size_t size() const { return map_.size(); }
  bool empty() const { return map_.empty(); }
  bool operator==(const Arrays&) const = default;

 private:
  Map map_;
};

}  // namespace physinv
