// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/lag_change.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include "elastocal/math/interruption.hpp"
#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

constexpr int kLeastBlocks = 12;        // fewer do not tell a standard deviation
constexpr int kWeightings = 4;          // rounds of weights and estimates
constexpr double kLeastFollowed = 0.5;  // share of a marker's motion that the log must explain
constexpr double kFloor_m = 0.05e-3;    // added in squares to a marker's residual in its weight
constexpr Eigen::Index kLeastMoments = 20;

using Indices = std::vector<Eigen::Index>;

// One marker in the moments in which it is seen. Rows: x, y, z of the first of these, and so on.
struct Equations {
  Indices moments;
  std::vector<int> unknowns;  // unknowns of its shapes, then level and slope of the lag
  Eigen::MatrixXd rows;       // derivatives by `unknowns`
  Eigen::VectorXd off;        // measured minus predicted
  double variation = 0.0;     // of the measured coordinates about their means, m^2
  Eigen::MatrixXd normal;     // rows^T rows
  Eigen::VectorXd right;      // rows^T off
};

// Rows of one marker in a matrix of moments x 3 markers, one coordinate below the other.
Eigen::VectorXd Stacked(const Eigen::MatrixXd& all, const Indices& moments, Eigen::Index marker) {
  return all(moments, Eigen::seqN(3 * marker, 3)).transpose().reshaped();
}

std::optional<Equations> MakeEquations(const MarkerMotion& motion, Eigen::Index marker,
                                       double middle_s, Eigen::Index lags) {
  InterruptionPoint();
  Equations made;
  for (Eigen::Index i = 0; i < motion.time_s.size(); ++i) {
    if (!std::isnan(motion.measured(i, 3 * marker))) made.moments.push_back(i);
  }
  const auto count = static_cast<Eigen::Index>(made.moments.size());
  if (count < kLeastMoments) return std::nullopt;
  const MarkerMotion::Shapes& shapes = motion.shapes[Size(marker)];
  made.unknowns = shapes.unknowns;
  for (Eigen::Index k = 0; k < lags; ++k) {
    made.unknowns.push_back(static_cast<int>(motion.prior_sd.size() + k));
  }
  made.rows.resize(3 * count, std::ssize(made.unknowns));
  const Eigen::VectorXd slower = -Stacked(motion.velocity, made.moments, marker);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Index moment = made.moments[Size(i)];
    auto rows = made.rows.middleRows<3>(3 * i);
    rows.leftCols(shapes.derivatives.cols()) = shapes.derivatives.middleRows<3>(3 * moment);
    rows.col(shapes.derivatives.cols()) = slower.segment<3>(3 * i);
    if (lags > 1)
      rows.rightCols<1>() = (motion.time_s[moment] - middle_s) * slower.segment<3>(3 * i);
  }
  const Eigen::VectorXd measured = Stacked(motion.measured, made.moments, marker);
  made.off = measured - Stacked(motion.predicted, made.moments, marker);
  const Eigen::Map<const Eigen::Matrix3Xd> points(measured.data(), 3, count);
  made.variation = (points.colwise() - points.rowwise().mean()).squaredNorm();
  made.normal = made.rows.transpose() * made.rows;
  made.right = made.rows.transpose() * made.off;
  return made;
}

/// The estimate of all unknowns: those of the shapes, then level and slope of the lag.
class Estimate {
 public:
  Estimate(const MarkerMotion& motion, std::vector<Equations> equations, Eigen::Index lags)
      : motion_(motion), equations_(std::move(equations)), lags_(lags) {
    unknowns_.setZero(motion.prior_sd.size() + lags);
  }

  // Weights the markers and solves for all unknowns; false if the motion does not tell the lag.
  bool Solve() {
    const Eigen::Index count = unknowns_.size();
    Eigen::MatrixXd N = Eigen::MatrixXd::Zero(count, count);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
    N.diagonal().head(count - lags_) = motion_.prior_sd.cwiseAbs2().cwiseInverse();
    weights_.clear();
    for (const Equations& of : equations_) {
      weights_.push_back(
          1.0 / (SquaresLeft(of) / static_cast<double>(of.off.size()) + kFloor_m * kFloor_m));
      N(of.unknowns, of.unknowns) += weights_.back() * of.normal;
      right(of.unknowns) += weights_.back() * of.right;
    }
    const Eigen::LDLT<Eigen::MatrixXd> solved(N);
    if (solved.info() != Eigen::Success) return false;
    unknowns_ = solved.solve(right);
    by_lag_ = solved.solve(Eigen::MatrixXd::Identity(count, count).rightCols(lags_));
    return unknowns_.allFinite() && by_lag_.allFinite() &&
           by_lag_.bottomRows(lags_).diagonal().minCoeff() > 0.0;
  }

