// SPDX-License-Identifier: Apache-2.0
#include "elastocal/project/project.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "elastocal/files/output_files.hpp"
#include "tests/expect_input_error.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

/// A small project with the arm of the tests: the robot is on line 1, markers on line 2, `more`
/// from line 3.
Project Parse(
    const std::string& more = "",
    const std::string& markers = "{single: [{name: M, link: tool, position_mm: [1, 2, 3]}]}") {
  return ParseProject("robot: {urdf: arm6.urdf}\nmarkers: " + markers + "\n" + more,
                      SourceFile("tests/robots/p.yaml"));
}

void ExpectError(const std::string& more, std::initializer_list<std::string> parts) {
  ExpectInputError([&] { Parse(more); }, parts);
}

void ExpectMarkerError(const std::string& markers, std::initializer_list<std::string> parts) {
  ExpectInputError([&] { Parse("", markers); }, parts);
}

TEST(Project, ReadsMeasurementAndForceTorqueSensors) {
  const Project project = Parse(
      "force_torque_sensors: [{name: tip_ft, link: tool}]\n"
      "measurement: {cutoff_hz: 6, filter_order: 4, longest_gap_s: 0, expected_lag_s: -3.5,\n"
      "  longest_lag_s: 20, largest_lag_sd_ms: 4, largest_rest_lag_sd_ms: 20, rest_speed_mm_per_s: "
      "8, hold_s: 0.6,\n"
      "  samples_per_rest: 12, sine_rate_hz: 5}\n");
  ASSERT_EQ(project.force_torque_sensors.size(), 1u);
  EXPECT_EQ(project.force_torque_sensors[0].name, "tip_ft");
  EXPECT_EQ(project.force_torque_sensors[0].link, FindLink(project.tree, "tool"));
  const MeasurementOptions& options = project.measurement;
  EXPECT_EQ(options.smoothing.cutoff_hz, 6.0);
  EXPECT_EQ(options.smoothing.filter_order, 4);
  EXPECT_EQ(options.smoothing.longest_fill_s, 0.0);
  EXPECT_EQ(options.expected_lag_s, -3.5);
  EXPECT_EQ(options.clock.longest_lag_s, 20.0);
  EXPECT_DOUBLE_EQ(options.clock.largest_sd_s, 4e-3);
  EXPECT_DOUBLE_EQ(options.largest_rest_lag_sd_s, 20e-3);
  EXPECT_DOUBLE_EQ(options.rest.threshold_m_per_s, 8e-3);
  EXPECT_EQ(options.rest.hold_s, 0.6);
  EXPECT_EQ(options.rest.samples_per_run, 12);
  EXPECT_EQ(options.sine_rate_hz, 5.0);
  EXPECT_FALSE(Parse().measurement.expected_lag_s);
  EXPECT_EQ(Parse("measurement:\n").measurement.rest.samples_per_run, 8);
  ExpectError("measurement: {cutoff_hz: 0}", {"p.yaml:3: ", "measurement.cutoff_hz", "from 0.01"});
  ExpectError("measurement: {filter_order: 11}", {"measurement.filter_order", "10"});
  ExpectError("measurement: {longest_gap_s: -1}", {"longest_gap_s", "from 0 to 60"});
  ExpectError("measurement: {longest_lag_s: 4000}", {"longest_lag_s", "to 3600"});
  ExpectError("measurement: {samples_per_rest: 0}", {"samples_per_rest"});
  ExpectError("measurement: {cutof_hz: 5}", {"did you mean 'cutoff_hz'"});
  ExpectError("force_torque_sensors: [{name: a, link: tol}]", {"p.yaml:3: ", "'tool'"});
  ExpectError("force_torque_sensors: [{name: a, link: tool}, {name: a, link: wrist}]",
              {"second sensor of the name 'a'"});
  ExpectError("force_torque_sensors: [{name: a, link: tool}, {name: b, link: tool}]",
              {"second sensor on the same link"});
}

