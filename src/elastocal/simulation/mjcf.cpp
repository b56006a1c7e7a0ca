// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/mjcf.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <stdexcept>

#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/robot/inverse_dynamics.hpp"
#include "elastocal/robot/physical_inertia.hpp"
#include "elastocal/robot/statics.hpp"
#include "elastocal/simulation/standing_feet.hpp"

namespace elastocal {
namespace {

std::string Number(double value) {
  std::array<char, 32> buffer{};
  const auto [end, error] = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return {buffer.data(), end};
}

template <typename Vector>
std::string Numbers(const Vector& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : " ") + Number(value);
  return text;
}

std::string Attribute(const std::string& name, const std::string& value) {
  return " " + name + "=\"" + value + "\"";
}

std::string PoseAttributes(const Transform& T) {
  const Eigen::Quaterniond q(T.linear());
  return Attribute("pos", Numbers(Eigen::Vector3d(T.translation()))) +
         Attribute("quat", Numbers(Eigen::Vector4d(q.w(), q.x(), q.y(), q.z())));
}

/// Writes the bodies, walking over the tree from the waist, which is fixed or floats.
class MjcfWriter {
 public:
  MjcfWriter(const TrueRobot& robot, const std::vector<int>& support, const PhysicsOptions& options,
             const std::vector<PhysicalPlate>& plates)
      : robot_(robot),
        tree_(robot.tree),
        support_(support),
        options_(options),
        plates_(plates),
        torques_(LargestGravityTorques(robot.tree)) {}

  std::string text;

  /// Attributes of parts that touch the floor. The contact gives way by hundredths of a millimetre
  /// under a robot on one foot, because soles have springs of their own (MuJoCo's default gives way
  /// by half a millimetre).
  std::string OnFloor() const {
    return Attribute("friction", Number(options_.floor_friction) + " 0.01 0.001") +
           R"( solimp="0.99 0.99 0.001")";
  }

  /// Writes the tables, far below.
  void WriteTables() {
    for (std::size_t i = 0; i < plates_.size(); ++i) {
      text += "<body" + Attribute("name", "t" + std::to_string(i)) +
              R"( mocap="true" pos="0 0 -100"><geom type="plane" size="1 1 0.1")" +
              ContactOf(i, "contype") + "/></body>\n";
    }
  }

  /// Writes the waist, which is fixed to the world or floats, and everything beyond it.
  void WriteFromWaist(const Transform& T_world_waist, bool floating) {
    OpenBody(0, T_world_waist);
    if (floating) text += "<freejoint name=\"float\"/>\n";
    Contents(0);
  }

 private:
  const Link& FootLink(int sole) const {
    return tree_.links[static_cast<std::size_t>(support_[static_cast<std::size_t>(sole)])];
  }
  const Joint& JointAt(int k) const { return tree_.joints[static_cast<std::size_t>(k)]; }

  /// Pose of a joint's body in the body that carries it, at position 0.
  Transform JointPlacement(int k) const {
    const Joint& joint = JointAt(k);
    return tree_.links[static_cast<std::size_t>(joint.parent_link)].T_body_link *
           joint.T_parent_child;
  }

  void OpenBody(int body, const Transform& T_from_body) {
    text += "<body" + Attribute("name", "b" + std::to_string(body)) + PoseAttributes(T_from_body) +
            ">\n";
  }

  /// Opens the far half of an elastic link, on the side of joint k. It is a body of its own,
  /// because MuJoCo allows at most six degrees of freedom between two bodies. The near half has the
  /// link's weight.
  void OpenHalf(int k) {
    text += "<body" + Attribute("name", "h" + std::to_string(k)) +
            "><inertial pos=\"0 0 0\" mass=\"1e-6\" diaginertia=\"1e-7 1e-7 1e-7\"/>\n";
  }

  /// Writes the inertia of a body, then everything that it carries. Closes the body.
  void Contents(int body) {
    Inertial(body);
    Plates(body);
    for (std::size_t s = 0; s < support_.size(); ++s) {
      if (FootLink(static_cast<int>(s)).body == body) WriteSole(static_cast<int>(s));
    }
    for (int k = 0; k < static_cast<int>(tree_.joints.size()); ++k) {
      if (JointAt(k).parent_body == body) Outwards(k);
    }
    text += "</body>\n";
  }

