// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "elastocal/calibration/calibrate.hpp"
#include "elastocal/project/project.hpp"
#include "elastocal/recorded/measurements.hpp"
#include "elastocal/recorded/recorded_model.hpp"
#include "elastocal/screening/log_check.hpp"

namespace elastocal {

/// A mistake in a recording that was tried: undone, the recording fits far better.
struct RecordingMistake {
  std::string name;     ///< short, for AcceptMistakes: "sign:arm_left_7_joint"; empty: none
  std::string what;     ///< in words
  double before = 0.0;  ///< rms distance of all markers from the fit, m; infinite: no robot fits
  double after = 0.0;   ///< the same once it is undone
  Recording corrected;  ///< without it and those before it
};

/// rms distance of all markers from where a calibrated robot has them, m.
double MarkerError(const CalibrationResult& result, const Recording& recording,
                   const CalibrationOptions& options);

/// The same, but infinite where that is no robot: axes turned by half a turn explain a reversed
/// sign perfectly.
double FitError(const CalibrationResult& result, const Recording& recording,
                const CalibrationOptions& options);

/// Mistakes of a recording that a fit proves. Suspicions come from the nominal robot
/// (FindLogSuspicions, FindLabelSuspicions, LooksMirrored; of a table FindTableSuspicions,
/// FindRowShift), and from axes that `result` has turned by more than a right angle: the sign of
/// their joints and of those before, until a robot explains what is left; of all joints, where
/// markers would have an implausible noise. Each is undone, the robot is calibrated again, and it
/// is a mistake if the error falls to less than half (that of `result` on the recording `fitted`)
/// and, in the end, to less than 20 mm. Then the next is sought in the corrected recording, at most
/// three in all. Without suspicions, which no clean recording has, nothing is fitted. `measured` as
/// recorded.
std::vector<RecordingMistake> FindRecordingMistakes(const Project& project,
                                                    std::optional<std::uint64_t> seed,
                                                    const Measurements& measured,
                                                    const Recording& fitted,
                                                    const CalibrationResult& result);

/// What else to suspect in a recording with this error, m.
using FurtherSuspicions = std::function<std::vector<LogSuspicion>(const Recording&, double error)>;

/// The same by any figure of how well a recording is explained, m: `error_of`, infinite where it is
/// not explained at all. `error`: of the recording itself; `more`: further suspicions of it and of
/// what is left of it once a mistake is undone; `left_of_error`: what each mistake may at most
/// leave of the error.
std::vector<RecordingMistake> FindMistakesBy(
    const Project& project, const Recording& recording, double error,
    const std::function<double(const Recording&)>& error_of, const FurtherSuspicions& more = {},
    double left_of_error = 0.5);

/// The same by how well a stored calibration explains a recording, m. `error_of` gets the model of
/// the recording as well; where it throws InputError, nothing is explained. None where
/// more than 20 mm are left in the end.
std::vector<RecordingMistake> FindMistakesBy(
    const Project& project, std::optional<std::uint64_t> seed, const Measurements& as_recorded,
    double error, const std::function<double(const RecordedModel&, const Recording&)>& error_of);

/// Undoes the mistakes of these names wherever the trials for calibration and for validation seem
/// to have them, and says what was undone, in words: `sign:JOINT`, `exchange:JOINT,JOINT`,
/// `frozen:JOINT` (its postures are left out), `labels:NAME,NAME` of two clusters or markers,
/// `rows:+1` of a table whose markers belong to the joints of the next row.
/// Names with a size (ParseStatedCorrection: `gain:JOINT=1.05` ...) are done as they say.
/// Throws InputError for a name of which the recording shows nothing, with those that it does show.
std::vector<std::string> AcceptMistakes(const Project& project,
                                        const std::vector<std::string>& accepted,
                                        Measurements& measured);

/// What AcceptMistakes undid, as a warning: "corrected on request: ...".
std::string DescribeUndone(const std::string& what);

/// "the sign of ... is reversed ...; without that the error of the fit falls from 14.2 to 0.31 mm
/// (--accept NAME corrects it)"
std::string DescribeMistake(const RecordingMistake& mistake);

}  // namespace elastocal
