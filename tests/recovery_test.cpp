// SPDX-License-Identifier: Apache-2.0
// The whole estimator recovers a known truth, for the embedded humanoid and other robots.

#include <cmath>

#include <gtest/gtest.h>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/robot/kinematics.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

using Kind = ParameterKind;

/// A chain of a project, with all its markers.
struct ChainModel {
  ErrorModel model;
  BaseParameters base;
};

ChainModel MakeChainModel(const std::string& project_file, const std::string& chain_name) {
  const Project project = ReadProject(SourceFile(project_file));
  for (const Chain& chain : project.chains) {
    if (chain.name != chain_name) continue;
    ChainModel setup;
    setup.model = SelectMarkers(MakeErrorModel(project.tree, project.markers, project.placement),
                                ChainMarkers(project, chain));
    setup.base = FindBaseParameters(setup.model, project.identifiability);
    return setup;
  }
  throw std::runtime_error("no chain " + chain_name);
}

/// Errors as large as those of a real robot, and markers that are off by a centimetre.
std::map<Kind, double> RealisticErrors(double factor = 1.0) {
  const double angle = factor * 0.5 * M_PI / 180.0;
  const double length = factor * 1e-3;
  return {{Kind::kTheta, angle}, {Kind::kAlpha, angle},
          {Kind::kBeta, angle},  {Kind::kGamma, angle},
          {Kind::kR, length},    {Kind::kD, length},
          {Kind::kB, length},    {Kind::kMarker, 10.0 * length}};
}

std::vector<int> AllParameters(const ErrorModel& model) {
  std::vector<int> all(model.parameter_count());
  for (int i = 0; i < model.parameter_count(); ++i) all[i] = i;
  return all;
}

ErrorModel SeenFromAfar(ErrorModel model) {
  model.T_ref_waist = Transform(Eigen::Translation3d(1.5, -0.7, 0.9)) * RotZ(2.1) * RotX(0.3);
  return model;
}

class Recovery : public ::testing::TestWithParam<std::pair<std::string, std::string>> {};

TEST_P(Recovery, NoiseFreeDataGiveBackEveryIdentifiableParameter) {
  const auto [project, chain] = GetParam();
  const ChainModel chain_model = MakeChainModel(project, chain);
  const ErrorModel truth_model = SeenFromAfar(chain_model.model);
  const Eigen::VectorXd truth =
      DrawErrors(truth_model, AllParameters(truth_model), RealisticErrors(), 7);
  const Recording recording =
      MakeSyntheticRecording(truth_model, truth, {.postures = 40, .marker_sd = 0.0});
  const CalibrationResult result =
      Calibrate(chain_model.model, recording, chain_model.base, ModelKind::kGeometric, {});
  EXPECT_EQ(result.termination, Termination::kConverged);
  EXPECT_TRUE(result.outliers.empty());
  // Perfect data (with at least a micrometre of assumed noise) determine some parameters exactly.
  // For the others they determine combinations, and the standard deviation says so.
  int told = 0;
  for (int i = 0; i < chain_model.model.parameter_count(); ++i) {
    const Parameter& parameter = chain_model.model.parameters[i];
    if (parameter.kind == Kind::kWaistPose) continue;  // refers to another registration
    EXPECT_NEAR(result.delta[i], truth[i], 1e-8 + 5.0 * result.sd[i]) << parameter.name;
    if (result.sd[i] < 1e-6) {
      EXPECT_NEAR(result.delta[i], truth[i], 1e-6) << parameter.name;
      ++told;
    }
  }
  EXPECT_GE(2 * told, static_cast<int>(chain_model.model.active_joints.size()));
}

// All parameters have errors, also the dropped ones. The estimate finds the combinations that the
// regrouping names. This holds to first order, so the errors are 1e-3 of realistic ones, whose
// square is 1e-10 rad.
TEST_P(Recovery, DroppedParametersAreRegroupedAsReported) {
  const auto [project, chain] = GetParam();
  const ChainModel chain_model = MakeChainModel(project, chain);
  const Eigen::VectorXd truth =
      DrawErrors(chain_model.model, AllParameters(chain_model.model), RealisticErrors(1e-3), 3);
  const Recording recording =
      MakeSyntheticRecording(chain_model.model, truth, {.postures = 40, .marker_sd = 0.0});
  const CalibrationResult result =
      Calibrate(chain_model.model, recording, chain_model.base, ModelKind::kGeometric, {});
  const BaseParameters& base = chain_model.base;
  const auto combined = [&](const Eigen::VectorXd& delta) {
    return Eigen::VectorXd(delta(base.kept) + base.regrouping * delta(base.dropped));
  };
  const Eigen::VectorXd expected = combined(truth);
  const Eigen::VectorXd found = combined(result.delta);
  for (std::size_t i = 0; i < chain_model.base.kept.size(); ++i) {
    const Parameter& parameter = chain_model.model.parameters[chain_model.base.kept[i]];
    if (parameter.kind == Kind::kWaistPose) continue;
    const auto k = static_cast<Eigen::Index>(i);
    EXPECT_NEAR(found[k], expected[k], 3e-7) << parameter.name;
  }
}