TEST(Project, ReadsRobotMarkersAndRecording) {
  const Project project = Parse(
      "chains:\n"
      "  - {name: arm, tip: tool}\n"
      "  - {name: wrist, from: forearm, tip: tool}\n"
      "torque_sensors: [turret_joint, elbow_joint]\n"
      "recording:\n"
      "  columns: {time: stamp, markers: {WRIST: [wx, wy, wz]}, joints: {rail_joint: rail}}\n"
      "  ignore: [operator]\n"
      "  not_recorded_deg: {roll_joint: 30}\n",
      "{reference: P, clusters: [\n"
      "  {name: P, link: pedestal, positions_mm: [[1, 2, 3], [4, 5, 6], [7, 8, 0]]},\n"
      "  {name: F, link: forearm, positions_mm: [[1, 2, 3], [-20, 130, 21], [7, 8, 0]]}],\n"
      "  single: [{name: WRIST, link: wrist, position_mm: [35, 40, 45]}]}");
  EXPECT_EQ(project.urdf, SourceFile("tests/robots/arm6.urdf"));
  EXPECT_EQ(project.tree.name, "arm6");
  ASSERT_EQ(project.chains.size(), 2u);
  EXPECT_EQ(project.chains[0].from_link, 0);
  EXPECT_EQ(project.tree.links[project.chains[1].from_link].name, "forearm");
  EXPECT_EQ(project.reference_cluster, "P");
  ASSERT_EQ(project.clusters.size(), 2u);
  ASSERT_EQ(project.markers.size(), 7u);
  const Marker& second = project.markers[project.clusters[1].markers[1]];
  EXPECT_EQ(second.name, "F_2");
  EXPECT_EQ(project.tree.links[second.link].name, "forearm");
  EXPECT_TRUE(second.p_link_marker.isApprox(Eigen::Vector3d(-0.02, 0.13, 0.021), 1e-15));
  EXPECT_EQ(project.markers[6].name, "WRIST");
  ASSERT_EQ(project.torque_sensors.size(), 2u);
  EXPECT_EQ(project.tree.joints[project.torque_sensors[0]].name, "turret_joint");
  EXPECT_EQ(project.recording.time, "stamp");
  EXPECT_EQ(project.recording.markers.at("WRIST")[2], "wz");
  EXPECT_EQ(project.recording.joints.at("rail_joint"), "rail");
  EXPECT_EQ(project.recording.ignore, std::vector<std::string>{"operator"});
  // 30 degrees, up to rounding.
  EXPECT_NEAR(project.recording.not_recorded.at("roll_joint"), M_PI / 6.0, 1e-15);
}

TEST(Project, ReadsTheProjectsOfTheRepository) {
  const Project talos = ReadProject(SourceFile("models/talos/project.yaml"));
  EXPECT_EQ(talos.markers.size(), 63u);
  EXPECT_EQ(talos.torque_sensors.size(), 24u);
  for (const char* robot : {"arm6", "mini_humanoid"}) {
    const std::string file = std::string("tests/robots/") + robot + "_project.yaml";
    EXPECT_EQ(ReadProject(SourceFile(file)).tree.name, robot);
  }
  const Project arm = ReadProject(SourceFile("examples/talos_left_arm/project.yaml"));
  EXPECT_EQ(arm.markers.size(), 1u);
  EXPECT_EQ(arm.urdf, talos.urdf);
}

