#include "elastocal/io/urdf_reader.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <mutex>
#include <set>

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include "elastocal/io/output_files.hpp"
#include "elastocal/io/text.hpp"
#include "elastocal/io/urdf_document.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Collects what urdfdom would print.
class CapturedLog : public console_bridge::OutputHandler {
 public:
  CapturedLog() : previous_(console_bridge::getOutputHandler()) {
    console_bridge::useOutputHandler(this);
  }
  CapturedLog(const CapturedLog&) = delete;
  CapturedLog& operator=(const CapturedLog&) = delete;
  ~CapturedLog() override { console_bridge::useOutputHandler(previous_); }

  void log(const std::string& text, console_bridge::LogLevel, const char*, int) override {
    text_ += (text_.empty() ? "" : "; ") + text;
  }
  const std::string& text() const { return text_; }

 private:
  console_bridge::OutputHandler* previous_;
  std::string text_;
};

urdf::ModelInterfaceSharedPtr ReadModel(const UrdfDocument& document, const std::string& source) {
  static std::mutex mutex;  // the log handler is one for the whole process
  const std::lock_guard<std::mutex> lock(mutex);
  const CapturedLog log;
  urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(document.canonical);
  if (model == nullptr) throw InputError(source + ": not a usable URDF: " + log.text());
  return model;
}

Transform ToTransform(const urdf::Pose& pose) {
  Eigen::Quaterniond rotation;
  pose.rotation.getQuaternion(rotation.x(), rotation.y(), rotation.z(), rotation.w());
  return Eigen::Translation3d(pose.position.x, pose.position.y, pose.position.z) *
         rotation.normalized();
}

Link ToLink(const urdf::Link& source) {
  Link link;
  link.name = source.name;
  link.T_body_link = Transform::Identity();
  if (source.inertial == nullptr) return link;
  const urdf::Inertial& inertial = *source.inertial;
  const Transform T_link_inertial = ToTransform(inertial.origin);
  Eigen::Matrix3d inertia;
  inertia << inertial.ixx, inertial.ixy, inertial.ixz,  //
      inertial.ixy, inertial.iyy, inertial.iyz,         //
      inertial.ixz, inertial.iyz, inertial.izz;
  link.mass = inertial.mass;
  link.com = T_link_inertial.translation();
  link.inertia = T_link_inertial.linear() * inertia * T_link_inertial.linear().transpose();
  return link;
}

JointLimits ToLimits(const urdf::Joint& source) {
  JointLimits limits = {-kInfinity, kInfinity, kInfinity, kInfinity};
  if (source.limits == nullptr) return limits;
  limits.velocity = source.limits->velocity;
  limits.effort = source.limits->effort;
  if (source.type == urdf::Joint::CONTINUOUS) return limits;
  limits.lower = source.limits->lower;
  limits.upper = source.limits->upper;
  return limits;
}

/// How a joint moves: position = multiplier * q[coordinate] + offset.
struct Motion {
  double multiplier, offset;
  int coordinate;
};

/// Builds the tree of bodies outwards from the root.
class TreeBuilder {
 public:
  TreeBuilder(const UrdfDocument& document, const urdf::ModelInterface& model,
              const std::string& source)
      : document_(document), model_(model), source_(source) {}

  RobotTree Build() {
    tree_.name = model_.getName();
    AddLinks();
    ListChildJoints();
    Reach(0);
    while (!ready_.empty()) {
      const int next = *ready_.begin();
      ready_.erase(ready_.begin());
      AddMovable(document_.joints[next]);
    }
    AssignCoordinates();
    return std::move(tree_);
  }

 private:
  const urdf::Joint& Source(const std::string& joint) const {
    const urdf::JointConstSharedPtr found = model_.getJoint(joint);
    if (found == nullptr) throw InputError(source_ + ": urdfdom has no joint " + Quote(joint));
    return *found;
  }

  void AddLink(const std::string& name) {
    const urdf::LinkConstSharedPtr found = model_.getLink(name);
    if (found == nullptr) throw InputError(source_ + ": urdfdom has no link " + Quote(name));
    tree_.links.push_back(ToLink(*found));
  }

  void AddLinks() {
    AddLink(document_.root);
    for (const std::string& name : document_.links) {
      if (name != document_.root) AddLink(name);
    }
    for (std::size_t i = 0; i < tree_.links.size(); ++i) {
      link_index_[tree_.links[i].name] = static_cast<int>(i);
    }
  }

