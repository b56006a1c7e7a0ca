// Virtual robots with one cause of error that neither geometry nor springs describe: it is named.

#include <cmath>
#include <cstdlib>
#include <map>

#include <gtest/gtest.h>

#include "elastocal/calibration/outliers.hpp"
#include "elastocal/io/project.hpp"
#include "elastocal/math/random.hpp"
#include "elastocal/pipeline/choose_causes.hpp"
#include "elastocal/simulation/synthetic_recording.hpp"
#include "tests/test_files.hpp"

namespace elastocal {
namespace {

using Kind = ParameterKind;

constexpr double kMarkerNoise = 0.1e-3;  // m: of a posture, which is the mean of many frames

constexpr const char* kProject = R"(
robot: {urdf: models/talos/talos.urdf}
chains: [{name: arm, tip: gripper_left_base_link}]
markers:
  single:
    - {name: A, link: arm_left_7_link, position_mm: [60, 10, -70]}
    - {name: B, link: arm_left_7_link, position_mm: [-50, 40, -60]}
    - {name: C, link: arm_left_7_link, position_mm: [10, -60, -90]}
)";

struct Injected {
  const char* cause;
  const char* parameter;
  double size;
};

// On a joint that turns far, with a long lever, under loads of both signs.
constexpr Injected kInjected[] = {
    {"arm_left_3_joint.eccentricity", "arm_left_3_joint.eccentricity_sin", 1e-3},
    {"arm_left_3_joint.backlash", "arm_left_3_joint.backlash", 1e-3},
    {"arm_left_3_joint.hysteresis", "arm_left_3_joint.hysteresis", 1e-3},
    {"arm_left_3_joint.gear", "arm_left_3_joint.gear", 1e-3},
    {"waist.suspension", "waist.suspension_rx", 1e-5},
    {"waist.drift", "waist.drift_x", 0.5e-3},
};

Project ArmProject() { return ParseProject(kProject, SourceFile("project.yaml")); }

/// Sixty postures in two hours of a robot with errors of geometry, springs, masses and `injected`
/// (null: nothing else), and where they are to be found.
Measurements Record(const Project& project, const Injected* injected, std::uint64_t seed) {
  Random random(seed);
  Project real = project;
  for (Link& link : real.tree.links) link.mass *= 1.0 + random.Normal(0.05);
  real.elasticity.torsion = {"torso*", "arm_left*"};
  real.elasticity.hours = 1.0;
  if (injected != nullptr) real.elasticity.extra = {injected->cause};
  ErrorModel model = MakeProjectModel(real, {});
  model.T_ref_waist.translation() = Eigen::Vector3d(1.0, 0.5, 0.8);
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(model.parameter_count());
  for (int i = 0; i < model.parameter_count(); ++i) {
    const Kind kind = model.parameters[static_cast<std::size_t>(i)].kind;
    if (IsAngle(kind)) delta[i] = random.Normal(0.005);
    if (kind == Kind::kR || kind == Kind::kD || kind == Kind::kB) delta[i] = random.Normal(1e-3);
    if (kind == Kind::kMarker) delta[i] = random.Normal(5e-3);
    if (kind == Kind::kTorsion) delta[i] = random.Uniform(2e-5, 1e-4);
  }
  if (injected != nullptr) {
    delta[FindParameter(model.parameters, injected->parameter)] = injected->size;
  }
  Recording recording =
      MakeSyntheticRecording(model, delta, {.postures = 60, .marker_sd = 0.0, .seed = seed});
  recording.time_s = Eigen::VectorXd::LinSpaced(60, 0.0, 7200.0);
  NoteApproach(recording);
  recording.markers = PredictedPositions(model, recording, delta, {});
  for (double& x : recording.markers.reshaped()) x += random.Normal(kMarkerNoise);
  Measurements measured;
  measured.calibration = std::move(recording);
  return measured;
}

Project Elastic(Project project) {
  project.elasticity.torsion = {"torso*", "arm_left*"};
  project.elasticity.bending.emplace();
  return project;
}

/// Of how many seeds; `ELASTOCAL_CAUSE_SEEDS` gives the study of docs/accuracy.md.
int Seeds() {
  const char* seeds = std::getenv("ELASTOCAL_CAUSE_SEEDS");
  return seeds == nullptr ? 2 : std::atoi(seeds);
}

TEST(Causes, TheInjectedOneIsNamedFirst) {
  const Project project = Elastic(ArmProject());
  for (const Injected& injected : kInjected) {
    int first = 0;
    double without = 0.0, with = 0.0;
    for (int seed = 1; seed <= Seeds(); ++seed) {
      const auto s = static_cast<std::uint64_t>(seed);
      const CauseReport report = StudyCauses(project, Record(project, &injected, s), s);
      const CauseSearch& search = report.search;
      const std::string named = search.chosen.empty() ? "nothing" : search.chosen.front().cause;
      if (search.accepted && named == injected.cause) {
        ++first;
      } else {
        std::printf("  seed %d: %s%s (best %s, p %.2g)\n", seed, named.c_str(),
                    search.accepted ? "" : " not accepted", search.findings.front().cause.c_str(),
                    search.findings.front().p_adjusted);
      }
      without += search.error / Seeds();
      with += (search.chosen.empty() ? search.error : search.nested_error) / Seeds();
    }
    std::printf("%s: first in %d of %d; held-out error %.3f to %.3f mm\n", injected.cause, first,
                Seeds(), 1e3 * without, 1e3 * with);
    EXPECT_GE(first, static_cast<int>(std::ceil(0.9 * Seeds()) - 0.5 * Seeds()));
  }
}

TEST(Causes, NothingIsNamedWhereNothingIs) {
  const Project project = Elastic(ArmProject());
  int named = 0;
  double error = 0.0;
  for (int seed = 1; seed <= Seeds(); ++seed) {
    const auto s = static_cast<std::uint64_t>(seed);
    const CauseReport report = StudyCauses(project, Record(project, nullptr, 100 + s), s);
    error += report.search.error / Seeds();
    if (!report.search.accepted) continue;
    ++named;
    std::printf("  seed %d: %s\n", seed, report.search.chosen.front().cause.c_str());
  }
  std::printf("nothing injected: named in %d of %d; held-out error %.3f mm\n", named, Seeds(),
              1e3 * error);
  EXPECT_LE(named, 1 + Seeds() / 20);
}

}  // namespace
}  // namespace elastocal