  /// Walks from the body that carries joint k to the one that it moves.
  void Outwards(int k) {
    const Joint& joint = JointAt(k);
    const Transform T_parent_child = JointPlacement(k);
    const bool halved = robot_.link_compliance[static_cast<std::size_t>(k)].any();
    if (halved) {
      OpenHalf(k);
      LinkSprings(CarrierSprings(k), T_parent_child.translation(), Transform::Identity());
    }
    OpenBody(k + 1, T_parent_child);
    JointSpring(k, joint.axis);
    Motor(k, joint.axis);
    Contents(k + 1);
    if (halved) text += "</body>\n";
  }

  /// Writes a foot on the floor. A foot that is held by a constraint is heavy, because MuJoCo lets
  /// the constraints of lighter bodies give way more.
  void WriteSole(int sole) {
    const Link& link = FootLink(sole);
    text += "<body" + Attribute("name", "s" + std::to_string(sole)) +
            PoseAttributes(link.T_body_link) + ">\n";
    LinkSprings(FootSprings(sole), link.T_body_link.translation(), link.T_body_link.inverse());
    const bool free = StandsFreely(support_, options_);
    text += std::string("<inertial pos=\"0 0 0\" ") +
            (free ? R"(mass="0.1" diaginertia="1e-4 1e-4 1e-4")"
                  : R"(mass="1000" diaginertia="100 100 100")") +
            "/>\n";
    if (free) {
      text += "<geom" + Shape(SoleOf(support_[static_cast<std::size_t>(sole)], options_)) +
              " mass=\"0\"" + OnFloor() + "/>\n";
    }
    text += "</body>\n";
  }

  static std::string Shape(const Sole& sole) {
    constexpr double kHalfThickness = 0.01, kLeastBall = 0.001;
    if (sole.ball_radius) {
      return R"( type="sphere")" +
             Attribute("size", Number(std::max(kLeastBall, *sole.ball_radius)));
    }
    const Eigen::Vector2d centre = sole.centre(), half = 0.5 * (sole.upper - sole.lower);
    return R"( type="box")" +
           Attribute("pos", Numbers(std::array{centre.x(), centre.y(), kHalfThickness})) +
           Attribute("size", Numbers(std::array{half.x(), half.y(), kHalfThickness}));
  }

  /// A plate and its table share a bit, so that nothing else touches either.
  static std::string ContactOf(std::size_t plate, const std::string& as) {
    constexpr std::size_t kBits = 29;  // the first is for the floor
    const std::string other = as == "contype" ? "conaffinity" : "contype";
    return Attribute(as, std::to_string(2U << (plate % kBits))) + Attribute(other, "0") +
           R"( condim="1" solref="0.08 1" solimp="0.5 0.5 0.001")";
  }

  void Plates(int body) {
    constexpr double kHalfThickness = 0.005;
    for (std::size_t i = 0; i < plates_.size(); ++i) {
      const PhysicalPlate& plate = plates_[i];
      const Link& link = tree_.links[static_cast<std::size_t>(plate.link)];
      if (link.body != body) continue;
      const Transform T_box = link.T_body_link * plate.T_link_face * TrZ(kHalfThickness);
      text += R"(<geom type="box" mass="0")" + Attribute("name", "p" + std::to_string(i)) +
              PoseAttributes(T_box) +
              Attribute("size",
                        Numbers(std::array{0.5 * plate.edge, 0.5 * plate.edge, kHalfThickness})) +
              ContactOf(i, "conaffinity") + "/>\n";
    }
  }

