// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/observed_scale.hpp"

#include <algorithm>
#include <string_view>

#include "elastocal/pipeline/contact_result.hpp"

namespace elastocal {
namespace {

bool MeasuresLengths(const Instrument& instrument) {
  const std::string_view kind = instrument.kind();
  return kind == "pose" || kind == "position" || kind == "wire";
}

}  // namespace

std::optional<CommonScale> FindObservedScale(const ObservedRobot& model,
                                             const Observations& observations,
                                             const ObservationFit& fit) {
  const bool told = std::any_of(
      observations.all.begin(), observations.all.end(),
      [&](const Observation& of) { return MeasuresLengths(model.instrument(of.instrument)); });
  // Where an earlier calibration tells the lengths, a scale is sought like other faults.
  if (!told || !model.earlier.empty()) return std::nullopt;
  CalibrationResult result = InformationOfContacts(model, observations, fit);
  const std::vector<Source> common = CommonSources();
  result.prior_scale[PriorGroup::kLengths] = fit.spread[kLength] / common[kLength].sd;
  return FindWrongScale(result, {});
}

}  // namespace elastocal