  // Leaves out markers of whose motion the model explains less than `kLeastFollowed`.
  void LeaveOutStrangers() {
    std::erase_if(equations_, [&](const Equations& of) {
      return SquaresLeft(of) > (1.0 - kLeastFollowed) * of.variation;
    });
  }

  double RmsLeft() const {
    double squares = 0.0, rows = 0.0;
    for (const Equations& of : equations_) {
      squares += SquaresLeft(of);
      rows += static_cast<double>(of.off.size());
    }
    return std::sqrt(squares / rows);
  }

  bool empty() const { return equations_.empty(); }
  Eigen::VectorXd lag() const { return unknowns_.tail(lags_); }

  // Covariance of the lag, by the scatter of the contributions of blocks of time to its estimate.
  std::optional<Eigen::MatrixXd> Covariance(double block_s) const {
    const double start_s = motion_.time_s[0];
    const double length_s = motion_.time_s[motion_.time_s.size() - 1] - start_s;
    Eigen::MatrixXd added =
        Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(length_s / block_s) + 1, lags_);
    for (std::size_t k = 0; k < equations_.size(); ++k) {
      const Equations& of = equations_[k];
      const Eigen::MatrixXd gain = weights_[k] * of.rows * by_lag_(of.unknowns, Eigen::all);
      const Eigen::VectorXd left = of.off - of.rows * unknowns_(of.unknowns);
      for (Eigen::Index row = 0; row < left.size(); ++row) {
        const double since_s = motion_.time_s[of.moments[Size(row / 3)]] - start_s;
        added.row(static_cast<Eigen::Index>(since_s / block_s)) += left[row] * gain.row(row);
      }
    }
    const auto blocks = (added.col(0).array() != 0.0).count();
    if (blocks < kLeastBlocks) return std::nullopt;
    const double spare = static_cast<double>(blocks) / static_cast<double>(blocks - lags_);
    return spare * added.transpose() * added;
  }

 private:
  double SquaresLeft(const Equations& of) const {
    const Eigen::VectorXd at = unknowns_(of.unknowns);
    return std::max(0.0, of.off.squaredNorm() - 2.0 * at.dot(of.right) + at.dot(of.normal * at));
  }

  const MarkerMotion& motion_;
  std::vector<Equations> equations_;
  Eigen::Index lags_;  // 1: the level only; 2: level and slope
  std::vector<double> weights_;
  Eigen::VectorXd unknowns_;
  Eigen::MatrixXd by_lag_;  // columns of the inverse of the normal matrix
};

// Camera time about which the motion is as strong before as after.
double MiddleOfMotion(const MarkerMotion& motion) {
  const Eigen::VectorXd strength = motion.velocity.rowwise().squaredNorm();
  return strength.sum() > 0.0 ? strength.dot(motion.time_s) / strength.sum() : motion.time_s[0];
}

}  // namespace

double LagChange::Sd(double time_s) const {
  return std::hypot(level_sd_s, slope_sd * (time_s - middle_s));
}

std::optional<LagChange> FindLagChange(const MarkerMotion& motion, bool with_slope,
                                       double block_s) {
  if (motion.time_s.size() < 2) return std::nullopt;
  LagChange change;
  change.middle_s = MiddleOfMotion(motion);
  const Eigen::Index lags = with_slope ? 2 : 1;
  std::vector<Equations> equations;
  for (Eigen::Index m = 0; m < motion.measured.cols() / 3; ++m) {
    if (auto of = MakeEquations(motion, m, change.middle_s, lags)) {
      equations.push_back(std::move(*of));
    }
  }
  Estimate estimate(motion, std::move(equations), lags);
  for (int round = 0; round < kWeightings; ++round) {
    if (estimate.empty() || !estimate.Solve()) return std::nullopt;
    if (round == 0) estimate.LeaveOutStrangers();
  }
  const auto covariance = estimate.Covariance(block_s);
  if (!covariance) return std::nullopt;
  change.left_m = estimate.RmsLeft();
  change.level_s = estimate.lag()[0];
  change.level_sd_s = std::sqrt((*covariance)(0, 0));
  if (with_slope) {
    change.slope = estimate.lag()[1];
    change.slope_sd = std::sqrt((*covariance)(1, 1));
  }
  return change;
}

}  // namespace elastocal
