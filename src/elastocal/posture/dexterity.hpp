// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "elastocal/posture/constraint.hpp"

namespace elastocal {

/// The least singular value of the Jacobian of a link: its displacement by 0.3 m and its rotation
/// (rad), by the coordinates of `chain` in the present posture. Where it is small, an error of the
/// link in the direction in which the chain can hardly move it asks the joints for that error over
/// this value: the limb is stretched, or two of its axes are in line. 0 with fewer than six
/// coordinates.
double LeastSingularValue(const MovingChain& chain, int link);

/// The end of a limb can be moved in all directions: the least singular value of its Jacobian stays
/// above a share of what it is in the present posture of `chain`. For chains of six or more
/// coordinates. Where two singular values are the least, the derivative is that of one of them.
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