  void ListChildJoints() {
    child_joints_.resize(tree_.links.size());
    for (std::size_t j = 0; j < document_.joints.size(); ++j) {
      const UrdfJoint& joint = document_.joints[j];
      if (!joint.dropped)
        child_joints_[link_index_.at(joint.parent)].push_back(static_cast<int>(j));
    }
  }

  /// Links fixed to a reached one are reached with it; movable joints on it become ready.
  void Reach(int first) {
    std::vector<int> reached = {first};
    while (!reached.empty()) {
      const int parent = reached.back();
      reached.pop_back();
      for (int j : child_joints_[parent]) {
        const UrdfJoint& joint = document_.joints[j];
        if (joint.type != "fixed") {
          ready_.insert(j);
          continue;
        }
        Link& child = tree_.links[link_index_.at(joint.child)];
        child.body = tree_.links[parent].body;
        child.T_body_link = tree_.links[parent].T_body_link * Origin(joint.name);
        reached.push_back(link_index_.at(joint.child));
      }
    }
  }

  Transform Origin(const std::string& joint) const {
    return ToTransform(Source(joint).parent_to_joint_origin_transform);
  }

  void AddMovable(const UrdfJoint& description) {
    const urdf::Joint& source = Source(description.name);
    Joint joint;
    joint.name = description.name;
    joint.type =
        source.type == urdf::Joint::PRISMATIC ? JointType::kPrismatic : JointType::kRevolute;
    joint.parent_link = link_index_.at(description.parent);
    joint.child_link = link_index_.at(description.child);
    joint.parent_body = tree_.links[joint.parent_link].body;
    joint.T_parent_child = Origin(description.name);
    joint.axis = Eigen::Vector3d(source.axis.x, source.axis.y, source.axis.z).normalized();
    joint.limits = ToLimits(source);
    joint.mimic = source.mimic != nullptr;
    tree_.joints.push_back(joint);
    tree_.links[joint.child_link].body = static_cast<int>(tree_.joints.size());
    Reach(joint.child_link);
  }

  void AssignCoordinates() {
    for (std::size_t k = 0; k < tree_.joints.size(); ++k) {
      if (tree_.joints[k].mimic) continue;
      motions_[tree_.joints[k].name] = Motion{1.0, 0.0, tree_.coordinate_count()};
      tree_.coordinate_joint.push_back(static_cast<int>(k));
    }
    for (Joint& joint : tree_.joints) {
      const Motion motion = FollowMimic(joint.name);
      if (!std::isfinite(motion.offset) || !std::isfinite(motion.multiplier)) {
        throw InputError(source_ + ": joint " + Quote(joint.name) +
                         " mimics others with a multiplier or offset that is not finite");
      }
      joint.multiplier = motion.multiplier;
      joint.offset = motion.offset;
      joint.coordinate = motion.coordinate;
    }
  }

  /// Along a line of mimic joints: position = m (m' q + o') + o.
  Motion FollowMimic(std::string name) {
    std::vector<std::string> followers;
    for (; !motions_.contains(name); name = Source(name).mimic->joint_name) {
      followers.push_back(name);
    }
    Motion motion = motions_.at(name);
    std::reverse(followers.begin(), followers.end());
    for (const std::string& follower : followers) {
      const auto mimic = Source(follower).mimic;
      motion.offset = mimic->multiplier * motion.offset + mimic->offset;
      motion.multiplier *= mimic->multiplier;
      motions_[follower] = motion;
    }
    return motion;
  }

  const UrdfDocument& document_;
  const urdf::ModelInterface& model_;
  const std::string& source_;
  RobotTree tree_;
  std::map<std::string, int> link_index_;
  std::vector<std::vector<int>> child_joints_;  ///< of every link, in the order of the file
  std::map<std::string, Motion> motions_;       ///< of the joints done so far
  std::set<int> ready_;                         ///< movable joints whose parent link is placed
};

}  // namespace

RobotTree ReadUrdf(const std::filesystem::path& file) {
  return ParseUrdf(ReadFile(file), file.string());
}

RobotTree ParseUrdf(const std::string& text, const std::string& source) {
  const UrdfDocument document = CheckUrdf(text, source);
  const urdf::ModelInterfaceSharedPtr model = ReadModel(document, source);
  return TreeBuilder(document, *model, source).Build();
}

}  // namespace elastocal
