// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/trial_clock.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/stable_samples.hpp"
#include "elastocal/measurement/standing_kinematics.hpp"

namespace elastocal {
namespace {

constexpr double kWidest_s = 600.0;  // bounds the cost of the search
constexpr double kMostSamples = 1e8;
constexpr double kRestWindow_s = 0.3;
constexpr double kJump = 0.02;  // size of a jump, as a share of the mean speed's standard deviation
constexpr double kJumpReach_s = 0.1;  // time that is left out on either side of a jump
constexpr int kMostPasses = 3;
constexpr double kSettled_s =
    5e-3;  // change of the lag that counts as none; well within a jump's reach
constexpr double kMostUnexplained = 0.25;  // largest share of the markers
constexpr double kLeastSeen =
    0.5;  // least share of the trial in which a marker must be seen to count

// Mean of the known values of each row; NaN if fewer than `least` are known.
Eigen::VectorXd MeanKnown(const Eigen::MatrixXd& values, const std::vector<bool>& columns,
                          double least) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(values.rows());
  Eigen::VectorXd count = sum;
  for (Eigen::Index column = 0; column < values.cols(); ++column) {
    if (!columns[static_cast<std::size_t>(column)]) continue;
    for (Eigen::Index row = 0; row < values.rows(); ++row) {
      if (std::isnan(values(row, column))) continue;
      sum[row] += values(row, column);
      count[row] += 1.0;
    }
  }
  return (count.array() >= least).select(sum.array() / count.array(), kNaN);
}

// The two mean speeds, over the same markers at each moment.
struct MeansOfSeen {
  Eigen::VectorXd measured;  // by frame
  Eigen::VectorXd logged;    // by logged time
};

// Mean of the logged speeds at one time, over the markers that are seen in a frame.
double MeanOfSeen(const Eigen::MatrixXd& logged, Eigen::Index row, const Eigen::MatrixXd& measured,
                  Eigen::Index frame) {
  double sum = 0.0;
  int count = 0;
  for (Eigen::Index m = 0; m < measured.cols(); ++m) {
    if (std::isnan(measured(frame, m))) continue;
    sum += logged(row, m);
    ++count;
  }
  return count > 0 ? sum / count : logged.row(row).mean();
}

// `clock` tells which frame belongs to which logged time. When markers come or go, the mean jumps
// in both signals at the same time by this clock, even if the clock is wrong; frames around such
// jumps are therefore left out.
MeansOfSeen TakeMeansOfSeen(const Eigen::MatrixXd& measured, const Eigen::VectorXd& measured_mean,
                            double rate_hz, const LoggedSpeeds& logged, const ClockFit& clock) {
  MeansOfSeen means{measured_mean, logged.speeds.rowwise().mean()};
  const double jump =
      kJump * std::sqrt((means.logged.array() - means.logged.mean()).square().mean());
  const auto reach = static_cast<Eigen::Index>(std::ceil(kJumpReach_s * rate_hz));
  for (Eigen::Index i = 0; i < logged.time_s.size(); ++i) {
    const Eigen::Index frame = std::llround(clock.CameraTime(logged.time_s[i]) * rate_hz);
    if (frame < 0 || frame >= measured.rows()) continue;
    means.logged[i] = MeanOfSeen(logged.speeds, i, measured, frame);
    if (frame == 0) continue;
    const double before = MeanOfSeen(logged.speeds, i, measured, frame - 1);
    if (std::abs(means.logged[i] - before) <= jump) continue;
    const Eigen::Index begin = std::max<Eigen::Index>(0, frame - reach);
    const Eigen::Index end = std::min(measured.rows(), frame + reach);
    means.measured.segment(begin, end - begin).setConstant(kNaN);
  }
  return means;
}

/// Which markers are seen most of the time.
std::vector<bool> MostlySeen(const Eigen::MatrixXd& measured) {
  std::vector<bool> mostly_seen;
  for (const auto& speed : measured.colwise()) {
    const auto known = speed.size() - speed.array().isNaN().count();
    mostly_seen.push_back(static_cast<double>(known) >=
                          kLeastSeen * static_cast<double>(speed.size()));
  }
  return mostly_seen;
}

// First by the markers that are seen most of the time, then by all that are seen at each moment.
ClockFit FitSeen(const Eigen::MatrixXd& measured, double rate_hz, const LoggedSpeeds& logged,
                 const ClockOptions& options) {
  const std::vector<bool> mostly_seen = MostlySeen(measured);
  const auto markers =
      static_cast<double>(std::count(mostly_seen.begin(), mostly_seen.end(), true));
  if (markers == 0.0) return {};
  const Eigen::VectorXd all = MeanKnown(logged.speeds, mostly_seen, 1.0);
  const MeasuredSpeed seen{rate_hz, MeanKnown(measured, mostly_seen, 0.5 * markers)};
  const ClockFit first = EstimateClock(seen, {logged.time_s, all}, options);
  if (first.state == ClockState::kNoOverlap || first.state == ClockState::kWeak) return first;
  const std::vector<bool> every(mostly_seen.size(), true);
  const Eigen::VectorXd mean = MeanKnown(measured, every, 0.5 * markers);
  ClockFit fit = first;
  for (int pass = 0; pass < kMostPasses; ++pass) {
    const ClockFit last = fit;
    const MeansOfSeen means = TakeMeansOfSeen(measured, mean, rate_hz, logged, last);
    fit = EstimateClock({rate_hz, means.measured}, {logged.time_s, means.logged}, options);
    if (std::abs(fit.lag_s - last.lag_s) < kSettled_s) break;
  }
  return first.state == ClockState::kAmbiguous ? first : fit;
}

// Markers whose speed the log does not explain, though they move as much as the others: their
// labels were exchanged for a while. None if there are many of them, because then the log is wrong.
std::vector<int> FindUnexplained(const Eigen::MatrixXd& measured, double rate_hz,
                                 const LoggedSpeeds& logged, const ClockFit& clock) {
  Eigen::ArrayXd unexplained = Eigen::ArrayXd::Zero(measured.cols());
  for (Eigen::Index i = 0; i < logged.time_s.size(); ++i) {
    const Eigen::Index frame = std::llround(clock.CameraTime(logged.time_s[i]) * rate_hz);
    if (frame < 0 || frame >= measured.rows()) continue;
    const Eigen::ArrayXd difference = (measured.row(frame) - logged.speeds.row(i)).transpose();
    unexplained += difference.isNaN().select(0.0, difference.square());
  }
  const Eigen::ArrayXd motion =
      (logged.speeds.rowwise() - logged.speeds.colwise().mean()).colwise().squaredNorm();
  std::vector<int> found;
  for (Eigen::Index m = 0; m < measured.cols(); ++m) {
    if (unexplained[m] > std::max(motion[m], motion.mean())) found.push_back(static_cast<int>(m));
  }
  if (static_cast<double>(found.size()) > kMostUnexplained * static_cast<double>(measured.cols())) {
    found.clear();
  }
  return found;
}

void ChooseRange(double camera_s, const Eigen::VectorXd& log_time_s, ClockOptions& options) {
  const double together = -log_time_s[0];
  const double ending = camera_s - log_time_s[log_time_s.size() - 1];
  const double half = 0.5 * std::clamp(ending - together, -kWidest_s, kWidest_s);
  options.expected_lag_s = together + half;
  options.longest_lag_s += std::abs(half);
}

// Chooses the range of lags, and corrects the logged speeds for noise: the length of a noisy
// velocity is never zero. Without this the two speeds would differ at each rest, which would hide
// how well they agree. Returns false if there is nothing to search.
bool Prepare(const Eigen::MatrixXd& measured, double rate_hz,
             const std::optional<double>& expected_lag_s, LoggedSpeeds& logged,
             ClockOptions& options) {
  if (logged.time_s.size() < 2 || measured.rows() == 0) return false;
  const double span_s = logged.time_s[logged.time_s.size() - 1] - logged.time_s[0];
  if (!(span_s * rate_hz < kMostSamples)) return false;  // e.g. a log of years with one hole
  options.expected_lag_s = expected_lag_s.value_or(0.0);
  if (!expected_lag_s) {
    ChooseRange(static_cast<double>(measured.rows()) / rate_hz, logged.time_s, options);
  }
  std::vector<int> columns(static_cast<std::size_t>(measured.cols()));
  std::iota(columns.begin(), columns.end(), 0);
  const double resting = EstimateRestingSpeed(measured, columns, rate_hz, kRestWindow_s);
  if (std::isfinite(resting)) {
    logged.speeds = (logged.speeds.array().square() + resting * resting).sqrt();
  }
  return true;
}

}  // namespace

