#include "suite/core/dataset.h"

#include "suite/core/hash.h"

namespace physinv {
namespace {

std::uint64_t add(std::uint64_t h, const Batch<double>& b) {
  const Index shape[] = {b.rows(), b.cols()};
  h = hash_bytes(shape, sizeof(shape), h);
  return hash_bytes(
      b.data(), static_cast<std::size_t>(b.size()) * sizeof(double), h);
}

}  // namespace

std::uint64_t content_hash(const Samples<double>& s) {
  return add(add(add(hash_text("samples"), s.x), s.y), s.given);
}

}  // namespace physinv
