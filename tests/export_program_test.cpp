// SPDX-License-Identifier: Apache-2.0
// The commands `export`, in each of its formats and read back, and `compensate`, as their users run
// them.
#include <array>
#include <cmath>
#include <cstdlib>
#include <memory>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <yaml-cpp/yaml.h>

#include "elastocal/description/urdf_reader.hpp"
#include "elastocal/files/output_files.hpp"
#include "elastocal/io/motion_file.hpp"
#include "elastocal/pipeline/runtime_robot.hpp"
#include "elastocal/runtime/compensator.hpp"
#include "elastocal/tables/read_file.hpp"
#include "tests/program_fixture.hpp"
#include "tests/runtime_calibration.hpp"
#include "tests/user_mjcf.hpp"

namespace elastocal {
namespace {

const Eigen::VectorXd kStatics;  // no torques
constexpr double kRounding = 1e-9;

/// The small TALOS with a drawn calibration in a folder.
class CalibratedTalos : public testing::Test {
 protected:
  CalibratedTalos()
      : project_(ReadProject(ProjectFile())), stored_(RandomCalibration(project_, 1)) {
    WriteCalibration(stored_);
  }

  static std::string ProjectFile() { return SourceFile("models/talos/project.yaml").string(); }

  void WriteCalibration(const StoredCalibration& stored) {
    CalibrationEstimate estimate;
    estimate.robot = stored.robot;
    estimate.nominal = stored.nominal;
    estimate.recording = "drawn <at> random -- twice";
    estimate.model = "full";
    const StoredRobot robot = RestoreRobot(project_, stored);
    for (const Parameter& parameter : robot.model.parameters) {
      const auto value = stored.joint_errors.find(parameter.name);
      if (value == stored.joint_errors.end()) continue;
      estimate.parameters.push_back({.name = parameter.name,
                                     .unit = UnitName(parameter.unit),
                                     .value = value->second,
                                     .sd = std::max(0.1 * std::abs(value->second), 1e-12)});
    }
    std::filesystem::create_directories(scratch_.path() / "out");
    scratch_.Write("out/calibration.yaml", MakeCalibrationYaml(estimate));
  }

  /// `export` into a file; its path.
  std::string Export(const std::string& format, const std::string& more = "") {
    const std::string file = (scratch_.path() / format).string();
    const ProgramResult result = RunExport(format, file, more);
    EXPECT_EQ(result.exit_code, 0) << format << ": " << result.err;
    return file;
  }

  ProgramResult RunExport(const std::string& format, const std::string& file,
                          const std::string& more = "") const {
    return RunProgram("export " + (scratch_.path() / "out").string() + " --project " +
                      ProjectFile() + " --format " + format + " -o " + file + " " + more);
  }

  ProgramResult Compensate(const std::string& motion, const std::string& more = "") const {
    return RunProgram("compensate " + (scratch_.path() / "out").string() + " --project " +
                      ProjectFile() + " --motion " + motion + " -o " +
                      (scratch_.path() / "corrected.csv").string() + " " + more);
  }

  Compensator Robot(RuntimeContent content) const {
    return Compensator(MakeRuntimeModel(project_, stored_, content));
  }

  Eigen::VectorXd Posture(int number) const {
    Eigen::VectorXd q = project_.motion.rest;
    for (Eigen::Index c = 0; c < q.size(); ++c) q[c] += 0.1 * std::sin(1.7 * number + 2.3 * c);
    return q.cwiseMax(project_.motion.lower).cwiseMin(project_.motion.upper);
  }

  /// The zeros of the encoders, by coordinate.
  Eigen::VectorXd Zeros(const std::map<std::string, double>& by_joint) const {
    Eigen::VectorXd zeros = Eigen::VectorXd::Zero(project_.tree.coordinate_count());
    for (std::size_t c = 0; c < project_.tree.coordinate_joint.size(); ++c) {
      const auto joint = static_cast<std::size_t>(project_.tree.coordinate_joint[c]);
      const auto zero = by_joint.find(project_.tree.joints[joint].name);
      if (zero != by_joint.end()) zeros[static_cast<Eigen::Index>(c)] = zero->second;
    }
    return zeros;
  }

