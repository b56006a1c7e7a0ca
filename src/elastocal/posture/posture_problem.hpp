// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "elastocal/posture/criterion.hpp"
#include "elastocal/posture/feasible_set.hpp"
#include "elastocal/posture/posture_regressor.hpp"

namespace elastocal {

/// For each marker, whether it counts in a posture, because some camera sees it.
using MarkerVisibility = std::function<std::vector<char>(const MovingChain&)>;

/// The problem for which calibration postures are sought: a chain, the parameters to be identified
/// with it, and the postures that it may take. It holds scratch space: use one for each thread.
struct PostureProblem {
  FeasibleSet feasible;
  PostureRegressor regressor;
  Criterion criterion = Criterion::kO1;
  MarkerVisibility visible = {};  ///< empty: all markers always count

  int variable_count() const { return feasible.variable_count(); }
  int column_count() const { return regressor.columns(); }
};

/// Psi_b of posture x, with zero rows for markers that no camera sees.
Eigen::MatrixXd EvaluateRegressor(PostureProblem& problem, const Eigen::VectorXd& x);

/// Postures with their regressors and their information, sum of Psi^T Psi.
class PostureSet {
 public:
  explicit PostureSet(int columns) : information_(Eigen::MatrixXd::Zero(columns, columns)) {}

  int size() const { return static_cast<int>(postures_.size()); }
  const std::vector<Eigen::VectorXd>& postures() const { return postures_; }
  const Eigen::VectorXd& posture(int k) const { return postures_[k]; }
  const Eigen::MatrixXd& psi(int k) const { return psi_[k]; }
  const Eigen::MatrixXd& information() const { return information_; }
  /// Information of all postures except some.
  Eigen::MatrixXd InformationWithout(const std::vector<int>& left_out) const;

  void Add(PostureProblem& problem, const Eigen::VectorXd& x);
  void Replace(PostureProblem& problem, int k, const Eigen::VectorXd& x);
  void Remove(int k);

  /// Index of the set; 0 if the set does not determine all parameters.
  double Index(Criterion criterion) const;

 private:
  std::vector<Eigen::VectorXd> postures_;
  std::vector<Eigen::MatrixXd> psi_;
  Eigen::MatrixXd information_;
};

PostureSet MakePostureSet(PostureProblem& problem, const std::vector<Eigen::VectorXd>& postures);

/// For each posture, the index of the set without it. O1 uses the matrix determinant lemma, with
/// one factorisation for all postures.
Eigen::VectorXd IndicesWithoutEach(const PostureSet& set, Criterion criterion);

}  // namespace elastocal
