#include "elastocal/calibration/knocks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <Eigen/Cholesky>

#include "elastocal/calibration/fit.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/optim/linearisation.hpp"
#include "elastocal/robot/kinematics.hpp"

namespace elastocal {
namespace {

constexpr int kMaxKnocks = 4;
constexpr int kFewUpdates = 2;           // of the noise
constexpr int kLeastPostures = 3;        // on either side
constexpr double kLeastDistance = 1e-3;  // m
constexpr double kLeastScatters = 3.0;
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

std::vector<int> Estimated(const ErrorModel& model, const BaseParameters& base) {
  std::vector<int> free;
  for (int i : base.kept) {
    if (model.parameters[i].kind != ParameterKind::kBase) free.push_back(i);
  }
  return free;
}

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

/// A cluster displaced from a posture on.
struct Step {
  int cluster = -1;
  int posture = 0, last_before = 0;
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< in the link's axes, m
  double gain = 0.0;                                       ///< by which the sum of squares drops
};

/// The best step of one cluster; counts those tried.
Step BestStep(const Linearised& linear, int cluster, const Eigen::VectorXd& explained, int& tried) {
  const Pushes& pushes = linear.pushes[cluster];
  Step best;
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
    const Eigen::LLT<Eigen::Matrix3d> factor(information + kVague * Eigen::Matrix3d::Identity());
    const Eigen::Vector3d displacement = factor.solve(score);
    const double gain = score.dot(displacement);
    if (!(gain > best.gain)) continue;
    best = {cluster, at->first, std::next(at)->first, displacement, gain};
  }
  return best;
}

/// Of the cluster about its mean before and that after the step, m per axis.
double Scatter(const Pushes& pushes, const Step& step) {
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

/// The step that explains most, if it is a knock; else of no cluster.
Step FindStep(const Linearised& linear, const Fit& fit, double probability, double& significance) {
  const Eigen::VectorXd explained = linear.factor.matrixL().solve(linear.gradient);
  Step best;
  int tried = 0;
  for (std::size_t c = 0; c < linear.pushes.size(); ++c) {
    const Step step = BestStep(linear, static_cast<int>(c), explained, tried);
    if (step.gain > best.gain) best = step;
  }
  if (best.cluster < 0) return {};
  const double level = 1.0 - probability / tried;
  const double freedom = fit.degrees_of_freedom - 3.0;
  if (std::isinf(freedom)) {
    significance = best.gain / ChiSquareQuantile(level, 3.0);
  } else {
    const double rest = std::max(linear.squares - best.gain, 1e-12 * linear.squares);
    significance = freedom < 1.0
                       ? 0.0
                       : best.gain / 3.0 / (rest / freedom) / FisherQuantile(level, 3.0, freedom);
  }
  const double distance = best.displacement.norm();
  const double scatter = Scatter(linear.pushes[best.cluster], best);
  const bool knocked =
      significance > 1.0 && distance >= kLeastDistance && distance >= kLeastScatters * scatter;
  return knocked ? best : Step();
}

bool SeenOnBothSides(const Recording& recording, int marker, int posture) {
  bool sides[2] = {false, false};
  for (int i = 0; i < recording.posture_count(); ++i) {
    if (Seen(recording, i, marker)) sides[i < posture ? 0 : 1] = true;
  }
  return sides[0] && sides[1];
}

std::string NameBefore(const std::string& name, const std::vector<std::string>& taken) {
  for (int n = 1;; ++n) {
    std::string candidate = name + (n == 1 ? "(before)" : "(before " + std::to_string(n) + ")");
    if (std::find(taken.begin(), taken.end(), candidate) == taken.end()) return candidate;
  }
}

/// Of each new marker: that which it was split from.
std::vector<int> SplitOne(const Knock& knock, ErrorModel& model, Recording& recording) {
  std::vector<int> origins;
  ErrorModel extended = model;
  for (int m : knock.markers) {
    if (!SeenOnBothSides(recording, m, knock.posture)) continue;
    origins.push_back(m);
    extended.markers.push_back(model.markers[m]);
    Marker& before = extended.markers.back();
    before.name = NameBefore(before.name, recording.marker_names);
    recording.marker_names.push_back(before.name);
    Eigen::MatrixXd column = recording.markers.middleCols<3>(3 * m);
    const Eigen::Index after = recording.posture_count() - knock.posture;
    column.bottomRows(after).setConstant(std::numeric_limits<double>::quiet_NaN());
    recording.markers.middleCols<3>(3 * m)
        .topRows(knock.posture)
        .setConstant(std::numeric_limits<double>::quiet_NaN());
    recording.markers.conservativeResize(Eigen::NoChange, recording.markers.cols() + 3);
    recording.markers.rightCols<3>() = column;
  }
  model = SelectMarkers(extended, recording.marker_names);
  return origins;
}

/// The fit with the markers split: each new one where its other half was before the knock.
void SplitFit(const ErrorModel& model, const std::vector<int>& origins, std::vector<int>& free,
              Fit& fit) {
  const auto first = fit.delta.size();
  const auto old_markers = model.marker_count() - static_cast<int>(origins.size());
  fit.delta.conservativeResize(model.parameter_count());
  for (std::size_t n = 0; n < origins.size(); ++n) {
    const auto at = first + 3 * static_cast<Eigen::Index>(n);
    fit.delta.segment<3>(at) = fit.delta.segment<3>(first - 3 * (old_markers - origins[n]));
    for (int axis = 0; axis < 3; ++axis) free.push_back(static_cast<int>(at) + axis);
  }
}

/// The cluster is two from now on, those of `origins` and their other halves.
void SplitCluster(const Step& step, const std::vector<int>& origins, int first_new,
                  std::vector<LabelCluster>& clusters) {
  LabelCluster before = clusters[step.cluster];
  before.name += "(before)";
  before.markers.clear();
  for (std::size_t n = 0; n < origins.size(); ++n) {
    before.markers.push_back(first_new + static_cast<int>(n));
  }
  clusters.push_back(std::move(before));
}

}  // namespace

std::vector<Knock> FindKnocks(const ErrorModel& model, const Recording& recording,
                              const BaseParameters& base, const std::vector<LabelCluster>& clusters,
                              const CalibrationOptions& options) {
  if (recording.trials.empty()) return {};
  ErrorModel split_model = model;
  Recording split = recording;
  std::vector<LabelCluster> sets = clusters;
  CalibrationOptions quick = options;
  quick.support_form = SupportForm::kNuisance;
  const FitProblem problem{split_model, split, quick, NoiseGroups(model, recording)};
  std::vector<int> free = Estimated(model, base);
  Fit fit = StartFit(problem, SelectAll(split), Eigen::VectorXd::Zero(model.parameter_count()));
  std::vector<Knock> knocks;
  for (;;) {
    const Selection selection = SelectAll(split);
    fit = FitParameters(problem, selection, free, fit, false, kFewUpdates);
    const Linearised linear = Lineariser(problem, fit, sets).Run(selection, free);
    double significance = 0.0;
    const Step step = FindStep(linear, fit, options.outlier_probability, significance);
    if (step.cluster < 0) break;
    knocks.push_back({sets[step.cluster].name, sets[step.cluster].markers, step.posture,
                      step.last_before, step.displacement.norm(), significance});
    if (static_cast<int>(knocks.size()) == kMaxKnocks) break;
    const int first_new = split_model.marker_count();
    const std::vector<int> origins = SplitOne(knocks.back(), split_model, split);
    SplitFit(split_model, origins, free, fit);
    SplitCluster(step, origins, first_new, sets);
  }
  return knocks;
}

void SplitMarkers(const std::vector<Knock>& knocks, ErrorModel& model, Recording& recording) {
  for (const Knock& knock : knocks) SplitOne(knock, model, recording);
}

void AddUnseenMarkers(const ErrorModel& model, Recording& recording) {
  const Eigen::Index before = recording.markers.cols();
  for (int m = recording.marker_count(); m < model.marker_count(); ++m) {
    recording.marker_names.push_back(model.markers[m].name);
  }
  recording.markers.conservativeResize(Eigen::NoChange, 3 * recording.marker_count());
  recording.markers.rightCols(recording.markers.cols() - before)
      .setConstant(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace elastocal
