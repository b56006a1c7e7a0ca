// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/description/urdf_writer.hpp"

namespace elastocal {

/// Where the zero offsets of the joints go (theta of a revolute, r of a prismatic joint).
enum class ZeroOffsets {
  kOrigin,  ///< into the origins of the URDF: the joint positions of the controller stay as they
            ///< are
  /// Apart: position in this URDF = position of the controller + offset. A mimic joint has no
  /// encoder: where its zero offset is not multiplier times that of the joint that it follows, the
  /// difference is in its origin.
  kEncoder,
};

/// A user's URDF with the calibration in it.
struct CalibratedUrdf {
  std::string text;
  std::map<std::string, UrdfOrigin> nominal, calibrated;  ///< joints with changed origins only
  /// rad or m, of all joints in the error model but mimic joints, 0 where nothing was estimated;
  /// empty for ZeroOffsets::kOrigin.
  std::map<std::string, double> encoder_offsets;
  /// Spherical wrists and parallel axes that are exact no more, and corrections that move branches
  /// of which nothing was measured; in words.
  std::vector<std::string> warnings;
};

/// Writes the errors of `calibration` into `urdf`, the text that its robot tree was read from.
///
/// Only origins of joints with errors change (and of mimic joints whose leader's encoder has an
/// offset). An MDH joint turns about the axis that the URDF's turns about, so the result is exact:
/// before it is returned, it is read back and the poses of all links, with the encoder offsets
/// added to the positions, are compared with the calibrated model's at 1000 random postures; joints
/// that carry no marker move as in the nominal robot there. Throws std::runtime_error when they
/// differ by more than 1e-9 m or rad.
CalibratedUrdf MakeCalibratedUrdf(const std::string& urdf, const std::string& source,
                                  const CalibrationResult& calibration, ZeroOffsets zero_offsets);

/// The same changes as PAL's xacro properties: `<joint>_{x,y,z,roll,pitch,yaw}_offset`, to be added
/// component by component to the nominal origin, and `<joint>_offset` for all encoder offsets. What
/// a name in Python cannot have is '_' in them.
std::string MakeXacroOffsets(const CalibratedUrdf& calibrated);

}  // namespace elastocal
