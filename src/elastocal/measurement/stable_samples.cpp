// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/stable_samples.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/gaps.hpp"

namespace elastocal {
namespace {

constexpr double kRestingShare = 0.05;  // share of the windows that are surely at rest

// What is known of one frame for the choice of samples.
struct FrameSpeed {
  double largest = 0.0;
  int fastest = -1;  // column of the speeds
  int visible = 0;
};

std::vector<FrameSpeed> SummariseFrames(const Eigen::MatrixXd& speeds,
                                        const std::vector<int>& markers) {
  std::vector<FrameSpeed> frames(static_cast<std::size_t>(speeds.rows()));
  for (const int marker : markers) {
    for (Eigen::Index i = 0; i < speeds.rows(); ++i) {
      const double speed = speeds(i, marker);
      if (std::isnan(speed)) continue;
      FrameSpeed& frame = frames[static_cast<std::size_t>(i)];
      ++frame.visible;
      if (frame.fastest < 0 || speed > frame.largest) {
        frame.largest = speed;
        frame.fastest = marker;
      }
    }
  }
  return frames;
}

// The value below which `share` of the values lie; reorders them.
double Quantile(std::vector<double>& values, double share) {
  if (values.empty()) return kNaN;
  const auto rank = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + rank, values.end());
  return values[static_cast<std::size_t>(rank)];
}

void CheckArguments(const Eigen::MatrixXd& speeds, const std::vector<int>& markers, double rate_hz,
                    const StableSampleOptions& options) {
  const auto require = [](bool holds, const char* expected) {
    if (!holds) throw std::invalid_argument(std::string("stable samples: expected ") + expected);
  };
  require(!markers.empty(), "at least one marker");
  for (const int marker : markers) {
    require(marker >= 0 && marker < speeds.cols(), "markers that are columns of the speeds");
  }
  require(rate_hz > 0.0, "a rate above 0");
  require(options.threshold_m_per_s >= 0.0, "a threshold of 0 (automatic) or above");
  require(options.threshold_factor > 0.0, "a threshold factor above 0");
  require(options.hold_s >= 0.0, "a hold time of 0 or above");
  require(options.samples_per_run >= 1, "at least one sample a run");
  require(options.least_visible >= 0.0 && options.least_visible <= 1.0,
          "a share of visible markers from 0 to 1");
}

void ChooseThreshold(const Eigen::MatrixXd& speeds, const std::vector<int>& markers, double rate_hz,
                     const StableSampleOptions& options, StableSamples& result) {
  result.threshold_m_per_s = options.threshold_m_per_s;
  if (options.threshold_m_per_s > 0.0) return;
  const double window_s = std::max(options.hold_s, 0.1);
  const double resting = EstimateRestingSpeed(speeds, markers, rate_hz, window_s);
  result.resting_speed_m_per_s = resting;
  const double threshold =
      std::max(options.threshold_factor * resting, options.least_threshold_m_per_s);
  // True also if no speed is known, when the resting speed is NaN.
  result.threshold_limited = !(threshold <= options.threshold_limit_m_per_s);
  result.threshold_m_per_s = result.threshold_limited ? options.threshold_limit_m_per_s : threshold;
}

enum class State { kUnseen, kMoving, kResting };

// Consecutive frames in the same state.
struct Stretch {
  FrameInterval frames;
  State state = State::kUnseen;
  int fastest_marker = -1;
};

std::vector<Stretch> SplitByState(const std::vector<FrameSpeed>& frames, double threshold,
                                  double least_visible) {
  std::vector<Stretch> stretches;
  double largest = 0.0;  // largest speed of the last stretch
  for (int i = 0; i < static_cast<int>(frames.size()); ++i) {
    State state = State::kUnseen;
    if (frames[i].visible >= least_visible) {
      state = frames[i].largest < threshold ? State::kResting : State::kMoving;
    }
    if (stretches.empty() || stretches.back().state != state) {
      stretches.push_back({{i, i}, state, frames[i].fastest});
      largest = frames[i].largest;
    }
    stretches.back().frames.end = i + 1;
    if (frames[i].largest > largest) {
      largest = frames[i].largest;
      stretches.back().fastest_marker = frames[i].fastest;
    }
  }
  return stretches;
}

// Chooses equally spaced frames of a run, among those in which most markers are seen.
std::vector<int> ChooseFrames(const std::vector<FrameSpeed>& frames, const FrameInterval& run,
                              int count) {
  int most = 0;
  for (int i = run.begin; i < run.end; ++i) most = std::max(most, frames[i].visible);
  std::vector<int> candidates;
  for (int i = run.begin; i < run.end; ++i) {
    if (frames[i].visible == most) candidates.push_back(i);
  }
  const int available = static_cast<int>(candidates.size());
  const int taken = std::min(count, available);
  std::vector<int> chosen;
  for (int k = 0; k < taken; ++k)
    chosen.push_back(candidates[(2 * k + 1) * available / (2 * taken)]);
  return chosen;
}

// Appends the frames of a run that are not samples.
void AppendSpare(const FrameInterval& run, const std::vector<int>& chosen,
                 std::vector<UnusedFrames>& unused) {
  int begin = run.begin;
  const auto append = [&](int end) {
    if (end > begin) unused.push_back({{begin, end}, UnusedReason::kSpare, -1});
    begin = end + 1;
  };
  for (const int frame : chosen) append(frame);
  append(run.end);
}

}  // namespace

