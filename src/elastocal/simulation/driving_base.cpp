// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/driving_base.hpp"

#include <algorithm>
#include <cstddef>
#include <vector>

#include "elastocal/math/random.hpp"
#include "elastocal/math/smooth_step.hpp"

namespace elastocal {
namespace {

/// A place on the floor, m, and the direction, rad.
using Place = Eigen::Vector3d;

Place DrawPlace(Random& random) {
  return {random.Uniform(-kDrivingSpan, kDrivingSpan), random.Uniform(-kDrivingSpan, kDrivingSpan),
          random.Uniform(-kDrivingTurn, kDrivingTurn)};
}

Transform PoseAt(const Place& place) {
  return Transform(Eigen::Translation3d(place.x(), place.y(), 0.0)) * RotZ(place.z());
}

/// Where the run of equal entries ends that begins at `i`.
std::size_t RunEnd(const std::vector<bool>& flags, std::size_t i) {
  std::size_t end = i;
  while (end < flags.size() && flags[end] == flags[i]) ++end;
  return end;
}

/// For each frame, whether the robot is commanded to stay where it is, for longer than at the
/// turning points of a sine.
std::vector<bool> RestingFrames(const Motion& commanded, const TrueMotion& played) {
  constexpr double kShortestRest = 0.3;  // s
  std::vector<bool> resting;
  Eigen::VectorXd before = PostureAt(commanded, 0.0);
  for (int i = 0; i < played.frame_count(); ++i) {
    Eigen::VectorXd now = PostureAt(commanded, i / played.rate_hz);
    resting.push_back(now == before);
    before = std::move(now);
  }
  for (std::size_t i = 0; i < resting.size();) {
    const std::size_t end = RunEnd(resting, i);
    if (static_cast<double>(end - i) < kShortestRest * played.rate_hz) {
      std::fill(resting.begin() + static_cast<std::ptrdiff_t>(i),
                resting.begin() + static_cast<std::ptrdiff_t>(end), false);
    }
    i = end;
  }
  return resting;
}

/// For each frame, the place of the root link: constant in each rest, and on a smooth way to the
/// next place between two rests.
std::vector<Place> DrivenPlaces(const std::vector<bool>& resting, Random& random) {
  std::vector<Place> places;
  Place from = DrawPlace(random);
  for (std::size_t i = 0; i < resting.size();) {
    const std::size_t end = RunEnd(resting, i);
    const Place to = resting[i] ? from : DrawPlace(random);
    const auto frames = static_cast<double>(end - i);
    for (std::size_t k = i; k < end; ++k) {
      places.emplace_back(from + SmoothStep(static_cast<double>(k - i) / frames) * (to - from));
    }
    from = to;
    i = end;
  }
  return places;
}

}  // namespace

void DriveBase(const Motion& commanded, const Transform& T_camera_world, std::uint64_t seed,
               TrueMotion& played) {
  Random random(seed);
  const std::vector<Place> places = DrivenPlaces(RestingFrames(commanded, played), random);
  for (Eigen::Index i = 0; i < played.markers.rows(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    const Transform T = T_camera_world * PoseAt(places[at]) * T_camera_world.inverse();
    for (Eigen::Index m = 0; m < played.markers.cols(); m += 3) {
      const Eigen::Vector3d p = played.markers.block<1, 3>(i, m).transpose();
      played.markers.block<1, 3>(i, m) = (T * p).transpose();
    }
    played.T_camera_waist[at] = T * played.T_camera_waist[at];
  }
}

}  // namespace elastocal
