// SPDX-License-Identifier: Apache-2.0
// Compares the closure of rods with MuJoCo, which closes the same loops by equality constraints.

#include <array>
#include <cstring>
#include <map>
#include <memory>
#include <stdexcept>

#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include "elastocal/robot/linkage_errors.hpp"
#include "tests/linked_biped.hpp"

namespace elastocal {
namespace {

std::string Numbers(const Eigen::VectorXd& v) {
  std::string text;
  for (const double number : v) text += fmt::format("{:.17g} ", number);
  return text;
}

/// MuJoCo's model of thigh, shank, cross and foot of a leg. A rod is a body that a ball joint holds
/// to the crank's pin, or for an actuator one that slides out of a ball joint. `connect` joins its
/// other end to the link. An equality constraint holds each motor.
std::string LoopsXml(const RobotTree& tree, const std::string& side, const Linkage& knee,
                     const Linkage& ankle) {
  const std::string mass = R"(<inertial pos="0 0 0" mass="1" diaginertia="0.01 0.01 0.01"/>)";
  std::string equality;
  // Initially the rod lies along x of its body. `connect` moves it to where it ends.
  const auto rod_body = [&](const Rod& rod, const Transform& T_here_anchor) {
    const std::string& name = rod.motor;
    equality +=
        fmt::format(R"(<joint name="{0}" joint1="{0}"/>)"
                    R"(<connect name="end_{0}" body1="end_{0}" body2="{1}" anchor="0 0 0"/>)",
                    name, tree.links[static_cast<std::size_t>(rod.to_link)].name);
    const Eigen::Vector3d start = rod.actuator ? rod.centre : rod.pin;
    const Eigen::Vector3d along = T_here_anchor * rod.anchor - start;
    const Eigen::Quaterniond turn =
        Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitX(), along);
    const Eigen::Vector4d wxyz(turn.w(), turn.x(), turn.y(), turn.z());
    const Eigen::Vector3d end = rod.length * Eigen::Vector3d::UnitX();
    const std::string slide =
        rod.actuator ? fmt::format(R"(<joint name="{}" type="slide" axis="1 0 0"/>)", name) : "";
    const std::string rest = fmt::format(
        R"(<body name="rod_{0}" pos="{1}" quat="{2}"><joint type="ball"/>{3}<body name="end_{0}" pos="{4}">{5}{3}</body></body>)",
        name, Numbers(rod.actuator ? rod.centre : Eigen::Vector3d(rod.pin - rod.centre)),
        Numbers(wxyz), mass, Numbers(end), slide);
    if (rod.actuator) return rest;
    return fmt::format(R"(<body pos="{}"><joint name="{}" type="hinge" axis="{}"/>{}{}</body>)",
                       Numbers(rod.centre), name, Numbers(rod.axis), mass, rest);
  };
  const auto joint = [&](const std::string& name) -> const Joint& {
    return tree.joints[static_cast<std::size_t>(FindJoint(tree, side + name))];
  };
  const auto link = [&](const std::string& name, const std::string& moved_by,
                        const std::string& content) {
    const Joint& by = joint(moved_by);
    return fmt::format(
        R"(<body name="{0}" pos="{1}"><joint name="{2}" type="hinge" axis="{3}"/>{4}{5}</body>)",
        side + name, Numbers(by.T_parent_child.translation()), side + moved_by, Numbers(by.axis),
        mass, content);
  };
  const Transform T_shank_foot =
      joint("ankle_pitch").T_parent_child * joint("ankle_roll").T_parent_child;
  std::string rods;
  for (const Rod& rod : ankle.rods) rods += rod_body(rod, T_shank_foot);
  const std::string foot = link("foot", "ankle_roll", "");
  const std::string shank = link("shank", "knee", rods + link("ankle", "ankle_pitch", foot));
  const std::string actuator = rod_body(knee.rods[0], joint("knee").T_parent_child);
  return fmt::format(
      R"(<mujoco><option timestep="0.0005" gravity="0 0 0"><flag contact="disable"/></option>)"
      R"(<default><joint damping="2"/><equality solref="0.002 1"/></default>)"
      R"(<worldbody><body name="{}thigh">{}{}</body></worldbody><equality>{}</equality></mujoco>)",
      side, actuator, shank, equality);
}

using Model = std::unique_ptr<mjModel, decltype(&mj_deleteModel)>;

Model Compile(const std::string& xml) {
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  mj_makeEmptyFileVFS(files.get(), "loops.xml", static_cast<int>(xml.size()) + 1);
  std::memcpy(files->filedata[0], xml.c_str(), xml.size() + 1);
  std::array<char, 1000> error{};
  Model model(mj_loadXML("loops.xml", files.get(), error.data(), error.size()), &mj_deleteModel);
  mj_deleteVFS(files.get());
  if (!model) throw std::runtime_error(std::string("MuJoCo: ") + error.data());
  return model;
}

double* EqualityData(mjModel& model, const std::string& name) {
  return model.eq_data + mjNEQDATA * mj_name2id(&model, mjOBJ_EQUALITY, name.c_str());
}

/// MuJoCo takes the initial places of the rods' ends. They must be the anchors.
void ConnectRods(const Linkage& linkage, mjModel& model) {
  for (const Rod& rod : linkage.rods) {
    Eigen::Map<Eigen::Vector3d>(EqualityData(model, "end_" + rod.motor) + 3) = rod.anchor;
  }
}

/// Moves the motors to these positions and waits until the loops are at rest. Returns the positions
/// of the named joints.
std::vector<double> SettledPositions(mjModel& model, const std::map<std::string, double>& motors,
                                     const std::vector<std::string>& names) {
  const std::unique_ptr<mjData, decltype(&mj_deleteData)> data(mj_makeData(&model), &mj_deleteData);
  constexpr int kMostSteps = 20000, kMoving = 4000;
  for (int i = 0; i < kMostSteps; ++i) {
    const double share = std::min(1.0, static_cast<double>(i) / kMoving);
    for (const auto& [motor, at] : motors) EqualityData(model, motor)[0] = share * at;
    mj_step(&model, data.get());
    const Eigen::Map<const Eigen::VectorXd> speeds(data->qvel, model.nv);
    if (i > 2 * kMoving && speeds.cwiseAbs().maxCoeff() < 1e-11) break;
  }
  std::vector<double> positions;
  for (const std::string& name : names) {
    const int id = mj_name2id(&model, mjOBJ_JOINT, name.c_str());
    positions.push_back(data->qpos[model.jnt_qposadr[id]]);
  }
  return positions;
}

// MuJoCo's constraints are springs. Without weights they have no force at rest.
TEST_F(LinkedBiped, ClosesItsLoopsAsMujocoDoes) {
  Random random(11);
  const std::array<int, 2> which = {0, 1};  // left_knee, left_ankle
  for (int i = 0; i < 3; ++i) {
    const Eigen::VectorXd q = RandomPosture(project_.tree, random);
    std::vector<Eigen::VectorXd> errors;
    for (const Linkage& linkage : project_.tree.linkages) {
      errors.push_back(random.NormalVector(linkage.error_count(), 1.5e-3));
    }
    std::vector<Linkage> rods;
    std::map<std::string, double> motors;
    for (int l : which) {
      const Linkage& linkage = project_.tree.linkages[l];
      rods.push_back(WithErrors(linkage, errors[l]));
      const Eigen::VectorXd at =
          *MotorPositions(project_.tree, linkage, q(CoordinatesOf(project_.tree, linkage)));
      for (std::size_t m = 0; m < linkage.rods.size(); ++m) {
        motors[linkage.rods[m].motor] = at[static_cast<Eigen::Index>(m)];
      }
    }
    const Model mujoco = Compile(LoopsXml(project_.tree, "left_", rods[0], rods[1]));
    for (const Linkage& linkage : rods) ConnectRods(linkage, *mujoco);
    const Eigen::VectorXd placed = PlaceLinkages(project_.tree, errors, q).q;
    const std::vector<std::string> names = {"left_knee", "left_ankle_pitch", "left_ankle_roll"};
    const std::vector<double> found = SettledPositions(*mujoco, motors, names);
    for (std::size_t j = 0; j < names.size(); ++j) {
      const int k = FindJoint(project_.tree, names[j]);
      EXPECT_NEAR(JointPosition(project_.tree.joints[k], placed), found[j], 1e-8) << names[j];
    }
    EXPECT_GT((placed - q).norm(), 1e-3);
  }
}

}  // namespace
}  // namespace elastocal
