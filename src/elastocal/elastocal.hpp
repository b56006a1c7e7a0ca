// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Everything that calibrating a robot from recordings takes: `find_package(elastocal COMPONENTS
/// calibration)`, target elastocal::elastocal. Begin with CalibrateExperiment.

#include "elastocal/files/output_files.hpp"
#include "elastocal/files/output_set.hpp"
#include "elastocal/io/posture_table.hpp"
#include "elastocal/math/input_error.hpp"
#include "elastocal/pipeline/calibrate_experiment.hpp"
#include "elastocal/pipeline/calibration_files.hpp"
#include "elastocal/pipeline/check_calibration.hpp"
#include "elastocal/pipeline/compare_calibrations.hpp"
#include "elastocal/pipeline/inspect_robot.hpp"
#include "elastocal/pipeline/result_folder.hpp"
#include "elastocal/pipeline/summary.hpp"
#include "elastocal/pipeline/validate_calibration.hpp"
#include "elastocal/project/project.hpp"
