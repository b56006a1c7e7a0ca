// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/outliers.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "elastocal/math/decompositions.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {
namespace {

constexpr double kLeastVariance = 0.05;
constexpr double kTailFreedom = 4.0;  // of Student's distribution, beyond which an error is gross
// Smallest number of markers on a body of which one can be judged wrong.
constexpr std::size_t kLeastMarkers = 3;
// Smallest squared effect of a displacement on the shape, relative.
constexpr double kLeastReach = 1e-3;
constexpr double kRoughExcess = 0.25;  // smallest excess that the fit's share could raise to 1

/// Squared Mahalanobis distance in units of the noise. Variances are at least a share of the
/// largest: an observation that alone determines a parameter has a residual of zero and a variance
/// of zero.
double SquaredDistance(const Eigen::VectorXd& residual, const Eigen::MatrixXd& covariance) {
  const SymmetricDecomposition eigen = DecomposeSymmetric(covariance);
  const double largest = eigen.values.tail<1>()[0];
  const Eigen::ArrayXd variances = eigen.values.array().max(kLeastVariance * largest);
  return ((eigen.vectors.transpose() * residual).array().square() / variances).sum();
}

/// Limit of the squared distance of `size` numbers whose variance was estimated with `freedom`
/// degrees of freedom.
double Threshold(double level, double size, double freedom) {
  return std::isinf(freedom) ? ChiSquareQuantile(level, size)
                             : size * FisherQuantile(level, size, freedom);
}

class OutlierSearch {
 public:
  OutlierSearch(const FitProblem& problem, const Selection& selection, const std::vector<int>& free,
                const Fit& fit, double probability)
      : problem_(problem),
        selection_(selection),
        fit_(fit),
        residuals_(problem, selection, free, fit) {
    residuals_.body.Evaluate(residuals_.body.Start(), true);
    equations_.emplace(residuals_.body);
    covariance_ = InverseOfInformation(equations_->information());
    const double tests = std::max<double>(1.0, static_cast<double>(selection.bodies.size()));
    level_ = 1.0 - probability / tests;
    marker_level_ = 1.0 - probability / std::max<double>(1.0, Observations());
  }

  OutlierVerdict Run() {
    for (int b = 0; b < residuals_.body.body_count(); ++b) {
      if (selection_.bodies[b].used) {
        Judge(b);
      } else {
        JudgeLeftOut(b);
      }
    }
    for (std::size_t t = 0; t < residuals_.body.tied_postures().size(); ++t) {
      JudgeTie(residuals_.body.TieBlock(static_cast<int>(t)), residuals_.body.tied_postures()[t]);
    }
    std::sort(verdict_.markers.begin(), verdict_.markers.end(),
              [](const Outlier& a, const Outlier& b) {
                return std::pair(a.posture, a.marker) < std::pair(b.posture, b.marker);
              });
    return std::move(verdict_);
  }

 private:
  double Observations() const {
    std::size_t markers = 0;
    for (const BodyObservation& body : selection_.bodies) markers += body.markers.size();
    return static_cast<double>(markers);
  }

  /// Residuals of a body's markers, m.
  Eigen::VectorXd Raw(int b) const {
    return selection_.bodies[b].basis *
           residuals_.body.Residual(b).cwiseProduct(residuals_.body.Sds(b));
  }

  void Name(int b, std::size_t n, double square) {
    const BodyObservation& body = selection_.bodies[b];
    verdict_.markers.push_back({body.posture, body.markers[n],
                                Raw(b).segment<3>(3 * static_cast<Eigen::Index>(n)).norm(),
                                std::sqrt(square)});
  }

  /// Squared distance of a body's shared rows by the noise alone, without weights.
  double SharedSquare(int b) const {
    const BodyObservation& body = selection_.bodies[b];
    const Eigen::ArrayXd squares =
        (residuals_.body.Residual(b).array() * residuals_.body.Sds(b).array()).square() /
        body.Variances(fit_.noise, problem_.group[body.posture]);
    return squares.head(body.shared_rows()).sum();
  }