int StableSamples::UnusedCount(UnusedReason reason) const {
  int count = 0;
  for (const UnusedFrames& some : unused) count += some.reason == reason ? some.frames.size() : 0;
  return count;
}

Eigen::MatrixXd MarkerSpeeds(const MarkerTrajectories& trajectories) {
  const Eigen::Index inner = trajectories.positions.rows() - 2;
  Eigen::MatrixXd speeds =
      Eigen::MatrixXd::Constant(trajectories.frame_count(), trajectories.marker_count(), kNaN);
  if (inner < 1) return speeds;
  for (int marker = 0; marker < trajectories.marker_count(); ++marker) {
    const auto track = trajectories.positions.middleCols<3>(3 * marker);
    auto speed = speeds.col(marker).segment(1, inner);
    speed.setZero();
    for (int k = 0; k < 3; ++k) {
      const auto x = track.col(k);
      // The frame itself is added only to make the result NaN if the marker is not seen in it.
      speed.array() +=
          (x.tail(inner) - x.head(inner)).array().square() + 0.0 * x.segment(1, inner).array();
    }
    speed = 0.5 * trajectories.rate_hz * speed.cwiseSqrt();
  }
  return speeds;
}

void ForgetEdges(const MarkerTrajectories& trajectories, double margin_s, Eigen::MatrixXd& speeds) {
  const int frames = trajectories.frame_count();
  const int margin = static_cast<int>(margin_s * trajectories.rate_hz);
  for (int marker = 0; marker < trajectories.marker_count(); ++marker) {
    std::vector<FrameInterval> gaps =
        RunsWhere(frames, [&](int frame) { return !Seen(trajectories, frame, marker); });
    gaps.push_back({0, 0});
    gaps.push_back({frames, frames});
    for (const FrameInterval& gap : gaps) {
      const int begin = std::max(0, gap.begin - margin);
      const int end = std::min(frames, gap.end + margin);
      speeds.col(marker).segment(begin, end - begin).setConstant(kNaN);
    }
  }
}

double EstimateRestingSpeed(const Eigen::MatrixXd& speeds, const std::vector<int>& markers,
                            double rate_hz, double window_s) {
  const int length = std::max(1, static_cast<int>(std::lround(window_s * rate_hz)));
  std::vector<double> medians;
  std::vector<double> values;
  for (Eigen::Index begin = 0; begin + length <= speeds.rows(); begin += length) {
    values.clear();
    for (const int marker : markers) {
      for (const double speed : speeds.col(marker).segment(begin, length)) {
        if (!std::isnan(speed)) values.push_back(speed);
      }
    }
    if (!values.empty()) medians.push_back(Quantile(values, 0.5));
  }
  return Quantile(medians, kRestingShare);
}

StableSamples FindStableSamples(const Eigen::MatrixXd& speeds, const std::vector<int>& markers,
                                double rate_hz, const StableSampleOptions& options) {
  CheckArguments(speeds, markers, rate_hz, options);
  StableSamples result;
  ChooseThreshold(speeds, markers, rate_hz, options, result);
  const std::vector<FrameSpeed> frames = SummariseFrames(speeds, markers);
  const double least_visible =
      std::max(1.0, options.least_visible * static_cast<double>(markers.size()));
  const long hold = std::lround(options.hold_s * rate_hz);
  for (const Stretch& stretch : SplitByState(frames, result.threshold_m_per_s, least_visible)) {
    if (stretch.state == State::kUnseen) {
      result.unused.push_back({stretch.frames, UnusedReason::kTooFewVisible, -1});
    } else if (stretch.state == State::kMoving) {
      result.unused.push_back({stretch.frames, UnusedReason::kMoving, stretch.fastest_marker});
    } else if (stretch.frames.size() < hold) {
      result.unused.push_back({stretch.frames, UnusedReason::kTooShort, -1});
    } else {
      const auto chosen = ChooseFrames(frames, stretch.frames, options.samples_per_run);
      AppendSpare(stretch.frames, chosen, result.unused);
      result.frames.insert(result.frames.end(), chosen.begin(), chosen.end());
      result.run_of_frame.resize(result.frames.size(), static_cast<int>(result.runs.size()));
      result.runs.push_back(stretch.frames);
    }
  }
  for (const int marker : markers) {
    result.samples_of_marker.push_back(
        static_cast<int>(std::count_if(result.frames.begin(), result.frames.end(), [&](int frame) {
          return !std::isnan(speeds(frame, marker));
        })));
  }
  return result;
}

}  // namespace elastocal
