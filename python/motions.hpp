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

/// A trajectory that a user gives: a Plan, a file (CSV), or a dict with `time_s` (samples,),
/// `positions` (samples, joints) and perhaps `support`. It is read as from a file, so that it has
/// its bits.
JointMotion MotionOf(const py::object& given, const Project& project);

}  // namespace elastocal::python
