// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/known_soles.hpp"

#include "elastocal/io/calibration_file.hpp"
#include "elastocal/pipeline/calibration_files.hpp"

namespace elastocal {

std::vector<SoleSpring> KnownSoles(const CalibrationResult& result, const Measurements& measured,
                                   const std::filesystem::path& earlier) {
  std::vector<SoleSpring> soles =
      EstimateSoleSprings(result, measured.foot_rests, measured.calibration.gravity);
  if (earlier.empty()) return soles;
  const StoredCalibration stored = ReadCalibration(FindCalibrationFiles(earlier).calibration);
  for (SoleSpring& sole : soles) {
    for (const SoleSpring& known : stored.soles) {
      if (known.leg == sole.leg && known.told() && !sole.told()) sole = known;
    }
  }
  return soles;
}

}  // namespace elastocal
