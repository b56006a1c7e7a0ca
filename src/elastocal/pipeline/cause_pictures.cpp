// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/cause_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "elastocal/calibration/cause_fit.hpp"
#include "elastocal/calibration/loads.hpp"

namespace elastocal {
namespace {

constexpr int kCurvePoints = 81, kMostPoints = 400;
constexpr double kWorst = 4.0;     // times the median standard deviation
constexpr double kNoShape = 1e-6;  // smallest shape with which a posture shows the cause

std::size_t Nth(int index) { return static_cast<std::size_t>(index); }

CauseVariable VariableOf(CorrectionShape shape) {
  switch (shape) {
    case CorrectionShape::kBacklash:
    case CorrectionShape::kStiffening:
      return CauseVariable::kLoad;
    case CorrectionShape::kHysteresis:
      return CauseVariable::kApproach;
    case CorrectionShape::kSuspensionMx:
    case CorrectionShape::kSuspensionMy:
      return CauseVariable::kMoment;
    case CorrectionShape::kHours:
      return CauseVariable::kTime;
    case CorrectionShape::kMass:
    case CorrectionShape::kFirstMoment:
    case CorrectionShape::kGravityTilt:
      return CauseVariable::kAddedLoad;
    default:
      return CauseVariable::kPosition;
  }
}

/// Whether two corrections displace the same thing by functions of the same variable.
bool IsDrawnWith(const Correction& a, const Correction& b) {
  const bool same_moment = VariableOf(a.shape) != CauseVariable::kMoment || a.shape == b.shape;
  return a.joint == b.joint && a.axis == b.axis && a.source == b.source && same_moment &&
         VariableOf(a.shape) == VariableOf(b.shape);
}

class Painter {
 public:
  Painter(const LinearStudy& study, const CauseScene& scene)
      : study_(study),
        model_(scene.wide),
        geometry_(scene.geometry),
        loads_(scene.loads),
        q_(scene.q),
        sums_(study) {
    for (const LinearStudy::Posture& posture : study.postures) sums_.Add(posture, 1.0);
  }

  /// `taken` are the causes that the estimate contains.
  CausePicture Draw(const CauseFinding& finding, const std::vector<int>& taken) const {
    CausePicture picture;
    picture.finding = finding;
    Choose(picture);
    const BaseFit fit(study_, sums_, taken);
    std::vector<Point> points;
    for (int i = 0; i < static_cast<int>(study_.postures.size()); ++i) {
      if (study_.postures[Nth(i)].residual.size() == 0) continue;
      const Point point = PointOf(i, picture, fit);
      if (std::isfinite(point.y) && std::isfinite(point.sd)) points.push_back(point);
    }
    Store(points, picture);
    AddCurve(picture);
    return picture;
  }

  int CauseNamed(const std::string& name) const {
    return static_cast<int>(std::find(study_.causes.begin(), study_.causes.end(), name) -
                            study_.causes.begin());
  }

 private:
  struct Point {
    int posture;
    double x, y, sd;
  };

  const Correction& CorrectionOf(int parameter) const {
    return model_.elasticity.corrections[Nth(model_.parameters[Nth(parameter)].correction)];
  }

  /// Chooses the parameter with the smallest relative standard deviation, and those that are drawn
  /// with it.
  void Choose(CausePicture& picture) const {
    const CauseFinding& finding = picture.finding;
    std::size_t surest = 0;
    const auto sureness = [&](std::size_t i) {
      return std::abs(finding.estimate[i]) / finding.sd[i];
    };
    for (std::size_t i = 1; i < finding.parameters.size(); ++i) {
      if (sureness(i) > sureness(surest)) surest = i;
    }
    const Correction& correction = CorrectionOf(finding.parameters[surest]);
    for (int parameter : finding.parameters) {
      if (IsDrawnWith(CorrectionOf(parameter), correction)) picture.parameters.push_back(parameter);
    }
    picture.correction = model_.parameters[Nth(picture.parameters.front())].correction;
    picture.variable = VariableOf(correction.shape);
    picture.joint = correction.source >= 0 ? correction.source : correction.joint;
    if (picture.variable == CauseVariable::kAddedLoad) {
      ChooseJoint(picture);
      return;
    }
    if (picture.joint >= 0) {
      const Joint& driver = model_.tree.joints[Nth(picture.joint)];
      picture.driver = driver.name;
      picture.driver_turns = driver.type == JointType::kRevolute;
    }
    if (correction.joint >= 0) picture.owner = model_.tree.joints[Nth(correction.joint)].name;
    if (correction.marker >= 0) picture.owner = correction.marker_name;
    picture.is_angle = correction.joint < 0
                           ? correction.axis >= 3
                           : model_.tree.joints[Nth(correction.joint)].type == JointType::kRevolute;
  }