  void Inertial(int body) {
    const BodyInertia as_described = BodyInertias(tree_)[static_cast<std::size_t>(body)];
    const Eigen::Vector3d& com = as_described.com;
    // MuJoCo requires moving bodies to have some inertia, and one that can exist.
    Eigen::Matrix3d inertia = 1e-7 * Eigen::Matrix3d::Identity();
    for (const Link& link : tree_.links) {
      if (link.body != body) continue;
      const Eigen::Matrix3d R = link.T_body_link.linear();
      const Eigen::Matrix3d lever = Skew(link.T_body_link * link.com - com);
      inertia += R * PhysicalInertia(link.inertia) * R.transpose() - link.mass * lever * lever;
    }
    const std::array entries{inertia(0, 0), inertia(1, 1), inertia(2, 2),
                             inertia(0, 1), inertia(0, 2), inertia(1, 2)};
    text += "<inertial" + Attribute("pos", Numbers(com)) +
            Attribute("mass", Number(std::max(as_described.mass, 1e-6))) +
            Attribute("fullinertia", Numbers(entries)) + "/>\n";
  }

  void AddJoint(const std::string& name, bool slides, const Eigen::Vector3d& axis,
                const Eigen::Vector3d& anchor, const std::array<double, 3>& dynamics) {
    text += "<joint" + Attribute("name", name) + Attribute("type", slides ? "slide" : "hinge") +
            Attribute("axis", Numbers(axis)) + Attribute("pos", Numbers(anchor)) +
            Attribute("stiffness", Number(dynamics[0])) +
            Attribute("damping", Number(dynamics[1])) + Attribute("armature", Number(dynamics[2])) +
            "/>\n";
  }

  void Motor(int k, const Eigen::Vector3d& axis) {
    const bool slides = JointAt(k).type == JointType::kPrismatic;
    constexpr double kLargestSag = 0.01;  // rad or m, by gravity: robots may carry tonnes
    const double stiffness =
        std::max(slides ? options_.sliding_servo_stiffness : options_.servo_stiffness,
                 torques_[k] / kLargestSag);
    const double omega = options_.servo_frequency;
    AddJoint("m" + std::to_string(k), slides, axis, Eigen::Vector3d::Zero(),
             {stiffness, 2.0 * stiffness / omega, stiffness / (omega * omega)});
  }

  void Spring(const std::string& name, bool slides, const Eigen::Vector3d& axis,
              const Eigen::Vector3d& anchor, double compliance) {
    if (compliance <= 0.0) return;
    const double stiffness = 1.0 / compliance;
    const double inertia_time = options_.spring_inertia_time_s;
    AddJoint(name, slides, axis, anchor,
             {stiffness, stiffness * options_.spring_damping_time_s,
              stiffness * inertia_time * inertia_time});
  }

  void JointSpring(int k, const Eigen::Vector3d& axis) {
    Spring("e" + std::to_string(k), JointAt(k).type == JointType::kPrismatic, axis,
           Eigen::Vector3d::Zero(), robot_.compliance[k]);
  }

  struct NamedSprings {
    std::string name;
    const Vector6d& compliance;
  };
  NamedSprings CarrierSprings(int k) const {
    return {"x" + std::to_string(k), robot_.link_compliance[static_cast<std::size_t>(k)]};
  }
  NamedSprings FootSprings(int sole) const {
    const int foot = support_[static_cast<std::size_t>(sole)];
    std::size_t leg = 0;
    while (robot_.legs[leg].foot_link != foot) ++leg;
    return {"y" + std::to_string(sole), robot_.foot_compliance[leg]};
  }

  /// Writes the springs of a body's link, half way to `p_body_next`. T_here_body maps to the frame
  /// of the body being written.
  void LinkSprings(const NamedSprings& springs, const Eigen::Vector3d& p_body_next,
                   const Transform& T_here_body) {
    const Eigen::Vector3d anchor = T_here_body * Eigen::Vector3d(0.5 * p_body_next);
    for (int i = 0; i < 6; ++i) {
      const Eigen::Vector3d axis = T_here_body.linear().col(i % 3);
      Spring(springs.name + "_" + std::to_string(i), i < 3, axis, anchor, springs.compliance[i]);
    }
  }

