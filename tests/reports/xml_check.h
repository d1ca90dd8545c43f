// Well-formedness of the XML we write: tags nest, attributes are quoted and
// not repeated, no stray markup characters.
#pragma once

#include <set>
#include <string>
#include <vector>

namespace physinv {

/// Empty if well-formed, else what is wrong.
inline std::string xml_error(const std::string& xml) {
  std::vector<std::string> open;
  std::size_t roots = 0;
  for (std::size_t i = 0; i < xml.size(); ++i) {
    if (xml[i] == '&') {
      const std::string rest = xml.substr(i, 6);
      bool known = false;
      for (const char* e : {"&amp;", "&lt;", "&gt;", "&quot;"}) {
        known = known || rest.starts_with(e);
      }
      if (!known) return "stray & at " + std::to_string(i);
    }
    if (xml[i] == '>') return "stray > at " + std::to_string(i);
    if (xml[i] != '<') continue;
    const std::size_t end = xml.find('>', i);
    if (end == xml.npos) return "unclosed tag";
    std::string tag = xml.substr(i + 1, end - i - 1);
    i = end;
    if (tag.starts_with('/')) {
      if (open.empty() || open.back() != tag.substr(1)) return "bad </" + tag;
      open.pop_back();
      continue;
    }
    const bool leaf = tag.ends_with('/');
    if (leaf) tag.pop_back();
    std::size_t at = tag.find(' ');
    const std::string name = tag.substr(0, at);
    std::set<std::string> keys;
    while (at != tag.npos && at + 1 < tag.size()) {
      const std::size_t equal = tag.find("=\"", at);
      if (equal == tag.npos) return "attribute without value in " + tag;
      const std::size_t quote = tag.find('"', equal + 2);
      if (quote == tag.npos) return "unclosed quote in " + tag;
      if (!keys.insert(tag.substr(at + 1, equal - at - 1)).second) {
        return "attribute twice in " + tag;
      }
      at = quote + 1;
    }
    if (open.empty()) ++roots;
    if (!leaf) open.push_back(name);
  }
  if (!open.empty()) return "unclosed " + open.back();
  return roots == 1 ? "" : "not one root";
}

}  // namespace physinv
