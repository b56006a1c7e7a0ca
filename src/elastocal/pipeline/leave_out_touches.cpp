// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/leave_out_touches.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/math/statistics.hpp"
#include "elastocal/pipeline/off_alone.hpp"

namespace elastocal {
namespace {

constexpr double kMostInTheAir = 0.25;  // share of the touches of a plate

/// Heights of touches as text, mm: "12", "5.9 to 39".
std::string HeightsInWords(const std::vector<TouchInTheAir>& touches) {
  const auto [low, high] =
      std::minmax_element(touches.begin(), touches.end(),
                          [](const auto& a, const auto& b) { return a.height < b.height; });
  const std::string least = fmt::format("{:.2g}", 1e3 * low->height);
  const std::string most = fmt::format("{:.2g}", 1e3 * high->height);
  return least == most ? least : least + " to " + most;
}

/// Whether the touches lie on another plane, as far as a robot tells: touches in the air have any
/// height.
bool AreAsHigh(const std::vector<TouchInTheAir>& touches) {
  constexpr std::size_t kFewestOfAPlane = 4;
  constexpr double kScatter = 0.25;  // of the height
  std::vector<double> heights;
  for (const TouchInTheAir& touch : touches) heights.push_back(touch.height);
  if (heights.size() < kFewestOfAPlane) return false;
  const double middle = Median(heights);
  return std::all_of(heights.begin(), heights.end(),
                     [&](double height) { return std::abs(height - middle) <= kScatter * middle; });
}

/// Number of touches of each plate.
std::vector<int> TouchesByPlate(const ObservedRobot& model, const Observations& observations) {
  std::vector<int> touches(model.setup.plates.size(), 0);
  for (const Observation& of : observations.all) {
    if (model.IsPlate(of.instrument)) ++touches[Size(of.instrument)];
  }
  return touches;
}

}  // namespace

std::string DescribeTouchesInTheAir(const ObservedRobot& model, const Observations& observations,
                                    const std::vector<TouchInTheAir>& air) {
  const std::vector<int> touches = TouchesByPlate(model, observations);
  std::vector<int> in_the_air;
  for (const TouchInTheAir& touch : air) in_the_air.push_back(touch.observation);
  return fmt::format(
      "{} of {} touches seem to be none: by the others, the plate stood {} mm above its table in "
      "{}{}",
      air.size(), std::accumulate(touches.begin(), touches.end(), 0), HeightsInWords(air),
      PlacesOf(in_the_air, observations),
      AreAsHigh(air) ? " (all as high: another table, or one that was moved?)" : "");
}

std::optional<TouchesLeftOut> WithoutTouchesInTheAir(const ObservedRobot& model,
                                                     const Observations& observations) {
  const std::vector<TouchInTheAir> air = FindTouchesInTheAir(model, observations);
  if (air.empty()) return std::nullopt;
  TouchesLeftOut left_out{WithoutTouches(observations, air),
                          DescribeTouchesInTheAir(model, observations, air)};
  const std::vector<int> before = TouchesByPlate(model, observations);
  const std::vector<int> after = TouchesByPlate(model, left_out.others);
  for (std::size_t plate = 0; plate < before.size(); ++plate) {
    left_out.many = left_out.many || before[plate] - after[plate] > kMostInTheAir * before[plate];
  }
  return left_out;
}

bool LeaveOutTouchesInTheAir(ContactRun& run) {
  std::optional<TouchesLeftOut> left_out = WithoutTouchesInTheAir(run.model, run.observations);
  if (!left_out) return false;
  run.observations = std::move(left_out->others);
  if (left_out->many) {
    run.wrong_rows = left_out->text +
                     ". Record them again, or delete these rows if nothing was touched; touches "
                     "of another table belong into a file of their own";
  } else {
    run.warnings.push_back(left_out->text + "; left out: was there contact?");
  }
  return true;
}

std::string DescribeOtherSessions(const std::vector<OtherSession>& found,
                                  const Observations& observations) {
  std::map<std::pair<std::string, std::string>, std::vector<int>> places;  // by said, seen
  for (const OtherSession& of : found) {
    const auto first =
        std::find_if(observations.all.begin(), observations.all.end(),
                     [&](const Observation& one) { return one.posture == of.posture; });
    places[{of.said, of.seen}].push_back(static_cast<int>(first - observations.all.begin()));
  }
  std::vector<std::string> texts;
  for (const auto& [sessions, rows] : places) {
    texts.push_back(fmt::format("{} of '{}' as if of '{}'", PlacesOf(rows, observations),
                                sessions.first, sessions.second));
  }
  return fmt::format(
      "{} of {} rows seem to be of another session (contact.sessions, or the file) than they say: "
      "{}",
      found.size(), observations.posture_count(), fmt::join(texts, "; "));
}

bool ExchangeSessions(ContactRun& run) {
  const std::vector<OtherSession> found = FindExchangedSessions(run.model, run.observations);
  if (found.empty()) return false;
  run.wrong_rows = DescribeOtherSessions(found, run.observations) +
                   "; so the robot leaves less than half as much (or was there no contact?)";
  run.observations = InOtherSessions(found, run.observations);
  return true;
}

}  // namespace elastocal
