// SPDX-License-Identifier: Apache-2.0
#include "elastocal/pipeline/off_alone.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "elastocal/math/numbers.hpp"

namespace elastocal {
namespace {

constexpr double kMostAlone = 0.25;  // share of an instrument's observations
constexpr int kFewestOthers = 4;     // then three predict each
constexpr double kOffLikeWorst = 0.5;

/// Root mean square of an observation's residual over the coordinates of the row `row`.
double OffBy(const Instrument& instrument, const std::string& row, const Eigen::VectorXd& left) {
  const std::vector<RowMeaning> rows = instrument.rows();
  double squares = 0.0, count = 0.0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (row != rows[i].name) continue;
    squares += std::pow(left[static_cast<Eigen::Index>(i)], 2);
    ++count;
  }
  return count > 0.0 ? std::sqrt(squares / count) : 0.0;
}

}  // namespace

OffAlone FindOffAlone(const ObservedRobot& model, const Observations& observations,
                      const RowErrors& row, double most, const PredictObservations& predict) {
  std::set<int> out;
  for (;;) {
    const std::vector<Eigen::VectorXd> left = predict(WithoutObservations(observations, out));
    std::vector<std::pair<int, double>> own;  // index of an observation, and its error
    std::size_t next = 0;
    double squares = 0.0, worst = 0.0;
    for (int i = 0; i < observations.count(); ++i) {
      if (out.contains(i)) continue;
      const Eigen::VectorXd& left_of = left[next++];
      if (observations.all[Size(i)].instrument != row.instrument) continue;
      const double off = OffBy(model.instrument(row.instrument), row.row, left_of);
      own.emplace_back(i, off);
      squares += off * off;
      worst = std::max(worst, off);
    }
    const double rms = std::sqrt(squares / static_cast<double>(own.size()));
    if (rms <= most) return {{out.begin(), out.end()}, rms};
    for (const auto& [i, off] : own) {
      if (off >= kOffLikeWorst * worst) out.insert(i);
    }
    const auto alone = static_cast<int>(out.size());
    if (alone > kMostAlone * row.observations || row.observations - alone < kFewestOthers)
      return {};
  }
}

std::string PlacesOf(const std::vector<int>& some, const Observations& observations) {
  std::string text;
  int file = -1;
  for (const int i : some) {
    const PosturePlace& place = observations.postures[Size(observations.all[Size(i)].posture)];
    text += text.empty() ? "" : ", ";
    if (place.file != file) text += observations.files[Size(place.file)] + ":";
    text += std::to_string(place.line);
    file = place.file;
  }
  return text;
}

}  // namespace elastocal
