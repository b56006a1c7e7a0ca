// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "elastocal/math/transform.hpp"
#include "elastocal/observation/quantity.hpp"
#include "elastocal/observation/sources.hpp"

namespace elastocal {

/// Derivatives by a screw [a; m] of a link, which moves point p of the link by a x p + m.
using ByScrew = Eigen::Matrix<double, Eigen::Dynamic, 6>;

/// Inputs of an instrument in one posture.
struct Sight {
  std::vector<Transform> T_floor_link;  ///< by link of the instrument
  /// By quantity of the instrument, effects of sessions included.
  std::vector<QuantityValue> values;
};

/// Residual of an observation, with its derivatives by all inputs.
struct ObservationResidual {
  Eigen::VectorXd left;                      ///< predicted minus measured, one a row
  std::vector<ByScrew> by_link;              ///< by the screw of each link, in the floor's frame
  std::vector<Eigen::MatrixXd> by_quantity;  ///< by the numbers of each quantity
};

/// Meaning of one row of an instrument's residual.
struct RowMeaning {
  const char* name;  ///< rows with the same name are judged together: position, rotation
  SourceUnit unit;
};

/// A device that measures the robot: the geometry of one kind of observation. It sees links of the
/// robot by their poses on the floor, and does not depend on how these follow from the parameters.
class Instrument {
 public:
  virtual ~Instrument() = default;

  std::string name;
  std::vector<int> links;       ///< links of the robot's tree that it sees
  std::vector<int> quantities;  ///< indices of the setup's quantities on which it depends
  std::vector<int> noise;       ///< by row: index of the source of its noise
  int varying = -1;  ///< place in `quantities` of the one that differs between sessions; -1: none
  /// Matrix by which rows are multiplied before they are divided by the standard deviations of
  /// their sources: the inverse of a factor of a covariance that is known up to scale. Empty:
  /// identity.
  Eigen::MatrixXd whitening = {};

  virtual const char* kind() const = 0;  ///< name of the kind: "pose"
  virtual std::vector<RowMeaning> rows() const = 0;
  virtual int measured_size() const = 0;  ///< count of numbers in one measurement

  /// The residual with exact derivatives.
  virtual ObservationResidual Evaluate(const Sight& sight,
                                       const Eigen::VectorXd& measured) const = 0;

  /// The measurement without noise, for which the residual is zero. (For a contact, which shows
  /// nothing, an empty vector.)
  virtual Eigen::VectorXd Predict(const Sight& sight) const = 0;

  /// Whether it can measure in this situation: a camera does not see what is behind it.
  virtual bool Sees(const Sight&) const { return true; }

  /// Moves the origins of its own quantities to the values that its observations and the nominal
  /// robot suggest. By default they stay.
  virtual void Begin(const std::vector<Sight>& sights, const std::vector<Eigen::VectorXd>& measured,
                     std::vector<QuantityValue*>& values) const;

  /// Points in the parent frame of the first quantity (a tracker's pose), each with its position in
  /// the tracker's frame. By default none.
  using Landmarks = std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>>;
  virtual void AddLandmarks(const Sight& sight, const Eigen::VectorXd& measured,
                            Landmarks& landmarks) const;

  int size() const { return static_cast<int>(noise.size()); }
  /// Matrix that brings the residual's rows into units of their standard deviations, by
  /// multiplication from the left.
  Eigen::MatrixXd Weights(const Spread& spread) const;
};

/// Derivative of a point p by the screw of its link: 3 x 6.
Eigen::Matrix<double, 3, 6> PointByScrew(const Eigen::Vector3d& p);

/// Derivative of a rotation by the screw, which is the rotation vector a itself: 3 x 6.
Eigen::Matrix<double, 3, 6> TurnByScrew();

}  // namespace elastocal
