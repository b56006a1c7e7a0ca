// SPDX-License-Identifier: Apache-2.0
#include "elastocal/drafting/limbs.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <set>

#include "elastocal/drafting/limb_names.hpp"
#include "elastocal/math/numbers.hpp"
#include "elastocal/motion/leg_chain.hpp"
#include "elastocal/robot/legs.hpp"
#include "elastocal/robot/moving_chain.hpp"

namespace elastocal {
namespace {

/// Reach of the branch beyond a body: the longest sum of distances between its joints, m.
double Reach(const RobotTree& tree, int body) {
  double longest = 0.0;
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    const Joint& joint = tree.joints[k];
    if (joint.parent_body != body) continue;
    const Eigen::Vector3d offset =
        tree.links[Size(joint.parent_link)].T_body_link * joint.T_parent_child.translation();
    longest = std::max(longest, offset.norm() + Reach(tree, static_cast<int>(k) + 1));
  }
  return longest;
}

std::vector<int> Branches(const RobotTree& tree, int body) {
  std::vector<int> bodies;
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    if (tree.joints[k].parent_body == body) bodies.push_back(static_cast<int>(k) + 1);
  }
  return bodies;
}

void MarkBeyond(const RobotTree& tree, int body, std::vector<bool>& marked) {
  for (const int next : Branches(tree, body)) {
    marked[Size(next)] = true;
    MarkBeyond(tree, next, marked);
  }
}

/// Whether some joint beyond a body follows no other one, as in a neck whose upper bend follows the
/// lower one. In a finger, all joints beyond a following joint follow, too.
bool MovesByItselfBeyond(const RobotTree& tree, int body) {
  const std::vector<int> branches = Branches(tree, body);
  return std::any_of(branches.begin(), branches.end(), [&](int next) {
    return !tree.joints[Size(next - 1)].mimic || MovesByItselfBeyond(tree, next);
  });
}

/// Largest number of joints beyond a body, up to the end of a branch.
int JointsBeyond(const RobotTree& tree, int body) {
  int most = 0;
  for (const int next : Branches(tree, body)) most = std::max(most, 1 + JointsBeyond(tree, next));
  return most;
}

/// Whether some branches of a body are fingers at the far end of a long link, as of a forearm
/// without a wrist: they have joints alike, or one follows another, and the largest distance
/// between two of them plus their reach is at most `most`, m.
bool AreFingersFarOut(const RobotTree& tree, const std::vector<int>& branches, double most) {
  if (branches.size() < 2) return false;
  constexpr int kAlike = 1;  // a thumb often has one joint more or less than a finger
  int least_joints = std::numeric_limits<int>::max(), most_joints = 0;
  bool follows = false;
  double spread = 0.0, reach = 0.0;
  const auto place = [&](int branch) -> Eigen::Vector3d {
    const Joint& joint = tree.joints[Size(branch - 1)];
    return tree.links[Size(joint.parent_link)].T_body_link * joint.T_parent_child.translation();
  };
  for (const int branch : branches) {
    least_joints = std::min(least_joints, JointsBeyond(tree, branch));
    most_joints = std::max(most_joints, JointsBeyond(tree, branch));
    follows = follows || tree.joints[Size(branch - 1)].mimic;
    reach = std::max(reach, Reach(tree, branch));
    for (const int other : branches) {
      spread = std::max(spread, (place(branch) - place(other)).norm());
    }
  }
  return (follows || most_joints - least_joints <= kAlike) && spread + reach <= most;
}

/// Marks bodies that belong to a gripper or to fingers.
std::vector<bool> FindTools(const RobotTree& tree) {
  constexpr double kShort = 0.22;
  constexpr double kFinger = 0.12;  // m: largest travel of a finger
  constexpr std::size_t kLeastJoints = 3;
  const double longest = LongestBranch(tree);
  std::vector<bool> tool(Size(tree.body_count()), false);
  for (int body = 1; body < tree.body_count(); ++body) {
    const std::vector<int> branches = Branches(tree, body);
    if (JointsToBody(tree, body).size() < kLeastJoints || branches.empty()) continue;
    const double most = kShort * longest;
    if (Reach(tree, body) > most && !AreFingersFarOut(tree, branches, most)) continue;
    const bool mimics = std::any_of(branches.begin(), branches.end(), [&](int b) {
      return tree.joints[Size(b - 1)].mimic && !MovesByItselfBeyond(tree, b);
    });
    const Joint& only = tree.joints[Size(branches[0] - 1)];
    const bool jaw =
        only.type == JointType::kPrismatic && only.limits.upper - only.limits.lower <= kFinger;
    if (branches.size() > 1 || mimics || jaw) MarkBeyond(tree, body, tool);
  }
  return tool;
}

