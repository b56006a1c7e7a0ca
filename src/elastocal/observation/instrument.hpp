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

/// Derivatives by a screw [a; m] of a link: point p of the link moves by a x p + m.
using ByScrew = Eigen::Matrix<double, Eigen::Dynamic, 6>;

/// What an instrument depends on in one posture.
struct Sight {
  std::vector<Transform> T_floor_link;  ///< by link of the instrument
  std::vector<QuantityValue> values;    ///< by quantity of the instrument, with session effects
};

/// What is left of an observation, and how it changes with all that it depends on.
struct ObservationResidual {
  Eigen::VectorXd left;                      ///< predicted minus measured, a row each
  std::vector<ByScrew> by_link;              ///< by screw of each link in the floor's frame
  std::vector<Eigen::MatrixXd> by_quantity;  ///< by the numbers of each quantity
};

/// One row of what an instrument shows.
struct RowMeaning {
  const char* name;  ///< rows of one name are judged together: position, rotation
  SourceUnit unit;
};

/// Something that measures the robot: the geometry of one kind of observation. It sees links of the
/// robot by their poses on the floor; how these follow from the parameters is not its business.
class Instrument {
 public:
  virtual ~Instrument() = default;

  std::string name;
  std::vector<int> links;       ///< of the robot's tree that it sees
  std::vector<int> quantities;  ///< on which it depends, of the setup
  std::vector<int> noise;       ///< by row: its source
  int varying = -1;  ///< of `quantities`, the one that differs between sessions; -1: none
  /// Rows are multiplied by this before they are divided by the standard deviations of their
  /// sources: inverse of a factor of a covariance that is known up to scale. Empty: identity.
  Eigen::MatrixXd whitening = {};

  virtual const char* kind() const = 0;  ///< in words: "pose"
  virtual std::vector<RowMeaning> rows() const = 0;
  virtual int measured_size() const = 0;  ///< numbers of one measurement

  /// The residual with its derivatives, exact.
  virtual ObservationResidual Evaluate(const Sight& sight,
                                       const Eigen::VectorXd& measured) const = 0;

  /// What it would show without noise: the measurement that leaves nothing. (Of a contact, which
  /// shows nothing, an empty vector.)
  virtual Eigen::VectorXd Predict(const Sight& sight) const = 0;

  /// Whether it can measure at all: a camera does not see what is behind it.
  virtual bool Sees(const Sight&) const { return true; }

  /// Moves the origins of its own quantities to where the nominal robot suggests them, from all of
  /// its observations. By default they stay.
  virtual void Begin(const std::vector<Sight>& sights, const std::vector<Eigen::VectorXd>& measured,
                     std::vector<QuantityValue*>& values) const;

  /// Points in the parent frame of the first quantity, a tracker's pose, and where the tracker has
  /// them. By default none.
  using Landmarks = std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>>;
  virtual void AddLandmarks(const Sight& sight, const Eigen::VectorXd& measured,
                            Landmarks& landmarks) const;

  int size() const { return static_cast<int>(noise.size()); }
  /// The residual's rows in units of their standard deviations, to be multiplied from the left.
  Eigen::MatrixXd Weights(const Spread& spread) const;
};

/// Derivatives of a point p by the screw of the link that carries it: 3 x 6.
Eigen::Matrix<double, 3, 6> PointByScrew(const Eigen::Vector3d& p);

/// Of a rotation: the rotation vector a itself. 3 x 6.
Eigen::Matrix<double, 3, 6> TurnByScrew();

}  // namespace elastocal
