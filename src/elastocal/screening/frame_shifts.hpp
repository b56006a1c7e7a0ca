// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "elastocal/optim/normal_equations.hpp"
#include "elastocal/screening/recording_fault.hpp"

namespace elastocal {

/// Whether a displacement of the frame has no direction yet (MeasureShifts).
inline bool IsOfAnyDirection(const RecordingFault& fault) {
  return fault.kind == FaultKind::kFrameShift && fault.along.isZero(0.0);
}

/// Effects of displacements of the markers' frame in any direction, tried one by one
/// (NormalEquations::Add). `by_axis` has the derivatives of the residuals by displacements along x,
/// y and z, `variance` the factor by which residuals vary more than they should. Each displacement
/// gets its direction, its size in m and, as its share, the decrease of the sum of squares; zeros
/// where the other unknowns reproduce a direction. A direction has two numbers more than an offset,
/// which chance fills: they are subtracted from the decrease and from the certainty (`sd`).
void MeasureShifts(const NormalEquations& equations,
                   const std::vector<std::vector<Eigen::VectorXd>>& by_axis,
                   const std::vector<int>& cluster, const Eigen::MatrixXd& factors,
                   const Eigen::MatrixXd& covariance, double variance,
                   std::vector<RecordingFault>& shifts);

/// Leaves out displacements of the markers' frame of which offsets of sliding joints in the same
/// postures explain at least 95 %. Along the joint they are the same, and the joint's can be
/// corrected. Where a displacement explains as much as an offset, the offset gets its direction.
void PreferSlides(const RobotTree& tree, std::vector<RecordingFault>& faults);

/// Whether an offset of a joint may be a displacement of the frame (PreferSlides).
inline bool MayBeShift(const RecordingFault& fault) {
  return fault.kind == FaultKind::kJointOffset && !fault.along.isZero(0.0);
}

/// Adds `more` to a displacement of the frame in the same postures.
void AddShift(const RecordingFault& more, RecordingFault& shift);

/// Text such as "the frame of the markers lies 11.2 +- 0.8 mm elsewhere ([10.1, 5.0, -0.2] mm) from
/// posture 19 on (the tracker or the base was pushed?)".
std::string DescribeShift(const RecordingFault& shift, const Recording& recording);

}  // namespace elastocal