LoggedSpeeds PredictSpeeds(const MarkedRobot& robot, const std::vector<int>& markers,
                           const std::vector<int>& standing, const SmoothedLog& log,
                           const std::vector<int>& coordinates, double rate_hz) {
  const StandingKinematics kinematics(robot, markers, standing);
  Eigen::VectorXd q = robot.q_not_logged;
  std::vector<double> times;
  std::vector<Eigen::MatrixXd> speeds;
  Eigen::Index rows = 0;
  for (const LogPiece& piece : log.pieces) {
    const auto stride = std::max<Eigen::Index>(
        1, static_cast<Eigen::Index>(piece.rate_hz / rate_hz * (1.0 + 1e-9)));
    const Eigen::Index count = piece.values.rows() / stride;
    if (count < 3) continue;
    const double step_s = static_cast<double>(stride) / piece.rate_hz;
    Eigen::MatrixXd& speed =
        speeds.emplace_back(count - 2, static_cast<Eigen::Index>(markers.size()));
    Eigen::Matrix3Xd before, here, after;
    for (Eigen::Index k = 0; k < count; ++k) {
      for (int c = 0; c < log.joints; ++c) q[coordinates[c]] = piece.values(k * stride, c);
      after = kinematics.Positions(q);
      if (k >= 2) {
        speed.row(k - 2) = (after - before).colwise().norm() / (2.0 * step_s);
        times.push_back(piece.start_s + static_cast<double>(k - 1) * step_s);
      }
      before.swap(here);
      here.swap(after);
    }
    rows += speed.rows();
  }
  LoggedSpeeds logged;
  logged.time_s = Eigen::VectorXd::Map(times.data(), rows);
  logged.speeds.resize(rows, static_cast<Eigen::Index>(markers.size()));
  Eigen::Index row = 0;
  for (const Eigen::MatrixXd& speed : speeds) {
    logged.speeds.middleRows(row, speed.rows()) = speed;
    row += speed.rows();
  }
  return logged;
}

