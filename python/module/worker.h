/// What this process is to a campaign that Python started.
#pragma once

namespace physinv::python {

/// A fork that runs cases.
bool in_worker();

}  // namespace physinv::python
