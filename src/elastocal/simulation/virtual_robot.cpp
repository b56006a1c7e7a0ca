// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/virtual_robot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <regex>
#include <stdexcept>
#include <string>

#include <mujoco/mujoco.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/math/interruption.hpp"
#include "elastocal/robot/legs.hpp"

namespace elastocal {
namespace {

using ModelPointer = std::unique_ptr<mjModel, decltype(&mj_deleteModel)>;
using DataPointer = std::unique_ptr<mjData, decltype(&mj_deleteData)>;

/// A message of MuJoCo in one line. The numbers of bodies in it ("b24") are replaced by the names
/// of the links with which these bodies begin.
std::string WithLinkNames(std::string message, const RobotTree& tree) {
  for (int body = tree.body_count() - 1; body >= 0; --body) {
    const Joint* joint = body > 0 ? &tree.joints[static_cast<std::size_t>(body - 1)] : nullptr;
    const int link = joint != nullptr ? joint->child_link : 0;
    const std::regex number("\\bb" + std::to_string(body) + "\\b");
    message = std::regex_replace(message, number,
                                 "link '" + tree.links[static_cast<std::size_t>(link)].name + "'");
  }
  std::replace(message.begin(), message.end(), '\n', ' ');
  return message;
}

/// Replaces MuJoCo's handler, which writes warnings to a file in the current folder. Unstable()
/// reports them instead.
void NoWarning(const char* /*message*/) {}

ModelPointer Compile(const std::string& xml, const RobotTree& tree) {
  static const bool quiet = (mju_user_warning = NoWarning) != nullptr;
  static_cast<void>(quiet);
  const auto files = std::make_unique<mjVFS>();  // two megabytes: too large for the stack
  mj_defaultVFS(files.get());
  const char* name = "robot.xml";
  mj_makeEmptyFileVFS(files.get(), name, static_cast<int>(xml.size()) + 1);
  std::memcpy(files->filedata[mj_findFileVFS(files.get(), name)], xml.c_str(), xml.size() + 1);
  std::array<char, 1000> error{};
  ModelPointer model(mj_loadXML(name, files.get(), error.data(), error.size()), &mj_deleteModel);
  mj_deleteVFS(files.get());
  if (model == nullptr) {
    throw InputError("the robot '" + tree.name +
                     "' cannot be simulated: " + WithLinkNames(error.data(), tree));
  }
  return model;
}

/// Indices of one of MuJoCo's joints (with one degree of freedom) in MuJoCo's arrays; -1 if there
/// is none.
struct Address {
  int position = -1, speed = -1;
  double stiffness = 0.0, damping = 0.0;
};

Address FindAddress(const mjModel& model, const std::string& joint) {
  const int id = mj_name2id(&model, mjOBJ_JOINT, joint.c_str());
  if (id < 0) return {};
  const int speed = model.jnt_dofadr[id];
  return {model.jnt_qposadr[id], speed, model.jnt_stiffness[id], model.dof_damping[speed]};
}

int FindBody(const mjModel& model, const std::string& name) {
  const int id = mj_name2id(&model, mjOBJ_BODY, name.c_str());
  if (id < 0) throw std::runtime_error("MuJoCo's model has no body '" + name + "'");
  return id;
}

}  // namespace

struct VirtualRobot::Simulation {
  TrueRobot robot;
  ModelPointer model;
  DataPointer data;
  std::vector<Address> motors, springs;  // by joint
  std::vector<int> bodies, soles;        // MuJoCo's, by body of the tree and by support
  std::vector<PhysicalPlate> plates;
  Eigen::VectorXd bristle;                        // by joint, state of friction in [-1, 1]
  Eigen::Vector3d top = Eigen::Vector3d::Zero();  // point of the root link's frame, see Height()

  Simulation(const TrueRobot& true_robot, const MjcfModel& mjcf,
             const std::vector<PhysicalPlate>& with_plates)
      : robot(true_robot),
        model(Compile(mjcf.xml, robot.tree)),
        data(mj_makeData(model.get()), &mj_deleteData),
        plates(with_plates),
        bristle(Eigen::VectorXd::Zero(true_robot.offset.size())) {
    if (!robot.legs.empty()) top.z() = LegTop(robot.tree, robot.legs.front().joints);
    for (std::size_t k = 0; k < robot.tree.joints.size(); ++k) {
      motors.push_back(FindAddress(*model, "m" + std::to_string(k)));
      springs.push_back(FindAddress(*model, "e" + std::to_string(k)));
    }
    for (int b = 0; b < robot.tree.body_count(); ++b) {
      bodies.push_back(FindBody(*model, "b" + std::to_string(b)));
    }
    for (std::size_t s = 0; s < mjcf.T_world_foot.size(); ++s) {
      soles.push_back(FindBody(*model, "s" + std::to_string(s)));
    }
  }

  Transform BodyPose(int body) const {
    Transform T = Transform::Identity();
    T.linear() =
        Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(data->xmat + 9 * body);
    T.translation() = Eigen::Map<const Eigen::Vector3d>(data->xpos + 3 * body);
    return T;
  }