bool TurnsWithoutEnd(const Joint& joint) {
  return joint.type == JointType::kRevolute && !std::isfinite(joint.limits.lower);
}

/// Whether the name of the body's joint or of one of its links is that of a wheel.
bool NamedWheel(const RobotTree& tree, int body) {
  const auto says = [](const std::string& name) {
    const std::vector<std::string> words = WordsOf(name);
    return std::any_of(words.begin(), words.end(), [](const std::string& word) {
      return word.find("wheel") == 0 || word.find("caster") == 0 || word.find("castor") == 0;
    });
  };
  return says(tree.joints[Size(body) - 1].name) ||
         std::any_of(tree.links.begin(), tree.links.end(),
                     [&](const Link& link) { return link.body == body && says(link.name); });
}

/// Marks wheels as tools: bodies that turn without limits and carry nothing but other wheels. They
/// have such names, or one or two joints without limits carry them, or several of them are next to
/// each other.
void MarkWheels(const RobotTree& tree, std::vector<bool>& tool) {
  constexpr std::size_t kMostJoints = 2;
  std::vector<bool> wheel(Size(tree.body_count()), false);
  const auto end = [&](int body) {
    return Branches(tree, body).empty() && TurnsWithoutEnd(tree.joints[Size(body) - 1]);
  };
  for (int body = tree.body_count() - 1; body > 0; --body) {
    const std::vector<int> carried = Branches(tree, body);
    if (!TurnsWithoutEnd(tree.joints[Size(body) - 1]) ||
        !std::all_of(carried.begin(), carried.end(), [&](int b) { return wheel[Size(b)]; })) {
      continue;
    }
    const std::vector<int> joints = JointsToBody(tree, body);
    const bool near_root =
        joints.size() <= kMostJoints && std::all_of(joints.begin(), joints.end(), [&](int k) {
          return TurnsWithoutEnd(tree.joints[Size(k)]);
        });
    const std::vector<int> beside = Branches(tree, tree.joints[Size(body) - 1].parent_body);
    const bool several = end(body) && std::count_if(beside.begin(), beside.end(), end) > 1;
    wheel[Size(body)] = near_root || several || NamedWheel(tree, body);
    tool[Size(body)] = tool[Size(body)] || wheel[Size(body)];
  }
}

/// The nearest body towards the root on which several limbs begin.
int BranchBody(const RobotTree& tree, const std::vector<bool>& tool, int tip) {
  int body = tip;
  while (body != 0) {
    body = tree.joints[Size(body - 1)].parent_body;
    int limbs = 0;
    for (const int b : Branches(tree, body)) limbs += tool[Size(b)] ? 0 : 1;
    if (limbs > 1) return body;
  }
  return 0;
}

std::string FileName(const std::string& text) {
  std::string name;
  for (const char c : text) {
    const bool plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
    name += plain && static_cast<unsigned char>(c) < 128 ? c : '_';
  }
  return name.empty() ? "limb" : name;
}

int LinkNamed(const RobotTree& tree, const std::string& name) {
  for (std::size_t i = 0; i < tree.links.size(); ++i) {
    if (tree.links[i].name == name) return static_cast<int>(i);
  }
  return -1;
}

/// Whether a group contains exactly the end of this limb.
bool Names(const SemanticGroup& group, const RobotTree& tree, const Limb& limb) {
  const int tip = group.tip_link.empty() ? -1 : LinkNamed(tree, group.tip_link);
  if (tip >= 0) return tree.links[Size(tip)].body == limb.tip_body;
  bool last = false;
  for (const std::string& name : group.joints) {
    const auto joint = std::find_if(tree.joints.begin(), tree.joints.end(),
                                    [&](const Joint& j) { return j.name == name; });
    if (joint == tree.joints.end()) continue;  // a fixed joint
    const int k = static_cast<int>(joint - tree.joints.begin());
    if (std::find(limb.joints.begin(), limb.joints.end(), k) == limb.joints.end()) return false;
    last = last || k == limb.joints.back();
  }
  return last;
}

/// Name of the first group that contains exactly the end of this limb; empty: none does.
std::string GroupOf(const RobotTree& tree, const Semantics& semantics, const Limb& limb) {
  for (const SemanticGroup& group : semantics.groups) {
    if (Names(group, tree, limb)) return group.name;
  }
  return "";
}