  /// Chooses the joint that deflects most by the first parameter of the picture.
  void ChooseJoint(CausePicture& picture) const {
    double most = -1.0;
    for (int joint : model_.active_joints) {
      for (int axis = 0; axis < 3; ++axis) {
        const double compliance = geometry_.joints[Nth(joint)].compliance[axis];
        double squares = 0.0;
        for (const JointLoads& loads : loads_) {
          const auto& added = loads.by_correction[Nth(picture.correction)];
          squares += std::pow(compliance * added(axis, joint), 2);
        }
        if (squares <= most) continue;
        most = squares;
        picture.joint = joint;
        picture.axis = axis;
        picture.compliance = compliance;
      }
    }
    const Joint& joint = model_.tree.joints[Nth(picture.joint)];
    picture.driver = picture.owner = joint.name;
    picture.is_angle = picture.driver_turns = joint.type == JointType::kRevolute;
  }

  /// Displacement of what the picture shows by one unit of a parameter.
  double ShapeIn(const CausePicture& picture, int parameter, int posture) const {
    const auto correction = model_.parameters[Nth(parameter)].correction;
    const JointLoads& loads = loads_[Nth(posture)];
    if (picture.variable != CauseVariable::kAddedLoad) return loads.shapes[correction];
    return picture.compliance * loads.by_correction[Nth(correction)](picture.axis, picture.joint);
  }

  double Estimate(const CausePicture& picture, int parameter) const {
    const std::vector<int>& all = picture.finding.parameters;
    const auto at = std::find(all.begin(), all.end(), parameter) - all.begin();
    return picture.finding.estimate[static_cast<std::size_t>(at)];
  }

  double Variable(const CausePicture& picture, int posture) const {
    const JointLoads& loads = loads_[Nth(posture)];
    const double shape = loads.shapes[picture.correction];
    switch (picture.variable) {
      case CauseVariable::kPosition:
        return JointPosition(model_.tree.joints[Nth(picture.joint)], q_.row(posture).transpose());
      case CauseVariable::kLoad:
        return loads(2, picture.joint);
      case CauseVariable::kAddedLoad:
        return loads.by_correction[Nth(picture.correction)](picture.axis, picture.joint);
      case CauseVariable::kTime:
        return shape + model_.elasticity.corrections[Nth(picture.correction)].centre;
      default:
        return shape;
    }
  }

  /// The derivative of a posture's residuals by the displacement is the derivative by a parameter
  /// over its shape function; with several parameters it is fitted to all of them.
  Point PointOf(int posture, const CausePicture& picture, const BaseFit& fit) const {
    const LinearStudy::Posture& rows = study_.postures[Nth(posture)];
    Eigen::VectorXd by_displacement = Eigen::VectorXd::Zero(rows.residual.size());
    double squares = 0.0, displacement = 0.0;
    for (int parameter : picture.parameters) {
      const double shape = ShapeIn(picture, parameter, posture);
      const int column = ColumnOf(parameter);
      by_displacement +=
          shape / study_.scale[Nth(column)] * rows.jacobian.col(study_.base + column);
      squares += shape * shape;
      displacement += shape * Estimate(picture, parameter);
    }
    if (!(squares > kNoShape * kNoShape)) return {posture, 0.0, NAN, NAN};
    by_displacement /= squares;
    const double information = by_displacement.squaredNorm();
    const double more = -by_displacement.dot(Left(rows, picture, fit)) / information;
    return {posture, Variable(picture, posture), displacement + more, 1.0 / std::sqrt(information)};
  }

  /// Residuals of a posture after the fit of base and cause.
  Eigen::VectorXd Left(const LinearStudy::Posture& rows, const CausePicture& picture,
                       const BaseFit& fit) const {
    const Eigen::MatrixXd beside = fit.Beside(rows);
    Eigen::VectorXd left = fit.Residual(rows);
    for (int parameter : picture.finding.parameters) {
      const int column = ColumnOf(parameter);
      const auto at = std::find(fit.others.begin(), fit.others.end(), study_.base + column);
      left += beside.col(at - fit.others.begin()) * Estimate(picture, parameter) /
              study_.scale[Nth(column)];
    }
    return left;
  }

  int ColumnOf(int parameter) const {
    return static_cast<int>(
        std::find(study_.corrections.begin(), study_.corrections.end(), parameter) -
        study_.corrections.begin());
  }