  /// Force of the floor in a contact, and its moment about the world's origin.
  std::pair<Eigen::Vector3d, Eigen::Vector3d> ContactWrench(int i) const {
    std::array<double, 6> local{};  // in the contact's axes; the floor is the first geometry
    mj_contactForce(model.get(), data.get(), i, local.data());
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> axes(
        data->contact[i].frame);
    const Eigen::Vector3d force =
        axes.transpose() * Eigen::Map<const Eigen::Vector3d>(local.data());
    const Eigen::Map<const Eigen::Vector3d> point(data->contact[i].pos);
    const Eigen::Vector3d moment =
        point.cross(force) + axes.transpose() * Eigen::Map<const Eigen::Vector3d>(local.data() + 3);
    return {force, moment};
  }

  /// Sum of the wrenches of floor and tables on the chosen geometries, in the axes of a frame and
  /// about its origin.
  template <typename Chosen>
  Vector6d WrenchAt(const Transform& T_world_frame, const Chosen& chosen) const {
    const Eigen::Matrix3d R = T_world_frame.linear().transpose();
    Vector6d wrench = Vector6d::Zero();
    for (int i = 0; i < data->ncon; ++i) {
      if (!chosen(data->contact[i].geom2)) continue;
      const auto [force, moment] = ContactWrench(i);
      wrench.head<3>() += R * force;
      wrench.tail<3>() += R * (moment - T_world_frame.translation().cross(force));
    }
    return wrench;
  }

