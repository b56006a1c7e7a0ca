// SPDX-License-Identifier: Apache-2.0
#include "elastocal/optim/normal_equations.hpp"

#include <algorithm>
#include <map>
#include <numeric>

namespace elastocal {
namespace {

/// Keeps a nuisance that nothing determines from being divided by zero; information of the others
/// is of the order of one or more.
constexpr double kRidge = 1e-12;
constexpr Eigen::Index kBatchRows = 384;  // of nuisance, eliminated in one product
constexpr int kMostActiveSets = 20;
constexpr double kLeastLeft = 1e-6;       // of an added unknown, beside the others
constexpr double kSlightGradient = 1e-9;  // no reason to leave a bound

}  // namespace

NormalEquations::NormalEquations(const LeastSquaresProblem& problem) : problem_(problem) {
  LayOut();
  const auto size = static_cast<Eigen::Index>(unknowns_.size());
  information_.setZero(size, size);
  gradient_.setZero(size);
  for (const std::vector<int>& blocks : alike_) AddBlocks(blocks);
  EliminateNuisance();
  information_.triangularView<Eigen::StrictlyUpper>() = information_.transpose();
}

void NormalEquations::LayOut() {
  const std::vector<int>& sizes = problem_.parameter_blocks;
  std::vector<char> is_nuisance(sizes.size(), 0);
  for (int k : problem_.nuisance_blocks) is_nuisance[k] = 1;
  std::vector<int> first(1, 0);
  for (std::size_t k = 0; k < sizes.size(); ++k) {
    for (int i = 0; i < sizes[k]; ++i) {
      position_.push_back(is_nuisance[k] != 0 ? -1 : static_cast<int>(unknowns_.size()));
      if (is_nuisance[k] == 0) unknowns_.push_back(first.back() + i);
    }
    first.push_back(first.back() + sizes[k]);
  }
  std::map<int, int> group_of;  // by nuisance block
  for (std::size_t block = 0; block < problem_.residual_blocks.size(); ++block) {
    Layout layout;
    int column = 0;
    for (int k : problem_.residual_blocks[block].parameter_blocks) {
      if (is_nuisance[k] != 0) {
        const auto [at, added] = group_of.try_emplace(k, static_cast<int>(groups_.size()));
        if (added) {
          groups_.emplace_back();
          groups_.back().first = first[k];
        }
        layout.group = at->second;
        layout.nuisance = column;
        layout.width = sizes[k];
        column += sizes[k];
        continue;
      }
      column += sizes[k];
      for (int i = 0; i < sizes[k]; ++i) layout.unknowns.push_back(position_[first[k] + i]);
    }
    layout.own = layout.nuisance == 0 ? layout.width : 0;
    if (layout.group >= 0) groups_[layout.group].blocks.push_back(static_cast<int>(block));
    layout_.push_back(std::move(layout));
  }
  for (Group& group : groups_) {
    group.row = nuisance_rows_;
    group.size = layout_[group.blocks.front()].width;
    nuisance_rows_ += group.size;
  }
  FindAlike();
}

void NormalEquations::FindAlike() {
  struct Batch {
    std::size_t index = 0;
    Eigen::Index rows = kBatchRows;
  };
  std::map<std::vector<int>, Batch> last;
  for (std::size_t block = 0; block < layout_.size(); ++block) {
    Batch& batch = last[layout_[block].unknowns];
    if (batch.rows >= kBatchRows) {
      batch = {alike_.size(), 0};
      alike_.emplace_back();
    }
    alike_[batch.index].push_back(static_cast<int>(block));
    batch.rows += problem_.Residual(static_cast<int>(block)).size();
  }
}

NormalEquations::Columns NormalEquations::OwnJacobian(int block) const {
  const Layout& layout = layout_[block];
  const auto& J = problem_.Jacobian(block);
  return J.middleCols(layout.own, J.cols() - layout.width);
}

NormalEquations::Columns NormalEquations::NuisanceJacobian(int block) const {
  const Layout& layout = layout_[block];
  return problem_.Jacobian(block).middleCols(layout.nuisance, layout.width);
}

Eigen::MatrixXd NormalEquations::OwnJacobians(const std::vector<int>& blocks) const {
  Eigen::Index rows = 0;
  for (int block : blocks) rows += problem_.Residual(block).size();
  Eigen::MatrixXd J(rows, static_cast<Eigen::Index>(layout_[blocks.front()].unknowns.size()));
  rows = 0;
  for (int block : blocks) {
    const Columns own = OwnJacobian(block);
    J.middleRows(rows, own.rows()) = own;
    rows += own.rows();
  }
  return J;
}

void NormalEquations::AddBlocks(const std::vector<int>& blocks) {
  std::vector<int> active;
  for (int block : blocks) {
    if (problem_.residual_blocks[block].active) active.push_back(block);
  }
  if (active.empty()) return;
  const std::vector<int>& to = layout_[active.front()].unknowns;
  const Eigen::MatrixXd J = OwnJacobians(active);
  Eigen::VectorXd residual(J.rows());
  Eigen::Index row = 0;
  for (int block : active) {
    const auto& of = problem_.Residual(block);
    residual.segment(row, of.size()) = of;
    row += of.size();
  }
  Eigen::MatrixXd part = Eigen::MatrixXd::Zero(J.cols(), J.cols());
  part.selfadjointView<Eigen::Lower>().rankUpdate(J.transpose());
  part.triangularView<Eigen::StrictlyUpper>() = part.transpose();
  const Eigen::VectorXd slope = J.transpose() * residual;
  for (std::size_t c = 0; c < to.size(); ++c) {
    const auto column = static_cast<Eigen::Index>(c);
    gradient_[to[c]] += slope[column];
    for (std::size_t r = 0; r < to.size(); ++r) {
      if (to[r] >= to[c]) information_(to[r], to[c]) += part(static_cast<Eigen::Index>(r), column);
    }
  }
}

void NormalEquations::EliminateNuisance() {
  gains_.setZero(nuisance_rows_, information_.rows());
  for (const std::vector<Group*>& batch : Batches()) {
    Rows reduced = Rows::Zero(batch.back()->row + batch.back()->size - batch.front()->row,
                              information_.rows());
    for (Group* group : batch) {
      auto rows = reduced.middleRows(group->row - batch.front()->row, group->size);
      Eigen::MatrixXd D = kRidge * Eigen::MatrixXd::Identity(group->size, group->size);
      Eigen::VectorXd own_gradient = Eigen::VectorXd::Zero(group->size);
      for (int block : group->blocks) {
        if (!problem_.residual_blocks[block].active) continue;
        const std::vector<int>& to = layout_[block].unknowns;
        const Columns E = NuisanceJacobian(block);
        const Rows part = E.transpose().lazyProduct(OwnJacobian(block));
        for (Eigen::Index r = 0; r < part.rows(); ++r) {
          for (std::size_t c = 0; c < to.size(); ++c) {
            rows(r, to[c]) += part(r, static_cast<Eigen::Index>(c));
          }
        }
        D.noalias() += E.transpose() * E;
        own_gradient.noalias() += E.transpose() * problem_.Residual(block);
      }
      group->factor.compute(D);
      group->own = group->factor.solve(own_gradient);
      nuisance_decrease_ += 0.5 * own_gradient.dot(group->own);
      gradient_.noalias() -= rows.transpose() * group->own;
      group->factor.matrixL().solveInPlace(rows);
      gains_.middleRows(group->row, group->size) = group->factor.matrixU().solve(rows);
    }
    information_.selfadjointView<Eigen::Lower>().rankUpdate(reduced.transpose(), -1.0);
  }
}

std::vector<std::vector<NormalEquations::Group*>> NormalEquations::Batches() {
  std::vector<std::vector<Group*>> batches;
  Eigen::Index rows = kBatchRows;
  for (Group& group : groups_) {
    if (rows >= kBatchRows) {
      batches.emplace_back();
      rows = 0;
    }
    batches.back().push_back(&group);
    rows += group.size;
  }
  return batches;
}

std::vector<int> NormalEquations::Positions(const std::vector<int>& entries) const {
  std::vector<int> positions;
  for (int entry : entries) positions.push_back(position_[entry]);
  return positions;
}

Eigen::VectorXd NormalEquations::Expand(const Eigen::VectorXd& step) const {
  Eigen::VectorXd all = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(position_.size()));
  all(unknowns_) = step;
  for (const Group& group : groups_) {
    all.segment(group.first, group.size) = -group.own - Gain(group) * step;
  }
  return all;
}

