// libFuzzer's entry into the reader PHYSINV_READER.
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/readers.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data,
                                      std::size_t size) {
  physinv::fuzz::PHYSINV_READER({reinterpret_cast<const char*>(data), size});
  return 0;
}