TEST(Project, ReadsCouplings) {
  const Project project = Parse(
      "couplings: [{joint: bend_joint, of: {shoulder_joint: -1, elbow_joint: -0.5}, offset_deg: "
      "90}]\n");
  EXPECT_EQ(project.tree.coordinate_count(), Parse().tree.coordinate_count() - 1);
  Eigen::VectorXd q = Eigen::VectorXd::Zero(project.tree.coordinate_count());
  const auto position = [&](const std::string& name) -> double {
    return JointPosition(project.tree.joints[FindJoint(project.tree, name)], q);
  };
  q[project.tree.joints[FindJoint(project.tree, "shoulder_joint")].coordinate] = 0.2;
  q[project.tree.joints[FindJoint(project.tree, "elbow_joint")].coordinate] = 0.4;
  EXPECT_NEAR(position("bend_joint"), M_PI / 2 - 0.2 - 0.2, 1e-15);
  const auto expect = [](const std::string& coupling, std::initializer_list<std::string> parts) {
    ExpectError("couplings: [" + coupling + "]", parts);
  };
  expect("{joint: bend_joint, of: {bend_jointt: 1}}", {"p.yaml:3: ", "did you mean 'bend_joint'"});
  expect("{joint: bend_joint, of: {shoulder_joint: 0}}", {"shoulder_joint", "other than 0"});
  expect("{joint: bend_joint, of: {}}", {"couplings[0].of", "joints and their factors"});
  expect("{joint: bend_joint, of: {bend_joint: 1}}",
         {"couplings[0]", "'bend_joint' follows itself"});
  expect("{joint: bend_joint, of: {shoulder_joint: 1}, offset_mm: 1}",
         {"'offset_mm'", "'offset_deg'"});
  expect("{joint: bend_joint, of: {shoulder_joint: 1e9}}",
         {"shoulder_joint", "from -1000 to 1000"});
}

/// A crank in the upper arm of the invented arm. Its rod bends the elbow.
std::string ElbowLinkage(const std::string& rod, const std::string& joints = "elbow_joint") {
  return "linkages: [{name: elbow, joints: [" + joints +
         "], rods: [{motor: m, from: upper_arm, to: forearm, axis: [0, 2, 0], centre_mm: [0, -30, "
         "100], pin_mm: [60, -30, 100], anchor_mm: [52.7, 28.8, 0]" +
         rod + "}]}]";
}

TEST(Project, ReadsLinkages) {
  const Project project = Parse(ElbowLinkage("") + "\n");
  ASSERT_EQ(project.tree.linkages.size(), 1u);
  const Rod& rod = project.tree.linkages[0].rods[0];
  EXPECT_EQ(rod.axis, Eigen::Vector3d::UnitY());
  EXPECT_NEAR(rod.length, 0.3, 1e-3);  // the axes are 0.3 m apart
  EXPECT_EQ(rod.uncertain.size(), 5u);
  const Rod given =
      Parse(ElbowLinkage(", length_mm: 290, uncertain: {zero_deg: 1, centre_mm: [2, 0, 3]}") + "\n")
          .tree.linkages[0]
          .rods[0];
  EXPECT_DOUBLE_EQ(given.length, 0.29);
  ASSERT_EQ(given.uncertain.size(), 3u);
  EXPECT_EQ(given.uncertain[2].quantity, RodQuantity::kCentreZ);
  EXPECT_DOUBLE_EQ(given.uncertain[2].sd, 3e-3);
  const ErrorModel model = MakeErrorModel(project.tree, project.markers, project.placement);
  EXPECT_EQ(MatchParameters(model.parameters, {"m.*"}).size(), 5u);

  ExpectError(ElbowLinkage(", length_mm: 900"), {"p.yaml:3: ", "linkages[0]", "cannot reach"});
  ExpectError(ElbowLinkage("", "elbow_jont"), {"did you mean 'elbow_joint'"});
  ExpectError(ElbowLinkage(", actuator: true"), {"'axis'"});
  ExpectError(ElbowLinkage(", uncertain: {length_mm: 0}"), {"uncertain.length_mm", "from 1e-06"});
  ExpectError(ElbowLinkage(", uncertain: {centre_mm: [1, 1e-300, 0]}"),
              {"uncertain.centre_mm", "0 where it is exact"});
  ExpectError(ElbowLinkage(", uncertain: {lenght_mm: 1}"), {"did you mean 'length_mm'"});
  std::string named = ElbowLinkage("");
  named.replace(named.find("motor: m"), 8, "motor: turret_joint");
  ExpectError(named, {"rods[0].motor", "there is a joint of the name 'turret_joint'"});
  ExpectError(ElbowLinkage("") + "\ncontact: {plates: []}", {"linkages", "contact"});
}

