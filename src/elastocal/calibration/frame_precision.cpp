// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/frame_precision.hpp"

#include <algorithm>
#include <cmath>

#include "elastocal/robot/kinematics.hpp"

namespace elastocal {
namespace {

constexpr int kPosturesAssessed = 20;  // spread over the recording: sizes change little with more

/// Poses of the links in the frame of the root link.
std::vector<Transform> PosesFromRoot(const ErrorModel& model, const Geometry& geometry,
                                     const Eigen::VectorXd& q, const std::vector<int>& links) {
  const std::vector<Transform> all = CalibratedLinkTransforms(model, geometry, q);
  const Transform T_root_reference = WaistPose(geometry).inverse();
  std::vector<Transform> poses;
  for (int link : links) poses.push_back(T_root_reference * all[static_cast<std::size_t>(link)]);
  return poses;
}

std::vector<int> SomePostures(const Recording& recording) {
  const int count = recording.posture_count();
  const int step = std::max(1, count / kPosturesAssessed);
  std::vector<int> postures;
  for (int i = 0; i < count; i += step) postures.push_back(i);
  return postures;
}

/// The links that no joint without errors of its own moves.
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

}  // namespace

std::vector<FramePrecision> AssessFrames(const CalibrationResult& result,
                                         const Recording& recording, const std::vector<int>& ends) {
  const ErrorModel& model = result.model;
  const std::vector<int> links = MovedByKnownJoints(model, ends);
  const std::vector<int>& parameters = result.posterior.parameters;
  const std::vector<int> postures = SomePostures(recording);
  const auto row = [&](std::size_t posture, std::size_t link) {
    return static_cast<Eigen::Index>(6 * (posture * links.size() + link));
  };
  const Geometry at = ApplyErrors(model, result.delta);
  std::vector<std::vector<Transform>> poses;
  for (int i : postures) {
    poses.push_back(PosesFromRoot(model, at, recording.q.row(i).transpose(), links));
  }
  // By posture and link: displacement and rotation with each parameter.
  Eigen::MatrixXd slopes =
      Eigen::MatrixXd::Zero(row(postures.size(), 0), static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const Parameter& parameter = model.parameters[static_cast<std::size_t>(parameters[k])];
    if (!PlacesLinks(parameter)) continue;
    const double step = 1e-3 * ParameterScale(parameter);
    Eigen::VectorXd beside = result.delta;
    beside[parameters[k]] += step;
    const Geometry moved = ApplyErrors(model, beside);
    for (std::size_t p = 0; p < postures.size(); ++p) {
      const std::vector<Transform> there =
          PosesFromRoot(model, moved, recording.q.row(postures[p]).transpose(), links);
      for (std::size_t j = 0; j < links.size(); ++j) {
        const Transform& here = poses[p][j];
        const Eigen::AngleAxisd turn(here.linear().transpose() * there[j].linear());
        auto slope = slopes.block<6, 1>(row(p, j), static_cast<Eigen::Index>(k));
        slope << there[j].translation() - here.translation(), turn.angle() * turn.axis();
        slope /= step;
      }
    }
  }
  const Eigen::VectorXd variances =
      (slopes * result.posterior.covariance).cwiseProduct(slopes).rowwise().sum();
  std::vector<FramePrecision> frames;
  for (std::size_t j = 0; j < links.size(); ++j) {
    double position = 0.0, attitude = 0.0;
    for (std::size_t p = 0; p < postures.size(); ++p) {
      position += variances.segment<3>(row(p, j)).sum();
      attitude += variances.segment<3>(row(p, j) + 3).sum();
    }
    const auto count = static_cast<double>(postures.size());
    frames.push_back({links[j], std::sqrt(position / count), std::sqrt(attitude / count)});
  }
  return frames;
}

}  // namespace elastocal
