// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/clock_windows.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include "elastocal/math/interruption.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"

namespace elastocal {
namespace {

constexpr int kIterations = 20;
constexpr double kConverged_s = 1e-7;
constexpr double kFarthest_s = 0.5;
constexpr double kLeastCorrelation = 0.5;
constexpr double kLeastKnownShare =
    0.5;  // share of a window's frames that must be known in both signals
constexpr double kBiweight = 4.685;  // 95 % efficient for normal errors

// Value and time derivative, at a given time, of the cubic through a signal's samples.
struct Interpolated {
  double value = 0.0;
  double derivative = 0.0;
};

std::optional<Interpolated> Interpolate(const UniformSpeed& signal, double time_s) {
  const double position = (time_s - signal.start_s) * signal.rate_hz;
  const double cell = std::floor(position);
  if (!(cell >= 1.0 && cell + 2.0 < static_cast<double>(signal.values.size()))) return std::nullopt;
  const Eigen::Vector4d v = signal.values.segment<4>(static_cast<Eigen::Index>(cell) - 1);
  const double u = position - cell;
  const double c1 = 0.5 * (v[2] - v[0]);
  const double c2 = v[0] - 2.5 * v[1] + 2.0 * v[2] - 0.5 * v[3];
  const double c3 = 0.5 * (v[3] - v[0]) + 1.5 * (v[1] - v[2]);
  const Interpolated result{v[1] + u * (c1 + u * (c2 + u * c3)),
                            (c1 + u * (2.0 * c2 + 3.0 * u * c3)) * signal.rate_hz};
  if (std::isnan(result.value)) return std::nullopt;
  return result;
}

// Least squares in a window at one lag: measured = gain p + offset - step p', which gives a lag of
// step / gain.
struct WindowSystem {
  int count = 0;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double measured_sum = 0.0;
  double measured_square = 0.0;
  double motion = 0.0;         // sum of p'^2
  double motion_moment = 0.0;  // ... times the time

  /// `taken`: by frame of the window; frames that are unknown at this lag are struck from it.
  WindowSystem(const UniformSpeed& measured, const UniformSpeed& predicted,
               const FrameInterval& frames, double lag_s, std::vector<char>& taken) {
    for (int frame = frames.begin; frame < frames.end; ++frame) {
      InterruptionPoint();
      char& take = taken[static_cast<std::size_t>(frame - frames.begin)];
      if (take == 0) continue;
      const double value = measured.values[frame];
      const double time = frame / measured.rate_hz;
      const std::optional<Interpolated> p =
          std::isnan(value) ? std::nullopt : Interpolate(predicted, time - lag_s);
      if (!p) {
        take = 0;
        continue;
      }
      const Eigen::Vector3d row(p->value, 1.0, -p->derivative);
      ++count;
      normal += row * row.transpose();
      right += row * value;
      measured_sum += value;
      measured_square += value * value;
      motion += row[2] * row[2];
      motion_moment += row[2] * row[2] * time;
    }
  }
};

// Factor by which the variance of an estimate grows because residuals are correlated from frame to
// frame: (1 + r) / (1 - r), for a first-order process.
double VarianceInflation(const UniformSpeed& measured, const UniformSpeed& predicted,
                         const FrameInterval& frames, double lag_s, const Eigen::Vector3d& fit) {
  double square = 0.0;
  double product = 0.0;
  double last = 0.0;
  for (int frame = frames.begin; frame < frames.end; ++frame) {
    const auto p = Interpolate(predicted, frame / measured.rate_hz - lag_s);
    const double value = measured.values[frame];
    if (!p || std::isnan(value)) continue;
    const double residual = value - fit[0] * p->value - fit[1];
    square += residual * residual;
    product += residual * last;
    last = residual;
  }
  const double r = square > 0.0 ? std::clamp(product / square, 0.0, 0.99) : 0.0;
  return (1.0 + r) / (1.0 - r);
}

// Line by the median of the slopes of all pairs of windows, and the median of the remainders.
LagLine TheilSen(const std::vector<WindowLag>& windows) {
  std::vector<double> slopes;
  for (std::size_t i = 0; i < windows.size(); ++i) {
    for (std::size_t j = i + 1; j < windows.size(); ++j) {
      slopes.push_back((windows[j].lag_s - windows[i].lag_s) /
                       (windows[j].time_s - windows[i].time_s));
    }
  }
  LagLine line;
  line.slope =
      Median(Eigen::VectorXd::Map(slopes.data(), static_cast<Eigen::Index>(slopes.size())));
  Eigen::VectorXd levels(static_cast<Eigen::Index>(windows.size()));
  for (Eigen::Index i = 0; i < levels.size(); ++i) {
    levels[i] = windows[i].lag_s - line.slope * windows[i].time_s;
  }
  line.level_s = Median(levels);
  return line;
}

// Adds to the windows' variances one that they have in common, as large as their scatter about a
// line requires. Errors of the robot's model shift each window by more than its noise, and a window
// with little noise must not determine the line alone.
Eigen::VectorXd AddCommonVariance(const std::vector<WindowLag>& windows,
                                  const Eigen::VectorXd& residuals) {
  Eigen::VectorXd variances(residuals.size());
  for (Eigen::Index i = 0; i < variances.size(); ++i) variances[i] = std::pow(windows[i].sd_s, 2);
  const double scatter = kNormalMad * Median(residuals.cwiseAbs());
  return variances.array() + std::max(0.0, scatter * scatter - Median(variances));
}

// Factor on the windows' variances. It raises them to the scatter about the line, or lowers them to
// the value that the scatter is surely (95 %) below: a window's own residuals also contain what the
// model of the speed does not explain, which need not shift its lag.
double VarianceScale(double chi_square, double degrees_of_freedom) {
  if (degrees_of_freedom < 1.0) return std::max(1.0, chi_square);
  const double mean = chi_square / degrees_of_freedom;
  if (mean > 1.0) return mean;
  return std::min(1.0, chi_square / ChiSquareQuantile(0.05, degrees_of_freedom));
}

// Fits a line by weighted least squares. Standard deviations follow from the weights and the
// scatter.
LagLine FitWeighted(const std::vector<WindowLag>& windows, const Eigen::VectorXd& weights) {
  LagLine line;
  const double total = weights.sum();
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    line.middle_s += weights[i] * windows[i].time_s / total;
    line.level_s += weights[i] * windows[i].lag_s / total;
  }
  double spread = 0.0;
  double moment = 0.0;
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    const double t = windows[i].time_s - line.middle_s;
    spread += weights[i] * t * t;
    moment += weights[i] * t * (windows[i].lag_s - line.level_s);
  }
  line.slope = moment / spread;
  double chi_square = 0.0;
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    chi_square += weights[i] * std::pow(windows[i].lag_s - line.Lag(windows[i].time_s), 2);
  }
  const double used = static_cast<double>((weights.array() > 0.0).count());
  // The scale must not vanish: with three windows the scatter is sometimes zero.
  const double scale = std::max(0.01, VarianceScale(chi_square, used - 2.0));
  line.level_sd_s = std::sqrt(scale / total);
  line.slope_sd = std::sqrt(scale / spread);
  line.residual_s = std::sqrt(chi_square / total);
  return line;
}

}  // namespace

