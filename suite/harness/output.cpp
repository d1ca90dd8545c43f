#include "suite/harness/output.h"

#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>

#include "suite/harness/stop_signal.h"

namespace physinv {
namespace {

constexpr int kPollMilliseconds = 50, kPollsAfterStop = 10;

/// What is left to write where the stream cannot be waited for, or fails.
void put_blindly(std::FILE* stream, std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stream);
  std::fflush(stream);
}

/// Can the descriptor take PIPE_BUF bytes? False if there was no reader for a
/// while since a signal to stop, and from then on at once.
bool wait_for_reader(int fd) {
  static int waits = 0;
  pollfd end{fd, POLLOUT, 0};
  while (poll(&end, 1, 0) <= 0) {
    if (stop_signals() == 0) {
      waits = 0;
    } else if (++waits > kPollsAfterStop) {
      return false;
    }
    poll(&end, 1, kPollMilliseconds);
  }
  return true;
}

/// Bytes of the UTF-8 character that `text` begins with; 0 if it is none.
std::size_t character(std::string_view text) {
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U;
  };
  const unsigned first = byte(0), second = byte(1);
  if (first < 0x80) return first < 0x20 || first == 0x7f ? 0 : 1;
  const std::size_t size = first >= 0xc2 && first < 0xe0   ? 2
                           : first >= 0xe0 && first < 0xf0 ? 3
                           : first >= 0xf0 && first < 0xf5 ? 4
                                                           : 0;
  for (std::size_t i = 1; i < size; ++i)
    if ((byte(i) & 0xc0U) != 0x80U) return 0;
  const bool control = first == 0xc2 && second < 0xa0;
  const bool overlong =
      (first == 0xe0 && second < 0xa0) || (first == 0xf0 && second < 0x90);
  const bool beyond =
      (first == 0xed && second > 0x9f) || (first == 0xf4 && second > 0x8f);
  return control || overlong || beyond ? 0 : size;
}

/// Up to `at`, or before the character that `at` is inside of.
std::size_t whole_characters(std::string_view text, std::size_t at) {
  while (at > 0 && (static_cast<unsigned char>(text[at]) & 0xc0U) == 0x80U)
    --at;
  return at;
}

}  // namespace

void put(std::FILE* stream, std::string_view text) {
  const int fd = fileno(stream);
  if (fd < 0) return put_blindly(stream, text);
  if (!wait_for_reader(fd)) return;
  std::fflush(stream);  // no more than a pipe can take
  while (!text.empty()) {
    if (!wait_for_reader(fd)) return;
    const ssize_t written =
        write(fd, text.data(), std::min<std::size_t>(text.size(), PIPE_BUF));
    if (written < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (written < 0) return put_blindly(stream, text);
    text.remove_prefix(static_cast<std::size_t>(written));
  }
}

std::string one_line(std::string_view text) {
  constexpr std::size_t kLongest = 2000, kEnd = 500;
  std::string line;
  while (!text.empty()) {
    const std::size_t size = character(text);
    if (size == 0) line += text[0] == '\n' || text[0] == '\t' ? ' ' : '?';
    line += text.substr(0, size);
    text.remove_prefix(std::max<std::size_t>(size, 1));
  }
  if (line.size() <= kLongest) return line;
  const std::size_t head = whole_characters(line, kLongest - kEnd);
  const std::size_t tail = whole_characters(line, line.size() - kEnd);
  return line.substr(0, head) + " ... " + line.substr(tail);
}

}  // namespace physinv
