// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/column_step.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

namespace elastocal {
namespace {

constexpr int kFewestNumbers = 10;      // least count of numbers that tells a step
constexpr double kOnGrid = 0.03;        // a multiple may be off by this share of a step
constexpr double kMostOnGrid = 0.9;     // least share of the differences that are multiples
constexpr std::size_t kCandidates = 5;  // smallest differences that are tried as the step
constexpr std::size_t kParts = 3;       // a difference may be one, two or three steps
constexpr double kSameNumber = 2e-6;    // rad or m: a log's own digits

}  // namespace

double StepOf(const Eigen::VectorXd& column) {
  std::vector<double> numbers(column.begin(), column.end());
  std::sort(numbers.begin(), numbers.end());
  std::vector<double> differences;
  for (std::size_t k = 1; k < numbers.size(); ++k) {
    if (numbers[k] - numbers[k - 1] > kSameNumber) {
      differences.push_back(numbers[k] - numbers[k - 1]);
    }
  }
  if (differences.size() + 1 < kFewestNumbers) return 0.0;
  std::vector<double> sorted = differences;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t candidates = std::min(kCandidates, sorted.size());
  double largest = 0.0;
  for (std::size_t k = 0; k < candidates * kParts; ++k) {
    double step = sorted[k / kParts] / static_cast<double>(1 + k % kParts);
    double sum = 0.0, steps = 0.0;
    std::size_t on = 0;
    for (const double difference : sorted) {  // each multiple makes the step more accurate
      const double multiple = std::round(difference / step);
      if (multiple < 1.0 || std::abs(difference / step - multiple) > kOnGrid) continue;
      ++on;
      sum += difference;
      steps += multiple;
      step = sum / steps;
    }
    if (static_cast<double>(on) >= kMostOnGrid * static_cast<double>(sorted.size())) {
      largest = std::max(largest, step);
    }
  }
  return largest;
}

}  // namespace elastocal
