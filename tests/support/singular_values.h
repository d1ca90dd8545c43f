/// What tests hold decompositions against, by another algorithm than theirs.
#pragma once

#include "suite/linalg/decompositions.h"

namespace physinv::test {

/// Thin U and V of any matrix, by Eigen's two-sided Jacobi rotations.
linalg::SingularValues jacobi_singular_values(const Batch<double>& a);

}  // namespace physinv::test
