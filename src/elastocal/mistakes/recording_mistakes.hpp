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

/// A mistake that was found in a recording: with it corrected, the recording fits far better.
struct RecordingMistake {
  std::string name;     ///< name for AcceptMistakes: "sign:arm_left_7_joint"; empty: none
  std::string what;     ///< the mistake as text
  double before = 0.0;  ///< rms distance of all markers from the fit, m; infinite: no robot fits
  double after = 0.0;   ///< the same with the mistake corrected
  Recording corrected;  ///< with this mistake and those before it corrected
};

/// Root mean square distance of all markers from their predictions by a calibrated robot, m.
double MarkerError(const CalibrationResult& result, const Recording& recording,
                   const CalibrationOptions& options);

/// As MarkerError, but infinite where the estimate is impossible for a robot: axes turned by half a
/// turn explain a reversed sign perfectly.
double FitError(const CalibrationResult& result, const Recording& recording,
                const CalibrationOptions& options);

/// Finds mistakes of a recording that a fit proves. Suspicions come from the nominal robot
/// (FindLogSuspicions, FindLabelSuspicions, LooksMirrored; for a table FindTableSuspicions and
/// FindRowShift). Further suspicions come from axes that `result` has turned by more than a right
/// angle: the sign of their joints and of those before. Where markers would have an implausible
/// noise, the signs of all joints are suspected.
///
/// Each suspicion is corrected and the robot calibrated again. It is a mistake if the error falls
/// to less than half (of the error of `result` on the recording `fitted`) and, in the end, below
/// MostLeft (20 mm, less for small robots). The next one is then sought in the corrected recording,
/// at most three in all. Without suspicions, which no clean recording has, nothing is fitted.
/// `measured` is the recording as recorded.
std::vector<RecordingMistake> FindRecordingMistakes(const Project& project,
                                                    std::optional<std::uint64_t> seed,
                                                    const Measurements& measured,
                                                    const Recording& fitted,
                                                    const CalibrationResult& result);

/// Returns further suspicions in a recording with this error, m.
using FurtherSuspicions = std::function<std::vector<LogSuspicion>(const Recording&, double error)>;

/// As FindRecordingMistakes, by any measure of how well a recording is explained, m: `error_of`,
/// infinite where it is not explained. `error` is that of the recording itself. `more` gives
/// further suspicions, also in corrected recordings. `left_of_error` is the largest share of the
/// error that a mistake may leave.
std::vector<RecordingMistake> FindMistakesBy(
    const Project& project, const Recording& recording, double error,
    const std::function<double(const Recording&)>& error_of, const FurtherSuspicions& more = {},
    double left_of_error = 0.5);

/// As FindRecordingMistakes, by how well a stored calibration explains a recording, m. `error_of`
/// also receives the model of the recording; where it throws InputError, nothing is explained.
/// Empty where more than MostLeft (20 mm, less for small robots) is left in the end.
std::vector<RecordingMistake> FindMistakesBy(
    const Project& project, std::optional<std::uint64_t> seed, const Measurements& as_recorded,
    double error, const std::function<double(const RecordedModel&, const Recording&)>& error_of);

/// Corrects the named mistakes wherever the trials for calibration and for validation seem to have
/// them, and returns descriptions: `sign:JOINT`, `exchange:JOINT,JOINT`, `frozen:JOINT` (its
/// postures are left out), `labels:NAME,NAME` of two clusters or markers, `rows:+1` of a table
/// whose markers belong to the joints of the next row. Names with a size (ParseStatedCorrection:
/// `gain:JOINT=1.05` ...) are applied after the others, as they say: the objections that state them
/// are of a recording without those mistakes. Throws InputError for a name of which the
/// recording shows nothing; the message lists those that it shows.
std::vector<std::string> AcceptMistakes(const Project& project,
                                        const std::vector<std::string>& accepted,
                                        Measurements& measured);

/// A warning about a correction that AcceptMistakes made: "corrected on request: ...".
std::string DescribeUndone(const std::string& what);

/// Text such as "the sign of ... is reversed ...; without that the error of the fit falls from 14.2
/// to 0.31 mm (--accept NAME corrects it)".
std::string DescribeMistake(const RecordingMistake& mistake);

}  // namespace elastocal
