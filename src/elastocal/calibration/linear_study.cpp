// SPDX-License-Identifier: Apache-2.0
#include "elastocal/calibration/linear_study.hpp"

#include <algorithm>
#include <map>

#include "elastocal/calibration/fit.hpp"
#include "elastocal/calibration/variances.hpp"
#include "elastocal/math/decompositions.hpp"
#include "elastocal/math/statistics.hpp"

namespace elastocal {
namespace {

/// The fit of a result, expressed in the parameters of the wide model.
Fit WideFit(const ErrorModel& wide, const CalibrationResult& result) {
  Fit fit;
  fit.delta = ErrorsByName(wide, NamedErrors(result.model, result.delta));
  fit.placement = result.placement;
  fit.noise = result.noise;
  fit.prior_scale = result.prior_scale;
  return fit;
}

class StudyMaker {
 public:
  StudyMaker(const ErrorModel& wide, const Recording& recording, const CalibrationResult& result,
             const CalibrationOptions& options)
      : model_(wide),
        result_(result),
        problem_{model_, recording, options, result.group},
        selection_(Select(model_, recording, result.used, result.tied)),
        fit_(WideFit(wide, result)) {
    model_.T_ref_waist = result.model.T_ref_waist;
    FindFree();
  }

  LinearStudy Make() && {
    {
      FitResiduals first(problem_, selection_, free_, fit_);
      first.body.Evaluate(first.body.Start(), false);
      fit_.weights =
          EstimateWeights(problem_, selection_, fit_.noise, first.body, Robustness::kMoments);
    }
    FitResiduals residuals(problem_, selection_, free_, fit_);
    BodyResiduals& body = residuals.body;
    const Eigen::VectorXd x = body.Start();
    body.Evaluate(x, true);
    Arrange(body, x);
    study_.postures.resize(static_cast<std::size_t>(problem_.recording.posture_count()));
    study_.other.setZero(study_.columns(), study_.columns());
    study_.other_gradient.setZero(study_.columns());
    std::vector<std::vector<int>> blocks(study_.postures.size());
    for (int b = 0; b < static_cast<int>(body.residual_blocks.size()); ++b) {
      if (!body.residual_blocks[b].active) continue;
      const int posture = PostureOf(body, b);
      if (posture < 0) {
        AddOther(body, b);
      } else {
        blocks[posture].push_back(b);
      }
    }
    for (std::size_t i = 0; i < blocks.size(); ++i)
      AddPosture(body, static_cast<int>(i), blocks[i]);
    const double t = std::max(1.96, result_.interval_factor);
    study_.degrees_of_freedom = t < 1.9600001 ? 1e6 : StudentDegreesOfFreedom(0.975, t);
    return std::move(study_);
  }

 private:
  void FindFree() {
    std::map<std::string, int> index;
    for (int i = 0; i < model_.parameter_count(); ++i) index[model_.parameters[i].name] = i;
    for (int i : result_.posterior.parameters) {
      free_.push_back(index.at(result_.model.parameters[i].name));
    }
    const std::vector<int> own = free_;
    for (int i = 0; i < model_.parameter_count(); ++i) {
      if (model_.parameters[i].kind != ParameterKind::kCorrection) continue;
      if (std::find(own.begin(), own.end(), i) != own.end()) continue;
      free_.push_back(i);
      candidates_.push_back(i);
    }
    std::sort(free_.begin(), free_.end());
  }

  /// Finds the column of the study for each entry of x; -1 for a pose of the waist or a compliance
  /// at zero.
  void Arrange(const BodyResiduals& body, const Eigen::VectorXd& x) {
    column_.assign(static_cast<std::size_t>(x.size()), -1);
    first_.assign(1, 0);
    for (int size : body.parameter_blocks) first_.push_back(first_.back() + size);
    std::vector<char> kept(column_.size(), 1);
    for (int entry : body.nonnegative) kept[entry] = x[entry] > kComplianceAtZero ? 1 : 0;
    for (int block : body.nuisance_blocks) {
      std::fill(kept.begin() + first_[block], kept.begin() + first_[block + 1], 0);
    }
    std::vector<int> candidate_entries;
    for (std::size_t entry = 0; entry < kept.size(); ++entry) {
      const bool parameter = entry < free_.size();
      if (parameter && std::binary_search(candidates_.begin(), candidates_.end(), free_[entry])) {
        candidate_entries.push_back(static_cast<int>(entry));
      } else if (kept[entry] != 0) {
        column_[entry] = study_.base++;
      }
    }
    for (int entry : candidate_entries) {
      const auto at = static_cast<std::size_t>(entry);
      column_[at] = AddStudyColumn(model_, free_[at], study_);
    }
  }

