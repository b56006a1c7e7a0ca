#include "elastocal/calibration/displacement_step.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "elastocal/calibration/residuals.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/optim/linearisation.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {
namespace {

constexpr int kLeastPostures = 3;    // on either side
constexpr double kLargestSd = 5e-4;  // m, of a displacement that is believed
constexpr double kVague = 1e-4;  // information that keeps free unknowns from being divided by zero

/// What a displacement of one cluster, in the axes of its link, does in one posture.
struct Push {
  Eigen::Vector3d score = Eigen::Vector3d::Zero();        ///< A' Q r
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  ///< A' Q A
  Eigen::Matrix3Xd cross;                                 ///< A' Q J, 3 x unknowns
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();        ///< sum over its markers, m
  int markers = 0;
};

/// Of one cluster, by posture in which it was seen.
using Pushes = std::map<int, Push>;

/// A fit, linearised: the waist of each posture is eliminated by Q.
struct Linearised {
  std::vector<Pushes> pushes;          ///< by cluster
  Eigen::LLT<Eigen::MatrixXd> factor;  ///< of the information about all other unknowns
  Eigen::VectorXd gradient;            ///< of these, J' Q r
  double squares = 0.0;                ///< sum of squared residuals
};

/// Axes of the links in each posture, in the cameras' frame.
std::vector<std::vector<Transform>> LinkPoses(const FitProblem& problem, const Fit& fit) {
  Geometry geometry = ApplyErrors(problem.model, fit.delta);
  std::vector<std::vector<Transform>> poses;
  for (int i = 0; i < problem.recording.posture_count(); ++i) {
    PlaceWaist(fit.placement.T_ref_waist[i], Vector6d::Zero(), geometry);
    poses.push_back(
        CalibratedLinkTransforms(problem.model, geometry, problem.recording.q.row(i).transpose()));
  }
  return poses;
}

std::vector<int> ClusterOfMarkers(const std::vector<LabelCluster>& clusters, int markers) {
  std::vector<int> cluster_of(markers, -1);
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    for (int m : clusters[c].markers) cluster_of[m] = static_cast<int>(c);
  }
  return cluster_of;
}

class Lineariser {
 public:
  Lineariser(const FitProblem& problem, const Fit& fit, const std::vector<LabelCluster>& clusters)
      : problem_(problem),
        fit_(fit),
        cluster_of_(ClusterOfMarkers(clusters, problem.recording.marker_count())),
        poses_(LinkPoses(problem, fit)) {
    result_.pushes.resize(clusters.size());
  }

  Linearised Run(const Selection& selection, const std::vector<int>& free) {
    const Prior prior = problem_.options.prior.Scaled(fit_.prior_scale);
    const std::vector<PostureLoads> loads = ComputeLoads(
        problem_.model, problem_.recording, fit_.delta, fit_.placement, problem_.options.load);
    BodyResiduals body({problem_.model, problem_.recording, problem_.group, selection.markers,
                        selection.tied, loads, prior, fit_.noise, problem_.options.support_form},
                       free, fit_.delta, fit_.placement);
    const Linearisation linear = Linearise(body, body.Start(), body.WaistBlocks());
    Eigen::MatrixXd information = linear.information;
    information.diagonal().array() += kVague;
    result_.factor.compute(information);
    result_.gradient.setZero(information.rows());
    for (const Linearisation::Group& group : linear.groups) AddGroup(body, group);
    return std::move(result_);
  }

 private:
  void AddGroup(const BodyResiduals& body, const Linearisation::Group& group) {
    Eigen::VectorXd r(group.jacobian.rows());
    std::map<std::pair<int, int>, Eigen::MatrixXd> by_push;  // cluster and posture: A
    for (std::size_t b = 0; b < group.blocks.size(); ++b) {
      const int block = group.blocks[b];
      const int row = group.first_row[b];
      body.Residual(block,
                    Eigen::Map<Eigen::VectorXd>(r.data() + row, body.residual_blocks[block].size));
      if (block >= static_cast<int>(body.meanings().size())) continue;
      const auto [posture, marker] = body.meanings()[block];
      if (marker < 0 || cluster_of_[marker] < 0) continue;
      const double sd = fit_.noise.marker_sd[problem_.group[posture]];
      const Eigen::Matrix3d R = poses_[posture][problem_.model.markers[marker].link].linear();
      const int cluster = cluster_of_[marker];
      const auto [A, added] = by_push.try_emplace({cluster, posture});
      if (added) A->second.setZero(r.size(), 3);
      A->second.middleRows<3>(row) = R / sd;
      Push& push = result_.pushes[cluster][posture];
      push.shift += sd * R.transpose() * r.segment<3>(row);
      ++push.markers;
    }
    result_.squares += r.squaredNorm();
    result_.gradient(group.columns) += group.jacobian.transpose() * r;
    for (const auto& [which, A] : by_push)
      AddPush(group, r, A, result_.pushes[which.first][which.second]);
  }