TEST(Project, LeavesDefaultsWhereTheFileSaysNothing) {
  const Project project = Parse();
  const CalibrationOptions calibration;
  EXPECT_EQ(project.calibration.prior.sd, calibration.prior.sd);
  EXPECT_EQ(project.calibration.max_iterations, calibration.max_iterations);
  EXPECT_EQ(project.identifiability.postures, IdentifiabilityOptions().postures);
  EXPECT_EQ(project.placement.parallel_tolerance_rad, PlacementOptions().parallel_tolerance_rad);
  EXPECT_EQ(project.recording.time, RecordingColumns().time);
  EXPECT_EQ(Parse("calibration:\nchains:\nrecording:\n").calibration.marker_sd,
            calibration.marker_sd);
}

TEST(Project, ReadsWhatPointsUpInATable) {
  EXPECT_EQ(Parse().recording.gravity, Eigen::Vector3d(0.0, 0.0, -9.81));
  EXPECT_EQ(Parse("recording: {up: -y}").recording.gravity, Eigen::Vector3d(0.0, 9.81, 0.0));
  const Eigen::Vector3d tilted = Parse("recording: {up: [3, 0, 4]}").recording.gravity;
  EXPECT_LT((tilted + 9.81 * Eigen::Vector3d(0.6, 0.0, 0.8)).norm(), 1e-14);
  ExpectError("recording: {up: w}", {"recording.up", "'w'", "x, y, z, -x, -y, -z"});
  ExpectError("recording: {up: [0, 0, 0]}", {"recording.up", "a direction"});
}

TEST(Project, ReadsSettingsInTheirUnits) {
  const Project project = Parse(
      "placement: {parallel_tolerance_deg: 2}\n"
      "identifiability: {postures: 50, tolerance: 1e-5, seed: 9,\n"
      "  hold: ['*_joint.theta', waist.T0.b]}\n"
      "calibration:\n"
      "  marker_sd_mm: 0.2\n"
      "  prior: {theta_deg: 90, r_mm: 3, marker_mm: 20, beta_deg: .inf,\n"
      "          torsion_urad_per_Nm: 20, bending_urad_per_Nm: 30, base_force_um_per_N: 4,\n"
      "          base_moment_urad_per_Nm: .inf, torque_bias_Nm: 0.5}\n"
      "  widen_prior: false\n"
      "  outlier_probability: 0.05\n"
      "  support_threshold: 0.8\n"
      "  correlation_threshold: 1\n"
      "  max_iterations: 7\n");
  EXPECT_NEAR(project.placement.parallel_tolerance_rad, M_PI / 90.0, 1e-15);
  EXPECT_EQ(project.identifiability.postures, 50);
  EXPECT_EQ(project.identifiability.tolerance, 1e-5);
  EXPECT_EQ(project.identifiability.seed, 9u);
  EXPECT_EQ(project.identifiability.hold,
            (std::vector<std::string>{"*_joint.theta", "waist.T0.b"}));
  const CalibrationOptions& calibration = project.calibration;
  EXPECT_NEAR(calibration.marker_sd, 2e-4, 1e-18);
  EXPECT_NEAR(calibration.prior[ParameterKind::kTheta], M_PI / 2.0, 1e-15);
  EXPECT_NEAR(calibration.prior[ParameterKind::kR], 3e-3, 1e-17);
  EXPECT_NEAR(calibration.prior[ParameterKind::kMarker], 0.02, 1e-16);
  EXPECT_EQ(calibration.prior[ParameterKind::kBeta], std::numeric_limits<double>::infinity());
  EXPECT_EQ(calibration.prior[ParameterKind::kD], CalibrationOptions().prior[ParameterKind::kD]);
  EXPECT_NEAR(calibration.prior[ParameterKind::kTorsion], 20e-6, 1e-18);
  EXPECT_NEAR(calibration.prior[ParameterKind::kBending], 30e-6, 1e-18);
  EXPECT_NEAR(calibration.prior[ParameterKind::kLegForce], 4e-6, 1e-18);
  EXPECT_EQ(calibration.prior[ParameterKind::kLegMoment], std::numeric_limits<double>::infinity());
  EXPECT_EQ(calibration.prior[ParameterKind::kTorqueBias], 0.5);
  EXPECT_FALSE(calibration.widen_prior);
  EXPECT_EQ(calibration.outlier_probability, 0.05);
  EXPECT_EQ(calibration.support_threshold, 0.8);
  EXPECT_EQ(calibration.correlation_threshold, 1.0);
  EXPECT_EQ(calibration.max_iterations, 7);
}

