// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/known_places.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "elastocal/io/marker_places_file.hpp"
#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

/// Standard deviations that are too small by less than this factor are not enlarged.
constexpr double kTooSmall = 1.5;

bool IsKnocked(const std::string& marker, const Recording& recording,
               const std::vector<Knock>& knocks) {
  return std::ranges::any_of(knocks, [&](const Knock& knock) {
    return std::ranges::any_of(knock.markers, [&](int m) {
      return m < recording.marker_count() &&
             recording.marker_names[static_cast<std::size_t>(m)] == marker;
    });
  });
}

}  // namespace

std::vector<MarkerMeasurement> OpenMarkerPlaces(const std::filesystem::path& file,
                                                const Project& project, const Recording& recording,
                                                const std::vector<Knock>& knocks,
                                                std::vector<std::string>& warnings) {
  if (file.empty()) return {};
  std::vector<MarkerMeasurement> places = ReadMarkerPlaces(file, project);
  std::erase_if(places, [&](const MarkerMeasurement& place) {
    return std::ranges::count(recording.marker_names, place.marker) == 0;
  });
  if (places.empty()) {
    throw InputError(file.string() + ": the recording has none of these markers");
  }
  std::erase_if(places, [&](const MarkerMeasurement& place) {
    if (!IsKnocked(place.marker, recording, knocks)) return false;
    warnings.push_back(fmt::format(
        "{}: the place of marker {} is not used, because it was displaced during the experiment",
        file.string(), place.marker));
    return true;
  });
  return places;
}

CalibrationResult CalibrateWithPlaces(std::vector<MarkerMeasurement> places,
                                      const RecordedModel& robot, const Recording& recording,
                                      CalibrationOptions& options,
                                      std::vector<std::string>& warnings) {
  const EarlierEstimate before = options.earlier;
  double factor = 1.0;
  for (;;) {
    options.earlier = before;
    KnowMarkers(places, robot.model, options.earlier);
    CalibrationResult result =
        Calibrate(robot.model, recording, robot.base, ModelKinds(robot.model).back(), options);
    const PlaceAgreement agreement = JudgeMarkers(places, result, options.outlier_probability);
    if (!agreement.contradictory.empty()) {
      const ContradictoryPlace& worst = agreement.contradictory.front();
      warnings.push_back(fmt::format(
          "the measured place of marker {} is {:.1f} mm from where the recording and the other "
          "places have it: it is left out; was it measured from another link, or are two markers "
          "exchanged?",
          worst.marker, 1e3 * worst.distance));
      std::erase_if(places,
                    [&](const MarkerMeasurement& place) { return place.marker == worst.marker; });
      continue;
    }
    if (factor > 1.0 || agreement.factor < kTooSmall) return result;
    factor = agreement.factor;
    for (MarkerMeasurement& place : places) place.sd *= factor;
    warnings.push_back(fmt::format(
        "the measured places of markers contradict each other by more than their standard "
        "deviations say, which are taken {:.1f} times as large",
        factor));
  }
}

}  // namespace elastocal