Eigen::MatrixXd NormalEquations::Explained(int block, const Eigen::MatrixXd& covariance) const {
  const Layout& layout = layout_[block];
  const Eigen::MatrixXd J = OwnJacobian(block);
  Eigen::MatrixXd explained =
      J * Eigen::MatrixXd(covariance(layout.unknowns, layout.unknowns)) * J.transpose();
  if (layout.group < 0) return explained;
  const Group& group = groups_[layout.group];
  const Columns E = NuisanceJacobian(block);
  const Eigen::MatrixXd reach = covariance * (E * Gain(group)).transpose();
  const Eigen::MatrixXd both = J * reach(layout.unknowns, Eigen::all);
  const Eigen::MatrixXd by_gain = E * Gain(group) * reach;
  explained += by_gain - both - both.transpose() + E * group.factor.solve(E.transpose());
  return explained;
}

std::vector<Eigen::VectorXd> NormalEquations::ExplainedVariances(
    const Eigen::MatrixXd& covariance) const {
  std::vector<Eigen::VectorXd> variances(layout_.size());
  for (const std::vector<int>& blocks : alike_) {
    const std::vector<int>& at = layout_[blocks.front()].unknowns;
    const Eigen::MatrixXd J = OwnJacobians(blocks);
    const Eigen::MatrixXd spread = J * Eigen::MatrixXd(covariance(at, at));
    const Eigen::VectorXd all = spread.cwiseProduct(J).rowwise().sum();
    Eigen::Index row = 0;
    for (int block : blocks) {
      variances[block] = all.segment(row, problem_.Residual(block).size());
      row += variances[block].size();
    }
  }
  // gain C, of many groups at once.
  Rows reach;
  Eigen::Index begin = 0;
  for (const Group& group : groups_) {
    if (group.row + group.size > begin + reach.rows()) {
      begin = group.row;
      const Eigen::Index rows = std::min(std::max(kBatchRows, group.size), nuisance_rows_ - begin);
      reach.noalias() = gains_.middleRows(begin, rows) * covariance;
    }
    const Eigen::MatrixXd own = reach.middleRows(group.row - begin, group.size);
    const Eigen::MatrixXd spread =
        own * Gain(group).transpose() +
        group.factor.solve(Eigen::MatrixXd::Identity(group.size, group.size));
    for (int block : group.blocks) {
      const Columns E = NuisanceJacobian(block);
      const Eigen::MatrixXd across =
          OwnJacobian(block) *
          Eigen::MatrixXd(own(Eigen::all, layout_[block].unknowns)).transpose();
      variances[block] += (E * spread - 2.0 * across).cwiseProduct(E).rowwise().sum();
    }
  }
  return variances;
}

