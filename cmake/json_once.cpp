#include "cmake/json_once.h"

#define NOTHING
PHYSINV_JSON_ONCE(NOTHING);