TEST(Project, ChainMarkersAreThoseBeyondItsFirstLink) {
  const std::string single = ", position_mm: [1, 2, 3]}";
  const Project project =
      Parse("chains: [{name: arm, tip: tool}, {name: wrist, from: forearm, tip: hand}]\n",
            "{single: [{name: P, link: pedestal" + single + ", {name: F, link: forearm" + single +
                ", {name: W, link: wrist" + single + ", {name: T, link: tool" + single + "]}");
  EXPECT_EQ(ChainMarkers(project, project.chains[0]), (std::vector<std::string>{"F", "W", "T"}));
  EXPECT_EQ(ChainMarkers(project, project.chains[1]), std::vector<std::string>{"W"});
}

TEST(Project, NamesAMissingFile) {
  ExpectInputError([] { ReadProject("nowhere/p.yaml"); },
                   {"nowhere/p.yaml", "there is no such file"});
  ExpectInputError(
      [] {
        ParseProject("markers: {}\nrobot:\n  urdf: no.urdf", SourceFile("tests/robots/p.yaml"));
      },
      {"p.yaml:3: robot.urdf: ", "no.urdf"});
}

TEST(Project, NamesWhatIsNoFileOfItsKind) {
  ExpectInputError([] { ParseProject("robot: {urdf: package://r/r.urdf}", "p.yaml"); },
                   {"p.yaml:1: robot.urdf: ", "'package://r/r.urdf'", "not resolved", "a path"});
  ExpectInputError([] { ReadProject(SourceFile("tests/robots/arm6.urdf")); },
                   {"arm6.urdf:1: this is XML; a project file (YAML) was expected"});
  ExpectInputError([] { ReadProject(SourceFile("tests/robots")); }, {"robots: is a folder"});
  ExpectInputError([] { ParseProject("robot: {urdf: .}", SourceFile("tests/robots/p.yaml")); },
                   {"is a folder"});
}

TEST(Project, NamesMalformedRobot) {
  const ScratchFolder scratch;
  const std::filesystem::path& folder = scratch.path();
  WriteFile(folder / "bad.urdf", "<robot name='r'>\n<link>\n</robot>");
  ExpectInputError([&] { ParseProject("robot: {urdf: bad.urdf}", folder / "p.yaml"); },
                   {"bad.urdf:3: ", "malformed XML"});
}

TEST(Project, NamesUnknownKeysOfEverySection) {
  ExpectError("marker: {}", {"p.yaml:3: ", "'marker'", "did you mean 'markers'"});
  ExpectError("chains:\n  - {name: arm, tipp: tool}", {"p.yaml:4: chains[0]", "'tip'"});
  ExpectMarkerError("{singel: []}", {"p.yaml:2: markers: ", "'single'"});
  ExpectMarkerError("{single: [{name: M, link: tool, position: [1, 2, 3]}]}",
                    {"p.yaml:2: markers.single[0]: ", "'position_mm'"});
  ExpectMarkerError("{clusters: [{nam: M}]}", {"markers.clusters[0]", "'name'"});
  ExpectError("recording: {colums: {}}", {"p.yaml:3: recording: ", "'columns'"});
  ExpectError("recording: {columns: {times: t}}", {"recording.columns: ", "'time'"});
  ExpectError("placement: {parallel_tolerance: 1}", {"placement: ", "'parallel_tolerance_deg'"});
  ExpectError("identifiability: {posture: 1}", {"identifiability: ", "'postures'"});
  ExpectError("calibration: {prio: {}}", {"calibration: ", "'prior'"});
  ExpectError("calibration: {prior: {theta_dg: 1}}", {"calibration.prior: ", "'theta_deg'"});
  ExpectInputError([] { ParseProject("robot: {urd: x}", "p.yaml"); },
                   {"p.yaml:1: robot: ", "'urdf'"});
}