Eigen::MatrixXd NormalEquations::Scores(const std::vector<Eigen::VectorXd>& residuals,
                                        const std::vector<int>& cluster, int clusters) const {
  Eigen::MatrixXd scores = Eigen::MatrixXd::Zero(information_.rows(), clusters);
  const auto add_own = [&](int block) {
    const Eigen::VectorXd slope = OwnJacobian(block).transpose() * residuals[block];
    for (std::size_t c = 0; c < layout_[block].unknowns.size(); ++c) {
      scores(layout_[block].unknowns[c], cluster[block]) += slope[static_cast<Eigen::Index>(c)];
    }
  };
  const auto takes_part = [&](int block) {
    return cluster[block] >= 0 && problem_.residual_blocks[block].active;
  };
  for (std::size_t block = 0; block < layout_.size(); ++block) {
    const int b = static_cast<int>(block);
    if (layout_[block].group < 0 && takes_part(b)) add_own(b);
  }
  for (const Group& group : groups_) {
    Eigen::VectorXd own = Eigen::VectorXd::Zero(group.size);
    int of = -1;
    for (int block : group.blocks) {
      if (!takes_part(block)) continue;
      of = cluster[block];
      add_own(block);
      own += NuisanceJacobian(block).transpose() * residuals[block];
    }
    if (of >= 0) scores.col(of) -= Gain(group).transpose() * own;
  }
  return scores;
}

