/// What tables and figures call the methods of the literature.
#pragma once

#include <string>

namespace physinv {

/// "hig" -> "HIG"; of any other method its id.
std::string method_title(const std::string& id);

}  // namespace physinv
