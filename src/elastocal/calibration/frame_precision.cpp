// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/frame_precision.hpp"

#include <algorithm>
#include <cmath>

#include "elastocal/calibration/frames_from_link.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {
namespace {

constexpr int kPosturesAssessed = 20;  // number of postures; the result changes little with more

/// Poses of `links` in the frame of the link `from`.
std::vector<Transform> PosesFrom(int from, const ErrorModel& model, const Geometry& geometry,
                                 const Eigen::VectorXd& q, const std::vector<int>& links) {
  const std::vector<Transform> all = CalibratedLinkTransforms(model, geometry, q);
  const Transform T_from_reference = all[static_cast<std::size_t>(from)].inverse();
  std::vector<Transform> poses;
  for (int link : links) poses.push_back(T_from_reference * all[static_cast<std::size_t>(link)]);
  return poses;
}

std::vector<int> SomePostures(const Recording& recording) {
  const int count = recording.posture_count();
  const int step = std::max(1, count / kPosturesAssessed);
  std::vector<int> postures;
  for (int i = 0; i < count; i += step) postures.push_back(i);
  return postures;
}

/// Removes the links that are moved by a joint whose errors are not in the model.
std::vector<int> MovedByKnownJoints(const ErrorModel& model, std::vector<int> links) {
  std::erase_if(links, [&](int link) {
    const std::vector<int> joints =
        JointsToBody(model.tree, model.tree.links[static_cast<std::size_t>(link)].body);
    return !std::ranges::all_of(joints, [&](int joint) {
      return std::ranges::find(model.active_joints, joint) != model.active_joints.end();
    });
  });
  return links;
}

bool PlacesLinks(const Parameter& parameter) {
  return !IsExternal(parameter.kind) && !IsCompliance(parameter.kind);
}

/// Derivatives of the poses of `links`, seen from `from`, by the parameters: six rows
/// (displacement, rotation) for each posture and link.
Eigen::MatrixXd SlopesOfFrames(int from, const KnownGeometry& known,
                               const Eigen::MatrixXd& postures, const std::vector<int>& links) {
  const ErrorModel& model = known.model;
  const auto poses_with = [&](const Eigen::VectorXd& delta) {
    const Geometry geometry = ApplyErrors(model, delta);
    std::vector<Transform> poses;
    for (Eigen::Index p = 0; p < postures.rows(); ++p) {
      for (const Transform& pose :
           PosesFrom(from, model, geometry, postures.row(p).transpose(), links)) {
        poses.push_back(pose);
      }
    }
    return poses;
  };
  const std::vector<Transform> at = poses_with(known.delta);
  Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(
      6 * static_cast<Eigen::Index>(at.size()), static_cast<Eigen::Index>(known.parameters.size()));
  for (std::size_t k = 0; k < known.parameters.size(); ++k) {
    const int index = known.parameters[k];
    const Parameter& parameter = model.parameters[static_cast<std::size_t>(index)];
    if (!PlacesLinks(parameter)) continue;
    const double step = 1e-3 * ParameterScale(parameter);
    Eigen::VectorXd beside = known.delta;
    beside[index] += step;
    const std::vector<Transform> moved = poses_with(beside);
    for (std::size_t i = 0; i < at.size(); ++i) {
      const Eigen::AngleAxisd turn(at[i].linear().transpose() * moved[i].linear());
      auto slope =
          slopes.block<6, 1>(6 * static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k));
      slope << moved[i].translation() - at[i].translation(), turn.angle() * turn.axis();
      slope /= step;
    }
  }
  return slopes;
}

}  // namespace

std::vector<FramePrecision> AssessFramesFrom(int from, const KnownGeometry& known,
                                             const Eigen::MatrixXd& postures,
                                             const std::vector<int>& ends) {
  if (MovedByKnownJoints(known.model, {from}).empty() || postures.rows() == 0) return {};
  const std::vector<int> links = MovedByKnownJoints(known.model, ends);
  const Eigen::MatrixXd slopes = SlopesOfFrames(from, known, postures, links);
  const Eigen::VectorXd variances =
      (slopes * known.covariance).cwiseProduct(slopes).rowwise().sum();
  std::vector<FramePrecision> frames;
  for (std::size_t j = 0; j < links.size(); ++j) {
    double position = 0.0, attitude = 0.0;
    for (std::size_t p = 0; p < static_cast<std::size_t>(postures.rows()); ++p) {
      const auto row = static_cast<Eigen::Index>(6 * (p * links.size() + j));
      position += variances.segment<3>(row).sum();
      attitude += variances.segment<3>(row + 3).sum();
    }
    const auto count = static_cast<double>(postures.rows());
    frames.push_back({links[j], std::sqrt(position / count), std::sqrt(attitude / count)});
  }
  return frames;
}

std::vector<FramePrecision> AssessFrames(const CalibrationResult& result,
                                         const Recording& recording, const std::vector<int>& ends) {
  return AssessFramesFrom(
      0, {result.model, result.delta, result.posterior.parameters, result.posterior.covariance},
      recording.q(SomePostures(recording), Eigen::all), ends);
}

}  // namespace elastocal
