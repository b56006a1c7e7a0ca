// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/butterworth.hpp"

#include <cmath>
#include <complex>
#include <fstream>
#include <limits>
#include <numbers>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/test_files.hpp"

namespace elastocal {
namespace {

struct Case {
  int order;
  double cutoff_hz;
  double rate_hz;
  std::vector<double> signal;
  std::vector<double> filtered;
};

// Reads cases from a file. A new case begins where the order or the cutoff changes.
std::vector<Case> ReadReference() {
  std::ifstream file(SourceFile("tests/signals/sosfiltfilt.csv"));
  std::vector<Case> cases;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    std::istringstream cells(line);
    double order = 0, cutoff = 0, rate = 0, x = 0, y = 0;
    char comma = 0;
    cells >> order >> comma >> cutoff >> comma >> rate >> comma >> x >> comma >> y;
    EXPECT_FALSE(cells.fail()) << line;
    const int n = static_cast<int>(order);
    if (cases.empty() || cases.back().order != n || cases.back().cutoff_hz != cutoff) {
      cases.push_back({n, cutoff, rate, {}, {}});
    }
    cases.back().signal.push_back(x);
    cases.back().filtered.push_back(y);
  }
  return cases;
}

Eigen::VectorXd ToVector(const std::vector<double>& values) {
  return Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size()));
}

// Gain of the chain of sections at a frequency, by its definition.
double Gain(const SecondOrderSections& sections, double frequency_hz, double rate_hz) {
  const auto z = std::polar(1.0, -2.0 * std::numbers::pi * frequency_hz / rate_hz);
  std::complex<double> gain = 1.0;
  for (const SecondOrderSection& s : sections) {
    gain *= (s.b0 + s.b1 * z + s.b2 * z * z) / (1.0 + s.a1 * z + s.a2 * z * z);
  }
  return std::abs(gain);
}

TEST(FiltFilt, EqualsSciPy) {
  const std::vector<Case> cases = ReadReference();
  ASSERT_EQ(cases.size(), 5u);
  ASSERT_EQ(cases[2].signal.size(), 19u);  // the shortest that order 5 takes
  for (const Case& c : cases) {
    Eigen::MatrixXd signal = ToVector(c.signal);
    FiltFilt(ButterworthLowPass(c.order, c.cutoff_hz, c.rate_hz), signal);
    // The requirement. The two orders of the sections differ by rounding of about 1e-13.
    EXPECT_LT((signal - ToVector(c.filtered)).cwiseAbs().maxCoeff(), 1e-9)
        << "order " << c.order << ", " << c.signal.size() << " samples";
  }
}

TEST(FiltFilt, LeavesAStraightLineAndFiltersEachColumnForItself) {
  const SecondOrderSections sections = ButterworthLowPass(5, 5.0, 100.0);
  Eigen::MatrixXd signals(1001, 2);
  signals.col(0).setLinSpaced(-2.0, 3.0);
  signals.col(1).setZero();
  signals(500, 1) = 1.0;
  const Eigen::VectorXd line = signals.col(0);
  FiltFilt(sections, signals);
  // A disturbance from the ends decays by exp(-0.097) a sample, so to 2e-13 over 300 samples.
  EXPECT_LT((signals.col(0) - line).segment(300, 400).cwiseAbs().maxCoeff(), 1e-11);
  // With zero phase, the response to an impulse is symmetric and highest at the impulse.
  for (int k = 1; k < 200; ++k) EXPECT_NEAR(signals(500 - k, 1), signals(500 + k, 1), 1e-11);
  EXPECT_GT(signals(500, 1), signals(501, 1));
}

TEST(FiltFilt, RefusesShortSignals) {
  const SecondOrderSections sections = ButterworthLowPass(5, 5.0, 100.0);
  EXPECT_EQ(FiltFiltPadding(sections), 18);
  EXPECT_EQ(FiltFiltPadding(ButterworthLowPass(4, 5.0, 100.0)), 15);
  Eigen::MatrixXd shortest = Eigen::MatrixXd::Constant(19, 1, 4.0);
  FiltFilt(sections, shortest);
  EXPECT_NEAR(shortest(7, 0), 4.0, 1e-12);
  Eigen::MatrixXd too_short(18, 1);
  too_short.setZero();
  EXPECT_THROW(FiltFilt(sections, too_short), std::invalid_argument);
}

TEST(ButterworthLowPass, HasTheGainOfItsName) {
  for (int order = 1; order <= 10; ++order) {
    for (const double cutoff : {0.5, 5.0, 20.0, 45.0}) {
      const SecondOrderSections sections = ButterworthLowPass(order, cutoff, 100.0);
      EXPECT_NEAR(Gain(sections, 0.0, 100.0), 1.0, 1e-9);
      const double warped = std::tan(std::numbers::pi * cutoff / 100.0);
      for (const double f : {0.3 * cutoff, cutoff, 1.05 * cutoff}) {
        const double ratio = std::tan(std::numbers::pi * f / 100.0) / warped;
        const double expected = 1.0 / std::sqrt(1.0 + std::pow(ratio, 2 * order));
        EXPECT_NEAR(Gain(sections, f, 100.0), expected, 1e-9) << order << " " << cutoff;
      }
    }
  }
}

TEST(ButterworthLowPass, RefusesOtherOrdersAndCutoffs) {
  EXPECT_THROW(ButterworthLowPass(0, 5.0, 100.0), std::invalid_argument);
  EXPECT_THROW(ButterworthLowPass(11, 5.0, 100.0), std::invalid_argument);
  EXPECT_THROW(ButterworthLowPass(5, 0.0, 100.0), std::invalid_argument);
  EXPECT_THROW(ButterworthLowPass(5, 50.0, 100.0), std::invalid_argument);
  EXPECT_THROW(ButterworthLowPass(5, std::numeric_limits<double>::quiet_NaN(), 100.0),
               std::invalid_argument);
}

}  // namespace
}  // namespace elastocal
