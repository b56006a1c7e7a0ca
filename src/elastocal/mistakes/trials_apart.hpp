// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/recorded/recorded_model.hpp"

namespace elastocal {

/// A part of a recording: a trial, or what is from one of the folders given.
struct PartOfRecording {
  std::string name;
  std::vector<int> postures;
};

/// Root mean square over the markers of all parts, of those of each part (`errors`), m.
double ErrorOverParts(const Recording& recording, const std::vector<PartOfRecording>& parts,
                      const std::vector<double>& errors);

/// rms distance of the markers of a recording, of which this is a part, from a robot of its own, m,
/// as large as it would be if the fit had no freedom; infinite where it has too few equations.
double ErrorAlone(const RecordedModel& robot, const Recording& part, ModelKind kind,
                  const CalibrationOptions& options);

/// Parts of a recording that no one robot explains, in words, and the error that robots of their
/// own leave, m.
struct PartsApart {
  std::string said;
  double error = 0.0;
};

/// Whether parts contradict each other: robots of their own leave less than half of the error that
/// one robot leaves, and 0.2 mm less. Both m.
bool AreApart(double error_apart, double error_together);

/// Trials that no one robot explains, in words; empty where one does. They contradict each other if
/// robots of their own leave far less (AreApart). What a trial exercises and no model
/// explains seldom fits alone; an error that is the same throughout a trial does. Sets of
/// trials that one robot explains (what is left is nearer to the error of all apart than to that of
/// all together, by their ratio, and no more than three times that of all apart) are put together:
/// all at once or, where that fails, halves of them. Trials that have too few equations are not
/// judged; nothing is where more than 50 are. `recording`: that of `together`; `most`: what another
/// explanation of the recording leaves, m.
std::optional<PartsApart> FindTrialsApart(const RecordedModel& robot, const Recording& recording,
                                          const CalibrationResult& together, double most,
                                          const CalibrationOptions& options);

}  // namespace elastocal
