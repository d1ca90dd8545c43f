/// The state of a running method as bytes, and back. Each part says once
/// what it keeps, for both ways:
///
///   void serialize(Archive& archive) { archive(m_, v_, steps_); }
///
/// Numbers are stored as in memory: for the build that wrote them. What is
/// given back may be anything: matrices that have rows, or numbers, keep their
/// shape; whatever else must fit, its part checks.
#pragma once

#include <cstring>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "suite/core/batch.h"
#include "suite/core/check.h"

namespace physinv {

class Archive {
 public:
  /// Collects.
  Archive() = default;
  /// Gives back what another collected.
  explicit Archive(std::string bytes)
      : bytes_(std::move(bytes)), reading_(true) {}

  template <class... Parts>
  void operator()(Parts&... parts) {
    (one(parts), ...);
  }

  bool reading() const { return reading_; }
  const std::string& bytes() const { return bytes_; }
  /// Everything was given back.
  bool at_end() const { return at_ == bytes_.size(); }

 private:
  template <class Part>
  void one(Part& part) {
    if constexpr (requires { part.serialize(*this); }) {
      part.serialize(*this);
    } else {
      static_assert(std::is_trivially_copyable_v<Part>);
      raw(&part, sizeof(Part));
    }
  }

  void one(bool& part) {
    auto byte = static_cast<unsigned char>(part);
    one(byte);
    SUITE_CHECK(byte <= 1, "a boolean in the checkpoint is invalid");
    part = byte == 1;
  }

  template <class T, int rows, int cols, int options>
  void one(Eigen::Matrix<T, rows, cols, options>& matrix) {
    Index r = matrix.rows(), c = matrix.cols();
    (*this)(r, c);
    constexpr Index kLargest = Index{1} << 40;
    SUITE_CHECK(r >= 0 && c >= 0 && r <= kLargest && c <= kLargest &&
                    (rows == Eigen::Dynamic || r == rows) &&
                    (cols == Eigen::Dynamic || c == cols),
                "an array in the checkpoint has an invalid shape");
    SUITE_CHECK((matrix.rows() == 0 || r == matrix.rows()) &&
                    (matrix.size() == 0 || c == matrix.cols()),
                "an array in the checkpoint has another shape");
    require(r, require(c, sizeof(T)));
    matrix.resize(r, c);
    raw(matrix.data(), sizeof(T) * static_cast<std::size_t>(matrix.size()));
  }

  template <class T>
  void one(std::vector<T>& list) {
    std::size_t size = list.size();
    one(size);
    require(static_cast<Index>(size), 1);
    list.resize(size);
    if constexpr (std::is_arithmetic_v<T>) {
      raw(list.data(), sizeof(T) * size);
    } else {
      for (T& entry : list) one(entry);
    }
  }

  /// Bytes of so many parts, which are there: a size is only a claim.
  std::size_t require(Index count, std::size_t each) const {
    std::size_t size = 0;
    SUITE_CHECK(!__builtin_mul_overflow(count, each, &size) &&
                    (!reading_ || size <= bytes_.size() - at_),
                "the checkpoint is too short");
    return size;
  }

  void raw(void* data, std::size_t size) {
    if (size == 0) return;
    if (!reading_) {
      bytes_.append(static_cast<const char*>(data), size);
      return;
    }
    SUITE_CHECK(size <= bytes_.size() - at_, "the checkpoint is too short");
    std::memcpy(data, bytes_.data() + at_, size);
    at_ += size;
  }

  std::string bytes_;
  std::size_t at_ = 0;
  bool reading_ = false;
};

}  // namespace physinv
