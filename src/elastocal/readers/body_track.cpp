// SPDX-License-Identifier: Apache-2.0
#include "elastocal/readers/body_track.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kPose = 7;
constexpr double kLongestStep = 1.5;  // intervals; longer steps are gaps
constexpr double kSameMoment = 0.02;  // intervals; closer stamps are of one moment

/// Sorts a track by its stamps and keeps each stamp once.
void SortTrack(BodyTrack& track) {
  std::vector<std::size_t> order(track.stamps_ns.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return track.stamps_ns[a] < track.stamps_ns[b];
  });
  BodyTrack sorted;
  sorted.name = track.name;
  for (const std::size_t i : order) {
    if (!sorted.stamps_ns.empty() && sorted.stamps_ns.back() == track.stamps_ns[i]) continue;
    sorted.stamps_ns.push_back(track.stamps_ns[i]);
    const auto from = track.poses.begin() + static_cast<std::ptrdiff_t>(kPose * i);
    sorted.poses.insert(sorted.poses.end(), from, from + kPose);
  }
  track = std::move(sorted);
}

/// Median interval between stamps, ns; 0 for fewer than two.
double MedianInterval(const BodyTrack& track) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < track.stamps_ns.size(); ++i) {
    intervals.push_back(static_cast<double>(track.stamps_ns[i] - track.stamps_ns[i - 1]));
  }
  if (intervals.empty()) return 0.0;
  const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>(intervals.size() / 2);
  std::nth_element(intervals.begin(), middle, intervals.end());
  return *middle;
}

/// The poses of one track at the times start + frame * interval, as columns.
void Interpolate(const BodyTrack& track, std::int64_t start, double interval, Eigen::Index at,
                 BodyPoses& to) {
  const double own = std::max(interval, MedianInterval(track));
  std::size_t next = 0;
  for (Eigen::Index frame = 0; frame < to.positions.rows(); ++frame) {
    const double time = interval * static_cast<double>(frame);
    const auto since = [&](std::size_t i) {
      return static_cast<double>(track.stamps_ns[i] - start) - time;
    };
    while (next < track.stamps_ns.size() && since(next) < -kSameMoment * interval) ++next;
    if (next == track.stamps_ns.size()) break;
    const double after = since(next);
    double share = 1.0;  // share of the later pose
    if (after > kSameMoment * interval) {
      if (next == 0) continue;
      const double step = after - since(next - 1);
      if (step > kLongestStep * own) continue;
      share = 1.0 - after / step;
    }
    const Eigen::Map<const Eigen::Matrix<double, kPose, 1>> later(&track.poses[kPose * next]);
    const Eigen::Map<const Eigen::Matrix<double, kPose, 1>> earlier(
        &track.poses[kPose * (share < 1.0 ? next - 1 : next)]);
    // Quaternions of opposite signs are one rotation.
    const double sign = later.tail<4>().dot(earlier.tail<4>()) < 0.0 ? -1.0 : 1.0;
    to.positions.block<1, 3>(frame, 3 * at) =
        ((1.0 - share) * earlier.head<3>() + share * later.head<3>()).transpose();
    to.rotations.block<1, 4>(frame, 4 * at) =
        ((1.0 - share) * sign * earlier.tail<4>() + share * later.tail<4>()).transpose();
  }
}

}  // namespace

RegularPoses ResampleTracks(const std::string& source, std::vector<BodyTrack> tracks) {
  std::erase_if(tracks, [](const BodyTrack& track) { return track.stamps_ns.empty(); });
  RegularPoses regular;
  double interval = 0.0;
  std::size_t most = 1, total = 0;
  std::int64_t first = INT64_MAX, last = INT64_MIN;
  for (BodyTrack& track : tracks) {
    SortTrack(track);
    total += track.stamps_ns.size();
    first = std::min(first, track.stamps_ns.front());
    last = std::max(last, track.stamps_ns.back());
    if (track.stamps_ns.size() <= most) continue;
    most = track.stamps_ns.size();
    interval = MedianInterval(track);
  }
  if (!(interval > 0.0)) {
    throw InputError(source + ": fewer than two poses of each body; a motion was expected");
  }
  const double frames =
      std::floor(static_cast<double>(last - first) / interval + kSameMoment) + 1.0;
  constexpr double kMostEmpty = 20.0;
  if (frames > 1000.0 + kMostEmpty * static_cast<double>(total)) {
    throw InputError(source +
                     ": the stamps of the poses are not regular: " + std::to_string(total) +
                     " poses in " + std::to_string((last - first) / 1000000000) +
                     " s, mostly every " + std::to_string(interval * 1e-9) + " s");
  }
  regular.rate_hz = 1e9 / interval;
  regular.start_ns = first;
  const auto rows = static_cast<Eigen::Index>(frames);
  const auto count = static_cast<Eigen::Index>(tracks.size());
  regular.poses.positions.setConstant(rows, 3 * count, kNaN);
  regular.poses.rotations.setConstant(rows, 4 * count, kNaN);
  for (Eigen::Index i = 0; i < count; ++i) {
    const BodyTrack& track = tracks[static_cast<std::size_t>(i)];
    regular.poses.names.push_back(track.name);
    Interpolate(track, first, interval, i, regular.poses);
  }
  return regular;
}

}  // namespace elastocal
