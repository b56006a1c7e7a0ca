// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/exchange_within_cluster.hpp"

#include <cmath>

#include <fmt/format.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/measurement/trial_names.hpp"
#include "elastocal/mistakes/estimated_place.hpp"
#include "elastocal/recorded/recorded_model.hpp"
#include "elastocal/validation/held_out.hpp"

namespace elastocal {
namespace {

constexpr double kLeftByExchange = 0.3;  // share of the error on held-out trials

/// Whether each of two markers is estimated where the project has the other.
bool AreExchanged(const CalibrationResult& result, int a, int b) {
  const auto from = [&](int m, int other) {
    return (EstimatedPlace(result, m) - result.model.markers[Size(other)].p_link_marker)
        .squaredNorm();
  };
  return from(a, b) + from(b, a) < from(a, a) + from(b, b);
}

std::string TrialsThatSee(const Recording& recording, int a, int b) {
  return TrialNames(recording, TrialsWith(recording, [&](int i) {
                      return Seen(recording, i, a) && Seen(recording, i, b);
                    }));
}

}  // namespace

std::optional<LabelExchange> ExchangeWithinCluster(const Project& project,
                                                   const Recording& recording,
                                                   const Recording& held_out,
                                                   const ModelComparison& comparison) {
  const auto squares_of = [&](const Recording& judged) -> Eigen::ArrayXXd {
    const HeldOut result = JudgeLargestOnTrials(comparison, judged, project.calibration);
    const auto& distances =
        result.predictions[static_cast<std::size_t>(comparison.largest_kind())].distances;
    return distances.array().isFinite().select(distances.array().square(), 0.0);
  };
  const Eigen::ArrayXXd given = squares_of(held_out);
  const double before = given.sum();
  const auto count = static_cast<double>((given > 0.0).count());
  double least = kLeftByExchange * kLeftByExchange * before;
  std::optional<LabelExchange> found;
  for (const LabelCluster& cluster : SeenClusters(project, recording)) {
    for (std::size_t i = 0; i < cluster.markers.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const int one = cluster.markers[j], other = cluster.markers[i];
        const Eigen::ArrayXd of_pair = given.col(one) + given.col(other);
        if (before - of_pair.sum() > least) continue;
        Recording exchanged = held_out;
        exchanged.markers.middleCols<3>(3 * one).swap(exchanged.markers.middleCols<3>(3 * other));
        const Eigen::ArrayXXd squares = squares_of(exchanged);
        const Eigen::ArrayXd left = squares.col(one) + squares.col(other);
        double gained = 0.0;
        std::vector<int> nearer;
        for (int k = 0; k < held_out.posture_count(); ++k) {
          if (!(left[k] < kLeftByExchange * of_pair[k])) continue;
          gained += of_pair[k] - left[k];
          nearer.push_back(k);
        }
        if (!(before - gained < least)) continue;
        least = before - gained;
        found = {one, other, nearer, std::sqrt(before / count), std::sqrt(least / count)};
      }
    }
  }
  if (found) found->of_estimate = AreExchanged(comparison.largest(), found->a, found->b);
  return found;
}

std::string DescribeExchange(const LabelExchange& exchange, const Recording& recording,
                             const Recording& held_out) {
  return fmt::format(
      "the labels of {} and {} seem exchanged in {}: exchanged back, held-out trials are {:.3g} "
      "mm off the model, as they are {:.3g} mm",
      recording.marker_names[Size(exchange.a)], recording.marker_names[Size(exchange.b)],
      exchange.of_estimate ? "trial " + TrialsThatSee(recording, exchange.a, exchange.b)
                           : fmt::format("{} postures of trial {}", exchange.postures.size(),
                                         TrialsThatSee(SelectPostures(held_out, exchange.postures),
                                                       exchange.a, exchange.b)),
      1e3 * exchange.after, 1e3 * exchange.before);
}

}  // namespace elastocal
