// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "elastocal/math/random.hpp"
#include "elastocal/math/rotation_vector.hpp"
#include "elastocal/observation/observed_posture.hpp"
#include "elastocal/pipeline/contact_run.hpp"
#include "elastocal/tables/table_writer.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

// The example with all kinds of instruments on a virtual TALOS.

/// A posture with bent knees. Arms and trunk are near the middle of their ranges.
Eigen::VectorXd InstrumentPosture(const RobotTree& tree, Random& random) {
  Eigen::VectorXd q = Eigen::VectorXd::Zero(tree.coordinate_count());
  for (const Joint& joint : tree.joints) {
    if (joint.mimic) continue;
    double& position = q[joint.coordinate];
    const double middle = 0.5 * (joint.limits.lower + joint.limits.upper);
    const double range = 0.5 * (joint.limits.upper - joint.limits.lower);
    if (joint.name.starts_with("arm_")) {
      position = middle + 0.7 * range * random.Uniform(-1.0, 1.0);
    } else if (joint.name.starts_with("torso_")) {
      position = middle + 0.4 * range * random.Uniform(-1.0, 1.0);
    } else if (joint.name.starts_with("leg_")) {
      position = random.Normal(0.04);
    }
  }
  const double knee = random.Uniform(0.5, 1.0);
  for (const std::string side : {"left", "right"}) {
    const auto add = [&](int joint, double by) {
      const std::string name = "leg_" + side + "_" + std::to_string(joint) + "_joint";
      q[tree.joints[FindJoint(tree, name)].coordinate] += by;
    };
    add(3, -0.5 * knee);
    add(4, knee);
    add(5, -0.5 * knee);
  }
  return q;
}

/// Measurements of the project's instruments on a robot with random errors, written as a table.
/// Every third posture lacks the trackers, and every fourth the wire.
class VirtualTalos {
 public:
  VirtualTalos(const Project& project, std::uint64_t seed)
      : project_(project),
        random_(seed),
        model_(MakeObservedRobot(project.tree, project.placement, SetupOf(project), {}, {})) {
    truth_.robot = Eigen::VectorXd::Zero(model_.robot.parameter_count());
    const Spread spread = FirstSpread(model_.setup.sources);
    const std::vector<SourceOfParameter> sources = SourcesOfParameters(model_);
    for (int i = 0; i < model_.robot.parameter_count(); ++i) {
      if (model_.unknown[i] >= 0) truth_.robot[i] = random_.Normal(spread[sources[i].source]);
    }
    for (const Quantity& quantity : model_.setup.quantities) {
      QuantityValue value{quantity.origin, Eigen::VectorXd(quantity.size())};
      for (int k = 0; k < quantity.size(); ++k) {
        value.x[k] = random_.Normal(std::min(0.1, spread[quantity.sources[k]]));
      }
      truth_.quantities.push_back(value);
    }
  }

  std::string Table(int postures) {
    Observations all;
    all.q.resize(postures, project_.tree.coordinate_count());
    for (int i = 0; i < postures; ++i) {
      all.postures.push_back({0, i + 2});
      all.q.row(i) = InstrumentPosture(project_.tree, random_).transpose();
      for (int n = 0; n < static_cast<int>(model_.setup.instruments.size()); ++n) {
        all.all.push_back({i, n, {}, {}});
      }
    }
    const auto sights = SightsOf(model_, all, truth_, {});
    TableWriter table;
    for (int joint : project_.tree.coordinate_joint) table.Add(project_.tree.joints[joint].name);
    for (const auto& columns : project_.contact->columns) {
      for (const std::string& column : columns) table.Add(column);
    }
    table.EndRow();
    std::size_t at = 0;
    for (int i = 0; i < postures; ++i) {
      for (double position : all.q.row(i)) table.Add(position);
      for (const auto& instrument : model_.setup.instruments) {
        const bool tracked = instrument->measured_size() == 7 || instrument->name == "rhand";
        const bool shown = !(tracked && i % 3 == 2) && !(instrument->name == "wire" && i % 4 == 3);
        Eigen::VectorXd measured = instrument->Predict(sights[at++]);
        const double noise = instrument->name == "imu" ? 0.02 : 5e-4;
        measured += random_.NormalVector(measured.size(), noise);
        if (measured.size() == 7) measured.tail<4>().normalize();
        for (double number : measured) {
          table.Add(shown ? number : std::numeric_limits<double>::quiet_NaN());
        }
      }
      table.EndRow();
    }
    return table.text();
  }

