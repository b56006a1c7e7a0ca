// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/observed_conventions.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include <Eigen/Geometry>

namespace elastocal {
namespace {

/// Quaternions are x, y, z, w.
Eigen::Quaterniond AttitudeIn(const Eigen::VectorXd& pose) {
  return Eigen::Quaterniond(Eigen::Vector4d(pose.tail<4>()));
}

Eigen::VectorXd PoseOf(const Eigen::Vector3d& position, const Eigen::Quaterniond& attitude) {
  Eigen::VectorXd pose(7);
  pose << position, attitude.coeffs();
  return pose;
}

Eigen::VectorXd WithWLast(const Eigen::VectorXd& pose) {
  return PoseOf(pose.head<3>(), Eigen::Quaterniond(pose[3], pose[4], pose[5], pose[6]));
}

Eigen::VectorXd WithAttitudeReversed(const Eigen::VectorXd& pose) {
  return PoseOf(pose.head<3>(), AttitudeIn(pose).conjugate());
}

Eigen::VectorXd Inverse(const Eigen::VectorXd& pose) {
  const Eigen::Quaterniond back = AttitudeIn(pose).conjugate();
  return PoseOf(back * Eigen::Vector3d(-pose.head<3>()), back);
}

/// Reverses y of a position, and of a pose.
Eigen::VectorXd Mirrored(const Eigen::VectorXd& measured) {
  Eigen::VectorXd mirrored = measured;
  mirrored[1] *= -1.0;
  if (measured.size() == 7) {
    mirrored[3] *= -1.0;
    mirrored[5] *= -1.0;
  }
  return mirrored;
}

class Conventions {
 public:
  Conventions(const ObservedRobot& model, const Observations& observations)
      : model_(model), observations_(observations) {}

  /// Rewrites what instruments of these kinds measured, if there are any.
  void Add(const std::vector<std::string_view>& kinds, const auto& rewrite, const std::string& what,
           const std::string& right) {
    WrittenConvention convention{what, right, observations_};
    bool any = false;
    for (Observation& observation : convention.undone.all) {
      const std::string_view kind = model_.instrument(observation.instrument).kind();
      if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) continue;
      observation.measured = rewrite(observation.measured);
      any = true;
    }
    if (any) found.push_back(std::move(convention));
  }

  std::vector<WrittenConvention> found;

 private:
  const ObservedRobot& model_;
  const Observations& observations_;
};

}  // namespace

std::vector<WrittenConvention> WrittenConventions(const ObservedRobot& model,
                                                  const Observations& observations) {
  Conventions conventions(model, observations);
  conventions.Add({"pose"}, WithWLast, "w comes first in the quaternions of bodies", "x, y, z, w");
  conventions.Add({"pose"}, WithAttitudeReversed,
                  "the attitudes of bodies are those of the tracker in the body",
                  "that of the body in the tracker");
  conventions.Add({"pose"}, Inverse, "the poses of bodies are those of the tracker in the body",
                  "that of the body in the tracker");
  conventions.Add({"pose", "position"}, Mirrored, "one axis of the tracker is reversed",
                  "a right-handed frame");
  for (int axis = 0; axis < 3; ++axis) {
    const auto reversed = [axis](Eigen::VectorXd pose) {
      pose[axis] *= -1.0;
      return pose;
    };
    conventions.Add({"pose"}, reversed,
                    std::string(1, "xyz"[axis]) +
                        " of the positions of bodies is reversed, but not "
                        "in their attitudes",
                    "one right-handed frame of both");
  }
  return std::move(conventions.found);
}

}  // namespace elastocal
