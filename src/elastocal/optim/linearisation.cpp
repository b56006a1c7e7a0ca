#include "elastocal/optim/linearisation.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include <Eigen/Cholesky>

namespace elastocal {
namespace {

/// Keeps a nuisance that nothing determines from being divided by zero; information of the others
/// is of the order of one or more.
constexpr double kRidge = 1e-12;

std::vector<int> FirstEntries(const LeastSquaresProblem& problem) {
  std::vector<int> first(problem.parameter_blocks.size() + 1, 0);
  std::partial_sum(problem.parameter_blocks.begin(), problem.parameter_blocks.end(),
                   first.begin() + 1);
  return first;
}

/// Blocks of the problem by their nuisance block; those without one by all the blocks they meet.
std::vector<Linearisation::Group> MakeGroups(const LeastSquaresProblem& problem,
                                             const std::vector<char>& is_nuisance,
                                             std::vector<int>& nuisance_of_group) {
  std::vector<Linearisation::Group> groups;
  std::map<std::vector<int>, std::size_t> group_of;
  for (std::size_t i = 0; i < problem.residual_blocks.size(); ++i) {
    const std::vector<int>& met = problem.residual_blocks[i].parameter_blocks;
    const auto own =
        std::find_if(met.begin(), met.end(), [&](int k) { return is_nuisance[k] != 0; });
    const std::vector<int> key = own == met.end() ? met : std::vector<int>{*own};
    const auto [at, added] = group_of.try_emplace(key, groups.size());
    if (added) {
      groups.emplace_back();
      nuisance_of_group.push_back(own == met.end() ? -1 : *own);
    }
    groups[at->second].blocks.push_back(static_cast<int>(i));
  }
  return groups;
}

class Assembler {
 public:
  Assembler(const LeastSquaresProblem& problem, const std::vector<int>& position)
      : problem_(problem),
        first_(FirstEntries(problem)),
        position_(position),
        local_(first_.back()) {}

  /// Fills the group's rows and columns; gives the columns of the nuisance apart.
  Eigen::MatrixXd Assemble(int nuisance, Linearisation::Group& group) {
    int rows = 0;
    for (int block : group.blocks) {
      group.first_row.push_back(rows);
      rows += problem_.residual_blocks[block].size;
      for (int k : problem_.residual_blocks[block].parameter_blocks) {
        if (k == nuisance) continue;
        for (int entry = first_[k]; entry < first_[k + 1]; ++entry) {
          group.columns.push_back(position_[entry]);
        }
      }
    }
    std::sort(group.columns.begin(), group.columns.end());
    group.columns.erase(std::unique(group.columns.begin(), group.columns.end()),
                        group.columns.end());
    for (std::size_t c = 0; c < group.columns.size(); ++c) {
      local_[group.columns[c]] = static_cast<int>(c);
    }
    group.jacobian.setZero(rows, static_cast<Eigen::Index>(group.columns.size()));
    Eigen::MatrixXd own =
        Eigen::MatrixXd::Zero(rows, nuisance < 0 ? 0 : problem_.parameter_blocks[nuisance]);
    for (std::size_t b = 0; b < group.blocks.size(); ++b) {
      AddBlock(group.blocks[b], group.first_row[b], nuisance, group, own);
    }
    return own;
  }

 private:
  void AddBlock(int block, int row, int nuisance, Linearisation::Group& group,
                Eigen::MatrixXd& own) {
    const auto& shape = problem_.residual_blocks[block];
    for (std::size_t k = 0; k < shape.parameter_blocks.size(); ++k) {
      const int parameter = shape.parameter_blocks[k];
      part_.resize(static_cast<Eigen::Index>(shape.size) * problem_.parameter_blocks[parameter]);
      Eigen::Map<LeastSquaresProblem::RowMajorMatrix> J(part_.data(), shape.size,
                                                        problem_.parameter_blocks[parameter]);
      problem_.Jacobian(block, static_cast<int>(k), J);
      if (parameter == nuisance) {
        own.middleRows(row, shape.size) = J;
        continue;
      }
      for (Eigen::Index c = 0; c < J.cols(); ++c) {
        const int entry = first_[parameter] + static_cast<int>(c);
        group.jacobian.block(row, local_[position_[entry]], shape.size, 1) = J.col(c);
      }
    }
  }