TEST(Project, NamesMissingKeys) {
  ExpectInputError([] { ParseProject("", "p.yaml"); }, {"p.yaml:1: ", "'robot' is missing"});
  ExpectInputError(
      [] { ParseProject("robot: {urdf: arm6.urdf}", SourceFile("tests/robots/p.yaml")); },
      {"p.yaml:1: ", "'markers' is missing"});
  ExpectError("chains: [{name: arm}]", {"p.yaml:3: chains[0]: ", "'tip' is missing"});
}

TEST(Project, NamesUnknownLinksAndJoints) {
  ExpectError("chains: [{name: arm, tip: tol}]", {"p.yaml:3: chains[0].tip: ", "'tool'"});
  ExpectError("chains: [{name: arm, from: rial, tip: tool}]", {"chains[0].from: ", "'rail'"});
  ExpectMarkerError("{single: [{name: M, link: tol, position_mm: [1, 2, 3]}]}",
                    {"p.yaml:2: markers.single[0].link: ", "did you mean 'tool'"});
  ExpectError("torque_sensors: [elbow]", {"p.yaml:3: torque_sensors[0]: ", "'elbow'"});
  ExpectError("recording: {columns: {joints: {elbw_joint: q}}}",
              {"p.yaml:3: recording.columns.joints.elbw_joint: ", "'elbow_joint'"});
  ExpectError("recording: {columns: {markers: {N: [x, y, z]}}}", {"no marker 'N'"});
  ExpectError("recording: {not_recorded_deg: {elbw_joint: 0}}", {"'elbow_joint'"});
  ExpectError("identifiability:\n  hold: ['elbow_joint.thet']",
              {"p.yaml:4: identifiability.hold[0]: ", "'elbow_joint.theta'"});
}

TEST(Project, ChecksChains) {
  ExpectError("chains: [{name: a, tip: tool}, {name: a, tip: tool}]", {"second chain", "'a'"});
  for (const char* name : {"../x", "'..'", "left arm", "a/b", "b\u00e8ta", "."}) {
    ExpectError(std::string("chains:\n  - {name: ") + name + ", tip: tool}",
                {"p.yaml:4: chains[0].name: found ", "can name a file"});
  }
  ExpectError("chains: [{name: a, tip: rail}]", {"chains[0]", "no joint", "'rail'"});
  ExpectError("chains: [{name: a, from: tool, tip: forearm}]",
              {"'tool' does not carry link 'forearm'"});
  ExpectError("torque_sensors: [elbow_joint, elbow_joint]", {"torque_sensors[1]", "twice"});
}