  const TrueRobot& robot_;
  const RobotTree& tree_;
  const std::vector<int>& support_;
  const PhysicsOptions& options_;
  const std::vector<PhysicalPlate>& plates_;
  const Eigen::VectorXd torques_;
};

/// The leg that has this foot.
const Leg& LegOf(const TrueRobot& robot, int foot) {
  for (const Leg& leg : robot.legs) {
    if (leg.foot_link == foot) return leg;
  }
  throw std::invalid_argument("a robot can stand on the feet of its legs only");
}

/// Constraint that holds a sole where it was put down.
std::string Weld(std::size_t sole, const Transform& T_world_sole) {
  const Transform T_sole_world = T_world_sole.inverse();
  const Eigen::Quaterniond q(T_sole_world.linear());
  const Eigen::Vector3d p = T_sole_world.translation();
  return "<weld" + Attribute("body1", "s" + std::to_string(sole)) +
         Attribute("relpose",
                   Numbers(std::array{p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()})) +
         " solref=\"0.01 1\" solimp=\"0.999 0.9999 0.001\"/>\n";
}

std::string GravityOf(const PhysicsOptions& options) {
  const Eigen::Vector3d turn(options.gravity_tilt_x, options.gravity_tilt_y, 0.0);
  if (turn.isZero(0.0)) return "0 0 " + Number(-options.gravity);
  const Eigen::Vector3d gravity =
      RotationFromVector(turn) * Eigen::Vector3d(0.0, 0.0, -options.gravity);
  return Numbers(std::array{gravity.x(), gravity.y(), gravity.z()});
}

std::string Header(const PhysicsOptions& options, bool contact) {
  return std::string("<mujoco><compiler angle=\"radian\"/>\n<option") +
         Attribute("timestep", Number(options.time_step_s)) +
         Attribute("gravity", GravityOf(options)) +
         R"( iterations="200" tolerance="1e-12" solver=")" + (contact ? "Newton" : "PGS") +
         "\"><flag" + (contact ? "" : " contact=\"disable\"") + "/></option>\n<worldbody>\n";
}

}  // namespace

MjcfModel BuildMjcf(const TrueRobot& robot, const std::vector<int>& support,
                    const Eigen::VectorXd& encoders, const PhysicsOptions& options,
                    const std::vector<PhysicalPlate>& plates) {
  if (options.standing == Standing::kFree && support.empty()) {
    throw std::invalid_argument("a robot that stands freely needs feet");
  }
  MjcfModel model;
  MjcfWriter writer(robot, support, options, plates);
  const std::vector<Transform> T_waist_link =
      TrueLinkTransforms(robot, TrueJointPositions(robot, encoders));
  const bool stands_freely = StandsFreely(support, options);
  const bool on_balls = CountBalls(support, options) >= kBallsThatStand;
  for (int foot : support) {
    const Transform& T_waist_foot = T_waist_link[static_cast<std::size_t>(foot)];
    if (model.T_world_foot.empty() && on_balls) {
      model.T_world_waist = PutOnBalls(support, options, T_waist_link);
      model.T_world_foot.push_back(model.T_world_waist * T_waist_foot);
    } else if (model.T_world_foot.empty()) {
      model.T_world_foot.emplace_back(LegOf(robot, foot).R_floor_foot);
      model.T_world_waist = model.T_world_foot[0] * T_waist_foot.inverse();
    } else {
      LegOf(robot, foot);
      model.T_world_foot.push_back(model.T_world_waist * T_waist_foot);
    }
  }
  std::string constraints;
  if (stands_freely) {
    writer.text += R"(<geom type="plane" size="5 5 0.1")" + writer.OnFloor() + "/>\n";
  } else {
    for (std::size_t s = 0; s < support.size(); ++s) constraints += Weld(s, model.T_world_foot[s]);
  }
  writer.WriteFromWaist(model.T_world_waist, !support.empty());
  writer.WriteTables();
  const bool contact = stands_freely || !plates.empty();
  model.xml = Header(options, contact) + writer.text + "</worldbody>\n<equality>\n" + constraints +
              "</equality>\n</mujoco>\n";
  return model;
}

}  // namespace elastocal
