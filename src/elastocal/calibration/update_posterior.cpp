// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <Eigen/SparseCore>

#include "elastocal/calibration/fit.hpp"
#include "elastocal/calibration/variances.hpp"
#include "elastocal/measurement/moments.hpp"

namespace elastocal {
namespace {

constexpr double kLeastLeft = 0.05;  // smallest share of the variance of a row

/// Cluster of each posture: one each, but in a motion up to twice `samples_each` consecutive
/// moments form one.
std::vector<int> ClusterOfPostures(const FitProblem& problem, const Noise& noise) {
  const std::vector<int> motion = MotionOfPostures(problem.recording);
  std::vector<int> cluster(motion.size());
  int size = 0;
  const auto samples_each = [&](int posture) {
    const MotionCorrelation& of = noise.motion[problem.group[posture]];
    return std::max(of.bodies.samples_each, of.waist.samples_each);
  };
  for (int i = 0; i < static_cast<int>(motion.size()); ++i) {
    const bool joins = i > 0 && !noise.motion.empty() && motion[i] >= 0 &&
                       motion[i] == motion[i - 1] && size < 2.0 * samples_each(i);
    cluster[i] = i == 0 ? 0 : cluster[i - 1] + (joins ? 0 : 1);
    size = joins ? size + 1 : 1;
  }
  return cluster;
}

/// Cluster of each residual block; -1 for floor and priors.
std::vector<int> ClusterOfBlocks(const std::vector<int>& cluster, const Selection& selection,
                                 const BodyResiduals& body) {
  std::vector<int> of_block;
  for (const BodyObservation& of : selection.bodies) of_block.push_back(cluster[of.posture]);
  for (int i : body.tied_postures()) of_block.push_back(cluster[i]);
  of_block.resize(body.residual_blocks.size(), -1);
  return of_block;
}

/// Information of the prior in the units of the solver: on the parameters, then on the poses.
Eigen::SparseMatrix<double> PriorInformation(const FitProblem& problem, const Prior& prior,
                                             const std::vector<int>& parameters,
                                             Eigen::Index unknowns) {
  Eigen::VectorXd own =
      Eigen::VectorXd::Constant(unknowns, BodyResiduals::kPoseScale * BodyResiduals::kPoseScale);
  Eigen::VectorXd unit(static_cast<Eigen::Index>(parameters.size()));
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const Parameter& parameter = problem.model.parameters[parameters[i]];
    const auto at = static_cast<Eigen::Index>(i);
    unit[at] = ParameterScale(parameter);
    own[at] = std::pow(unit[at] / prior.Of(problem.model.tree, parameter), 2);
  }
  const EarlierPart earlier = PartOf(problem.options.earlier, problem.model, parameters);
  if (earlier.positions.empty()) return Eigen::SparseMatrix<double>(own.asDiagonal());
  Eigen::MatrixXd information = own.asDiagonal();
  const Eigen::VectorXd scale = unit(earlier.positions);
  information(earlier.positions, earlier.positions) =
      scale.asDiagonal() * earlier.Information() * scale.asDiagonal();
  return information.sparseView();
}

/// Compares the covariance with the cluster-robust (sandwich) estimator, whose clusters are those
/// of ClusterOfPostures. Residuals r are divided by the root of the share of their variance that
/// the fit leaves (HC2), and C (sum J' r r' J) C is compared with C J' J C. If the postures scatter
/// more than the noise model says, on average over the robot's parameters, the data's part of the
/// covariance is multiplied by that ratio.
void WidenByClusters(const FitProblem& problem, const FitResiduals& residuals,
                     const Selection& selection, const NormalEquations& equations,
                     const Eigen::MatrixXd& covariance,
                     const std::vector<Eigen::VectorXd>& explained, Fit& fit) {
  const BodyResiduals& body = residuals.body;
  std::vector<Eigen::VectorXd> raised;
  for (std::size_t block = 0; block < explained.size(); ++block) {
    const Eigen::ArrayXd left = (1.0 - explained[block].array()).max(kLeastLeft);
    raised.emplace_back(body.Residual(static_cast<int>(block)).array() / left.sqrt());
  }
  const std::vector<int> cluster = ClusterOfPostures(problem, residuals.noise);
  const Eigen::MatrixXd scores = equations.Scores(raised, ClusterOfBlocks(cluster, selection, body),
                                                  cluster.empty() ? 0 : cluster.back() + 1);
  const std::vector<int>& parameters = fit.posterior.parameters;
  const auto count = static_cast<Eigen::Index>(parameters.size());
  const Eigen::MatrixXd by_prior =
      PriorInformation(problem, residuals.prior, parameters, covariance.rows()) *
      covariance.leftCols(count);
  const Eigen::MatrixXd by_data =
      covariance.topLeftCorner(count, count) - covariance.topRows(count) * by_prior;
  const Eigen::VectorXd by_clusters = (covariance * scores).rowwise().squaredNorm();
  double expected = 0.0;
  double found = 0.0;
  for (Eigen::Index i = 0; i < count; ++i) {
    if (IsExternal(problem.model.parameters[parameters[i]].kind)) continue;
    expected += by_data(i, i) / covariance(i, i);
    found += by_clusters[i] / covariance(i, i);
  }
  fit.posterior.cluster_factor = expected > 0.0 ? found / expected : 1.0;
  if (!(fit.posterior.cluster_factor > 1.0)) return;
  fit.posterior.covariance += ParameterCovariance(problem.model, parameters,
                                                  (fit.posterior.cluster_factor - 1.0) * by_data);
}

/// Information of the data on the parameters, without the prior, after the poses of waist and feet
/// are eliminated.
Eigen::MatrixXd DataInformation(const FitProblem& problem, const Prior& prior,
                                const std::vector<int>& parameters,
                                const NormalEquations& equations) {
  const auto count = static_cast<Eigen::Index>(parameters.size());
  const Eigen::Index poses = equations.information().rows() - count;
  Eigen::MatrixXd information = equations.information();
  information -= PriorInformation(problem, prior, parameters, information.rows());
  Eigen::MatrixXd own = information.topLeftCorner(count, count);
  if (poses > 0) {
    const auto across = information.topRightCorner(count, poses);
    own -= across * information.bottomRightCorner(poses, poses).ldlt().solve(across.transpose());
  }
  Eigen::VectorXd scale(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    scale[i] = ParameterScale(problem.model.parameters[parameters[i]]);
  }
  return scale.cwiseInverse().asDiagonal() * own * scale.cwiseInverse().asDiagonal();
}

}  // namespace

