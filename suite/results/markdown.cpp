#include "suite/results/markdown.h"

#include <algorithm>

namespace physinv {
namespace {

bool is_word(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') ||
         (c >= '0' && c <= '9');
}

/// Could a tag or an entity begin there? "< 1" is none.
bool is_html(std::string_view text, std::size_t at) {
  const char c = text[at];
  const char next = at + 1 < text.size() ? text[at + 1] : ' ';
  const bool letter = is_word(next) && (next < '0' || next > '9');
  return (c == '<' && (letter || next == '/' || next == '!' || next == '?')) ||
         (c == '&' && (letter || next == '#'));
}

/// Does it mark anything there? An underscore inside of a word does not, nor
/// does a quote or a heading that begins no line.
bool is_mark(std::string_view text, std::size_t at) {
  const char c = text[at];
  if (c == '>' || c == '#') return at == 0;
  if (c == '_')
    return at == 0 || at + 1 == text.size() || !is_word(text[at - 1]) ||
           !is_word(text[at + 1]);
  return std::string_view("\\`*[]|~").find(c) != std::string_view::npos;
}

char without_control(char c) {
  return static_cast<unsigned char>(c) < 0x20 || c == 0x7f ? ' ' : c;
}

}  // namespace

std::string markdown(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (is_html(text, i)) {
      out += c == '<' ? "&lt;" : "&amp;";
      continue;
    }
    if (is_mark(text, i)) out += '\\';
    out += without_control(c);
  }
  return out;
}

std::string markdown_code(std::string_view text) {
  std::string inside;
  std::size_t run = 0, longest = 0;
  for (const char c : text) {
    inside += without_control(c);
    run = c == '`' ? run + 1 : 0;
    longest = std::max(longest, run);
  }
  const std::string fence(longest + 1, '`');
  const bool pad = longest > 0 || inside.empty();
  return fence + (pad ? " " : "") + inside + (pad ? " " : "") + fence;
}

}  // namespace physinv