/// The link that the SRDF names as the end, or the furthest link of the last body.
int TipLink(const RobotTree& tree, const Semantics& semantics, const Limb& limb) {
  std::vector<std::string> named = semantics.end_links;
  for (const SemanticGroup& group : semantics.groups) {
    if (!group.tip_link.empty()) named.push_back(group.tip_link);
  }
  for (const std::string& name : named) {
    const int link = LinkNamed(tree, name);
    if (link >= 0 && tree.links[Size(link)].body == limb.tip_body) return link;
  }
  int furthest = BodyLink(tree, limb.tip_body);
  double distance = 1e-6;
  for (std::size_t i = 0; i < tree.links.size(); ++i) {
    if (tree.links[i].body != limb.tip_body) continue;
    const double d = tree.links[i].T_body_link.translation().norm();
    if (d > distance + 1e-6) {
      distance = d;
      furthest = static_cast<int>(i);
    }
  }
  return furthest;
}

void PairMirrors(const RobotTree& tree, std::vector<Limb>& limbs) {
  const auto poses = BodyPoses(tree, Eigen::VectorXd::Zero(tree.coordinate_count()));
  for (std::size_t i = 0; i < limbs.size(); ++i) {
    for (std::size_t j = i + 1; j < limbs.size(); ++j) {
      if (limbs[i].mirror >= 0 || limbs[j].mirror >= 0) continue;
      if (!LookAlike(tree, poses, limbs[i], limbs[j], Eigen::Vector3d::UnitY(), 0.0)) continue;
      limbs[i].mirror = static_cast<int>(j);
      limbs[j].mirror = static_cast<int>(i);
    }
  }
}

/// Height above the root link, in the zero posture, of the first joint that belongs to this limb
/// only, m.
double BeginOf(const RobotTree& tree, const std::vector<Transform>& poses, const Limb& limb) {
  const auto own = std::find_if(limb.joints.begin(), limb.joints.end(), [&](int k) {
    return tree.joints[Size(k)].parent_body == limb.from_body;
  });
  return own == limb.joints.end() ? 0.0 : poses[Size(*own) + 1].translation().z();
}

/// Finds the legs. Heights are relative to the root link or, where that is a frame on the floor, to
/// the hips.
void FindFeet(const RobotTree& tree, const RobotShapes& shapes, std::vector<Limb>& limbs) {
  constexpr double kSameFloor = 0.08, kBelow = 0.25;  // of the longest limb
  const auto poses = BodyPoses(tree, Eigen::VectorXd::Zero(tree.coordinate_count()));
  const double longest = LongestBranch(tree);
  std::vector<double> lowest(limbs.size(), std::numeric_limits<double>::infinity());
  double floor = 0.0;
  for (std::size_t i = 0; i < limbs.size(); ++i) {
    const int body = limbs[i].tip_body;
    for (const Eigen::Vector3d& p : shapes.bodies[Size(body)].points) {
      lowest[i] = std::min(lowest[i], (poses[Size(body)] * p).z());
    }
    floor = std::min(floor, lowest[i]);
  }
  const bool root_on_floor = floor > -kSameFloor * longest;
  for (std::size_t i = 0; i < limbs.size(); ++i) {
    Limb& limb = limbs[i];
    const double top = root_on_floor ? LegTop(tree, limb.joints) : 0.0;
    const bool far_below = poses[Size(limb.tip_body)].translation().z() < top - kBelow * longest;
    const bool above = !root_on_floor && BeginOf(tree, poses, limb) > kBelow * longest;
    limb.leg = limb.mirror >= 0 && far_below && !above &&
               lowest[i] < floor + kSameFloor * longest && !IsArmByNames(tree, limb);
  }
}

/// Height of the lowest point of a body's shape in the zero posture, m; infinite where no shape
/// says.
double LowestPoint(const RobotShapes& shapes, const std::vector<Transform>& poses, int body) {
  double lowest = std::numeric_limits<double>::infinity();
  if (shapes.bodies[Size(body)].guessed) return lowest;
  for (const Eigen::Vector3d& p : shapes.bodies[Size(body)].points) {
    lowest = std::min(lowest, (poses[Size(body)] * p).z());
  }
  return lowest;
}

bool HasSole(const RobotTree& tree, int body) {
  return std::any_of(tree.links.begin(), tree.links.end(),
                     [&](const Link& link) { return link.body == body && NamedSole(link.name); });
}

