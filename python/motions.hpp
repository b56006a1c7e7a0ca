// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bindings.hpp"
#include "elastocal/planning/plan_motion.hpp"

namespace elastocal::python {

/// A motion that was planned in this process.
struct PyPlan {
  Project project;
  MotionPlan plan;
  std::vector<MotionTrial> trials;
};

/// A trajectory from a user: a Plan, a file (CSV), or a dict with `time_s` (samples,), `positions`
/// (samples, joints) and optionally `support`. It is converted through the text of a file, so that
/// it has the same bits.
JointMotion MotionOf(const py::object& given, const Project& project);

}  // namespace elastocal::python
