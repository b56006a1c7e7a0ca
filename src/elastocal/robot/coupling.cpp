// SPDX-License-Identifier: Apache-2.0
#include "elastocal/robot/coupling.hpp"

#include <cmath>
#include <map>
#include <set>
#include <string>

#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

/// A position as a linear function of entries of q.
struct Expression {
  std::map<int, double> factors;  ///< by entry of q
  double offset = 0.0;
};

/// Expresses positions by the entries of q that remain: a coupling removes that of its joint.
class Substitution {
 public:
  Substitution(const RobotTree& tree, const std::vector<Coupling>& couplings) : tree_(tree) {
    for (const Coupling& coupling : couplings) {
      const Joint& joint = tree.joints[coupling.joint];
      if (joint.mimic) {
        throw InputError("joint '" + joint.name + "' follows a joint of the URDF already");
      }
      if (!couplings_.emplace(joint.coordinate, &coupling).second) {
        throw InputError("joint '" + joint.name + "' is coupled twice");
      }
    }
  }

  bool IsTaken(int coordinate) const { return couplings_.contains(coordinate); }

  Expression OfJoint(int k) {
    const Joint& joint = tree_.joints[k];
    Expression sum{{}, joint.offset};
    for (const Drive& drive : DrivesOf(joint)) {
      Add(OfCoordinate(drive.coordinate), drive.multiplier, sum);
    }
    return sum;
  }

 private:
  static void Add(const Expression& more, double factor, Expression& sum) {
    for (const auto& [coordinate, f] : more.factors) sum.factors[coordinate] += factor * f;
    sum.offset += factor * more.offset;
  }

  Expression OfCoordinate(int coordinate) {
    const auto found = couplings_.find(coordinate);
    if (found == couplings_.end()) return {{{coordinate, 1.0}}, 0.0};
    const auto known = done_.find(coordinate);
    if (known != done_.end()) return known->second;
    const Coupling& coupling = *found->second;
    const std::string name = "joint '" + tree_.joints[coupling.joint].name + "'";
    if (!open_.insert(coordinate).second) throw InputError(name + " follows itself in the end");
    Expression sum{{}, coupling.offset};
    for (const auto& [joint, factor] : coupling.of) Add(OfJoint(joint), factor, sum);
    bool finite = std::isfinite(sum.offset);
    for (const auto& [unused, factor] : sum.factors) finite = finite && std::isfinite(factor);
    if (!finite) throw InputError(name + " follows others with a factor that is not finite");
    open_.erase(coordinate);
    return done_[coordinate] = sum;
  }

  const RobotTree& tree_;
  std::map<int, const Coupling*> couplings_;  ///< by the entry of q that each removes
  std::map<int, Expression> done_;            ///< finished expressions, by removed entry of q
  std::set<int> open_;                        ///< entries whose expression is being written
};

}  // namespace

RobotTree Couple(RobotTree tree, const std::vector<Coupling>& couplings) {
  const RobotTree free = tree;
  Substitution substitution(free, couplings);
  std::map<int, int> left;  // entry of q -> that of the coupled robot
  tree.coordinate_joint.clear();
  for (int c = 0; c < free.coordinate_count(); ++c) {
    if (substitution.IsTaken(c)) continue;
    left[c] = tree.coordinate_count();
    tree.coordinate_joint.push_back(free.coordinate_joint[c]);
  }
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    const Expression position = substitution.OfJoint(static_cast<int>(k));
    Joint& joint = tree.joints[k];
    if (substitution.IsTaken(joint.coordinate)) joint.mimic = true;
    joint.offset = position.offset;
    joint.more.clear();
    bool first = true;
    for (const auto& [coordinate, factor] : position.factors) {
      if (first) {
        joint.coordinate = left.at(coordinate);
        joint.multiplier = factor;
      } else if (factor != 0.0) {
        joint.more.push_back({left.at(coordinate), factor});
      }
      first = false;
    }
  }
  return tree;
}

void CopyDrives(const RobotTree& from, RobotTree& to) {
  for (std::size_t k = 0; k < to.joints.size(); ++k) {
    const Joint& source = from.joints.at(k);
    Joint& joint = to.joints[k];
    joint.coordinate = source.coordinate;
    joint.multiplier = source.multiplier;
    joint.offset = source.offset;
    joint.mimic = source.mimic;
    joint.more = source.more;
  }
  to.coordinate_joint = from.coordinate_joint;
}

}  // namespace elastocal
