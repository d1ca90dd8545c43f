/// The members of nlohmann's JSON types are compiled once, in json_once.cpp,
/// instead of in every source that reads a value. One of the precompiled
/// headers: without it all is the same and takes longer to compile.
#pragma once

#include <nlohmann/json.hpp>

// NOLINTBEGIN(bugprone-macro-parentheses)
#define PHYSINV_JSON_ONCE(KEYWORD)                                         \
  KEYWORD template class nlohmann::basic_json<>;                           \
  KEYWORD template class nlohmann::basic_json<nlohmann::ordered_map>;      \
  KEYWORD template class nlohmann::detail::serializer<nlohmann::json>;     \
  KEYWORD template class nlohmann::detail::serializer<                     \
      nlohmann::ordered_json>;                                             \
  KEYWORD template class nlohmann::detail::json_sax_dom_parser<            \
      nlohmann::json>;                                                     \
  KEYWORD template class nlohmann::detail::json_sax_dom_callback_parser<   \
      nlohmann::json>;                                                     \
  KEYWORD template class nlohmann::detail::lexer<                          \
      nlohmann::json,                                                      \
      nlohmann::detail::iterator_input_adapter<                            \
          std::string::const_iterator>>;                                   \
  KEYWORD template class nlohmann::detail::parser<                         \
      nlohmann::json,                                                      \
      nlohmann::detail::iterator_input_adapter<std::string::const_iterator>>
// NOLINTEND(bugprone-macro-parentheses)

PHYSINV_JSON_ONCE(extern);
