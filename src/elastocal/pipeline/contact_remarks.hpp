// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/pipeline/contact_run.hpp"

namespace elastocal {

/// Remarks on statements about instruments in project and tables that the observations contradict.
/// They do not keep a calibration from being deployed.

/// Names instruments whose noise is far above what the project says (four times).
void RemarkOnNoise(ContactRun& run);

/// Names mountings, and parameters of cameras, that are far from the project's. They are estimated
/// all the same, but the project may name the wrong tag, link or camera.
void RemarkOnMountings(ContactRun& run);

/// Names covariances of poses whose shape the residuals contradict: other units, or rotations
/// first.
void RemarkOnCovariances(ContactRun& run);

}  // namespace elastocal
