// SPDX-License-Identifier: Apache-2.0
#pragma once

// What a user does before a recording is made, as functions: choose calibration postures, judge
// those of others, plan the motion through them, and simulate the whole experiment.
//
//   const Project project = ReadProject("project.yaml");
//   const PostureDesign design = DesignPostures(project, {});
//   const MotionPlan plan = PlanMotion(project, design.postures(), {});
//   SimulateExperiment(project, {.motion = plan.whole.motion}, "recording");

#include "elastocal/planning/assess_postures.hpp"
#include "elastocal/planning/design_follow_up.hpp"
#include "elastocal/planning/design_postures.hpp"
#include "elastocal/planning/known_truth.hpp"
#include "elastocal/planning/plan_motion.hpp"
#include "elastocal/planning/simulate_experiment.hpp"
#include "elastocal/planning/simulation_settings.hpp"
#include "elastocal/project/project.hpp"