// The same with errors of full size. Linear regrouping no longer holds, but the calibrated model
// must predict unseen postures exactly.
TEST_P(Recovery, ErrorsOnAllParametersAreExplainedExactly) {
  const auto [project, chain] = GetParam();
  const ChainModel chain_model = MakeChainModel(project, chain);
  const Eigen::VectorXd truth =
      DrawErrors(chain_model.model, AllParameters(chain_model.model), RealisticErrors(), 5);
  const Recording seen = MakeSyntheticRecording(chain_model.model, truth,
                                                {.postures = 60, .marker_sd = 0.0, .seed = 1});
  const Recording unseen = MakeSyntheticRecording(chain_model.model, truth,
                                                  {.postures = 20, .marker_sd = 0.0, .seed = 2});
  const CalibrationResult result =
      Calibrate(chain_model.model, seen, chain_model.base, ModelKind::kGeometric, {});
  EXPECT_LT(ResidualNorms(result.model, unseen, result.delta).maxCoeff(), 1e-7);
}

/// The robot with the origins of all joints displaced and turned by about `size` (m and rad), or
/// with all numbers of the origins rounded to four decimals (size 0).
ErrorModel Misaligned(const ErrorModel& model, double size, std::uint64_t seed) {
  Random random(seed);
  RobotTree tree = model.tree;
  for (Joint& joint : tree.joints) {
    Transform& T = joint.T_parent_child;
    if (size > 0.0) {
      const Eigen::Vector3d turn = random.NormalVector(3, size);
      T.translation() += random.NormalVector(3, size);
      T.linear() = T.linear() * RotationFromVector(turn);
    } else {
      const auto rounded = [](const Eigen::Vector3d& value) {
        return Eigen::Vector3d((1e4 * value.array()).round() * 1e-4);
      };
      T = FromXyzRpy(rounded(T.translation()), rounded(ToRpy(T.linear(), Eigen::Vector3d::Zero())));
    }
  }
  return MakeErrorModel(tree, model.markers);
}

// Which parameters are identifiable depends on axes that are exactly parallel or meet in a point.
// The estimate must not depend on this. The robot is that of the URDF with errors. The URDF for the
// estimator is off by anything from rounding to half a centimetre, like a calibrated URDF that
// becomes the next nominal one. The noise is 0.2 mm.
TEST_P(Recovery, DoesNotHingeOnExactAlignment) {
  const auto [project, chain] = GetParam();
  const ChainModel chain_model = MakeChainModel(project, chain);
  const Eigen::VectorXd truth =
      DrawErrors(chain_model.model, AllParameters(chain_model.model), RealisticErrors(), 9);
  const Recording recording = MakeSyntheticRecording(chain_model.model, truth, {.postures = 60});
  const Recording unseen = MakeSyntheticRecording(chain_model.model, truth,
                                                  {.postures = 40, .marker_sd = 0.0, .seed = 2});
  for (double size : {1e-12, 1e-9, 1e-6, 1e-4, 5e-3, 0.0}) {
    const ErrorModel model = Misaligned(chain_model.model, size, 3);
    const BaseParameters base = FindBaseParameters(model, {});
    const CalibrationResult result = Calibrate(model, recording, base, ModelKind::kGeometric, {});
    EXPECT_EQ(result.termination, Termination::kConverged) << size;
    EXPECT_TRUE(result.settled) << size;
    EXPECT_TRUE(result.outliers.empty()) << size;
    const Eigen::MatrixXd distances = ResidualNorms(result.model, unseen, result.delta);
    const double rmse = std::sqrt(distances.array().square().mean());
    std::printf(
        "misaligned by %g: %.3f mm rms, %.3f mm at most on unseen postures; marker noise "
        "%.3f mm\n",
        size, 1e3 * rmse, 1e3 * distances.maxCoeff(), 1e3 * result.marker_sd);
    EXPECT_LT(rmse, 0.12e-3) << size;
    EXPECT_NEAR(result.marker_sd, 0.2e-3, 0.02e-3) << size;
  }
}

