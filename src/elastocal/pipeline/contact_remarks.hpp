// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "elastocal/pipeline/contact_run.hpp"

namespace elastocal {

/// Remarks on what is stated of instruments in project and tables, where the observations say
/// otherwise. They do not keep a calibration from being deployed.

/// Noise that is far above what the project says of an instrument is no noise of it.
void RemarkOnNoise(ContactRun& run);

/// Mountings, and numbers of cameras, that are far from where the project has them: what is typed
/// wrong there is estimated all the same, but it may be the wrong tag, link or camera.
void RemarkOnMountings(ContactRun& run);

/// A covariance of poses in other units, or with rotations first, is not of what is left of them.
void RemarkOnCovariances(ContactRun& run);

}  // namespace elastocal
