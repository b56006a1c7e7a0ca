// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/posture_information.hpp"

#include <cmath>

#include <Eigen/Cholesky>

#include "elastocal/math/interruption.hpp"
#include "elastocal/math/numbers.hpp"

namespace elastocal {

PostureInformation::PostureInformation(const ObservationResiduals& residuals,
                                       const std::vector<int>& posture, int count) {
  std::vector<Eigen::Index> first = {0};
  for (int size : residuals.parameter_blocks) first.push_back(first.back() + size);
  const auto spread = [&](int block) {
    const auto& jacobian = residuals.Jacobian(block);
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(jacobian.rows(), first.back());
    Eigen::Index column = 0;
    for (int of : residuals.residual_blocks[Size(block)].parameter_blocks) {
      const int size = residuals.parameter_blocks[Size(of)];
      rows.middleCols(first[Size(of)], size) = jacobian.middleCols(column, size);
      column += size;
    }
    return rows;
  };
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(first.back(), first.back());
  const int observations = static_cast<int>(posture.size());
  for (int b = observations; b < static_cast<int>(residuals.residual_blocks.size()); ++b) {
    const Eigen::MatrixXd rows = spread(b);
    information += rows.transpose() * rows;
  }
  prior_ = information.llt().solve(Eigen::MatrixXd::Identity(first.back(), first.back()));
  rows_.assign(Size(count), Eigen::MatrixXd(0, first.back()));
  for (int b = 0; b < observations; ++b) {
    Eigen::MatrixXd& of = rows_[Size(posture[Size(b)])];
    const Eigen::MatrixXd rows = spread(b);
    Eigen::MatrixXd both(of.rows() + rows.rows(), first.back());
    both << of, rows;
    of = std::move(both);
  }
}

double PostureInformation::Gain(int posture, const Eigen::MatrixXd& covariance) const {
  InterruptionPoint();
  const Eigen::MatrixXd& J = rows_[Size(posture)];
  if (J.rows() == 0) return 0.0;
  Eigen::MatrixXd S = J * covariance * J.transpose();
  S.diagonal().array() += 1.0;
  return S.llt().matrixL().toDenseMatrix().diagonal().array().log().sum();
}

double PostureInformation::Update(int posture, double sign, Eigen::MatrixXd& covariance) const {
  InterruptionPoint();
  const Eigen::MatrixXd& J = rows_[Size(posture)];
  if (J.rows() == 0) return 0.0;
  const Eigen::MatrixXd across = covariance * J.transpose();
  Eigen::MatrixXd S = sign * (J * across);
  S.diagonal().array() += 1.0;
  const Eigen::LLT<Eigen::MatrixXd> factor(S);
  covariance -= sign * (across * factor.solve(across.transpose()));
  return factor.matrixL().toDenseMatrix().diagonal().array().log().sum();
}

double PostureInformation::Of(const std::vector<int>& postures) const {
  Eigen::MatrixXd covariance = prior_;
  double gain = 0.0;
  for (int posture : postures) gain += Update(posture, 1.0, covariance);
  return gain;
}

Eigen::VectorXd PostureInformation::OfChanges(const std::vector<int>& postures) const {
  Eigen::MatrixXd covariance = prior_;
  Eigen::MatrixXd data = Eigen::MatrixXd::Zero(prior_.rows(), prior_.cols());
  for (int posture : postures) {
    Update(posture, 1.0, covariance);
    const Eigen::MatrixXd& J = rows_[Size(posture)];
    data += J.transpose() * J;
  }
  return (data - data * covariance * data).diagonal();
}

int PostureInformation::Best(const Eigen::MatrixXd& covariance,
                             const std::vector<char>& taken) const {
  int best = -1;
  double most = -1.0;
  for (int i = 0; i < count(); ++i) {
    if (taken[Size(i)] != 0) continue;
    const double gain = Gain(i, covariance);
    if (gain <= most) continue;
    best = i;
    most = gain;
  }
  return best;
}

std::vector<int> PostureInformation::Choose(int count) const {
  std::vector<int> chosen;
  std::vector<char> taken(rows_.size(), 0);
  Eigen::MatrixXd covariance = prior_;
  const auto take = [&](int posture) {
    taken[Size(posture)] = 1;
    Update(posture, 1.0, covariance);
    return posture;
  };
  for (int i = 0; i < std::min(count, this->count()); ++i) {
    chosen.push_back(take(Best(covariance, taken)));
  }
  for (int& posture : chosen) {
    Update(posture, -1.0, covariance);
    taken[Size(posture)] = 0;
    posture = take(Best(covariance, taken));
  }
  return chosen;
}

}  // namespace elastocal
