// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/posture/constraint.hpp"

namespace elastocal {

/// The least singular value of the Jacobian of a link by the coordinates of `chain` in the present
/// posture: rows are the displacement of the link's origin over 0.3 m, and its rotation in rad. It
/// is small if the limb is stretched or two of its axes are in line. To correct an error of the
/// link in the worst direction, the joints must move by that error over this value. 0 with fewer
/// than six coordinates.
double LeastSingularValue(const MovingChain& chain, int link);

/// Keeps the end of a limb away from singular postures: LeastSingularValue stays above `share` of
/// its value in the posture that `chain` has when the constraint is made. For chains of six or more
/// coordinates. If the two least singular values are equal, the derivative is that of one of them.
class Dexterity : public PostureConstraint {
 public:
  Dexterity(const MovingChain& chain, int link, double share);
  std::string Name(int row) const override;
  void Evaluate(const MovingChain& chain, Eigen::Ref<Eigen::VectorXd> value,
                Eigen::Ref<Eigen::MatrixXd> jacobian) const override;

 private:
  int link_;
};

}  // namespace elastocal