  /// Applies Coulomb friction as that of a bristle that bends before it slips (Dahl). It holds at
  /// rest, and needs no constraint.
  void ApplyFriction() {
    constexpr double kBend = 2e-4;  // rad or m until it slips
    for (std::size_t k = 0; k < motors.size(); ++k) {
      const auto joint = static_cast<Eigen::Index>(k);
      const double largest = robot.friction[joint];
      if (largest <= 0.0) continue;
      double speed = data->qvel[motors[k].speed];
      if (springs[k].speed >= 0) speed += data->qvel[springs[k].speed];
      const double path = speed * model->opt.timestep / kBend;
      double& z = bristle[joint];
      z = std::clamp(z + path * (1.0 - std::copysign(z, z * path)), -1.0, 1.0);
      data->qfrc_applied[motors[k].speed] = -largest * z;
      if (springs[k].speed >= 0) data->qfrc_applied[springs[k].speed] = -largest * z;
    }
  }
};

VirtualRobot::VirtualRobot(const TrueRobot& robot, const std::vector<int>& support,
                           const Eigen::VectorXd& encoders, const PhysicsOptions& options,
                           const std::vector<PhysicalPlate>& plates)
    : simulation_(std::make_unique<Simulation>(
          robot, BuildMjcf(robot, support, encoders, options, plates), plates)) {
  Command(encoders);
  for (const Address& motor : simulation_->motors) {
    simulation_->data->qpos[motor.position] = simulation_->model->qpos_spring[motor.position];
  }
  mj_forward(simulation_->model.get(), simulation_->data.get());
}

VirtualRobot::~VirtualRobot() = default;
VirtualRobot::VirtualRobot(VirtualRobot&&) noexcept = default;

double VirtualRobot::time_step_s() const { return simulation_->model->opt.timestep; }

void VirtualRobot::Command(const Eigen::VectorXd& encoders) {
  const Eigen::VectorXd positions = TrueJointPositions(simulation_->robot, encoders);
  for (std::size_t k = 0; k < simulation_->motors.size(); ++k) {
    simulation_->model->qpos_spring[simulation_->motors[k].position] =
        positions[static_cast<Eigen::Index>(k)];
  }
}

void VirtualRobot::Step() {
  InterruptionPoint();
  simulation_->ApplyFriction();
  mj_step(simulation_->model.get(), simulation_->data.get());
  // After a step, MuJoCo's bodies are still where they were before it.
  mj_kinematics(simulation_->model.get(), simulation_->data.get());
}

bool VirtualRobot::Settle(double longest_s) {
  constexpr double kRest = 1e-7;
  constexpr int kStepsAtRest = 20;
  const mjModel& model = *simulation_->model;
  int resting = 0;
  for (int i = 0; i < static_cast<int>(longest_s / time_step_s()); ++i) {
    Step();
    const Eigen::Map<const Eigen::VectorXd> speeds(simulation_->data->qvel, model.nv);
    resting = speeds.cwiseAbs().maxCoeff() < kRest ? resting + 1 : 0;
    if (resting == kStepsAtRest) return true;
  }
  return false;
}

double VirtualRobot::Height() const { return (WaistPose() * simulation_->top).z(); }

bool VirtualRobot::FallenFrom(double height) const {
  constexpr double kFallen = 0.7;
  return Unstable() || !(Height() > kFallen * height);
}

bool VirtualRobot::Unstable() const {
  const auto& warnings = simulation_->data->warning;
  return warnings[mjWARN_BADQPOS].number + warnings[mjWARN_BADQVEL].number +
             warnings[mjWARN_BADQACC].number >
         0;
}

void VirtualRobot::PushWaist(const Vector6d& wrench) {
  const int body = simulation_->bodies[0];
  const Eigen::Map<const Eigen::Vector3d> com(simulation_->data->xipos + 3 * body);
  Eigen::Map<Vector6d> applied(simulation_->data->xfrc_applied + 6 * body);
  // MuJoCo applies the force at the centre of mass.
  const Eigen::Vector3d lever = WaistPose().translation() - com;
  const Eigen::Vector3d force = wrench.head<3>();
  applied.head<3>() = force;
  applied.tail<3>() = wrench.tail<3>() + lever.cross(force);
}

Eigen::VectorXd VirtualRobot::Encoders() const {
  Eigen::VectorXd positions(simulation_->robot.offset.size());
  for (std::size_t k = 0; k < simulation_->motors.size(); ++k) {
    positions[static_cast<Eigen::Index>(k)] =
        simulation_->data->qpos[simulation_->motors[k].position];
  }
  return EncoderPositions(simulation_->robot, positions);
}

Eigen::VectorXd VirtualRobot::Torques() const {
  const mjModel& model = *simulation_->model;
  const mjData& data = *simulation_->data;
  Eigen::VectorXd torques(simulation_->robot.offset.size());
  for (std::size_t k = 0; k < simulation_->motors.size(); ++k) {
    const Address& motor = simulation_->motors[k];
    const Address& spring = simulation_->springs[k];
    // The torque of the drive deflects its spring; in a rigid drive it is that of the servo.
    const Address& drive = spring.position >= 0 ? spring : motor;
    const double rest = spring.position >= 0 ? 0.0 : model.qpos_spring[motor.position];
    torques[static_cast<Eigen::Index>(k)] = drive.stiffness * (rest - data.qpos[drive.position]) -
                                            drive.damping * data.qvel[drive.speed];
  }
  return torques;
}

Transform VirtualRobot::WaistPose() const { return simulation_->BodyPose(simulation_->bodies[0]); }

Transform VirtualRobot::LinkPose(int link) const {
  const Link& found = simulation_->robot.tree.links[static_cast<std::size_t>(link)];
  return simulation_->BodyPose(simulation_->bodies[static_cast<std::size_t>(found.body)]) *
         found.T_body_link;
}

Transform VirtualRobot::SolePose(int index) const {
  return simulation_->BodyPose(simulation_->soles[static_cast<std::size_t>(index)]);
}

Eigen::Matrix3Xd VirtualRobot::MarkerPositions() const {
  const std::vector<Marker>& markers = simulation_->robot.markers;
  Eigen::Matrix3Xd positions(3, static_cast<Eigen::Index>(markers.size()));
  for (std::size_t m = 0; m < markers.size(); ++m) {
    positions.col(static_cast<Eigen::Index>(m)) =
        LinkPose(markers[m].link) * markers[m].p_link_marker;
  }
  return positions;
}

std::pair<Eigen::Vector3d, Eigen::Vector3d> VirtualRobot::FloorWrench() const {
  std::pair<Eigen::Vector3d, Eigen::Vector3d> total{Eigen::Vector3d::Zero(),
                                                    Eigen::Vector3d::Zero()};
  for (int i = 0; i < simulation_->data->ncon; ++i) {
    const auto [force, moment] = simulation_->ContactWrench(i);
    total.first += force;
    total.second += moment;
  }
  return total;
}

Vector6d VirtualRobot::SoleWrench(int index) const {
  const int body = simulation_->soles[static_cast<std::size_t>(index)];
  return simulation_->WrenchAt(simulation_->BodyPose(body), [&](int geometry) {
    return simulation_->model->geom_bodyid[geometry] == body;
  });
}

void VirtualRobot::PlaceTable(int plate, const Transform& T_world_table) {
  const mjModel& model = *simulation_->model;
  const int mocap = model.body_mocapid[FindBody(model, "t" + std::to_string(plate))];
  const Eigen::Quaterniond q(T_world_table.linear());
  const std::array pose{q.w(), q.x(), q.y(), q.z()};
  std::copy(pose.begin(), pose.end(), simulation_->data->mocap_quat + 4 * mocap);
  Eigen::Map<Eigen::Vector3d>(simulation_->data->mocap_pos + 3 * mocap) =
      T_world_table.translation();
}

Transform VirtualRobot::PlatePose(int plate) const {
  const PhysicalPlate& of = simulation_->plates[static_cast<std::size_t>(plate)];
  return LinkPose(of.link) * of.T_link_face;
}

Vector6d VirtualRobot::PlateWrench(int plate) const {
  const int box =
      mj_name2id(simulation_->model.get(), mjOBJ_GEOM, ("p" + std::to_string(plate)).c_str());
  return simulation_->WrenchAt(PlatePose(plate), [&](int geometry) { return geometry == box; });
}

int VirtualRobot::coordinate_count() const { return simulation_->model->nv; }

}  // namespace elastocal