double LagLine::Sd(double time_s) const {
  return std::hypot(level_sd_s, slope_sd * (time_s - middle_s));
}

std::optional<WindowLag> FitWindowLag(const UniformSpeed& measured, const UniformSpeed& predicted,
                                      const FrameInterval& frames, double coarse_lag_s) {
  double lag = coarse_lag_s;
  const std::vector<char> all(static_cast<std::size_t>(std::max(0, frames.size())), 1);
  std::vector<char> taken = all;
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const WindowSystem system(measured, predicted, frames, lag, taken);
    if (system.count < 10 || system.count < kLeastKnownShare * frames.size()) return std::nullopt;
    const Eigen::FullPivLU<Eigen::Matrix3d> lu(system.normal);
    if (!lu.isInvertible()) return std::nullopt;  // nothing moves
    const Eigen::Vector3d fit = lu.solve(system.right);
    const double step = fit[2] / fit[0];
    lag += step;
    if (!(fit[0] > 0.0 && std::abs(lag - coarse_lag_s) < kFarthest_s)) return std::nullopt;
    // Near the solution a frame at the rim that was lost once stays lost: coming and going, it
    // would keep the steps from ever becoming small.
    if (std::abs(step) * measured.rate_hz > 1.0) taken = all;
    if (std::abs(step) > kConverged_s) continue;

    const double residual = std::max(0.0, system.measured_square - fit.dot(system.right));
    const double variation =
        system.measured_square - system.measured_sum * system.measured_sum / system.count;
    if (residual > (1.0 - kLeastCorrelation * kLeastCorrelation) * variation) return std::nullopt;
    const double variance = residual / (system.count - 3) *
                            VarianceInflation(measured, predicted, frames, lag, fit) *
                            lu.inverse()(2, 2);
    // Without noise only rounding is left; the floor keeps the weight finite.
    const double sd = std::max(1e-6, std::sqrt(variance) / fit[0]);
    return WindowLag{system.motion_moment / system.motion, lag, sd, true};
  }
  return std::nullopt;
}

LagLine FitLine(std::vector<WindowLag>& windows) {
  const auto count = static_cast<Eigen::Index>(windows.size());
  LagLine line = TheilSen(windows);
  const auto residuals = [&] {
    Eigen::VectorXd values(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      values[i] = windows[i].lag_s - line.Lag(windows[i].time_s);
    }
    return values;
  };
  const Eigen::VectorXd variances = AddCommonVariance(windows, residuals());
  Eigen::VectorXd weights(count);
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    const Eigen::ArrayXd standardised = residuals().array().abs() / variances.array().sqrt();
    const double scale = std::max(1.0, kNormalMad * Median(standardised));
    const Eigen::ArrayXd u = (standardised / (kBiweight * scale)).min(1.0);
    weights = (1.0 - u.square()).square() / variances.array();
    for (Eigen::Index i = 0; i < count; ++i) windows[i].used = u[i] < 1.0;
    line = FitWeighted(windows, weights);
  }
  return line;
}

}  // namespace elastocal
