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
  /// Into a list of offsets: position in this URDF = position of the controller + offset. A mimic
  /// joint has no encoder: if its zero offset differs from multiplier times that of the joint that
  /// it follows, the difference is in its origin.
  kEncoder,
};

/// A user's URDF with the calibration in it.
struct CalibratedUrdf {
  std::string text;
  std::map<std::string, UrdfOrigin> nominal, calibrated;  ///< joints with changed origins only
  /// Offsets of the encoders, rad or m, for all joints in the error model except mimic joints; 0 if
  /// nothing was estimated. Empty for ZeroOffsets::kOrigin.
  std::map<std::string, double> encoder_offsets;
  /// Sentences about spherical wrists and parallel axes that are no longer exact, and about
  /// corrections that move branches of which nothing was measured.
  std::vector<std::string> warnings;
};

/// Writes the errors of `calibration` into `urdf`, the text that its robot tree was read from.
///
/// Only origins of joints with errors change (and of mimic joints whose leader's encoder has an
/// offset). An MDH joint turns about the same axis as the URDF's joint, so that the result is
/// exact. Before it is returned, it is read back: at 1000 random postures, with the encoder offsets
/// added to the positions, the poses of all links are compared with those of the calibrated model,
/// in which joints that carry no marker move as in the nominal robot. Throws std::runtime_error if
/// they differ by more than 1e-9 m or rad.
CalibratedUrdf MakeCalibratedUrdf(const std::string& urdf, const std::string& source,
                                  const CalibrationResult& calibration, ZeroOffsets zero_offsets);

/// The same changes as PAL's xacro properties: `<joint>_{x,y,z,roll,pitch,yaw}_offset`, to be added
/// component by component to the nominal origin, and `<joint>_offset` for all encoder offsets.
/// Characters that a name in Python cannot have are replaced by '_'.
std::string MakeXacroOffsets(const CalibratedUrdf& calibrated);

}  // namespace elastocal