  std::map<std::string, double> TrueZeros() const {
    std::map<std::string, double> zeros;
    for (const Joint& joint : project_.tree.joints) {
      const auto found = stored_.joint_errors.find(joint.name + ".theta");
      if (!joint.mimic && found != stored_.joint_errors.end()) zeros[joint.name] = found->second;
    }
    return zeros;
  }

  /// A robot description is the calibrated rigid robot, at positions of the encoders plus `zeros`.
  void ExpectTheCalibratedRobot(const std::string& urdf,
                                const std::map<std::string, double>& zeros) {
    const RobotTree tree = ParseUrdf(urdf, "exported");
    Compensator rigid = Robot(RuntimeContent::kGeometry);
    double largest = 0.0;
    for (int posture = 0; posture < 10; ++posture) {
      const Eigen::VectorXd q = Posture(posture);
      rigid.Forward(q, kStatics, 0);
      const std::vector<Transform> T_root_link = LinkTransforms(tree, q + Zeros(zeros));
      for (std::size_t i = 0; i < T_root_link.size(); ++i) {
        largest = std::max(largest,
                           (T_root_link[i].matrix() - rigid.link_pose(static_cast<int>(i)).matrix())
                               .cwiseAbs()
                               .maxCoeff());
      }
    }
    EXPECT_LT(largest, kRounding);
  }

