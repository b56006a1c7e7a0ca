// SPDX-License-Identifier: Apache-2.0
#include "elastocal/observation/observed_study.hpp"

#include <algorithm>

#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

/// Column of the study for each entry of x; -1: a compliance at zero.
std::vector<int> PlaceColumns(const ObservedRobot& wide, const ObservedRobot& model,
                              const ObservationResiduals& residuals, const Eigen::VectorXd& x,
                              LinearStudy& study) {
  std::vector<int> columns(static_cast<std::size_t>(x.size()), 0);
  for (const int entry : residuals.nonnegative) {
    if (x[entry] <= kComplianceAtZero) columns[static_cast<std::size_t>(entry)] = -1;
  }
  const auto known = NamedErrors(model.robot, Eigen::VectorXd::Zero(model.robot.parameter_count()));
  std::vector<std::pair<std::size_t, int>> candidates;  // entry of x, parameter
  for (int i = 0; i < wide.robot.parameter_count(); ++i) {
    if (wide.robot.parameters[i].kind != ParameterKind::kCorrection) continue;
    if (wide.unknown[i] < 0 || known.contains(wide.robot.parameters[i].name)) continue;
    candidates.emplace_back(residuals.RobotEntry(wide.unknown[i]), i);
    columns[candidates.back().first] = -1;
  }
  for (int& column : columns) {
    if (column >= 0) column = study.base++;
  }
  for (const auto& [entry, parameter] : candidates) {
    columns[entry] = AddStudyColumn(wide.robot, parameter, study);
  }
  return columns;
}

/// The Jacobian of a residual block by all columns of the study.
Eigen::MatrixXd SpreadJacobian(const ObservationResiduals& residuals, int block,
                               const std::vector<int>& first, const std::vector<int>& columns,
                               int width) {
  const auto& shape = residuals.residual_blocks[static_cast<std::size_t>(block)];
  const auto& J = residuals.Jacobian(block);
  Eigen::MatrixXd wide = Eigen::MatrixXd::Zero(shape.size, width);
  Eigen::Index at = 0;
  for (const int k : shape.parameter_blocks) {
    const auto of = static_cast<std::size_t>(k);
    for (int c = 0; c < residuals.parameter_blocks[of]; ++c, ++at) {
      const int column = columns[Size(first[of] + c)];
      if (column >= 0) wide.col(column) += J.col(at);
    }
  }
  return wide;
}

void Append(const Eigen::VectorXd& residual, const Eigen::MatrixXd& jacobian,
            LinearStudy::Posture& posture) {
  const Eigen::Index rows = posture.residual.size(), more = residual.size();
  posture.residual.conservativeResize(rows + more);
  posture.residual.tail(more) = residual;
  posture.jacobian.conservativeResize(rows + more, jacobian.cols());
  posture.jacobian.bottomRows(more) = jacobian;
  posture.to_metres.setOnes(rows + more);
  posture.markers = static_cast<int>(rows + more);
}

}  // namespace

std::vector<Correction> ObservableCorrections(const RobotTree& tree,
                                              const ObservationSetup& setup) {
  std::vector<Correction> corrections = PossibleCorrections(tree, std::nullopt);
  if (!setup.feet.empty()) {
    std::erase_if(corrections,
                  [](const Correction& of) { return TargetOf(of) != CorrectionTarget::kJoint; });
  }
  return corrections;
}

ObservedRobot WithCorrections(const ObservedRobot& model, const PlacementOptions& placement,
                              const Observations& observations,
                              const std::vector<Correction>& corrections) {
  const Elasticity& elasticity = model.robot.elasticity;
  ObservedRobot wide = MakeObservedRobot(model.robot.tree, placement, model.setup,
                                         elasticity.torsion, elasticity.bending, corrections);
  KeepObservedUnknowns(observations, wide);
  wide.earlier = model.earlier;
  return wide;
}

ObservedValues ValuesOfWide(const ObservedRobot& wide, const ObservedRobot& model,
                            const ObservedValues& values) {
  ObservedValues of_wide = values;
  of_wide.robot = ErrorsByName(wide.robot, NamedErrors(model.robot, values.robot));
  return of_wide;
}

LinearStudy MakeObservedStudy(const ObservedRobot& wide, const ObservedRobot& model,
                              const Observations& observations, const ObservationFit& fit) {
  const ObservedValues values = ValuesOfWide(wide, model, fit.values);
  const std::vector<JointLoads> loads = ObservedLoads(wide, observations, values.robot);
  ObservationResiduals residuals(wide, observations, loads, fit.spread, fit.weights, {}, values);
  const Eigen::VectorXd x = residuals.Start();
  residuals.Evaluate(x, true);
  LinearStudy study;
  const std::vector<int> columns = PlaceColumns(wide, model, residuals, x, study);
  std::vector<int> first = {0};
  for (const int size : residuals.parameter_blocks) first.push_back(first.back() + size);
  study.postures.resize(observations.postures.size());
  study.other.setZero(study.columns(), study.columns());
  study.other_gradient.setZero(study.columns());
  for (int block = 0; block < static_cast<int>(residuals.residual_blocks.size()); ++block) {
    if (!residuals.residual_blocks[static_cast<std::size_t>(block)].active) continue;
    const Eigen::MatrixXd J = SpreadJacobian(residuals, block, first, columns, study.columns());
    if (block < observations.count()) {
      const int posture = observations.all[static_cast<std::size_t>(block)].posture;
      Append(residuals.Residual(block), J, study.postures[static_cast<std::size_t>(posture)]);
    } else {
      study.other.noalias() += J.transpose() * J;
      study.other_gradient.noalias() += J.transpose() * residuals.Residual(block);
    }
  }
  study.degrees_of_freedom = fit.degrees_of_freedom;
  return study;
}

}  // namespace elastocal