NormalEquations::Score NormalEquations::Project(int block, const Eigen::MatrixXd& A) const {
  const Layout& layout = layout_[block];
  Score score;
  score.residual = A.transpose() * problem_.Residual(block);
  score.information = A.transpose() * A;
  score.cross.setZero(A.cols(), information_.rows());
  const Eigen::MatrixXd by_own = A.transpose() * OwnJacobian(block);
  for (std::size_t c = 0; c < layout.unknowns.size(); ++c) {
    score.cross.col(layout.unknowns[c]) += by_own.col(static_cast<Eigen::Index>(c));
  }
  if (layout.group < 0) return score;
  const Group& group = groups_[layout.group];
  const Eigen::MatrixXd by_nuisance = A.transpose() * NuisanceJacobian(block);
  score.residual -= by_nuisance * group.own;
  score.information -= by_nuisance * group.factor.solve(by_nuisance.transpose());
  score.cross -= by_nuisance * Gain(group);
  return score;
}

NormalEquations::Addition NormalEquations::Add(const std::vector<Eigen::VectorXd>& derivative,
                                               const Eigen::MatrixXd& covariance) const {
  double score = 0.0;
  double information = 0.0;
  Eigen::VectorXd cross = Eigen::VectorXd::Zero(information_.rows());
  const auto takes_part = [&](int block) {
    return derivative[block].size() > 0 && problem_.residual_blocks[block].active;
  };
  for (int block = 0; block < static_cast<int>(layout_.size()); ++block) {
    if (!takes_part(block)) continue;
    score += derivative[block].dot(problem_.Residual(block));
    information += derivative[block].squaredNorm();
    cross(layout_[block].unknowns) += OwnJacobian(block).transpose() * derivative[block];
  }
  for (const Group& group : groups_) {
    Eigen::VectorXd own = Eigen::VectorXd::Zero(group.size);
    for (int block : group.blocks) {
      if (takes_part(block)) own += NuisanceJacobian(block).transpose() * derivative[block];
    }
    if (own.isZero(0.0)) continue;
    score -= own.dot(group.own);
    information -= own.dot(group.factor.solve(own));
    cross -= Gain(group).transpose() * own;
  }
  const Eigen::VectorXd by_unknowns = covariance * cross;
  const double left = information - cross.dot(by_unknowns);
  if (!(left > kLeastLeft * information)) return {};
  const double slope = score - by_unknowns.dot(gradient_);
  return {-slope / left, 1.0 / left, slope * slope / left};
}

double CostOf(const LeastSquaresProblem& problem) {
  double squares = 0.0;
  for (std::size_t block = 0; block < problem.residual_blocks.size(); ++block) {
    if (!problem.residual_blocks[block].active) continue;
    squares += problem.Residual(static_cast<int>(block)).squaredNorm();
  }
  return 0.5 * squares;
}

Eigen::VectorXd BoundedStep(const Eigen::MatrixXd& information, const Eigen::VectorXd& gradient,
                            const Eigen::VectorXd& x, const std::vector<int>& nonnegative) {
  std::vector<char> held(static_cast<std::size_t>(x.size()), 0);
  for (int i : nonnegative) held[i] = x[i] <= 0.0 && gradient[i] >= 0.0;
  Eigen::VectorXd step = Eigen::VectorXd::Zero(x.size());
  for (int round = 0; round < kMostActiveSets; ++round) {
    std::vector<int> free;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      if (held[i]) {
        step[i] = -x[i];
      } else {
        step[i] = 0.0;
        free.push_back(static_cast<int>(i));
      }
    }
    const Eigen::VectorXd slope = gradient + information * step;
    const Eigen::MatrixXd own = information(free, free);
    step(free) = -own.llt().solve(slope(free));
    bool changed = false;
    for (int i : nonnegative) {
      if (held[i] || x[i] + step[i] >= 0.0) continue;
      held[i] = 1;
      changed = true;
    }
    if (changed) continue;
    const Eigen::VectorXd left = gradient + information * step;
    for (int i : nonnegative) {
      if (!held[i] || left[i] >= -kSlightGradient) continue;
      held[i] = 0;
      changed = true;
    }
    if (!changed) break;
  }
  for (int i : nonnegative) step[i] = std::max(step[i], -x[i]);
  return step;
}

}  // namespace elastocal
