// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <Eigen/Core>

namespace elastocal {

/// One section of a digital filter, b(z) / a(z) with two poles and two zeros, a0 = 1.
struct SecondOrderSection {
  double b0 = 1.0;
  double b1 = 0.0;
  double b2 = 0.0;
  double a1 = 0.0;
  double a2 = 0.0;
};

/// A filter as a chain of sections. Unlike one quotient of high-order polynomials, it stays exact
/// at any order and at cutoffs far below the rate.
using SecondOrderSections = std::vector<SecondOrderSection>;

/// Butterworth low-pass of the given order (1 to 10) by the bilinear transform, prewarped so that
/// the gain is sqrt(1/2) at `cutoff_hz` exactly (0 < cutoff < rate / 2) and 1 at rest. An odd order
/// has its one-pole section first. The paper (section 5.1) uses order 5 at 5 Hz.
///
/// Throws std::invalid_argument for any other order or cutoff.
SecondOrderSections ButterworthLowPass(int order, double cutoff_hz, double rate_hz);

/// Number of samples by which FiltFilt prolongs a signal at either end: three times the filter's
/// length, as in SciPy's sosfiltfilt; 3 (N + 1) for a Butterworth low-pass of order N.
int FiltFiltPadding(const SecondOrderSections& sections);

/// Filters every column of `signals` (samples x signals, any unit) in place, forwards and then
/// backwards, which gives zero phase and the square of the filter's gain. The result equals that of
/// SciPy's sosfiltfilt with its defaults: the signal is prolonged by odd reflection at both ends,
/// and each pass starts in the steady state of its first sample. Time is linear in the number of
/// samples.
///
/// Throws std::invalid_argument unless there are more samples than FiltFiltPadding(sections). All
/// samples must be finite: a NaN spoils its whole column.
void FiltFilt(const SecondOrderSections& sections, Eigen::Ref<Eigen::MatrixXd> signals);

}  // namespace elastocal