/// Whether the last body of a leg is a toe. The foot is then the body in front of the toe's joint:
/// one that touches the floor as the toe does, or that has a link named as a sole. To place the
/// foot, the leg must have joints enough of its own without the toe.
bool EndsWithToe(const RobotTree& tree, const RobotShapes& shapes,
                 const std::vector<Transform>& poses, const Limb& leg) {
  constexpr double kSameFloor = 0.005;  // of the longest limb: 6 mm of one of 1.25 m
  const int foot = tree.joints[Size(leg.tip_body) - 1].parent_body;
  const int hip = BodyLink(tree, leg.from_body);
  if (ChainCoordinates(tree, hip, BodyLink(tree, foot)).size() < LeastLegJoints(false)) {
    return false;
  }
  const double higher = LowestPoint(shapes, poses, foot) - LowestPoint(shapes, poses, leg.tip_body);
  const bool named = HasSole(tree, foot) && !HasSole(tree, leg.tip_body);
  return named || std::abs(higher) < kSameFloor * LongestBranch(tree);
}

/// Takes the toes from pairs of legs: from both, or from none.
void LeaveOutToes(const RobotTree& tree, const RobotShapes& shapes, const Semantics& semantics,
                  Limbs& found) {
  const auto poses = BodyPoses(tree, Eigen::VectorXd::Zero(tree.coordinate_count()));
  const auto ends = [&](const Limb& leg) { return EndsWithToe(tree, shapes, poses, leg); };
  for (Limb& leg : found.limbs) {
    if (!leg.leg) continue;
    Limb& other = found.limbs[Size(leg.mirror)];
    while (other.leg && ends(leg) && ends(other)) {
      for (Limb* one : {&leg, &other}) {
        const int foot = tree.joints[Size(one->tip_body) - 1].parent_body;
        found.tool[Size(one->tip_body)] = true;
        found.toes.insert(one->tip_body);
        one->tip_body = foot;
        one->joints = JointsToBody(tree, foot);
        one->tip_link = TipLink(tree, semantics, *one);
      }
    }
  }
}

}  // namespace

bool LookAlike(const RobotTree& tree, const std::vector<Transform>& T_root_body, const Limb& a,
               const Limb& b, const Eigen::Vector3d& normal, double offset) {
  constexpr double kSamePlace = 0.02, kAside = 0.01;
  if (a.from_body != b.from_body || a.joints.size() != b.joints.size()) return false;
  const double longest = LongestBranch(tree);
  bool aside = false;
  for (std::size_t i = 0; i < a.joints.size(); ++i) {
    if (a.joints[i] == b.joints[i]) continue;  // of the trunk
    const Eigen::Vector3d here = T_root_body[Size(a.joints[i]) + 1].translation();
    const Eigen::Vector3d there = T_root_body[Size(b.joints[i]) + 1].translation();
    const double height = normal.dot(here) - offset;
    if ((there - (here - 2.0 * height * normal)).norm() > kSamePlace * longest) return false;
    if (tree.joints[Size(a.joints[i])].type != tree.joints[Size(b.joints[i])].type) return false;
    aside = aside || std::abs(height) > kAside * longest;
  }
  return aside;
}

Limbs FindLimbs(const RobotTree& tree, const RobotShapes& shapes, const Semantics& semantics) {
  Limbs found;
  found.tool = FindTools(tree);
  const std::vector<bool> fingers = found.tool;
  MarkWheels(tree, found.tool);
  if (std::count(found.tool.begin() + 1, found.tool.end(), false) == 0) found.tool = fingers;
  for (int body = 1; body < tree.body_count(); ++body) {
    const std::vector<int> branches = Branches(tree, body);
    const bool ends =
        std::all_of(branches.begin(), branches.end(), [&](int b) { return found.tool[Size(b)]; });
    if (found.tool[Size(body)] || !ends) continue;
    Limb limb;
    limb.tip_body = body;
    limb.from_body = BranchBody(tree, found.tool, body);
    limb.joints = JointsToBody(tree, body);
    limb.tip_link = TipLink(tree, semantics, limb);
    found.limbs.push_back(std::move(limb));
  }
  PairMirrors(tree, found.limbs);
  FindFeet(tree, shapes, found.limbs);
  const std::vector<Limb> with_toes = found.limbs;
  LeaveOutToes(tree, shapes, semantics, found);
  std::set<std::string> used;
  for (std::size_t i = 0; i < found.limbs.size(); ++i) {
    Limb& limb = found.limbs[i];
    std::string name = GroupOf(tree, semantics, limb);
    if (name.empty()) name = GroupOf(tree, semantics, with_toes[i]);
    if (name.empty()) name = NameLimb(tree, found.limbs, limb);
    limb.name = FileName(name);
    for (int n = 2; !used.insert(limb.name).second; ++n) {
      limb.name = FileName(name) + "_" + std::to_string(n);
    }
  }
  return found;
}

}  // namespace elastocal
