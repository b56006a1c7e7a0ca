// SPDX-License-Identifier: Apache-2.0
#include "tests/mujoco_oracle.hpp"

#include <array>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <Eigen/LU>

namespace elastocal {
namespace {

std::string ReadText(const std::filesystem::path& file) {
  std::ifstream stream(file);
  if (!stream) throw std::runtime_error("cannot read " + file.string());
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

/// Adds compiler settings and the floating joint at the root after the opening `<robot>` tag.
/// Static links remain separate bodies, so that each has a pose.
std::string AddFloatingRoot(std::string urdf, const std::string& root_link) {
  const std::size_t robot = urdf.find("<robot");
  if (robot == std::string::npos) throw std::runtime_error("no <robot> element");
  const std::string addition =
      R"(<mujoco><compiler discardvisual="true" fusestatic="false"/></mujoco>)"
      R"(<link name="world"/><joint name="world_joint" type="floating">)"
      R"(<parent link="world"/><child link=")" +
      root_link + R"("/></joint>)";
  return urdf.insert(urdf.find('>', robot) + 1, addition);
}

mjModel* Compile(const std::string& urdf) {
  const auto files = std::make_unique<mjVFS>();  // two megabytes are too large for the stack
  mj_defaultVFS(files.get());
  const char* name = "robot.urdf";
  mj_makeEmptyFileVFS(files.get(), name, static_cast<int>(urdf.size()) + 1);
  std::memcpy(files->filedata[mj_findFileVFS(files.get(), name)], urdf.c_str(), urdf.size() + 1);
  std::array<char, 1000> error{};
  mjModel* model = mj_loadXML(name, files.get(), error.data(), error.size());
  mj_deleteVFS(files.get());
  if (model == nullptr) throw std::runtime_error(std::string("MuJoCo: ") + error.data());
  model->opt.disableflags |= mjDSBL_CONSTRAINT | mjDSBL_PASSIVE;
  return model;
}

int FindId(const mjModel* model, mjtObj type, const std::string& name) {
  const int id = mj_name2id(model, type, name.c_str());
  if (id < 0) throw std::runtime_error("MuJoCo's model has no '" + name + "'");
  return id;
}

}  // namespace

MujocoOracle::MujocoOracle(const std::filesystem::path& urdf, const std::string& root_link)
    : model_(Compile(AddFloatingRoot(ReadText(urdf), root_link)), &mj_deleteModel),
      data_(mj_makeData(model_.get()), &mj_deleteData) {
  Update();
}

void MujocoOracle::SetPosition(const std::string& joint, double position) {
  data_->qpos[model_->jnt_qposadr[JointId(joint)]] = position;
}

void MujocoOracle::SetGravity(const Eigen::Vector3d& gravity) {
  Eigen::Map<Eigen::Vector3d>(model_->opt.gravity) = gravity;
}

void MujocoOracle::Update() { mj_forward(model_.get(), data_.get()); }

Eigen::Isometry3d MujocoOracle::LinkPose(const std::string& link) const {
  const int body = LinkId(link);
  Eigen::Isometry3d T_root_link = Eigen::Isometry3d::Identity();
  T_root_link.linear() =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(data_->xmat + 9 * body);
  T_root_link.translation() = Eigen::Map<const Eigen::Vector3d>(data_->xpos + 3 * body);
  return T_root_link;
}

double MujocoOracle::GravityTorque(const std::string& joint) const {
  return data_->qfrc_bias[model_->jnt_dofadr[JointId(joint)]];
}

double MujocoOracle::StandingTorque(const std::string& joint, const std::string& fixed_link) const {
  // The floor's wrench on the link is chosen so that nothing is left for the floating joint, the
  // first one.
  using Jacobian = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Jacobian J(6, model_->nv);
  mj_jacBody(model_.get(), data_.get(), J.data(), J.data() + 3 * model_->nv, LinkId(fixed_link));
  const Eigen::Map<const Eigen::VectorXd> bias(data_->qfrc_bias, model_->nv);
  const Eigen::MatrixXd J_base = J.leftCols(6).transpose();
  const Eigen::VectorXd wrench = J_base.partialPivLu().solve(bias.head(6));
  const int dof = model_->jnt_dofadr[JointId(joint)];
  return bias[dof] - J.col(dof).dot(wrench);
}