TEST(Project, ChecksMarkers) {
  ExpectMarkerError("{}", {"p.yaml:2: markers: ", "no marker"});
  ExpectMarkerError("{single: [{name: M, link: tool, position_mm: [1, 2]}]}",
                    {"position_mm: found 2 numbers; expected three coordinates"});
  ExpectMarkerError("{single: [{name: M, link: pedestal, position_mm: [1, 2, 3]}]}",
                    {"p.yaml:2: markers: no joint moves any marker"});
  ExpectMarkerError("{single: [{name: M, link: tool, position_mm: [1, 2, x]}]}",
                    {"position_mm[2]: found 'x'"});
  ExpectMarkerError("{clusters: [{name: C, link: tool, positions_mm: [[1, 2, 3]]}]}",
                    {"positions_mm", "at least three"});
  ExpectMarkerError(
      "{clusters: [{name: C, link: tool, positions_mm: [[0.1, 0, 0], [0, 0.2, 0], [0, 0, 0]]}]}",
      {"positions_mm", "0.224 mm", "metres"});
  const std::string cluster =
      "{name: C, link: tool, positions_mm: [[1, 2, 3], [4, 5, 6], [7, 8, 0]]}";
  ExpectMarkerError("{clusters: [" + cluster + ",\n  " + cluster + "]}",
                    {"p.yaml:3: ", "second cluster", "'C'"});
  ExpectMarkerError(
      "{clusters: [" + cluster + "],\n  single: [{name: C_2, link: tool, position_mm: [1, 2, 3]}]}",
      {"p.yaml:3: ", "second marker", "'C_2'"});
  ExpectMarkerError("{reference: CC, clusters: [" + cluster + "]}",
                    {"markers.reference", "did you mean 'C'"});
  ExpectMarkerError("{reference: C, clusters: [" + cluster + "]}",
                    {"markers.reference", "'tool'", "root link 'pedestal'"});
}

TEST(Project, ChecksRecordingColumns) {
  ExpectError("recording: {columns: {markers: {M: [x, y]}}}", {"three columns"});
  ExpectError("recording: {reference_lengths: [{markers: [A], length_mm: 500, sd_mm: 0.1}]}",
              {"two markers"});
  ExpectError("recording: {reference_lengths: [{markers: [A, A], length_mm: 500, sd_mm: 0.1}]}",
              {"different"});
  ExpectError("recording: {reference_lengths: [{markers: [A, B], length_mm: 0.5, sd_mm: 0.1}]}",
              {"length_mm", "10"});
  ExpectError("recording: {not_recorded_deg: {rail_joint: 0}}", {"rail_joint", "not_recorded_mm"});
  ExpectError("design: {range_deg: {elbow_joint: [10, -10]}}", {"range_deg", "elbow_joint"});
  ExpectError("design: {range_deg: {elbow_joint: [10]}}", {"range_deg", "two numbers"});
  ExpectError("design: {range_deg: {elbow_joint: [1000, 2000]}}", {"within the joint's limits"});
  ExpectError("recording: {not_recorded_mm: {elbow_joint: 0}}", {"not_recorded_deg"});
  ExpectError("recording: {not_recorded_mm: {finger_right_joint: 0}}",
              {"'finger_right_joint' follows joint 'finger_left_joint'"});
  EXPECT_EQ(Parse("recording: {not_recorded_mm: {rail_joint: 250}}")
                .recording.not_recorded.at("rail_joint"),
            0.25);
}

TEST(Project, NamesValuesOutOfRange) {
  for (const char* setting :
       {"placement: {parallel_tolerance_deg: 0}", "placement: {parallel_tolerance_deg: 90}",
        "identifiability: {postures: 0}", "identifiability: {postures: 1.5}",
        "identifiability: {tolerance: 1}", "identifiability: {seed: -1}",
        "calibration: {marker_sd_mm: -1}", "calibration: {outlier_probability: 0}",
        "calibration: {support_threshold: 1.1}", "calibration: {correlation_threshold: 0}",
        "calibration: {max_iterations: 0}", "calibration: {widen_prior: 2}"}) {
    const std::string text = setting;
    const std::size_t open = text.find('{'), colon = text.find(": ", open);
    const std::string key =
        text.substr(0, text.find(':')) + "." + text.substr(open + 1, colon - open - 1);
    ExpectError(text, {"p.yaml:3: " + key + ": found '", "expected"});
  }
  ExpectError("calibration: {prior: {d_mm: 0}}", {"p.yaml:3: calibration.prior.d_mm: found '0'"});
}

}  // namespace
}  // namespace elastocal
