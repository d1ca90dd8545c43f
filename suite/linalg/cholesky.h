/// A = L L^T of a symmetric positive definite matrix, by panels of columns
/// (Golub and Van Loan, Matrix Computations, 4.2.6): n^3 / 3 flops, most of
/// them in register tiles. The order of every sum depends on n alone.
#pragma once

#include "suite/linalg/symmetric_update.h"

namespace physinv::linalg {

/// Memory row r of A becomes column r of L. False, with A partly overwritten,
/// where a pivot is not positive (or NaN). What tiles reach in front of the
/// diagonal has to be numbers.
bool cholesky(Symmetric a);

/// x = A^{-1} b from the result of `cholesky`; b is overwritten.
void cholesky_solve(Symmetric factor, double* b, double* x);

}  // namespace physinv::linalg