  Project project_;
  StoredCalibration stored_;
  ScratchFolder scratch_;
};

/// The nominal URDF with numbers added to the origins of its joints.
std::string WithOrigins(const std::string& urdf,
                        const std::map<std::string, std::array<double, 6>>& added) {
  pugi::xml_document xml;
  xml.load_string(urdf.c_str());
  for (pugi::xml_node joint : xml.child("robot").children("joint")) {
    const auto numbers = added.find(joint.attribute("name").value());
    if (numbers == added.end()) continue;
    pugi::xml_node origin = joint.child("origin");
    if (!origin) origin = joint.append_child("origin");
    const char* names[] = {"xyz", "rpy"};
    for (std::size_t part = 0; part < 2; ++part) {
      std::istringstream before(origin.attribute(names[part]).as_string("0 0 0"));
      std::string text;
      for (std::size_t i = 0; i < 3; ++i) {
        double value = 0.0;
        before >> value;
        text += fmt::format("{:.17g} ", value + numbers->second[3 * part + i]);
      }
      origin.remove_attribute(names[part]);
      origin.append_attribute(names[part]) = text.c_str();
    }
  }
  std::ostringstream out;
  xml.save(out);
  return out.str();
}

TEST_F(CalibratedTalos, RobotDescriptionsAreTheCalibratedRobot) {
  ExpectTheCalibratedRobot(ReadFile(Export("urdf")), {});
  const std::string apart = ReadFile(Export("urdf_encoder"));
  ExpectTheCalibratedRobot(apart, TrueZeros());
  const std::string rising = ReadFile(Export("urdf_rising"));
  std::map<std::string, double> zeros;
  pugi::xml_document xml, before;
  xml.load_string(rising.c_str());
  before.load_string(apart.c_str());
  for (pugi::xml_node joint : xml.child("robot").children("joint")) {
    const char* name = joint.attribute("name").value();
    const pugi::xml_node earlier =
        before.child("robot").find_child_by_attribute("joint", "name", name);
    const double zero = joint.child("calibration").attribute("rising").as_double() -
                        earlier.child("calibration").attribute("rising").as_double();
    if (zero != 0.0) zeros[name] = zero;
  }
  ExpectTheCalibratedRobot(rising, zeros);
}

TEST_F(CalibratedTalos, SevenNumbersAJointAreTheCalibratedRobot) {
  const std::string nominal = ReadFile(project_.urdf);
  std::map<std::string, std::array<double, 6>> added;
  std::map<std::string, double> zeros;
  const YAML::Node pal = YAML::LoadFile(Export("pal"));
  for (const auto& joint : pal) {
    const auto name = joint.first.as<std::string>();
    const char* keys[] = {"x", "y", "z", "roll", "pitch", "yaw"};
    for (std::size_t i = 0; i < 6; ++i) added[name][i] = joint.second[keys[i]].as<double>();
    zeros[name] = joint.second["offset"].as<double>();
  }
  ExpectTheCalibratedRobot(WithOrigins(nominal, added), zeros);

  added.clear();
  zeros.clear();
  pugi::xml_document xacro;
  xacro.load_file(Export("xacro").c_str());
  for (pugi::xml_node property : xacro.child("robot").children("xacro:property")) {
    std::string name = property.attribute("name").value();
    const double value = property.attribute("value").as_double();
    const char* endings[] = {"_x_offset",    "_y_offset",     "_z_offset",
                             "_roll_offset", "_pitch_offset", "_yaw_offset"};
    bool origin = false;
    for (std::size_t i = 0; i < 6 && !origin; ++i) {
      origin = name.ends_with(endings[i]);
      if (origin) added[name.substr(0, name.size() - std::strlen(endings[i]))][i] = value;
    }
    if (!origin) zeros[name.substr(0, name.size() - std::strlen("_offset"))] = value;
  }
  ExpectTheCalibratedRobot(WithOrigins(nominal, added), zeros);

  pugi::xml_document transmissions;
  const std::string wrapped = "<r>" + ReadFile(Export("ros2_control")) + "</r>";
  ASSERT_TRUE(transmissions.load_string(wrapped.c_str()));
  std::map<std::string, double> offsets;
  for (pugi::xml_node one : transmissions.child("r").children("transmission")) {
    const pugi::xml_node joint = one.child("joint");
    offsets[joint.attribute("name").value()] = joint.child("offset").text().as_double();
  }
  EXPECT_EQ(offsets, zeros);
}

TEST_F(CalibratedTalos, ControllersGetTheElasticRobot) {
  Compensator expected = Robot(RuntimeContent::kEverything);
  Compensator read(ReadRuntimeModel(std::filesystem::path(Export("runtime"))));
  for (StandingFeet feet : {0u, 1u, 3u}) {
    const Eigen::VectorXd q = Posture(static_cast<int>(feet));
    expected.Command(q, kStatics, feet);
    read.Command(q, kStatics, feet);
    EXPECT_EQ(read.command(), expected.command());
  }
  if (std::system("cc --version > /dev/null 2>&1") != 0) return;  // no compiler here
  const std::string header = Export("c99", "--prefix small");
  std::string positions;
  const Eigen::VectorXd q = Posture(5);
  for (double position : q) positions += fmt::format("{:a},", position);
  const std::string source = scratch_.Write(
      "main.c", "#include <stdio.h>\n#include \"" + header + "\"\nstatic small_state state;\n" +
                    "int main(void) {\n  double q[] = {" + positions +
                    "}, out[SMALL_Q_COUNT], residual[2];\n  int i;\n  small_init(&state);\n"
                    "  small_command(&state, q, 0, 1u, out, residual);\n"
                    "  for (i = 0; i < SMALL_Q_COUNT; ++i) printf(\"%.17g\\n\", out[i]);\n"
                    "  return 0;\n}\n");
  const std::string program = (scratch_.path() / "main").string();
  ASSERT_EQ(
      std::system(("cc -std=c99 -Wall -Werror -o " + program + " " + source + " -lm").c_str()), 0);
  ASSERT_EQ(std::system((program + " > " + program + ".txt").c_str()), 0);
  expected.Command(q, kStatics, 1);
  std::istringstream numbers(ReadFile(program + ".txt"));
  for (double command : expected.command()) {
    double number = 0.0;
    ASSERT_TRUE(numbers >> number);
    EXPECT_NEAR(number, command, kRounding);
  }
}

TEST_F(CalibratedTalos, MujocoTakesTheModelWithSpringsAndWithout) {
  const std::string user = scratch_.Write("user.xml", UserModel{project_.tree}.Text(false));
  int springs = 0;
  for (const std::string& more : {std::string(), std::string(" --mjcf-springs")}) {
    const std::string file = Export("mjcf", "--mjcf " + user + more);
    std::array<char, 500> error{};
    const std::unique_ptr<mjModel, decltype(&mj_deleteModel)> model(
        mj_loadXML(file.c_str(), nullptr, error.data(), error.size()), &mj_deleteModel);
    ASSERT_NE(model, nullptr) << error.data();
    for (int j = 0; j < model->njnt; ++j) springs += model->jnt_stiffness[j] > 0.0 ? 1 : 0;
    EXPECT_EQ(springs > 30, !more.empty()) << springs;
  }
  const std::string other = (scratch_.path() / "other").string();
  EXPECT_EQ(RunExport("mjcf", other).exit_code, 3);
  EXPECT_EQ(RunExport("urdf", other, "--mjcf-springs").exit_code, 3);
  EXPECT_EQ(RunExport("urdf", other, "--hip-damping 5").exit_code, 3);
  EXPECT_EQ(RunExport("linkages", other).exit_code, 3);
  EXPECT_EQ(RunExport("unknown", other).exit_code, 2);
  EXPECT_FALSE(std::filesystem::exists(other));
}

TEST_F(CalibratedTalos, HipsGetTheirStiffness) {
  // Springs about y and x of the root link, and about the hip's joints, whose axes are z, x and y.
  for (auto& [name, value] : stored_.joint_errors) {
    if (name.find(".compliance") != std::string::npos) value = 0.0;
    if (name.ends_with("alpha") || name.ends_with("beta") || name.ends_with("gamma")) value = 0.0;
  }
  stored_.joint_errors["leg_left_1_joint.compliance_root_y"] = 1e-4;
  stored_.joint_errors["leg_left_3_joint.compliance_z"] = 3e-4;
  stored_.joint_errors["leg_left_1_joint.compliance_z"] = 7e-4;  // about z: in neither
  stored_.joint_errors["leg_right_2_joint.compliance_z"] = 5e-4;
  stored_.joint_errors["leg_right_1_joint.compliance_root_x"] = 5e-4;
  WriteCalibration(stored_);
  const std::string file = Export("flex_joints");
  const YAML::Node yaml = YAML::LoadFile(file);
  constexpr double kZeroTurned = 1e-3;  // the zero posture is that of the drawn zeros
  EXPECT_NEAR(yaml["left_stiffness"][0].as<double>(), 2500.0, 2500.0 * kZeroTurned);
  EXPECT_NEAR(yaml["right_stiffness"][1].as<double>(), 1000.0, 1000.0 * kZeroTurned);
  EXPECT_GT(yaml["left_stiffness"][1].as<double>(), 1e6);
  EXPECT_FALSE(yaml["left_damping"]);
  EXPECT_NE(ReadFile(file).find("postures at rest tell no damping"), std::string::npos);
  // sd of 10 %, independent: 1.96 sqrt(1e-5^2 + 3e-5^2).
  const double half = 1.96 * std::hypot(1e-5, 3e-5);
  EXPECT_NE(ReadFile(file).find(fmt::format("{:.4g} to ", 1.0 / (4e-4 + half))), std::string::npos)
      << ReadFile(file);
  const YAML::Node damped = YAML::LoadFile(Export("flex_joints", "--hip-damping 12.5"));
  EXPECT_EQ(damped["right_damping"][1].as<double>(), 12.5);
}

TEST_F(CalibratedTalos, InsignificantJointsAreNamedInEveryFile) {
  for (const char* format : {"urdf", "urdf_encoder", "urdf_rising", "xacro", "pal", "ros2_control",
                             "runtime", "c99", "flex_joints"}) {
    const std::string text = ReadFile(Export(format, "--min-significance 5"));
    EXPECT_EQ(text.find("is nominal"), std::string::npos) << format;  // all have sd of 10 %
  }
  for (auto& [name, value] : stored_.joint_errors) {
    if (name.starts_with("head_1_joint")) value = 0.0;
  }
  WriteCalibration(stored_);
  for (const char* format : {"urdf", "urdf_encoder", "urdf_rising", "xacro", "pal", "ros2_control",
                             "runtime", "c99", "flex_joints"}) {
    const std::string text = ReadFile(Export(format, "--min-significance 5"));
    EXPECT_NE(text.find("head_1_joint is nominal"), std::string::npos) << format;
  }
  Compensator read(ReadRuntimeModel(scratch_.path() / "runtime"));  // with its comment
  EXPECT_EQ(read.model().robot, "talos");
  ExpectTheCalibratedRobot(ReadFile(scratch_.path() / "urdf"), {});
}

/// A motion of two seconds about a posture.
std::string MotionText(const RobotTree& tree, const Eigen::VectorXd& middle, double swing) {
  std::string text = "time";
  for (int k : tree.coordinate_joint) text += "," + tree.joints[static_cast<std::size_t>(k)].name;
  for (int i = 0; i <= 20; ++i) {
    text += fmt::format("\n{:.1f}", 0.1 * i);
    for (double q : middle) text += fmt::format(",{:.9f}", q + swing * std::sin(0.3 * i));
  }
  return text + "\n";
}

TEST_F(CalibratedTalos, CompensatedHandsAreWhereThePlanMeant) {
  const std::string motion =
      scratch_.Write("plan.csv", MotionText(project_.tree, project_.motion.rest, 0.05));
  const std::string json = (scratch_.path() / "c.json").string();
  const ProgramResult result = Compensate(motion, "--json " + json);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(nlohmann::json::parse(ReadFile(json))["status"], "fine");
  const JointMotion plan = ReadMotion(motion, project_);
  const JointMotion corrected = ReadMotion(scratch_.path() / "corrected.csv", project_);
  ASSERT_EQ(corrected.q.rows(), plan.q.rows());
  Compensator nominal = Robot(RuntimeContent::kNominal), real = Robot(RuntimeContent::kEverything);
  const int hand =
      project_.chains[static_cast<std::size_t>(FindChain(project_, "arm_left"))].tip_link;
  const auto place = [&](Compensator& robot, const JointMotion& at, Eigen::Index i) {
    robot.Forward(at.q.row(i).transpose(), kStatics, 3);
    return Eigen::Vector3d(robot.link_pose(hand).translation());
  };
  for (Eigen::Index i = 0; i < plan.q.rows(); i += 5) {
    const Eigen::Vector3d wanted = place(nominal, plan, i);
    EXPECT_LT((place(real, corrected, i) - wanted).norm(), 2e-4);
    EXPECT_GT((place(real, plan, i) - wanted).norm(), 3e-3);
  }
}

TEST_F(CalibratedTalos, AMotionThatWouldBreakALimitIsRefused) {
  // At the limit of a joint that the correction moves beyond it: one direction or the other.
  int refused = 0;
  const Joint& elbow =
      project_.tree.joints[static_cast<std::size_t>(FindJoint(project_.tree, "arm_left_4_joint"))];
  const Eigen::Index k = elbow.coordinate;
  Eigen::VectorXd middle = project_.motion.rest;
  for (const double limit : {elbow.limits.lower, elbow.limits.upper}) {
    middle[k] = limit;
    const std::string motion = scratch_.Write("plan.csv", MotionText(project_.tree, middle, 0.0));
    const std::string json = (scratch_.path() / "c.json").string();
    std::filesystem::remove(scratch_.path() / "corrected.csv");
    const ProgramResult result = Compensate(motion, "--json " + json);
    const bool written = std::filesystem::exists(scratch_.path() / "corrected.csv");
    if (result.exit_code == 0) {
      EXPECT_TRUE(written);
      continue;
    }
    ++refused;
    EXPECT_EQ(result.exit_code, 4);
    EXPECT_FALSE(written);
    EXPECT_NE(result.err.find("must not be played"), std::string::npos) << result.err;
    EXPECT_EQ(nlohmann::json::parse(ReadFile(json))["status"], "refused");
  }
  EXPECT_GT(refused, 0);
}

TEST_F(CalibratedTalos, ACalibrationOfAnotherRobotIsRefused) {
  const std::string motion =
      scratch_.Write("plan.csv", MotionText(project_.tree, project_.motion.rest, 0.0));
  const std::string calibration = (scratch_.path() / "out" / "calibration.yaml").string();
  std::string text = ReadFile(calibration);
  const std::size_t at = text.find(stored_.nominal);
  ASSERT_NE(at, std::string::npos);
  text.replace(at, stored_.nominal.size(), "0123456789abcdef");
  scratch_.Write("out/calibration.yaml", text);
  const ProgramResult compensated = Compensate(motion);
  EXPECT_EQ(compensated.exit_code, 3);
  EXPECT_NE(compensated.err.find("other nominal geometry"), std::string::npos) << compensated.err;
  EXPECT_FALSE(std::filesystem::exists(scratch_.path() / "corrected.csv"));
  for (const char* format : {"urdf", "c99", "runtime", "pal", "flex_joints"}) {
    const std::string file = (scratch_.path() / format).string();
    const ProgramResult exported = RunExport(format, file);
    EXPECT_EQ(exported.exit_code, 3) << format;
    EXPECT_NE(exported.err.find("other nominal geometry"), std::string::npos) << exported.err;
    EXPECT_FALSE(std::filesystem::exists(file)) << format;
  }
}

TEST_F(Program, OnlyWhatHeldOutPosturesSayHelpsIsExported) {
  // Errors of some joints alone: the others' estimates are noise.
  const Project project = ReadProject(project_);
  const ErrorModel model = MakeErrorModel(project.tree, project.markers, project.placement);
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(model.parameter_count());
  truth[FindParameter(model.parameters, "elbow_joint.theta")] = 0.01;
  truth[FindParameter(model.parameters, "turret_joint.alpha")] = -0.008;
  WritePostureTable(recording_, MakeSyntheticRecording(model, truth, {.postures = 40, .seed = 4}),
                    project.tree);
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  const std::string file = (scratch_.path() / "arm.yaml").string();
  const ProgramResult result =
      RunProgram("export " + out_ + " --format pal --min-gain 0.03 -o " + file);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("40 postures, each by an estimate without the fifth"),
            std::string::npos)
      << result.out;
  const std::string text = ReadFile(file);
  EXPECT_NE(text.find("# shoulder_joint is nominal"), std::string::npos) << text;
  EXPECT_EQ(text.find("# elbow_joint is nominal"), std::string::npos) << text;
  const YAML::Node pal = YAML::Load(text);
  EXPECT_NEAR(pal["elbow_joint"]["offset"].as<double>(), 0.01, 1e-3);
  EXPECT_EQ(pal["shoulder_joint"]["offset"].as<double>(), 0.0);
  EXPECT_EQ(pal["shoulder_joint"]["roll"].as<double>(), 0.0);

  EXPECT_EQ(RunProgram("export " + out_ + " --format pal --min-gain -1 -o " + file).exit_code, 2);
  std::filesystem::remove(recording_);
  const ProgramResult without =
      RunProgram("export " + out_ + " --format pal --min-gain 0.03 -o " + file + "2");
  EXPECT_EQ(without.exit_code, 3);
  EXPECT_NE(without.err.find("is not there"), std::string::npos) << without.err;
  EXPECT_FALSE(std::filesystem::exists(file + "2"));
}

}  // namespace
}  // namespace elastocal
