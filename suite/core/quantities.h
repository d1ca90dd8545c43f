/// What the columns of a problem's arrays are, for the files of its cases.
#pragma once

#include <string>

namespace physinv {

/// Columns of a problem that says nothing have no names.
struct Quantities {
  struct Array {
    std::string names;       ///< "v_x, v_y", or of a field "temperature (y, x)"
    std::string unit = "1";  ///< of all of them
  };
  Array unknowns, observations, given;
};

}  // namespace physinv
