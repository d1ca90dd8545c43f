/// What the JPO paper shows of the wave packet and of no other experiment:
/// a signal (Fig. 3a), its loss and gradient over the centre (Fig. 3b).
#pragma once

#include <vector>

#include "suite/results/report_model.h"

namespace physinv::packet {

std::vector<Figure> figures();

}  // namespace physinv::packet