  const LeastSquaresProblem& problem_;
  std::vector<int> first_;
  const std::vector<int>& position_;  // of an entry of x among the unknowns; -1
  std::vector<int> local_;            // of an unknown among the columns of the group in hand
  Eigen::VectorXd part_;
};

/// 1 for rows of active blocks, 0 for others.
Eigen::VectorXd Activity(const LeastSquaresProblem& problem, const Linearisation::Group& group) {
  Eigen::VectorXd activity(group.jacobian.rows());
  for (std::size_t b = 0; b < group.blocks.size(); ++b) {
    const auto& shape = problem.residual_blocks[group.blocks[b]];
    activity.segment(group.first_row[b], shape.size).setConstant(shape.active ? 1.0 : 0.0);
  }
  return activity;
}

void Eliminate(const Eigen::MatrixXd& own, const Eigen::VectorXd& activity,
               Linearisation::Group& group) {
  Eigen::MatrixXd H = own.transpose() * activity.asDiagonal() * own;
  H.diagonal().array() += kRidge;
  const Eigen::LLT<Eigen::MatrixXd> factor(H);
  const Eigen::MatrixXd gain = factor.solve(own.transpose());
  group.nuisance = own * gain;
  group.jacobian -= own * (gain * activity.asDiagonal() * group.jacobian);
}

}  // namespace

Linearisation Linearise(LeastSquaresProblem& problem, const Eigen::VectorXd& x,
                        const std::vector<int>& nuisance_blocks) {
  problem.Evaluate(x, true);
  std::vector<char> is_nuisance(problem.parameter_blocks.size(), 0);
  for (int k : nuisance_blocks) is_nuisance[k] = 1;

  Linearisation linearisation;
  std::vector<int> position;
  for (std::size_t k = 0; k < problem.parameter_blocks.size(); ++k) {
    for (int i = 0; i < problem.parameter_blocks[k]; ++i) {
      const auto entry = static_cast<int>(position.size());
      position.push_back(is_nuisance[k] ? -1 : static_cast<int>(linearisation.unknowns.size()));
      if (!is_nuisance[k]) linearisation.unknowns.push_back(entry);
    }
  }
  std::vector<int> nuisance_of_group;
  linearisation.groups = MakeGroups(problem, is_nuisance, nuisance_of_group);
  const auto size = static_cast<Eigen::Index>(linearisation.unknowns.size());
  linearisation.information.setZero(size, size);
  Assembler assembler(problem, position);
  for (std::size_t g = 0; g < linearisation.groups.size(); ++g) {
    Linearisation::Group& group = linearisation.groups[g];
    const Eigen::MatrixXd own = assembler.Assemble(nuisance_of_group[g], group);
    const Eigen::VectorXd activity = Activity(problem, group);
    if (own.cols() > 0) Eliminate(own, activity, group);
    const Eigen::MatrixXd active = activity.asDiagonal() * group.jacobian;
    const auto width = active.cols();
    Eigen::MatrixXd own_information = Eigen::MatrixXd::Zero(width, width);
    own_information.selfadjointView<Eigen::Lower>().rankUpdate(active.transpose());
    own_information.triangularView<Eigen::StrictlyUpper>() = own_information.transpose();
    linearisation.information(group.columns, group.columns) += own_information;
  }
  return linearisation;
}

std::vector<Eigen::MatrixXd> ExplainedCovariances(const Linearisation& linearisation,
                                                  const Eigen::MatrixXd& covariance) {
  std::vector<Eigen::MatrixXd> explained;
  for (const Linearisation::Group& group : linearisation.groups) {
    const Eigen::MatrixXd own = covariance(group.columns, group.columns);
    const Eigen::MatrixXd spread = group.jacobian * own;
    for (std::size_t b = 0; b < group.blocks.size(); ++b) {
      const int begin = group.first_row[b];
      const Eigen::Index end =
          b + 1 < group.blocks.size() ? group.first_row[b + 1] : group.jacobian.rows();
      const Eigen::Index size = end - begin;
      const auto block = static_cast<std::size_t>(group.blocks[b]);
      if (explained.size() <= block) explained.resize(block + 1);
      explained[block] =
          spread.middleRows(begin, size) * group.jacobian.middleRows(begin, size).transpose();
      if (group.nuisance.size() > 0) {
        explained[block] += group.nuisance.block(begin, begin, size, size);
      }
    }
  }
  return explained;
}

}  // namespace elastocal
