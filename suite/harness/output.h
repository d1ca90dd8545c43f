/// What people read.
#pragma once

#include <cstdio>
#include <string>
#include <string_view>

namespace physinv {

/// Writes what the stream holds back, and the text. Waits for its reader;
/// after a signal to stop (suite/harness/stop_signal.h) not for long: the rest
/// is dropped then. An error stays in the stream.
void put(std::FILE* stream, std::string_view text);

/// One line of UTF-8 without control characters, a very long one without its
/// middle.
std::string one_line(std::string_view text);

}  // namespace physinv
