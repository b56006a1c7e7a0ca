// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/observed_scale.hpp"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "elastocal/observation/contact_result.hpp"
#include "elastocal/observation/observation_fault.hpp"
#include "elastocal/observation/seen_tag.hpp"

namespace elastocal {
namespace {

/// Whether any length was measured. A tip that touches a plane measures the length 0, which no
/// scale changes.
bool LengthsWereMeasured(const ObservedRobot& model, const Observations& observations) {
  constexpr double kNoLength = 1e-3;  // m
  return std::any_of(observations.all.begin(), observations.all.end(), [&](const Observation& of) {
    const int lengths = LengthsMeasured(model.instrument(of.instrument));
    return lengths > 0 && of.measured.head(lengths).cwiseAbs().maxCoeff() > kNoLength;
  });
}

bool TagsWereSeen(const ObservedRobot& model, const Observations& observations) {
  return std::any_of(observations.all.begin(), observations.all.end(), [&](const Observation& of) {
    return TagSeenBy(model.instrument(of.instrument)) >= 0;
  });
}

/// Sizes as text, "100 or 82", and the same divided by a factor, "97.66 or 80.08", mm.
struct Sizes {
  std::string written, right;
};

Sizes SizesOfTags(const ObservedRobot& model, const Observations& observations, int tag,
                  double factor) {
  std::set<double> sizes;  // mm
  for (const Observation& of : observations.all) {
    const auto* seen = dynamic_cast<const SeenTag*>(&model.instrument(of.instrument));
    if (seen == nullptr || (tag >= 0 && TagSeenBy(*seen) != tag)) continue;
    sizes.insert(1e3 * (seen->p_tag_corner.col(1) - seen->p_tag_corner.col(0)).norm());
  }
  Sizes text;
  for (const double size : sizes) {
    const char* const next = text.written.empty() ? "" : " or ";
    text.written += fmt::format("{}{:g}", next, size);
    text.right += fmt::format("{}{:.4g}", next, size / factor);
  }
  return text;
}

}  // namespace

std::optional<CommonScale> FindObservedScale(const ObservedRobot& model,
                                             const Observations& observations,
                                             const ObservationFit& fit) {
  const bool told = LengthsWereMeasured(model, observations) || TagsWereSeen(model, observations);
  // With an earlier calibration, which tells the lengths, a scale is found like other faults.
  if (!told || !model.earlier.empty()) return std::nullopt;
  CalibrationResult result = InformationOfContacts(model, observations, fit);
  const std::vector<Source> common = CommonSources();
  result.prior_scale[PriorGroup::kLengths] = fit.spread[kLength] / common[kLength].sd;
  return FindWrongScale(result, {});
}

std::string DescribeScale(const CommonScale& scale, const ObservedRobot& model,
                          const Observations& observations) {
  constexpr double kLargestAccepted = 2.0;  // a larger factor is another unit
  const double factor = 1.0 + scale.size;
  const bool accepted = factor < kLargestAccepted && factor > 1.0 / kLargestAccepted;
  const bool lengths = LengthsWereMeasured(model, observations);
  std::string text = fmt::format(
      "{} {:.4f} +- {:.4f} times the true {}, since all lengths of the robot are off by as "
      "much{}: ",
      lengths ? "lengths as they were measured seem" : "size_mm of the tags seems", factor,
      scale.sd, lengths ? "ones" : "one", lengths ? "" : " and cameras know no other length");
  if (!lengths) {
    text += WriteSizeOfTags(model, observations, -1, factor) +
            ", or describe the robot with its own size";
  } else if (TagsWereSeen(model, observations)) {
    text += fmt::format(
        "check the scale of trackers and gauges and the size of the tags ({}), or describe "
        "the robot with its own size",
        WriteSizeOfTags(model, observations, -1, factor));
  } else if (accepted) {
    text += fmt::format(
        "check the scale of trackers and gauges, or describe the robot with its own size "
        "(--accept scale={:.5f} corrects it)",
        factor);
  } else {
    text += "metres were expected";
  }
  return text;
}

std::string WriteSizeOfTags(const ObservedRobot& model, const Observations& observations, int tag,
                            double factor) {
  const Sizes sizes = SizesOfTags(model, observations, tag, factor);
  return fmt::format(
      "measure {} again and correct the project, where {} mm would fit instead of {}",
      tag < 0 ? "them" : "it", sizes.right, sizes.written);
}

}  // namespace elastocal