  static void Store(std::vector<Point> points, CausePicture& picture) {
    if (points.empty()) return;
    std::vector<double> sds;
    for (const Point& point : points) sds.push_back(point.sd);
    std::nth_element(sds.begin(), sds.begin() + static_cast<std::ptrdiff_t>(sds.size() / 2),
                     sds.end());
    const double largest = kWorst * sds[sds.size() / 2];
    std::erase_if(points, [&](const Point& point) { return point.sd > largest; });
    const std::size_t stride = (points.size() + kMostPoints - 1) / kMostPoints;
    const auto count = static_cast<Eigen::Index>((points.size() + stride - 1) / stride);
    picture.x.resize(count);
    picture.y.resize(count);
    picture.sd.resize(count);
    for (Eigen::Index i = 0; i < count; ++i) {
      const Point& point = points[static_cast<std::size_t>(i) * stride];
      picture.postures.push_back(point.posture);
      picture.x[i] = point.x;
      picture.y[i] = point.y;
      picture.sd[i] = point.sd;
    }
  }

  void AddCurve(CausePicture& picture) const {
    if (picture.x.size() == 0) return;
    picture.curve_x =
        Eigen::VectorXd::LinSpaced(kCurvePoints, picture.x.minCoeff(), picture.x.maxCoeff());
    if (picture.variable == CauseVariable::kAddedLoad) {
      picture.curve_y =
          picture.compliance * Estimate(picture, picture.parameters.front()) * picture.curve_x;
      return;
    }
    picture.curve_y.setZero(kCurvePoints);
    for (Eigen::Index i = 0; i < kCurvePoints; ++i) {
      const Eigen::VectorXd shapes = ShapesAt(picture, picture.curve_x[i]);
      for (int parameter : picture.parameters) {
        picture.curve_y[i] +=
            shapes[model_.parameters[Nth(parameter)].correction] * Estimate(picture, parameter);
      }
    }
  }

  /// All functions where the variable has a value, and everything else is zero.
  Eigen::VectorXd ShapesAt(const CausePicture& picture, double x) const {
    const RobotTree& tree = model_.tree;
    Eigen::VectorXd q = Eigen::VectorXd::Zero(tree.coordinate_count());
    Eigen::VectorXd load = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(tree.joints.size()));
    PostureHistory history;
    history.approach.setZero(tree.coordinate_count());
    switch (picture.variable) {
      case CauseVariable::kPosition:
        q[tree.joints[Nth(picture.joint)].coordinate] = x;
        break;
      case CauseVariable::kLoad:
        load[picture.joint] = x;
        break;
      case CauseVariable::kApproach:
        history.approach[tree.joints[Nth(picture.joint)].coordinate] = x;
        break;
      case CauseVariable::kMoment:
        history.root_moment = {x, x, 0.0};  // of the two, one is drawn
        break;
      case CauseVariable::kTime:
        history.hours = x;
        break;
      case CauseVariable::kAddedLoad:  // a line, see AddCurve
        break;
    }
    return EvaluateShapes(tree, model_.elasticity.corrections, q, load, history);
  }

  const LinearStudy& study_;
  const ErrorModel& model_;
  const Geometry& geometry_;
  const std::vector<JointLoads>& loads_;
  const Eigen::MatrixXd& q_;
  StudySums sums_;
};

}  // namespace

CauseScene SceneOf(const ErrorModel& wide, const Recording& recording,
                   const CalibrationResult& result, const CalibrationOptions& options) {
  const Eigen::VectorXd delta = ErrorsByName(wide, NamedErrors(result.model, result.delta));
  CauseScene scene{.wide = wide, .q = recording.q};
  ErrorModel placed = wide;
  placed.T_ref_waist = result.model.T_ref_waist;
  scene.geometry = ApplyErrors(placed, delta);
  for (PostureLoads& loads :
       ComputeLoads(placed, recording, delta, result.placement, options.load)) {
    scene.loads.push_back(std::move(loads.joints));
  }
  return scene;
}

std::vector<CausePicture> DrawCauses(const LinearStudy& study, const CauseSearch& search,
                                     const CauseScene& scene, int most) {
  std::vector<CausePicture> pictures;
  if (search.findings.empty()) return pictures;
  const Painter painter(study, scene);
  std::vector<int> taken;
  if (search.accepted) {
    for (const CauseFinding& finding : search.chosen) {
      pictures.push_back(painter.Draw(finding, taken));
      taken.push_back(painter.CauseNamed(finding.cause));
    }
  }
  for (const CauseFinding& finding : search.findings) {
    if (static_cast<int>(pictures.size()) >= most) break;
    if (std::find(taken.begin(), taken.end(), painter.CauseNamed(finding.cause)) != taken.end()) {
      continue;
    }
    pictures.push_back(painter.Draw(finding, {}));
  }
  return pictures;
}

}  // namespace elastocal