  /// Applies the limit for heavy tails. The fit reduces the variance of what it used and increases
  /// that of what was left out.
  bool IsGross(double square, Eigen::Index rows, double explained, bool used) {
    const auto size = static_cast<double>(rows);
    const double share = std::min(1.0 - kLeastVariance, explained / size);
    const double variance = used ? 1.0 - share : 1.0 + share;
    const auto [limit, added] = gross_limits_.try_emplace(rows);
    if (added) limit->second = size * FisherQuantile(level_, size, kTailFreedom);
    return square / variance > limit->second;
  }

  /// Limit of the squared distance of a marker in `rank` directions.
  double MarkerLimit(Eigen::Index rank) {
    const auto [limit, added] = marker_limits_.try_emplace(rank);
    if (added) {
      limit->second = Threshold(marker_level_, static_cast<double>(rank), fit_.degrees_of_freedom);
    }
    return limit->second;
  }

  void Judge(int b) {
    const BodyObservation& body = selection_.bodies[b];
    const Eigen::Index shared = body.shared_rows();
    std::vector<char> wrong(body.markers.size(), 0);
    if (body.markers.size() >= kLeastMarkers) {
      FindContradictions(b, wrong);
    }
    if (std::find(wrong.begin(), wrong.end(), 1) != wrong.end()) return;
    const double square = SharedSquare(b);
    if (!IsGross(square, shared, 0.0, true)) {
      if (square < static_cast<double>(shared)) return;
      const double explained = equations_->Explained(b, covariance_).diagonal().head(shared).sum();
      if (!IsGross(square, shared, explained, true)) return;
    }
    for (std::size_t n = 0; n < body.markers.size(); ++n) Name(b, n, square);
  }

  /// Finds the marker whose own displacement explains most of the body's change of shape, then the
  /// next beside it, and so on.
  void FindContradictions(int b, std::vector<char>& wrong) {
    const Eigen::Index shared = selection_.bodies[b].shared_rows();
    const Eigen::Index own = residuals_.body.Residual(b).size() - shared;
    Eigen::VectorXd z = residuals_.body.Residual(b).tail(own);
    Eigen::MatrixXd P = Eigen::MatrixXd::Identity(own, own);
    // A displacement smaller than the shared error of the whole body does not matter.
    const double least =
        fit_.noise(problem_.group[selection_.bodies[b].posture], NoiseSource::kBodyPosition);
    bool rough = true;  // the first round leaves out what the fit explains, which takes most time
    for (std::size_t left = wrong.size(); left >= kLeastMarkers;) {
      std::size_t worst = wrong.size();
      ShapeTest largest;
      for (std::size_t n = 0; n < wrong.size(); ++n) {
        if (wrong[n] != 0) continue;
        const ShapeTest test = TestShape(Displacement(b, n).bottomRows(own), z, P);
        if (!(test.excess > largest.excess) || !(test.displacement > least)) continue;
        largest = test;
        worst = n;
      }
      if (rough) {
        if (!(largest.excess > kRoughExcess)) return;
        rough = false;
        P -= equations_->Explained(b, covariance_).bottomRightCorner(own, own);
        continue;
      }
      if (!(largest.excess > 1.0)) return;
      wrong[worst] = 1;
      Name(b, worst, largest.square);
      const Eigen::MatrixXd M = Displacement(b, worst).bottomRows(own);
      // M' P M is singular in directions that do not change the shape.
      const SymmetricDecomposition reach = DecomposeSymmetric(M.transpose() * P * M);
      const Eigen::ArrayXd sizes = reach.values.array();
      const Eigen::VectorXd inverse =
          (sizes > kLeastReach * sizes.maxCoeff()).select(sizes.inverse(), 0.0);
      const Eigen::MatrixXd gain =
          reach.vectors * inverse.asDiagonal() * reach.vectors.transpose() * M.transpose();
      z -= P * M * (gain * z);
      P -= Eigen::MatrixXd(P * M * gain * P);
      --left;
    }
  }