Eigen::MatrixXd TakeCovariance(const FitProblem& problem, const std::vector<int>& parameters,
                               const NormalEquations& equations, Fit& fit) {
  const Eigen::MatrixXd covariance = InverseOfInformation(equations.information());
  fit.posterior.parameters = parameters;
  fit.posterior.covariance = ParameterCovariance(problem.model, parameters, covariance);
  return covariance;
}

void UpdatePosterior(const FitProblem& problem, const Selection& selection,
                     const std::vector<int>& parameters, Fit& fit) {
  FitResiduals residuals(problem, selection, parameters, fit);
  BodyResiduals& body = residuals.body;
  body.Evaluate(body.Start(), true);
  const NormalEquations equations(body);
  const Eigen::MatrixXd covariance = TakeCovariance(problem, parameters, equations, fit);
  const ExplainedRows explained = equations.ExplainedVariances(covariance);
  fit.degrees_of_freedom = DegreesOfFreedom(
      problem.options, CollectComponents(problem, selection, fit.noise, body, explained));
  fit.posterior.effective_parameters = 0.0;
  const int observations = body.body_count() + static_cast<int>(body.tied_postures().size());
  for (int block = 0; block < observations; ++block) {
    if (body.residual_blocks[block].active) {
      fit.posterior.effective_parameters += explained.all[block].sum();
    }
  }
  WidenByClusters(problem, residuals, selection, equations, covariance, explained.all, fit);
  fit.posterior.data_information = DataInformation(problem, residuals.prior, parameters, equations);
}

}  // namespace elastocal