Eigen::Vector3d MujocoOracle::PointDerivative(const std::string& joint, const std::string& link,
                                              const Eigen::Vector3d& p_root_point) const {
  Eigen::Matrix<double, 3, Eigen::Dynamic, Eigen::RowMajor> jacobian(3, model_->nv);
  mj_jac(model_.get(), data_.get(), jacobian.data(), nullptr, p_root_point.data(), LinkId(link));
  return jacobian.col(model_->jnt_dofadr[JointId(joint)]);
}

double MujocoOracle::TotalMass() const { return mj_getTotalmass(model_.get()); }

Eigen::Matrix3d MujocoOracle::LinkInertia(const std::string& link) const {
  const int body = LinkId(link);
  const double* axes = model_->body_iquat + 4 * body;
  const Eigen::Matrix3d R =
      Eigen::Quaterniond(axes[0], axes[1], axes[2], axes[3]).toRotationMatrix();
  const Eigen::Map<const Eigen::Vector3d> moments(model_->body_inertia + 3 * body);
  return R * moments.asDiagonal() * R.transpose();
}

void MujocoOracle::SetRootMotion(const Eigen::Isometry3d& T_world_root,
                                 const Eigen::Vector3d& velocity, const Eigen::Vector3d& turn,
                                 const Eigen::Vector3d& acceleration,
                                 const Eigen::Vector3d& turn_rate) {
  // In MuJoCo's free joint, linear parts are in the world's axes and angular ones in the body's.
  const Eigen::Quaterniond attitude(T_world_root.linear());
  const Eigen::Vector3d position = T_world_root.translation();
  const Eigen::Matrix3d R_root_world = T_world_root.linear().transpose();
  Eigen::Map<Eigen::VectorXd> qpos(data_->qpos, model_->nq);
  qpos.head<7>() << position, attitude.w(), attitude.vec();
  Eigen::Map<Eigen::VectorXd>(data_->qvel, model_->nv).head<6>() << velocity, R_root_world * turn;
  Eigen::Map<Eigen::VectorXd>(data_->qacc, model_->nv).head<6>() << acceleration,
      R_root_world * turn_rate;
}

void MujocoOracle::SetMotion(const std::string& joint, double position, double velocity,
                             double acceleration) {
  SetPosition(joint, position);
  const int dof = model_->jnt_dofadr[JointId(joint)];
  data_->qvel[dof] = velocity;
  data_->qacc[dof] = acceleration;
}

void MujocoOracle::UpdateInverse() { mj_inverse(model_.get(), data_.get()); }

double MujocoOracle::InverseTorque(const std::string& joint) const {
  return data_->qfrc_inverse[model_->jnt_dofadr[JointId(joint)]];
}

Eigen::Vector3d MujocoOracle::InverseForce() const {
  return Eigen::Map<const Eigen::Vector3d>(data_->qfrc_inverse);
}

Eigen::Vector3d MujocoOracle::InverseMoment() const {
  const Eigen::Quaterniond attitude(data_->qpos[3], data_->qpos[4], data_->qpos[5], data_->qpos[6]);
  return attitude.toRotationMatrix() * Eigen::Map<const Eigen::Vector3d>(data_->qfrc_inverse + 3);
}

int MujocoOracle::LinkId(const std::string& link) const {
  return FindId(model_.get(), mjOBJ_BODY, link);
}

int MujocoOracle::JointId(const std::string& joint) const {
  return FindId(model_.get(), mjOBJ_JOINT, joint);
}

}  // namespace elastocal