  void AddPush(const Linearisation::Group& group, const Eigen::VectorXd& r,
               const Eigen::MatrixXd& A, Push& push) const {
    const Eigen::MatrixXd QA =
        group.nuisance.size() > 0 ? Eigen::MatrixXd(A - group.nuisance * A) : A;
    push.score += QA.transpose() * r;
    push.information += QA.transpose() * A;
    if (push.cross.size() == 0) push.cross.setZero(3, result_.gradient.size());
    push.cross(Eigen::all, group.columns) += A.transpose() * group.jacobian;
  }

  const FitProblem& problem_;
  const Fit& fit_;
  std::vector<int> cluster_of_;
  std::vector<std::vector<Transform>> poses_;
  Linearised result_;
};

/// The displacement in those directions in which it is known; elsewhere none.
Eigen::Vector3d KnownDisplacement(const Eigen::Matrix3d& information,
                                  const Eigen::Vector3d& score) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> directions(information);
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();
  for (int i = 0; i < 3; ++i) {
    const double known = directions.eigenvalues()[i];  // sd^-2
    if (!(known > 1.0 / (kLargestSd * kLargestSd))) continue;
    const Eigen::Vector3d along = directions.eigenvectors().col(i);
    displacement += along.dot(score) / known * along;
  }
  return displacement;
}

/// The best step of one cluster; counts those tried.
DisplacementStep BestStep(const Linearised& linear, int cluster, const Eigen::VectorXd& explained,
                          int& tried) {
  const Pushes& pushes = linear.pushes[cluster];
  DisplacementStep best;
  best.cluster = cluster;
  Push after;
  after.cross.setZero(3, explained.size());
  const int count = static_cast<int>(pushes.size());
  int seen = 0;
  for (auto at = pushes.rbegin(); at != pushes.rend(); ++at) {
    after.score += at->second.score;
    after.information += at->second.information;
    after.cross += at->second.cross;
    ++seen;
    if (seen < kLeastPostures || count - seen < kLeastPostures) continue;
    ++tried;
    const Eigen::MatrixXd W = linear.factor.matrixL().solve(after.cross.transpose());
    const Eigen::Matrix3d information = after.information - W.transpose() * W;
    const Eigen::Vector3d score = after.score - W.transpose() * explained;
    const Eigen::Vector3d displacement = KnownDisplacement(information, score);
    const double gain = score.dot(displacement);
    if (!(gain > best.gain)) continue;
    best = {cluster, at->first, std::next(at)->first, displacement, gain, 0.0, 0.0};
  }
  return best;
}

/// Of the cluster about its mean before and that after the step, m per axis.
double Scatter(const Pushes& pushes, const DisplacementStep& step) {
  Eigen::Vector3d mean[2] = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  double count[2] = {0.0, 0.0};
  for (const auto& [posture, push] : pushes) {
    const int side = posture < step.posture ? 0 : 1;
    mean[side] += push.shift / push.markers;
    count[side] += 1.0;
  }
  double squares = 0.0;
  for (const auto& [posture, push] : pushes) {
    const int side = posture < step.posture ? 0 : 1;
    squares += (push.shift / push.markers - mean[side] / count[side]).squaredNorm();
  }
  return std::sqrt(squares / (3.0 * (count[0] + count[1] - 2.0)));
}

/// Of the three numbers of a step among `tried` ones.
double Significance(const Linearised& linear, double gain, double freedom, double level) {
  if (std::isinf(freedom)) return gain / ChiSquareQuantile(level, 3.0);
  if (freedom < 1.0) return 0.0;
  const double rest = std::max(linear.squares - gain, 1e-12 * linear.squares);
  return gain / 3.0 / (rest / freedom) / FisherQuantile(level, 3.0, freedom);
}

}  // namespace

DisplacementStep FindLargestStep(const FitProblem& problem, const Selection& selection,
                                 const std::vector<int>& free, const Fit& fit,
                                 const std::vector<LabelCluster>& clusters, double probability) {
  const Linearised linear = Lineariser(problem, fit, clusters).Run(selection, free);
  const Eigen::VectorXd explained = linear.factor.matrixL().solve(linear.gradient);
  DisplacementStep best;
  int tried = 0;
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    const DisplacementStep step = BestStep(linear, static_cast<int>(c), explained, tried);
    if (step.gain > best.gain) best = step;
  }
  if (best.cluster < 0) return best;
  best.scatter = Scatter(linear.pushes[best.cluster], best);
  best.significance =
      Significance(linear, best.gain, fit.degrees_of_freedom - 3.0, 1.0 - probability / tried);
  return best;
}

}  // namespace elastocal