INSTANTIATE_TEST_SUITE_P(
    Robots, Recovery,
    ::testing::Values(std::pair<std::string, std::string>{"models/talos/project.yaml", "leg_left"},
                      std::pair<std::string, std::string>{"models/talos/project.yaml", "arm_left"},
                      std::pair<std::string, std::string>{"tests/robots/arm6_project.yaml", "arm"},
                      std::pair<std::string, std::string>{"tests/robots/mini_humanoid_project.yaml",
                                                          "left_leg"}),
    [](const auto& chain) {
      const std::string& project = chain.param.first;
      const std::size_t slash = project.rfind('/');
      std::string name = project.find("talos") != std::string::npos
                             ? "talos"
                             : project.substr(slash + 1, project.find('.') - slash - 1);
      return name + "_" + chain.param.second;
    });

// 95 % intervals must contain the truth in 95 % of cases. The truth is drawn from the prior, with
// noise of 0.2 mm and 100 seeds. Over 1800 joint parameters, the share has a standard deviation of
// half a per cent (more, because errors of one seed are correlated). So 93-97 % allows four of them
// to either side.
TEST(Coverage, IntervalsHoldWhatTheyPromise) {
  const ChainModel chain_model = MakeChainModel("models/talos/project.yaml", "leg_left");
  struct Count {
    int inside = 0, all = 0;
    double Fraction() const { return static_cast<double>(inside) / all; }
  } joints, markers;
  double mean_marker_sd = 0.0;
  constexpr int kSeeds = 100;
  for (int seed = 0; seed < kSeeds; ++seed) {
    const Eigen::VectorXd truth =
        DrawErrors(chain_model.model, AllParameters(chain_model.model), RealisticErrors(), seed);
    const Recording recording =
        MakeSyntheticRecording(chain_model.model, truth, {.postures = 24, .seed = 1000u + seed});
    const CalibrationResult result =
        Calibrate(chain_model.model, recording, chain_model.base, ModelKind::kGeometric, {});
    ASSERT_EQ(result.termination, Termination::kConverged) << seed;
    mean_marker_sd += result.marker_sd / kSeeds;
    for (int i = 0; i < chain_model.model.parameter_count(); ++i) {
      const Kind kind = chain_model.model.parameters[i].kind;
      if (kind == Kind::kWaistPose) continue;
      Count& count = kind == Kind::kMarker ? markers : joints;
      count.inside += std::abs(result.delta[i] - truth[i]) <= result.interval_factor * result.sd[i];
      ++count.all;
    }
  }
  std::printf("coverage: %.2f %% of %d joint parameters, %.2f %% of %d marker coordinates\n",
              100.0 * joints.Fraction(), joints.all, 100.0 * markers.Fraction(), markers.all);
  for (const Count& count : {joints, markers}) {
    EXPECT_GE(count.Fraction(), 0.93);
    EXPECT_LE(count.Fraction(), 0.97);
  }
  EXPECT_NEAR(mean_marker_sd, 0.2e-3,
              0.004e-3);  // from 64 800 coordinates: within 2 %
}

TEST(Repeatability, SameInputSameBits) {
  const ChainModel chain_model = MakeChainModel("models/talos/project.yaml", "leg_left");
  const Eigen::VectorXd truth =
      DrawErrors(chain_model.model, chain_model.base.kept, RealisticErrors(), 1);
  const Recording recording = MakeSyntheticRecording(chain_model.model, truth, {.postures = 20});
  const auto calibrate = [&] {
    return Calibrate(chain_model.model, recording, chain_model.base, ModelKind::kGeometric, {});
  };
  const CalibrationResult first = calibrate();
  const CalibrationResult second = calibrate();
  EXPECT_EQ(first.delta, second.delta);
  EXPECT_EQ(first.posterior.covariance, second.posterior.covariance);
}

// Only the order of summation differs, with an effect far below the standard deviations (1e-5).
TEST(Repeatability, OrderOfPosturesDoesNotMatter) {
  const ChainModel chain_model = MakeChainModel("models/talos/project.yaml", "leg_left");
  const Eigen::VectorXd truth =
      DrawErrors(chain_model.model, chain_model.base.kept, RealisticErrors(), 1);
  const Recording recording = MakeSyntheticRecording(chain_model.model, truth, {.postures = 20});
  std::vector<int> reversed;
  for (int i = 19; i >= 0; --i) reversed.push_back(i);
  const CalibrationResult a =
      Calibrate(chain_model.model, recording, chain_model.base, ModelKind::kGeometric, {});
  const CalibrationResult b = Calibrate(chain_model.model, SelectPostures(recording, reversed),
                                        chain_model.base, ModelKind::kGeometric, {});
  for (int i = 0; i < chain_model.model.parameter_count(); ++i) {
    if (chain_model.model.parameters[i].joint < 0) continue;
    EXPECT_NEAR(a.delta[i], b.delta[i], 1e-9) << chain_model.model.parameters[i].name;
  }
}

}  // namespace
}  // namespace elastocal