  const ObservedRobot& model() const { return model_; }
  const ObservedValues& truth() const { return truth_; }

 private:
  /// The feet stand flat where the project has them.
  static ObservationSetup SetupOf(const Project& project) {
    ObservationSetup setup = project.contact->setup;
    const std::vector<Transform> upright =
        LinkTransforms(project.tree, Eigen::VectorXd::Zero(project.tree.coordinate_count()));
    for (ContactFoot& foot : setup.feet) {
      foot.T_floor_foot.linear() = upright[static_cast<std::size_t>(foot.link)].linear();
    }
    return setup;
  }

  const Project& project_;
  Random random_;
  ObservedRobot model_;
  ObservedValues truth_;
};

TEST(InstrumentRun, AllKindsCalibrateTheExampleFromATable) {
  const Project project = ReadProject(SourceFile("examples/talos_instruments/project.yaml"));
  VirtualTalos robot(project, 3);
  ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "postures.csv";
  std::ofstream(file) << robot.Table(48);
  ContactRun run = CalibrateContacts(project, {file}, {.folds = 6});
  EXPECT_TRUE(run.deployable()) << (run.verdict.objections.empty()
                                        ? std::string()
                                        : run.verdict.objections.front());
  const auto rms = [&](const ContactOutcome& outcome, const std::string& name) {
    for (const RowErrors& of : ContactRun::Judged(outcome).rows) {
      if (run.model.instrument(of.instrument).name == name) return of.rms;
    }
    return 0.0;
  };
  // Errors on held-out postures, for noise of 0.5 mm.
  EXPECT_LT(rms(run.calibrated, "lhand"), 0.25 * rms(run.uncalibrated, "lhand"));
  EXPECT_LT(rms(run.calibrated, "rhand"), 0.25 * rms(run.uncalibrated, "rhand"));
  EXPECT_LT(rms(run.calibrated, "wire"), 0.5 * rms(run.uncalibrated, "wire"));
  const auto summary = nlohmann::json::parse(MakeContactSummary(run));
  EXPECT_EQ(summary["contact"]["observations"], 32 + 32 + 48 + 48 + 36);
  const auto quantities = summary["contact"]["quantities"];
  const auto imu = std::find_if(quantities.begin(), quantities.end(),
                                [](const auto& of) { return of["name"] == "imu.mounting"; });
  ASSERT_NE(imu, quantities.end());
  EXPECT_LT((*imu)["sds"][0].get<double>(), 0.02);
  EXPECT_GT((*imu)["sds"][0].get<double>(), 1e-4);
  EXPECT_EQ(summary["contact"]["kfold"]["instruments"].size(), 5u);
  // The files must be readable again.
  EXPECT_EQ(MakeContactFiles(project, run).count("calibration.yaml"), 1u);
}

// Thirty joints make 435 pairs.
TEST(InstrumentRun, AMistakeInTheTableOfAHumanoidIsNamed) {
  const Project project = ReadProject(SourceFile("examples/talos_instruments/project.yaml"));
  VirtualTalos robot(project, 3);
  std::istringstream lines(robot.Table(24));
  ScratchFolder folder;
  const std::filesystem::path file = folder.path() / "postures.csv";
  std::ofstream table(file);
  std::string line;
  std::getline(lines, line);
  table << line << "\n";
  const std::string joint = "arm_left_4_joint";
  const auto before =
      std::count(line.begin(), line.begin() + static_cast<std::ptrdiff_t>(line.find(joint)), ',');
  while (std::getline(lines, line)) {
    std::size_t at = 0;
    for (int k = 0; k < before; ++k) at = line.find(',', at) + 1;
    const bool negative = line[at] == '-';
    table << line.replace(at, negative ? 1 : 0, negative ? "" : "-") << "\n";
  }
  table.close();
  const ContactRun run = CalibrateContacts(project, {file}, {.folds = 0});
  ASSERT_FALSE(run.deployable());
  EXPECT_EQ(run.verdict.objections.front().find(joint + ": the sign of its positions is reversed"),
            0u)
      << run.verdict.objections.front();
}

}  // namespace
}  // namespace elastocal