  struct ShapeTest {
    double square = 0.0;        ///< squared Mahalanobis distance
    double excess = 0.0;        ///< over its threshold
    double displacement = 0.0;  ///< of the marker in its directions, m
  };

  /// Tests a displacement M in the rows z with covariance P. Directions that do not change the
  /// shape (with three markers: across their plane) are left out.
  ShapeTest TestShape(const Eigen::MatrixXd& M, const Eigen::VectorXd& z,
                      const Eigen::MatrixXd& P) {
    const SymmetricDecomposition reach = DecomposeSymmetric(M.transpose() * M);
    const Eigen::ArrayXd sizes = reach.values.array();
    const Eigen::Index rank = (sizes > kLeastReach * sizes.maxCoeff()).count();
    if (rank == 0 || !(sizes.maxCoeff() > 0.0)) return {};
    const Eigen::MatrixXd along = M * reach.vectors.rightCols(rank);
    ShapeTest test;
    test.square = SquaredDistance(along.transpose() * z, along.transpose() * P * along);
    test.displacement = (along.transpose() * along).ldlt().solve(along.transpose() * z).norm();
    test.excess = test.square / MarkerLimit(rank);
    return test;
  }

  /// Effect of displacing one marker of a body, in the rows of the body's residual block.
  Eigen::MatrixXd Displacement(int b, std::size_t n) const {
    Eigen::MatrixXd at = Eigen::MatrixXd::Zero(residuals_.body.Residual(b).size(), 3);
    at.middleRows<3>(3 * static_cast<Eigen::Index>(n)).setIdentity();
    return residuals_.body.Whiten(b, at);
  }

  /// Names a marker that was left out again if it is still off: from the position that the used
  /// markers of its body predict (two or more), else from the model.
  void JudgeLeftOut(int b) {
    const BodyObservation& body = selection_.bodies[b];
    const auto others = std::find_if(
        selection_.bodies.begin(), selection_.bodies.end(), [&](const BodyObservation& other) {
          return other.used && other.posture == body.posture && other.body == body.body;
        });
    const Eigen::Matrix3d explained = residuals_.body.Sds(b).asDiagonal() *
                                      equations_->Explained(b, covariance_) *
                                      residuals_.body.Sds(b).asDiagonal();
    const Eigen::Vector3d raw = Raw(b);
    if (others == selection_.bodies.end() || others->markers.size() < 2) {
      const double variance = residuals_.body.Sds(b).array().square().mean();
      const double square = raw.squaredNorm() / variance;
      if (IsGross(square, 3, explained.trace() / variance, false)) Name(b, 0, square);
      return;
    }
    Eigen::Vector3d expected;
    Eigen::Matrix3d covariance;
    Predict(static_cast<int>(others - selection_.bodies.begin()), expected, covariance);
    const double square = SquaredDistance(raw - expected, covariance + explained);
    if (square > MarkerLimit(3)) Name(b, 0, square);
  }

  /// Residual of a marker that the other markers of its body predict, with its covariance.
  void Predict(int others, Eigen::Vector3d& expected, Eigen::Matrix3d& covariance) const {
    const BodyObservation& of = selection_.bodies[others];
    const int group = problem_.group[of.posture];
    const auto count = static_cast<Eigen::Index>(of.markers.size());
    const double white = fit_.noise.Variance(group, NoiseSource::kMarker);
    const double shared = fit_.noise.Variance(group, NoiseSource::kBodyPosition);
    // The mean of the others, reduced to the share that is a displacement of the body.
    const double gain = shared / (shared + white / static_cast<double>(count));
    expected = gain * Raw(others).reshaped(3, count).rowwise().mean();
    covariance = (shared * (1.0 - gain) + white) * Eigen::Matrix3d::Identity();
  }

