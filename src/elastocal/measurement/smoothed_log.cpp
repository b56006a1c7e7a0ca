// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/smoothed_log.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "elastocal/math/butterworth.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/math/interruption.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/measurement/frame_interval.hpp"

namespace elastocal {
namespace {

constexpr double kLongestLogHole_s = 0.1;
constexpr double kHoleSteps = 2.5;  // in a slow log, two lost samples are a hole
constexpr double kRegular = 1e-4;   // share of a step: times this regular need no interpolation

std::vector<FrameInterval> SplitAtHoles(const Eigen::VectorXd& time_s) {
  const Eigen::Index steps = time_s.size() - 1;
  if (steps < 1) return {};
  const double step = Median(time_s.tail(steps) - time_s.head(steps));
  const double hole = std::max(kLongestLogHole_s, kHoleSteps * step);
  std::vector<FrameInterval> pieces;
  int begin = 0;
  for (int i = 1; i <= static_cast<int>(time_s.size()); ++i) {
    if (i < time_s.size() && time_s[i] - time_s[i - 1] <= hole) continue;
    pieces.push_back({begin, i});
    begin = i;
  }
  return pieces;
}

// Writes the signal to column `column` of `piece`, at the piece's constant rate.
void Regularise(const Eigen::Ref<const Eigen::VectorXd>& time_s,
                const Eigen::Ref<const Eigen::VectorXd>& signal, int column, LogPiece& piece) {
  Eigen::Index i = 0;
  const Eigen::Index last = time_s.size() - 2;
  for (Eigen::Index k = 0; k < time_s.size(); ++k) {
    const double time = piece.start_s + static_cast<double>(k) / piece.rate_hz;
    while (i < last && time_s[i + 1] < time) ++i;
    const double u = (time - time_s[i]) / (time_s[i + 1] - time_s[i]);
    piece.values(k, column) = signal[i] + u * (signal[i + 1] - signal[i]);
  }
}

bool IsRegular(const Eigen::Ref<const Eigen::VectorXd>& time_s, const LogPiece& piece) {
  for (Eigen::Index k = 0; k < time_s.size(); ++k) {
    const double time = piece.start_s + static_cast<double>(k) / piece.rate_hz;
    if (std::abs(time - time_s[k]) * piece.rate_hz > kRegular) return false;
  }
  return true;
}

LogPiece MakePiece(const JointLog& log, const FrameInterval& samples) {
  const auto rows = [&](const auto& all) { return all.middleRows(samples.begin, samples.size()); };
  const auto time_s = rows(log.time_s);
  const int joints = static_cast<int>(log.names.size());
  const int wrenches = static_cast<int>(log.wrenches.cols());
  LogPiece piece;
  piece.start_s = time_s[0];
  piece.rate_hz = (samples.size() - 1) / (time_s[samples.size() - 1] - time_s[0]);
  piece.values.resize(samples.size(), 2 * joints + wrenches);
  piece.values.leftCols(joints) = rows(log.positions);
  piece.values.middleCols(joints, joints) = rows(log.torques);
  if (wrenches > 0) piece.values.rightCols(wrenches) = rows(log.wrenches);
  if (IsRegular(time_s, piece)) return piece;
  for (int column = 0; column < static_cast<int>(piece.values.cols()); ++column) {
    const Eigen::VectorXd raw = piece.values.col(column);
    Regularise(time_s, raw, column, piece);
  }
  return piece;
}

// Filters neighbouring signals together. Signals with NaN are left out.
void FilterKnown(const SecondOrderSections& sections, Eigen::MatrixXd& values) {
  const auto is_known = [&](int column) { return values.col(column).allFinite(); };
  for (const FrameInterval& run : RunsWhere(static_cast<int>(values.cols()), is_known)) {
    FiltFilt(sections, values.middleCols(run.begin, run.size()));
  }
}

/// Logs of robots have some tens to thousands of samples a second.
std::string LikelyUnit(double rate_hz) {
  for (const auto& [unit, in_a_second] : {std::pair{"ms", 1e3}, {"us", 1e6}, {"ns", 1e9}}) {
    const double rate = rate_hz * in_a_second;
    if (rate > 10.0 && rate < 1e4)
      return std::string(" (is its time in ") + unit + " instead of s?)";
  }
  return "";
}

}  // namespace

SmoothedLog SmoothLog(const JointLog& log, const SmoothingOptions& options) {
  SmoothedLog smoothed;
  smoothed.joints = static_cast<int>(log.names.size());
  smoothed.wrench_sensors = static_cast<int>(log.wrench_sensors.size());
  smoothed.margin_s = 0.5 / options.cutoff_hz;
  for (const FrameInterval& samples : SplitAtHoles(log.time_s)) {
    InterruptionPoint();
    if (samples.size() < 2) continue;
    LogPiece piece = MakePiece(log, samples);
    if (!(piece.rate_hz > 2.0 * options.cutoff_hz)) {
      char text[160];
      std::snprintf(text, sizeof(text),
                    ": has %.3g samples a second; more than %.3g were expected, twice the cutoff "
                    "of the filter",
                    piece.rate_hz, 2.0 * options.cutoff_hz);
      throw InputError(log.source + text + LikelyUnit(piece.rate_hz));
    }
    const auto sections =
        ButterworthLowPass(options.filter_order, options.cutoff_hz, piece.rate_hz);
    if (piece.values.rows() <= FiltFiltPadding(sections)) continue;
    FilterKnown(sections, piece.values);
    smoothed.pieces.push_back(std::move(piece));
  }
  return smoothed;
}

const LogPiece* SmoothedLog::PieceAt(double robot_time_s) const {
  const auto covers = [&](const LogPiece& piece) {
    return robot_time_s >= piece.start_s + margin_s && robot_time_s <= piece.end_s() - margin_s;
  };
  const auto found = std::find_if(pieces.begin(), pieces.end(), covers);
  return found == pieces.end() ? nullptr : &*found;
}

std::optional<Eigen::VectorXd> SmoothedLog::At(double robot_time_s) const {
  const LogPiece* const piece = PieceAt(robot_time_s);
  if (piece == nullptr) return std::nullopt;
  const double sample = (robot_time_s - piece->start_s) * piece->rate_hz;
  const auto first =
      std::clamp<Eigen::Index>(static_cast<Eigen::Index>(sample) - 1, 0, piece->values.rows() - 4);
  const double u = sample - static_cast<double>(first);  // from 1 to 2, except at the ends
  const Eigen::Vector4d weights(-(u - 1.0) * (u - 2.0) * (u - 3.0) / 6.0,
                                u * (u - 2.0) * (u - 3.0) / 2.0, -u * (u - 1.0) * (u - 3.0) / 2.0,
                                u * (u - 1.0) * (u - 2.0) / 6.0);
  return piece->values.middleRows<4>(first).transpose() * weights;
}

}  // namespace elastocal
