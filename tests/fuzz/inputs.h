/// What the readers under test share: files for them, checksums, and the errors
/// that they may end in.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <string_view>

#include "suite/harness/errors.h"
#include "suite/store/errors.h"

namespace physinv::fuzz {

/// A folder of this process, in memory where the system has a place for that.
/// It goes when the process ends.
const std::filesystem::path& folder();

/// A file of these bytes in the folder; parts of its path are made.
std::filesystem::path put(const std::string& name, std::string_view bytes);

/// CRC-32C as every file of the suite writes it.
std::string checksum(std::string_view bytes);
inline constexpr std::string_view kNoChecksum = "00000000";

/// Text before and after the first `mark`; all of it before, if there is none.
struct Halves {
  std::string_view first, second;
};
Halves halves(std::string_view text, std::string_view mark);

/// Damaged input ends in one of the errors that `main` has a line and a code
/// for. Others pass.
template <class F>
void documented(F&& body) {
  const auto check = [](const std::exception& error) {
    if (*error.what() == '\0') throw std::logic_error("an error says nothing");
  };
  try {
    body();
  } catch (const StoreError& error) {
    check(error);
  } catch (const UnreadableInput& error) {
    check(error);
  } catch (const ExitError& error) {
    check(error);
  }
}

}  // namespace physinv::fuzz
