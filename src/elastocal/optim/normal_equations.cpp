// SPDX-License-Identifier: Apache-2.0
#include "elastocal/optim/normal_equations.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include "elastocal/math/dense.hpp"

namespace elastocal {
namespace {

/// Keeps a nuisance that nothing determines from being divided by zero; information of the others
/// is of the order of one or more.
constexpr double kRidge = 1e-12;
constexpr Eigen::Index kBatchRows = 384;  // rows of nuisance that are eliminated in one product
constexpr double kLeastLeft = 1e-6;       // least share of an added unknown beside the others

/// For each group with blocks in a cluster, calls `use` with the group, the cluster of the last
/// such block, and the sum of `product` (a vector of the size of the group's nuisance) over these
/// blocks.
template <typename Groups, typename IsIn, typename Product, typename Use>
void ForGroups(const Groups& groups, const std::vector<int>& cluster, const IsIn& is_in,
               const Product& product, const Use& use) {
  for (const auto& group : groups) {
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(group.size);
    int of = -1;
    for (const int block : group.blocks) {
      if (!is_in(block)) continue;
      of = cluster[block];
      sum += product(block);
    }
    if (of >= 0) use(group, of, sum);
  }
}

}  // namespace

NormalEquations::NormalEquations(const LeastSquaresProblem& problem) : problem_(problem) {
  LayOut();
  const auto size = static_cast<Eigen::Index>(unknowns_.size());
  information_.setZero(size, size);
  for (const std::vector<int>& blocks : alike_) AddBlocks(blocks);
  EliminateNuisance();
  information_.triangularView<Eigen::StrictlyUpper>() = information_.transpose();
  UpdateGradient();
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

/// The transposed Jacobians of blocks with the same unknowns, side by side: unknowns x rows.
Eigen::MatrixXd NormalEquations::OwnGradients(const std::vector<int>& blocks) const {
  Eigen::Index rows = 0;
  for (int block : blocks) rows += problem_.Residual(block).size();
  Eigen::MatrixXd gradients(static_cast<Eigen::Index>(layout_[blocks.front()].unknowns.size()),
                            rows);
  rows = 0;
  for (int block : blocks) {
    const Columns own = OwnJacobian(block);
    gradients.middleCols(rows, own.rows()) = own.transpose();
    rows += own.rows();
  }
  return gradients;
}

void NormalEquations::AddBlocks(const std::vector<int>& blocks) {
  std::vector<int> active;
  for (int block : blocks) {
    if (problem_.residual_blocks[block].active) active.push_back(block);
  }
  if (active.empty()) return;
  const std::vector<int>& to = layout_[active.front()].unknowns;
  const Eigen::MatrixXd gradients = OwnGradients(active);
  Eigen::MatrixXd part = Eigen::MatrixXd::Zero(gradients.rows(), gradients.rows());
  AddSquare(1.0, gradients, part);
  part.triangularView<Eigen::StrictlyUpper>() = part.transpose();
  for (std::size_t c = 0; c < to.size(); ++c) {
    const auto column = static_cast<Eigen::Index>(c);
    for (std::size_t r = 0; r < to.size(); ++r) {
      if (to[r] >= to[c]) information_(to[r], to[c]) += part(static_cast<Eigen::Index>(r), column);
    }
  }
}

void NormalEquations::EliminateNuisance() {
  gains_.setZero(information_.rows(), nuisance_rows_);
  for (const std::vector<Group*>& batch : Batches()) {
    const Eigen::Index first = batch.front()->row;
    Eigen::MatrixXd reduced =
        Eigen::MatrixXd::Zero(information_.rows(), batch.back()->row + batch.back()->size - first);
    for (Group* group : batch) {
      auto columns = reduced.middleCols(group->row - first, group->size);
      Eigen::MatrixXd D = kRidge * Eigen::MatrixXd::Identity(group->size, group->size);
      for (int block : group->blocks) {
        if (!problem_.residual_blocks[block].active) continue;
        const std::vector<int>& to = layout_[block].unknowns;
        const Columns E = NuisanceJacobian(block);
        const Rows part = E.transpose().lazyProduct(OwnJacobian(block));
        for (Eigen::Index r = 0; r < part.rows(); ++r) {
          for (std::size_t c = 0; c < to.size(); ++c) {
            columns(to[c], r) += part(r, static_cast<Eigen::Index>(c));
          }
        }
        D.noalias() += E.transpose() * E;
      }
      group->factor.compute(D);
      // About six columns are too few to pay for Eigen's preparation of large products.
      const Eigen::MatrixXd root =
          group->factor.matrixL().solve(Eigen::MatrixXd::Identity(group->size, group->size));
      const Eigen::MatrixXd scaled = columns.lazyProduct(root.transpose());
      gains_.middleCols(group->row, group->size) = scaled.lazyProduct(root);
      columns = scaled;
    }
    AddSquare(-1.0, reduced, information_);
  }
}

void NormalEquations::UpdateGradient() {
  const auto is_active = [&](int block) { return problem_.residual_blocks[block].active; };
  nuisance_decrease_ = 0.0;
  for (Group& group : groups_) {
    Eigen::VectorXd slope = Eigen::VectorXd::Zero(group.size);
    for (int block : group.blocks) {
      if (!is_active(block)) continue;
      slope.noalias() += NuisanceJacobian(block).transpose() * problem_.Residual(block);
    }
    group.own = group.factor.solve(slope);
    nuisance_decrease_ += 0.5 * slope.dot(group.own);
  }
  gradient_.setZero(information_.rows());
  for (int block = 0; block < static_cast<int>(layout_.size()); ++block) {
    if (!is_active(block)) continue;
    // The residual that the nuisance leaves. Of residuals with tiny standard deviations this is
    // almost nothing.
    Eigen::VectorXd left = problem_.Residual(block);
    const int group = layout_[block].group;
    if (group >= 0) left.noalias() -= NuisanceJacobian(block) * groups_[group].own;
    const std::vector<int>& to = layout_[block].unknowns;
    const Eigen::VectorXd slope = OwnJacobian(block).transpose() * left;
    for (std::size_t c = 0; c < to.size(); ++c) {
      gradient_[to[c]] += slope[static_cast<Eigen::Index>(c)];
    }
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

ExplainedRows NormalEquations::ExplainedVariances(const Eigen::MatrixXd& covariance) const {
  ExplainedRows explained;
  std::vector<Eigen::VectorXd>& variances = explained.all;
  variances.resize(layout_.size());
  explained.by_nuisance.resize(layout_.size());
  for (const std::vector<int>& blocks : alike_) {
    const std::vector<int>& at = layout_[blocks.front()].unknowns;
    const Eigen::MatrixXd gradients = OwnGradients(blocks);
    const Eigen::MatrixXd spread = Product(Eigen::MatrixXd(covariance(at, at)), gradients);
    const Eigen::VectorXd all = spread.cwiseProduct(gradients).colwise().sum().transpose();
    Eigen::Index row = 0;
    for (int block : blocks) {
      variances[block] = all.segment(row, problem_.Residual(block).size());
      row += variances[block].size();
      explained.by_nuisance[block] = Eigen::VectorXd::Zero(variances[block].size());
    }
  }
  // C gain', of all groups at once.
  const Eigen::MatrixXd reach = Product(covariance, gains_);
  for (const Group& group : groups_) {
    const auto own = reach.middleCols(group.row, group.size);
    const Eigen::MatrixXd nuisance =
        group.factor.solve(Eigen::MatrixXd::Identity(group.size, group.size));
    const Eigen::MatrixXd spread = Gain(group).lazyProduct(own) + nuisance;
    for (int block : group.blocks) {
      const Columns E = NuisanceJacobian(block);
      const Eigen::MatrixXd of_block = own(layout_[block].unknowns, Eigen::all);
      const Eigen::MatrixXd across = OwnJacobian(block).lazyProduct(of_block);
      variances[block] += (E * spread - 2.0 * across).cwiseProduct(E).rowwise().sum();
      explained.by_nuisance[block] = (E * nuisance).cwiseProduct(E).rowwise().sum();
    }
  }
  return explained;
}

bool NormalEquations::IsIn(const std::vector<int>& cluster, int block) const {
  return cluster[block] >= 0 && problem_.residual_blocks[block].active;
}

Eigen::MatrixXd NormalEquations::Scores(const std::vector<Eigen::VectorXd>& residuals,
                                        const std::vector<int>& cluster, int clusters) const {
  Eigen::MatrixXd scores = Eigen::MatrixXd::Zero(information_.rows(), clusters);
  const auto add_own = [&](int block) {
    if (!IsIn(cluster, block)) return;
    const Eigen::VectorXd slope = OwnJacobian(block).transpose() * residuals[block];
    for (std::size_t c = 0; c < layout_[block].unknowns.size(); ++c) {
      scores(layout_[block].unknowns[c], cluster[block]) += slope[static_cast<Eigen::Index>(c)];
    }
  };
  for (int block = 0; block < static_cast<int>(layout_.size()); ++block) {
    if (layout_[block].group < 0) add_own(block);
  }
  for (const Group& group : groups_)
    std::for_each(group.blocks.begin(), group.blocks.end(), add_own);
  ForGroups(
      groups_, cluster, [&](int block) { return IsIn(cluster, block); },
      [&](int block) -> Eigen::VectorXd {
        return NuisanceJacobian(block).transpose() * residuals[block];
      },
      [&](const Group& group, int of, const Eigen::VectorXd& sum) {
        scores.col(of) -= Gain(group).transpose() * sum;
      });
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

std::vector<NormalEquations::Addition> NormalEquations::Add(
    const std::vector<Eigen::VectorXd>& derivative, const std::vector<int>& cluster,
    const Eigen::MatrixXd& factors, const Eigen::MatrixXd& covariance) const {
  // The derivative's part in each cluster, the nuisance taken out.
  Eigen::VectorXd score = Eigen::VectorXd::Zero(factors.rows());
  Eigen::VectorXd information = score;
  for (int block = 0; block < static_cast<int>(layout_.size()); ++block) {
    if (!IsIn(cluster, block)) continue;
    score[cluster[block]] += derivative[block].dot(problem_.Residual(block));
    information[cluster[block]] += derivative[block].squaredNorm();
  }
  ForGroups(
      groups_, cluster, [&](int block) { return IsIn(cluster, block); },
      [&](int block) -> Eigen::VectorXd {
        return NuisanceJacobian(block).transpose() * derivative[block];
      },
      [&](const Group& group, int of, const Eigen::VectorXd& sum) {
        score[of] -= sum.dot(group.own);
        information[of] -= sum.dot(group.factor.solve(sum));
      });
  const auto clusters = static_cast<int>(factors.rows());
  const Eigen::MatrixXd cross = Product(Scores(derivative, cluster, clusters), factors);
  const Eigen::MatrixXd by_unknowns = Product(covariance, cross);
  std::vector<Addition> additions(static_cast<std::size_t>(factors.cols()));
  for (Eigen::Index k = 0; k < factors.cols(); ++k) {
    const double of_all = factors.col(k).cwiseAbs2().dot(information);
    const double left = of_all - cross.col(k).dot(by_unknowns.col(k));
    if (!(left > kLeastLeft * of_all)) continue;
    const double slope = factors.col(k).dot(score) - by_unknowns.col(k).dot(gradient_);
    additions[static_cast<std::size_t>(k)] = {-slope / left, 1.0 / left, slope * slope / left};
  }
  return additions;
}

double CostOf(const LeastSquaresProblem& problem) {
  double squares = 0.0;
  for (std::size_t block = 0; block < problem.residual_blocks.size(); ++block) {
    if (!problem.residual_blocks[block].active) continue;
    squares += problem.Residual(static_cast<int>(block)).squaredNorm();
  }
  return 0.5 * squares;
}

}  // namespace elastocal
