#include "suite/harness/screen.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include "suite/harness/context.h"

namespace physinv {
namespace {

constexpr int kMostColumns = 10'000;

}  // namespace

Screen Screen::of(std::FILE* stream) {
  Screen s{.stream = stream};
  const bool terminal = isatty(fileno(stream)) == 1;
  const auto ci = variable("CI");
  s.terminal = terminal;
  s.live = terminal && variable("TERM") != "dumb" &&
           (ci.empty() || ci == "false" || ci == "0");
  s.color = s.live && variable("NO_COLOR").empty();
  winsize size{};
  if (terminal && ioctl(fileno(stream), TIOCGWINSZ, &size) == 0 &&
      size.ws_col > 0)
    s.columns = size.ws_col;
  const long wanted = std::strtol(variable("COLUMNS").c_str(), nullptr, 10);
  if (wanted > 0)
    s.columns = static_cast<int>(std::min<long>(wanted, kMostColumns));
  s.columns = std::max(s.columns, 40);
  return s;
}

}  // namespace physinv
