// SPDX-License-Identifier: Apache-2.0
#include "elastocal/math/butterworth.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

namespace elastocal {
namespace {

constexpr int kHighestOrder = 10;

// The analogue section 1 / (s^2 + 2 damping s + 1) with s = (1 - 1/z) / (1 + 1/z) / warped.
SecondOrderSection PolePair(double damping, double warped) {
  const double square = warped * warped;
  const double scale = 1.0 / (1.0 + 2.0 * damping * warped + square);
  SecondOrderSection section;
  section.b0 = section.b2 = square * scale;
  section.b1 = 2.0 * section.b0;
  section.a1 = 2.0 * (square - 1.0) * scale;
  section.a2 = (1.0 - 2.0 * damping * warped + square) * scale;
  return section;
}

SecondOrderSection SinglePole(double warped) {
  SecondOrderSection section;
  section.b0 = section.b1 = warped / (1.0 + warped);
  section.a1 = (warped - 1.0) / (warped + 1.0);
  return section;
}

// Four signals are filtered at a time, one in each row: a sample depends on the one before it, so
// that a single signal would leave the processor idle.
constexpr int kLanes = 4;
using Lanes = Eigen::Array<double, kLanes, Eigen::Dynamic>;

// One pass in place, in transposed direct form II, started as if the first sample had lasted
// forever.
void Filter(const SecondOrderSection& f, Lanes& x) {
  const double gain = (f.b0 + f.b1 + f.b2) / (1.0 + f.a1 + f.a2);
  Eigen::Array<double, kLanes, 1> s1 = (gain - f.b0) * x.col(0);
  Eigen::Array<double, kLanes, 1> s2 = (f.b2 - f.a2 * gain) * x.col(0);
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    const Eigen::Array<double, kLanes, 1> in = x.col(i);
    const Eigen::Array<double, kLanes, 1> out = f.b0 * in + s1;
    s1 = f.b1 * in - f.a1 * out + s2;
    s2 = f.b2 * in - f.a2 * out;
    x.col(i) = out;
  }
}

// Mirrors the signal in its end points, `padding` samples at either end.
void ExtendOddly(const Eigen::Ref<const Eigen::VectorXd>& signal, int padding, int lane,
                 Lanes& extended) {
  const Eigen::Index n = signal.size();
  for (int k = 1; k <= padding; ++k) {
    extended(lane, padding - k) = 2.0 * signal[0] - signal[k];
    extended(lane, padding + n - 1 + k) = 2.0 * signal[n - 1] - signal[n - 1 - k];
  }
  extended.row(lane).segment(padding, n) = signal.transpose();
}

}  // namespace

SecondOrderSections ButterworthLowPass(int order, double cutoff_hz, double rate_hz) {
  if (order < 1 || order > kHighestOrder) {
    throw std::invalid_argument("order of a Butterworth filter is " + std::to_string(order) +
                                ", expected 1 to " + std::to_string(kHighestOrder));
  }
  if (!(cutoff_hz > 0.0 && cutoff_hz < 0.5 * rate_hz && std::isfinite(rate_hz))) {
    throw std::invalid_argument("cutoff of " + std::to_string(cutoff_hz) +
                                " Hz, expected more than 0 and less than half the rate of " +
                                std::to_string(rate_hz) + " Hz");
  }
  const double warped = std::tan(std::numbers::pi * cutoff_hz / rate_hz);
  SecondOrderSections sections;
  if (order % 2 == 1) sections.push_back(SinglePole(warped));
  for (int k = 0; k < order / 2; ++k) {
    const double angle = std::numbers::pi * (2 * k + 1) / (2 * order);
    sections.push_back(PolePair(std::sin(angle), warped));
  }
  return sections;
}

int FiltFiltPadding(const SecondOrderSections& sections) {
  const auto count = [&](auto is_zero) {
    return static_cast<int>(std::count_if(sections.begin(), sections.end(), is_zero));
  };
  const int poles_at_zero = count([](const SecondOrderSection& s) { return s.a2 == 0.0; });
  const int zeros_at_zero = count([](const SecondOrderSection& s) { return s.b2 == 0.0; });
  const int taps =
      2 * static_cast<int>(sections.size()) + 1 - std::min(poles_at_zero, zeros_at_zero);
  return 3 * taps;
}

void FiltFilt(const SecondOrderSections& sections, Eigen::Ref<Eigen::MatrixXd> signals) {
  const int padding = FiltFiltPadding(sections);
  if (signals.rows() <= padding) {
    throw std::invalid_argument("signal of " + std::to_string(signals.rows()) +
                                " samples, expected more than the filter's padding of " +
                                std::to_string(padding));
  }
  Lanes extended = Lanes::Zero(kLanes, signals.rows() + 2 * padding);
  for (Eigen::Index first = 0; first < signals.cols(); first += kLanes) {
    const int used = static_cast<int>(std::min<Eigen::Index>(kLanes, signals.cols() - first));
    for (int k = 0; k < used; ++k) ExtendOddly(signals.col(first + k), padding, k, extended);
    for (int pass = 0; pass < 2; ++pass) {
      for (const SecondOrderSection& section : sections) Filter(section, extended);
      extended.rowwise().reverseInPlace();
    }
    for (int k = 0; k < used; ++k) {
      signals.col(first + k) = extended.row(k).segment(padding, signals.rows()).transpose();
    }
  }
}

}  // namespace elastocal
