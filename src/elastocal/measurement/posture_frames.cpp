// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/posture_frames.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "elastocal/measurement/gaps.hpp"

namespace elastocal {
namespace {

constexpr double kMoved = 2e-3;  // rad or m

// Number of markers that are seen in all of the frames.
int MarkersSeen(const MarkerTrajectories& trajectories, const std::vector<int>& frames) {
  int seen = 0;
  for (int marker = 0; marker < trajectories.marker_count(); ++marker) {
    seen += std::all_of(frames.begin(), frames.end(),
                        [&](int frame) { return Seen(trajectories, frame, marker); });
  }
  return seen;
}

std::optional<Eigen::VectorXd> Joints(const TimedTrial& trial, int frame) {
  const auto signals = trial.log.At(trial.RobotTime(frame));
  if (!signals) return std::nullopt;
  return signals->head(trial.log.joints);
}

bool JointsMove(const TimedTrial& trial, int first, int last) {
  const auto before = Joints(trial, first);
  for (int frame = first; frame <= last; ++frame) {
    const auto now = Joints(trial, frame);
    if (!before || !now || (*now - *before).cwiseAbs().maxCoeff() > kMoved) return true;
  }
  return false;
}

}  // namespace

PostureFrames RestPostures(const TimedTrial& trial, const StableSamples& rests) {
  PostureFrames runs(rests.runs.size());
  for (std::size_t i = 0; i < rests.frames.size(); ++i) {
    runs[static_cast<std::size_t>(rests.run_of_frame[i])].push_back(rests.frames[i]);
  }
  PostureFrames postures;
  int most = 0;
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const int seen = MarkersSeen(trial.trajectories, runs[i]);
    if (i == 0 || JointsMove(trial, rests.runs[i - 1].end - 1, rests.runs[i].begin)) {
      postures.push_back(runs[i]);
      most = seen;
    } else if (seen > most) {
      postures.back() = runs[i];
      most = seen;
    }
  }
  return postures;
}

PostureFrames MotionPostures(const TimedTrial& trial, const StableSamples& rests, double rate_hz) {
  int first = trial.trajectories.frame_count();
  int last = -1;
  for (const UnusedFrames& unused : rests.unused) {
    if (unused.reason != UnusedReason::kMoving) continue;
    first = std::min(first, unused.frames.begin);
    last = unused.frames.end - 1;
  }
  const double step = std::max(1.0, trial.trajectories.rate_hz / rate_hz);
  PostureFrames postures;
  for (int k = 0;; ++k) {
    const int frame = first + static_cast<int>(std::lround(k * step));
    if (frame > last) return postures;
    if (trial.log.Covers(trial.RobotTime(frame))) postures.push_back({frame});
  }
}

}  // namespace elastocal
