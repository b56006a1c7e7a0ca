// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/missed_springs.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/recorded/choose_elasticity.hpp"
#include "elastocal/recorded/recorded_model.hpp"

namespace elastocal {
namespace {

constexpr double kLeftBySprings = 0.5;  // share of the error of the fit

bool HoldsSomethingRigid(const ElasticityChoice& choice) {
  if (!choice.base) return true;
  return choice.torsion &&
         std::find(choice.torsion->begin(), choice.torsion->end(), "*") == choice.torsion->end();
}

bool HasSprings(const ElasticityChoice& choice) {
  return choice.base || !choice.torsion || !choice.torsion->empty();
}

}  // namespace

std::string FindMissedSprings(const Project& project, std::optional<std::uint64_t> seed,
                              const Measurements& as_recorded, double left, double left_otherwise) {
  // With a prior, the earlier calibration has decided on springs.
  if (as_recorded.calibration.trials.empty() || !HoldsSomethingRigid(project.elasticity) ||
      !HasMasses(project.tree) || !project.calibration.earlier.empty()) {
    return "";
  }
  Project elastic = project;
  elastic.elasticity.torsion = elastic.elasticity.bending = std::nullopt;
  elastic.elasticity.base = true;
  Measurements measured = as_recorded;
  try {
    const RecordedModel robot = MakeRecordedModel(elastic, seed, measured, KnockSearch::kNone);
    const CalibrationResult fit = Calibrate(robot.model, measured.calibration, robot.base,
                                            ModelKinds(robot.model).back(), elastic.calibration);
    const double by_springs = FitError(fit, measured.calibration, elastic.calibration);
    if (!(by_springs < kLeftBySprings * left && by_springs < left_otherwise)) return "";
    return fmt::format(
        "the robot gives way under its weight, and the project holds {} rigid: with elastic joints "
        "and legs the error of the fit falls from {:.3g} to {:.3g} mm. Take `elasticity` out of "
        "the project",
        HasSprings(project.elasticity) ? "a part of it" : "it", 1e3 * left, 1e3 * by_springs);
  } catch (const InputError&) {
    return "";
  }
}

}  // namespace elastocal