  int PostureOf(const BodyResiduals& body, int block) const {
    if (block < body.body_count()) return selection_.bodies[block].posture;
    const int tie = block - body.body_count();
    const auto ties = static_cast<int>(body.tied_postures().size());
    return tie < ties ? body.tied_postures()[tie] : -1;
  }

  /// The Jacobian of a residual block by all columns of the study. `nuisance` receives its columns
  /// of the waist's pose.
  Eigen::MatrixXd Spread(const BodyResiduals& body, int block, Eigen::MatrixXd* nuisance) const {
    const auto& shape = body.residual_blocks[block];
    const auto& J = body.Jacobian(block);
    Eigen::MatrixXd wide = Eigen::MatrixXd::Zero(shape.size, study_.columns());
    Eigen::Index at = 0;
    for (int k : shape.parameter_blocks) {
      const int size = body.parameter_blocks[k];
      const bool is_nuisance = std::find(body.nuisance_blocks.begin(), body.nuisance_blocks.end(),
                                         k) != body.nuisance_blocks.end();
      if (is_nuisance && nuisance != nullptr) *nuisance = J.middleCols(at, size);
      for (int c = 0; c < size; ++c) {
        const int column =
            column_[static_cast<std::size_t>(first_[k]) + static_cast<std::size_t>(c)];
        if (column >= 0) wide.col(column) += J.col(at + c);
      }
      at += size;
    }
    return wide;
  }

  void AddOther(const BodyResiduals& body, int block) {
    const Eigen::MatrixXd J = Spread(body, block, nullptr);
    study_.other.noalias() += J.transpose() * J;
    study_.other_gradient.noalias() += J.transpose() * body.Residual(block);
  }

  void AddPosture(const BodyResiduals& body, int posture, const std::vector<int>& blocks) {
    LinearStudy::Posture& of = study_.postures[static_cast<std::size_t>(posture)];
    Eigen::Index rows = 0;
    for (int b : blocks) rows += body.residual_blocks[b].size;
    of.residual.resize(rows);
    of.jacobian.resize(rows, study_.columns());
    of.to_metres.setZero(rows);
    Eigen::MatrixXd nuisance = Eigen::MatrixXd::Zero(rows, 6);
    Eigen::Index at = 0;
    for (int b : blocks) {
      const int size = body.residual_blocks[b].size;
      Eigen::MatrixXd own = Eigen::MatrixXd::Zero(size, 6);
      of.jacobian.middleRows(at, size) = Spread(body, b, &own);
      nuisance.middleRows(at, size) = own;
      of.residual.segment(at, size) = body.Residual(b);
      if (b < body.body_count()) {
        of.to_metres.segment(at, size) = body.Sds(b);
        of.markers += static_cast<int>(selection_.bodies[b].markers.size());
      }
      at += size;
    }
    if (!nuisance.isZero(0.0) && rows > 6) Eliminate(nuisance, of);
  }

  /// Removes from a posture what the pose of the waist explains.
  void Eliminate(const Eigen::MatrixXd& nuisance, LinearStudy::Posture& of) const {
    const Eigen::MatrixXd Q = ThinOrthogonalFactor(nuisance);
    of.residual -= Q * (Q.transpose() * of.residual);
    of.jacobian -= Q * (Q.transpose() * of.jacobian).eval();
  }

  ErrorModel model_;
  const CalibrationResult& result_;
  FitProblem problem_;
  Selection selection_;
  Fit fit_;
  std::vector<int> free_, candidates_, column_, first_;
  LinearStudy study_;
};

}  // namespace

int AddStudyColumn(const ErrorModel& wide, int parameter, LinearStudy& study) {
  const Parameter& of = wide.parameters[static_cast<std::size_t>(parameter)];
  const auto number = static_cast<int>(study.corrections.size());
  study.corrections.push_back(parameter);
  study.scale.push_back(ParameterScale(of));
  const std::string& cause = wide.elasticity.corrections[of.correction].cause;
  auto at = std::find(study.causes.begin(), study.causes.end(), cause);
  if (at == study.causes.end()) {
    study.of_cause.emplace_back();
    at = study.causes.insert(at, cause);
  }
  study.of_cause[static_cast<std::size_t>(at - study.causes.begin())].push_back(number);
  return study.base + number;
}

LinearStudy MakeLinearStudy(const ErrorModel& wide, const Recording& recording,
                            const CalibrationResult& result, const CalibrationOptions& options) {
  return StudyMaker(wide, recording, result, options).Make();
}

}  // namespace elastocal
