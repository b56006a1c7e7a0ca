// SPDX-License-Identifier: Apache-2.0
// The command `export` as its users run it. The output in each format is read back.
#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <memory>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <mujoco/mujoco.h>
#include <nlohmann/json.hpp>
#include <pugixml.hpp>
#include <yaml-cpp/yaml.h>

#include "elastocal/files/output_files.hpp"
#include "elastocal/io/marker_places_file.hpp"
#include "tests/calibrated_talos.hpp"
#include "tests/program_fixture.hpp"
#include "tests/user_mjcf.hpp"

namespace elastocal {
namespace {

/// The nominal URDF with these numbers added to the origins of its joints.
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

TEST_F(CalibratedTalos, BesideSpringsTheUrdfHasTheGeometryOfTheElasticModel) {
  const std::string file = (scratch_.path() / "out/calibration.yaml").string();
  WriteFile(file, ReadFile(file) +
                      "urdf:\n  model: rigid\n  errors:\n    arm_left_1_joint.theta: 0.03\n");
  const Eigen::VectorXd q = Posture(1);
  const auto hand = [&](const std::string& urdf) -> Eigen::Vector3d {
    const RobotTree tree = ParseUrdf(urdf, "exported");
    const int link = FindLink(tree, "gripper_left_base_link");
    return LinkTransforms(tree, q)[static_cast<std::size_t>(link)].translation();
  };
  const std::string beside = ReadFile(Export("urdf", "--beside-springs"));
  EXPECT_GT((hand(ReadFile(Export("urdf"))) - hand(beside)).norm(), 1e-3);
  ExpectTheCalibratedRobot(beside, {});
  EXPECT_NE(beside.find("Geometry of the elastic model"), std::string::npos);
  EXPECT_EQ(RunExport("c99", (scratch_.path() / "x.h").string(), "--beside-springs").exit_code, 3);
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

TEST_F(CalibratedTalos, NamesThatCDoesNotTakeAreRefused) {
  for (const char* prefix : {"1bad", "'a b'"}) {
    const ProgramResult refused =
        RunExport("c99", (scratch_.path() / "x.h").string(), "--prefix " + std::string(prefix));
    EXPECT_EQ(refused.exit_code, 3) << refused.err;
    EXPECT_NE(refused.err.find("--prefix"), std::string::npos) << refused.err;
  }
}

TEST_F(CalibratedTalos, TheHeaderHasTheLowPassAndLimitsThatWereAskedFor) {
  const std::string plain = Export("c99", "--prefix small");
  const std::string own = (scratch_.path() / "own.h").string();
  const ProgramResult result = RunExport(
      "c99", own, "--prefix small --torque-time-constant-s 0.5 --period-s 0.004 --most-bend-mm 7");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const std::string text = ReadFile(own);
  // Share of a new torque that the low-pass takes, and the limits.
  EXPECT_NE(ReadFile(plain).find("\n    1, 0.05"), std::string::npos);
  EXPECT_NE(text.find("\n    0.00793650793650"), std::string::npos);  // 0.004 / 0.504
  EXPECT_NE(text.find(", 0.0070"), std::string::npos);
  const ProgramResult refused =
      RunExport("urdf", (scratch_.path() / "x.urdf").string(), "--period-s 0.004");
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_NE(refused.err.find("--period-s is about format c99"), std::string::npos) << refused.err;
}

TEST_F(CalibratedTalos, ControllersGetTheElasticRobot) {
  Compensator expected = Robot(RuntimeContent::kEverything);
  Compensator read(ReadRuntimeModel(std::filesystem::path(Export("runtime"))));
  for (StandingFeet feet : {0u, 1u, 3u}) {
    const Eigen::VectorXd q = Posture(static_cast<int>(feet));
    expected.Command(q, NoTorques(), feet);
    read.Command(q, NoTorques(), feet);
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
  expected.Command(q, NoTorques(), 1);
  std::istringstream numbers(ReadFile(program + ".txt"));
  for (double command : expected.command()) {
    double number = 0.0;
    ASSERT_TRUE(numbers >> number);
    EXPECT_NEAR(number, command, 1e-9);
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
  // The springs are about y and x of the root link and about the hip's joints, whose axes are z, x,
  // y.
  for (auto& [name, value] : stored_.joint_errors) {
    if (name.find(".compliance") != std::string::npos) value = 0.0;
    if (name.ends_with("alpha") || name.ends_with("beta") || name.ends_with("gamma")) value = 0.0;
  }
  stored_.joint_errors["leg_left_1_joint.compliance_root_y"] = 1e-4;
  stored_.joint_errors["leg_left_3_joint.compliance_z"] = 3e-4;
  stored_.joint_errors["leg_left_1_joint.compliance_z"] = 7e-4;  // about z, which has no stiffness
  stored_.joint_errors["leg_right_2_joint.compliance_z"] = 5e-4;
  stored_.joint_errors["leg_right_1_joint.compliance_root_x"] = 5e-4;
  WriteCalibration(stored_);
  const std::string file = Export("flex_joints");
  const YAML::Node yaml = YAML::LoadFile(file);
  constexpr double kZeroTurned = 1e-3;  // the drawn zeros turn the zero posture
  EXPECT_NEAR(yaml["left_stiffness"][0].as<double>(), 2500.0, 2500.0 * kZeroTurned);
  EXPECT_NEAR(yaml["right_stiffness"][1].as<double>(), 1000.0, 1000.0 * kZeroTurned);
  EXPECT_GT(yaml["left_stiffness"][1].as<double>(), 1e6);
  EXPECT_FALSE(yaml["left_damping"]);
  EXPECT_NE(ReadFile(file).find("postures at rest tell no damping"), std::string::npos);
  // With independent standard deviations of 10 %: 1.96 sqrt(1e-5^2 + 3e-5^2).
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
  Compensator read(ReadRuntimeModel(scratch_.path() / "runtime"));  // the file has a comment
  EXPECT_EQ(read.model().robot, "talos");
  ExpectTheCalibratedRobot(ReadFile(scratch_.path() / "urdf"), {});
}

// A URDF has the geometry of a fit of its own, and a format that carries no causes has no gain of
// them.
TEST_F(CalibratedTalos, SignificanceIsThatOfWhatTheFormatCarries) {
  for (auto& [name, value] : stored_.joint_errors) {
    if (name.starts_with("arm_left_4_joint")) value = 0.0;
  }
  stored_.joint_errors["arm_left_4_joint.eccentricity_sin"] = 5e-3;
  WriteCalibration(stored_);
  const std::string file = (scratch_.path() / "out/calibration.yaml").string();
  std::string geometry = "urdf:\n  model: rigid\n  errors:\n";
  for (const auto& [name, value] : stored_.joint_errors) {
    if (name.ends_with(".theta") && !name.starts_with("head_1_joint")) {
      geometry += fmt::format("    {}: {:.17g}\n", name, value);
    }
  }
  WriteFile(file, ReadFile(file) + geometry);
  const auto names = [&](const std::string& format, const std::string& joint,
                         const std::string& more = "") {
    const std::string text = ReadFile(Export(format, "--min-significance 5 " + more));
    return text.find(joint + " is nominal") != std::string::npos;
  };
  EXPECT_TRUE(names("urdf", "head_1_joint"));
  EXPECT_FALSE(names("runtime", "head_1_joint"));
  EXPECT_FALSE(names("runtime", "arm_left_4_joint"));
  const std::string user = scratch_.Write("user.xml", UserModel{project_.tree}.Text(false));
  EXPECT_TRUE(names("mjcf", "arm_left_4_joint", "--mjcf-springs --mjcf " + user));
}

TEST_F(CalibratedTalos, ExportsReplaceExportsAndNothingElse) {
  const std::string user = scratch_.Write("user.xml", UserModel{project_.tree}.Text(false));
  const std::string notes = ReadFile(project_.urdf);
  const std::string file = scratch_.Write("talos.txt", notes);
  for (const char* format : {"urdf", "urdf_encoder", "urdf_rising", "xacro", "pal", "ros2_control",
                             "runtime", "c99", "flex_joints", "mjcf"}) {
    const std::string more = format == std::string("mjcf") ? "--mjcf " + user : "";
    const ProgramResult result = RunExport(format, file, more);
    EXPECT_EQ(result.exit_code, 3) << format;
    EXPECT_NE(result.err.find("talos.txt: is there and was not written by this command"),
              std::string::npos)
        << result.err;
    EXPECT_EQ(ReadFile(file), notes) << format;
    Export(format, more);
    Export(format, more);  // replaced, because it states its origin
  }
}

TEST_F(Program, ExportsReplaceNoInputOfTheCalibration) {
  ASSERT_EQ(Calibrate(project_, recording_).exit_code, 0);
  // An input is protected even if it states that it was exported.
  WriteFile(recording_, "Made by elastocal ");
  const ProgramResult result = RunProgram("export " + out_ + " --format pal -o " + recording_);
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_NE(result.err.find("this is an input"), std::string::npos) << result.err;
  EXPECT_EQ(ReadFile(recording_), "Made by elastocal ");
}

// With measured places, `validate` reveals a zero that no marker shows. `diagnose` uses the places
// of the calibration.
TEST_F(Program, ValidateAndDiagnoseKnowMeasuredPlaces) {
  Eigen::VectorXd truth = Eigen::VectorXd::Zero(model_.parameter_count());
  truth[FindParameter(model_.parameters, "flange_joint.theta")] = 0.02;
  truth[FindParameter(model_.parameters, "elbow_joint.theta")] = 0.01;
  const std::string other = (scratch_.path() / "other.csv").string();
  WritePostureTable(recording_, MakeSyntheticRecording(model_, truth, {.postures = 40, .seed = 4}),
                    arm_.tree);
  WritePostureTable(other, MakeSyntheticRecording(model_, truth, {.postures = 40, .seed = 5}),
                    arm_.tree);
  std::vector<MarkerMeasurement> places;
  for (const Marker& marker : model_.markers) {
    places.push_back({marker.name, marker.p_link_marker, 5e-6});  // more exact than the data
  }
  const std::string table =
      " --marker-places " + scratch_.Write("p.csv", FormatMarkerPlaces(places));
  const std::string json = (scratch_.path() / "result.json").string();
  const auto error_of = [&](const std::string& more) {
    RunProgram("validate " + project_ + " --calibration " + out_ + " --recording " + other +
               " --json " + json + more);
    return nlohmann::json::parse(ReadFile(json))["rmse_3d_mm_all"]["calibrated"].get<double>();
  };
  ASSERT_EQ(Calibrate(project_, recording_, kFewFolds).exit_code, 0);
  const double noise = error_of("");
  EXPECT_GT(error_of(table), 1.3 * noise);
  ASSERT_EQ(Calibrate(project_, recording_, kFewFolds + table).exit_code, 0);
  EXPECT_LT(error_of(table), 1.1 * noise);
  const ProgramResult frozen = RunProgram("validate " + project_ + " --calibration " + out_ +
                                          " --recording " + other + " --frozen" + table);
  EXPECT_EQ(frozen.exit_code, 3);
  EXPECT_NE(frozen.err.find("nothing is fitted beside them"), std::string::npos) << frozen.err;
  EXPECT_EQ(RunProgram("diagnose " + out_ + " --json " + json).exit_code, 0);
  scratch_.Write("p.csv", "no table");  // diagnose reads it
  EXPECT_EQ(RunProgram("diagnose " + out_).exit_code, 3);
}

}  // namespace
}  // namespace elastocal
