// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/gaps.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/Cholesky>

#include "elastocal/math/interruption.hpp"
#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

constexpr double kNeighbourhood_s = 0.1;
constexpr int kLeastNeighbourhood = 4;  // frames on a side: two sides give a cubic and a remainder
constexpr int kLeastSeenOnASide = 2;

using Cubic = Eigen::Matrix<double, 4, 3>;  // coefficients x coordinates

// Legendre polynomials: nearly orthogonal over the frames of the fit, so that its normal equations
// lose no digits.
Eigen::Vector4d Basis(double t) {
  return {1.0, t, 0.5 * (3.0 * t * t - 1.0), 0.5 * t * (5.0 * t * t - 3.0)};
}

// A gap with the frames around it from which it is closed. Time runs from -1 to 1 over all of these
// frames.
struct GapFit {
  FrameInterval gap;
  int neighbourhood;

  double Time(int frame) const {
    const double middle = 0.5 * (gap.begin + gap.end - 1);
    return (frame - middle) / (0.5 * gap.size() + neighbourhood);
  }
};

std::optional<Cubic> FitCubic(const GapFit& fit, const std::vector<bool>& seen,
                              const Eigen::Ref<const Eigen::MatrixXd>& positions) {
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Cubic right = Cubic::Zero();
  const auto add_side = [&](int begin, int end) {
    int count = 0;
    for (int frame = std::max(begin, 0); frame < std::min<int>(end, positions.rows()); ++frame) {
      if (!seen[frame]) continue;
      const Eigen::Vector4d basis = Basis(fit.Time(frame));
      normal += basis * basis.transpose();
      right += basis * positions.row(frame);
      ++count;
    }
    return count >= kLeastSeenOnASide;
  };
  const bool before = add_side(fit.gap.begin - fit.neighbourhood, fit.gap.begin);
  const bool after = add_side(fit.gap.end, fit.gap.end + fit.neighbourhood);
  if (!before || !after) return std::nullopt;
  return normal.ldlt().solve(right);
}

MarkerSmoothing FillMarker(int longest_fill, int neighbourhood,
                           Eigen::Ref<Eigen::MatrixXd> positions) {
  const int frames = static_cast<int>(positions.rows());
  std::vector<bool> seen(frames);
  for (int frame = 0; frame < frames; ++frame) seen[frame] = positions.row(frame).allFinite();
  MarkerSmoothing report;
  report.frames_seen = static_cast<int>(std::count(seen.begin(), seen.end(), true));
  for (const FrameInterval& gap : RunsWhere(frames, [&](int frame) { return !seen[frame]; })) {
    InterruptionPoint();
    const GapFit fit{gap, neighbourhood};
    std::optional<Cubic> cubic;
    if (gap.size() <= longest_fill) cubic = FitCubic(fit, seen, positions);
    if (!cubic) {
      report.open.push_back(gap);
      continue;
    }
    for (int frame = gap.begin; frame < gap.end; ++frame) {
      positions.row(frame) = Basis(fit.Time(frame)).transpose() * *cubic;
    }
    report.filled.push_back(gap);
  }
  return report;
}

}  // namespace

std::vector<MarkerSmoothing> FillGaps(double longest_fill_s, MarkerTrajectories& trajectories) {
  // The slack makes 0.2 s at 100 Hz 20 frames, whatever the product rounds to.
  const int longest_fill =
      static_cast<int>(std::floor(longest_fill_s * trajectories.rate_hz + 1e-6));
  const int neighbourhood = std::max(
      kLeastNeighbourhood, static_cast<int>(std::lround(kNeighbourhood_s * trajectories.rate_hz)));
  std::vector<MarkerSmoothing> reports;
  for (int marker = 0; marker < trajectories.marker_count(); ++marker) {
    reports.push_back(
        FillMarker(longest_fill, neighbourhood, trajectories.positions.middleCols<3>(3 * marker)));
  }
  return reports;
}

std::vector<std::vector<FrameInterval>> FilterPieces(const SecondOrderSections& sections,
                                                     MarkerTrajectories& trajectories) {
  const int padding = FiltFiltPadding(sections);
  std::vector<std::vector<FrameInterval>> dropped(trajectories.marker_count());
  for (int marker = 0; marker < trajectories.marker_count(); ++marker) {
    const auto pieces = RunsWhere(trajectories.frame_count(),
                                  [&](int frame) { return Seen(trajectories, frame, marker); });
    for (const FrameInterval& piece : pieces) {
      auto block = trajectories.positions.block(piece.begin, 3 * marker, piece.size(), 3);
      if (piece.size() > padding) {
        FiltFilt(sections, block);
      } else {
        block.setConstant(kNaN);
        dropped[marker].push_back(piece);
      }
    }
  }
  return dropped;
}

std::vector<MarkerSmoothing> SmoothTrajectories(const SmoothingOptions& options,
                                                MarkerTrajectories& trajectories) {
  const SecondOrderSections sections =
      ButterworthLowPass(options.filter_order, options.cutoff_hz, trajectories.rate_hz);
  std::vector<MarkerSmoothing> reports = FillGaps(options.longest_fill_s, trajectories);
  std::vector<std::vector<FrameInterval>> dropped = FilterPieces(sections, trajectories);
  for (std::size_t marker = 0; marker < reports.size(); ++marker) {
    reports[marker].dropped = std::move(dropped[marker]);
  }
  return reports;
}

bool Seen(const MarkerTrajectories& trajectories, int frame, int marker) {
  return trajectories.positions.block<1, 3>(frame, 3 * marker).allFinite();
}

}  // namespace elastocal