std::optional<MeanSpeeds> TakeMeanSpeeds(const Eigen::MatrixXd& measured, double rate_hz,
                                         LoggedSpeeds logged,
                                         const std::optional<double>& expected_lag_s,
                                         ClockOptions options) {
  if (!Prepare(measured, rate_hz, expected_lag_s, logged, options)) return std::nullopt;
  const std::vector<bool> seen = MostlySeen(measured);
  const auto markers = static_cast<double>(std::count(seen.begin(), seen.end(), true));
  if (markers == 0.0) return std::nullopt;
  return MeanSpeeds{{rate_hz, MeanKnown(measured, seen, 0.5 * markers)},
                    {logged.time_s, MeanKnown(logged.speeds, seen, 1.0)},
                    options};
}

ClockFit EstimateTrialClock(const Eigen::MatrixXd& measured, double rate_hz, LoggedSpeeds logged,
                            const std::optional<double>& expected_lag_s, ClockOptions options) {
  if (!Prepare(measured, rate_hz, expected_lag_s, logged, options)) return {};
  const ClockFit fit = FitSeen(measured, rate_hz, logged, options);
  if (fit.state == ClockState::kReliable || fit.state == ClockState::kNoOverlap) return fit;
  const std::vector<int> unexplained = FindUnexplained(measured, rate_hz, logged, fit);
  if (unexplained.empty()) return fit;
  Eigen::MatrixXd others = measured;
  for (const int marker : unexplained) others.col(marker).setConstant(kNaN);
  return FitSeen(others, rate_hz, logged, options);
}

}  // namespace elastocal