  void JudgeTie(int block, int posture) {
    const bool used = selection_.tied[posture] != 0;
    const int group = problem_.group[posture];
    Eigen::ArrayXd sds(6);
    sds.head<3>().setConstant(fit_.noise(group, NoiseSource::kWaistPosition));
    sds.tail<3>().setConstant(fit_.noise(group, NoiseSource::kWaistRotation));
    const Eigen::ArrayXd raw =
        residuals_.body.Residual(block).array() * residuals_.body.Sds(block).array();
    const double square = (raw / sds).square().sum();
    if (square < 6.0) return;
    const double explained = equations_->Explained(block, covariance_).trace();
    if (!IsGross(square, 6, explained, used)) return;
    verdict_.footings.push_back({posture, raw.head<3>().matrix().norm(), std::sqrt(square)});
  }

  const FitProblem& problem_;
  const Selection& selection_;
  const Fit& fit_;
  FitResiduals residuals_;
  std::optional<NormalEquations> equations_;
  Eigen::MatrixXd covariance_;
  double level_ = 0.0, marker_level_ = 0.0;
  // by number of rows, because quantiles take long
  std::map<Eigen::Index, double> gross_limits_, marker_limits_;
  OutlierVerdict verdict_;
};

}  // namespace

Eigen::MatrixXd PredictedPositions(const ErrorModel& model, const Recording& recording,
                                   const Eigen::VectorXd& delta,
                                   const CalibrationOptions& options) {
  const Geometry geometry = ApplyErrors(model, delta);
  const std::vector<PostureLoads> loads = ComputeLoads(model, recording, delta, {}, options.load);
  Eigen::MatrixXd positions(recording.posture_count(), recording.markers.cols());
  for (int i = 0; i < positions.rows(); ++i) {
    positions.row(i) =
        MarkerPositions(model, geometry, recording.q.row(i).transpose(), loads[i].joints)
            .reshaped()
            .transpose();
  }
  return positions;
}

Eigen::MatrixXd MarkerDistances(const Recording& recording, const Eigen::MatrixXd& positions) {
  Eigen::MatrixXd distances(recording.posture_count(), recording.marker_count());
  for (int m = 0; m < distances.cols(); ++m) {
    distances.col(m) = (recording.markers - positions).middleCols<3>(3 * m).rowwise().norm();
  }
  return distances;
}

Eigen::MatrixXd ResidualNorms(const ErrorModel& model, const Recording& recording,
                              const Eigen::VectorXd& delta, const CalibrationOptions& options) {
  return MarkerDistances(recording, PredictedPositions(model, recording, delta, options));
}

OutlierVerdict FindOutliers(const FitProblem& problem, const Selection& selection,
                            const std::vector<int>& free, const Fit& fit, double probability) {
  return OutlierSearch(problem, selection, free, fit, probability).Run();
}

std::vector<ShortModel> FindShortModels(const FitProblem& problem, const Selection& selection,
                                        const Fit& fit) {
  FitResiduals residuals(problem, selection, {}, fit);
  residuals.body.Evaluate(residuals.body.Start(), false);
  std::vector<ShortModel> found;
  for (int b = 0; b < residuals.body.body_count(); ++b) {
    const BodyObservation& body = selection.bodies[b];
    if (!body.used || fit.weights.bodies.empty() || fit.weights.bodies[b].shared >= 1.0) continue;
    const Eigen::ArrayXd raw = residuals.body.Residual(b).array() * residuals.body.Sds(b).array();
    const Eigen::ArrayXd squares =
        raw.square() / body.Variances(fit.noise, problem.group[body.posture]);
    found.push_back({body.posture, body.body,
                     std::sqrt(raw.square().sum() / static_cast<double>(body.markers.size())),
                     std::sqrt(squares.head(body.shared_rows()).sum()),
                     fit.weights.bodies[b].shared});
  }
  std::stable_sort(found.begin(), found.end(), [](const ShortModel& a, const ShortModel& b) {
    return a.normalised > b.normalised;
  });
  return found;
}

}  // namespace elastocal
