#include "python/module/words.h"

#include <fmt/format.h>

namespace physinv::python {
namespace {

namespace py = pybind11;

/// UTF-8 without a NUL: what is neither becomes the escape that Python has for
/// it.
std::string plain_text(const py::object& text) {
  const auto bytes = text.attr("encode")("utf-8", "backslashreplace");
  std::string plain;
  for (const char c : bytes.cast<std::string>())
    plain += c == '\0' ? "\\x00" : std::string(1, c);
  return plain;
}

}  // namespace

std::string words_of(const py::error_already_set& error) {
  const std::string type = plain_text(error.type().attr("__name__"));
  try {
    return fmt::format("{}: {}", type, plain_text(py::str(error.value())));
  } catch (const py::error_already_set&) {
    return type + " without a readable message";
  }
}

}  // namespace physinv::python
