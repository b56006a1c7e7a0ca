// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/observed_faults.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "elastocal/math/numbers.hpp"
#include "elastocal/mistakes/observed_conventions.hpp"
#include "elastocal/mistakes/observed_corrections.hpp"
#include "elastocal/mistakes/observed_scale.hpp"
#include "elastocal/observation/observation_faults.hpp"
#include "elastocal/observation/observed_posture.hpp"

namespace elastocal {
namespace {

constexpr double kHalved = 0.5;         // largest share that is left with a fault corrected
constexpr std::size_t kMostFaults = 8;  // number of faults that are tried by a fit

/// Root mean square residual of a fit, by degrees of freedom, without some observations, in units
/// of the noise of `spread`. A fit to few observations leaves small residuals, whatever they are.
double RmsLeft(const ObservedRobot& model, const Observations& observations,
               const ObservationFit& fit, const Spread& spread,
               const std::vector<ObservationOutlier>& outliers) {
  std::set<int> out;
  for (const ObservationOutlier& outlier : outliers) out.insert(outlier.observation);
  const std::vector<Eigen::VectorXd> left = LeftOf(model, observations, fit.values);
  double squares = 0.0, rows = 0.0;
  for (int i = 0; i < observations.count(); ++i) {
    if (out.contains(i)) continue;
    const auto k = static_cast<std::size_t>(i);
    const Instrument& instrument = model.instrument(observations.all[k].instrument);
    squares += (instrument.Weights(spread) * left[k]).squaredNorm();
    rows += instrument.size();
  }
  return std::sqrt(squares / std::max(1.0, rows - fit.effective_parameters));
}

bool Slides(const ObservedRobot& model, int coordinate) {
  const RobotTree& tree = model.robot.tree;
  const int joint = tree.coordinate_joint[Size(coordinate)];
  return tree.joints[Size(joint)].type == JointType::kPrismatic;
}

std::string RemedyOf(const ObservationFault& fault, const ObservedRobot& model,
                     const Observations& observations) {
  const auto name = NameOfFault(fault, model, observations);
  if (name && fault.kind == ObservationFaultKind::kJointGain && fault.file < 0 &&
      Slides(model, fault.coordinate)) {
    return fmt::format(
        "--accept {} corrects it; if its scale is right, that of what measured is "
        "{:.4f} times the true one",
        *name, 1.0 / (1.0 + fault.size));
  }
  if (name) return "--accept " + *name + " corrects it";
  if (fault.kind == ObservationFaultKind::kTagSize) {
    return WriteSizeOfTags(model, observations, fault.quantity, 1.0 + fault.size);
  }
  if (fault.kind == ObservationFaultKind::kJointDrift) return "measure again";
  const auto varies = [&](const std::shared_ptr<const Instrument>& of) {
    return of->varying >= 0 && of->quantities[Size(of->varying)] == fault.quantity;
  };
  const auto& instruments = model.setup.instruments;
  return std::any_of(instruments.begin(), instruments.end(), varies)
             ? "each file is a session of its own: split the table there"
             : "calibrate the rows before and after apart";
}

/// Ratio of the residuals of a fit with the fault corrected to those with the fault. Frozen
/// postures count in the latter: at best they were left out as outliers, and the other postures are
/// too few to tell the noise.
double LeftWithout(const ObservedRobot& model, const Observations& observations,
                   const ObservationFit& with, const ObservationFault& fault) {
  const Observations without = WithoutFault(fault, model, observations);
  const auto [fit, outliers] = EstimateObserved(model, without, {});
  const bool fewer = fault.kind == ObservationFaultKind::kJointFrozen;
  const Spread& noise = fewer ? with.spread : fit.spread;
  return RmsLeft(model, without, fit, noise, outliers) /
         RmsLeft(model, observations, with, noise,
                 fewer ? std::vector<ObservationOutlier>() : outliers);
}

/// Finds a scale. A wrong scale looks like the gain of a prismatic joint; without that gain,
/// lengths determine it.
std::optional<CommonScale> ScaleBesideRails(const ObservedRobot& model,
                                            const Observations& observations,
                                            const std::vector<ObservationFault>& faults) {
  for (const ObservationFault& fault : faults) {
    if (fault.kind != ObservationFaultKind::kJointGain) continue;
    if (!Slides(model, fault.coordinate)) continue;
    const ObservationFault gain = Refined(fault, model, observations);
    const Observations without = WithoutFault(gain, model, observations);
    const ObservedEstimate estimate = EstimateObserved(model, without, {});
    const auto scale = FindObservedScale(model, without, estimate.fit);
    if (scale) return scale;
  }
  return std::nullopt;
}

/// The largest noise of cameras, relative to the expected one.
double NoiseOfCameras(const ObservedRobot& model, const Spread& spread) {
  const std::vector<Source>& sources = model.setup.sources;
  double most = 0.0;
  for (std::size_t s = 0; s < sources.size(); ++s) {
    if (sources[s].unit == SourceUnit::kPixel) most = std::max(most, spread.sd[s] / sources[s].sd);
  }
  return most;
}

/// Finds tags in another unit. Cameras whose poses are free explain so much of it that only their
/// noise is far above the expected one.
std::string UnitOfTags(const ObservedRobot& model, const Observations& observations,
                       const ObservationFit& fit) {
  constexpr double kNoisy = 4.0;
  const double before = NoiseOfCameras(model, fit.spread);
  if (before < kNoisy) return "";
  for (const WrittenConvention& other : TagsInOtherUnits(model, observations)) {
    const ObservationFit without = EstimateObserved(*other.robot, observations, {}).fit;
    if (NoiseOfCameras(model, without.spread) < kHalved * before) {
      return other.what + ": " + other.right + " was expected";
    }
  }
  return "";
}

}  // namespace

std::string DescribeWithRemedy(const ObservationFault& fault, const ObservedRobot& model,
                               const Observations& observations) {
  return fmt::format("{} ({})", DescribeFault(fault, model, observations),
                     RemedyOf(fault, model, observations));
}

std::string FindObservedFault(const ObservedRobot& model, const Observations& observations,
                              const ObservationFit& fit) {
  if (std::string unit = UnitOfTags(model, observations, fit); !unit.empty()) return unit;
  std::vector<ObservationFault> faults = FindObservationFaults(model, observations, fit);
  if (const auto scale = ScaleBesideRails(model, observations, faults)) {
    return DescribeScale(*scale, model, observations);
  }
  if (faults.size() > kMostFaults) faults.resize(kMostFaults);
  const ObservationFault* best = nullptr;
  double least = kHalved;
  for (const ObservationFault& fault : faults) {
    const double left = LeftWithout(model, observations, fit, fault);
    if (!(left < least)) continue;
    least = left;
    best = &fault;
  }
  if (best != nullptr) {
    const ObservationFault fault = Refined(*best, model, observations);
    return fmt::format("{}; without that, the calibrated robot leaves {:.2g} times as much",
                       DescribeWithRemedy(fault, model, observations),
                       std::min(least, LeftWithout(model, observations, fit, fault)));
  }
  const auto scale = FindObservedScale(model, observations, fit);
  return scale ? DescribeScale(*scale, model, observations) : "";
}

}  // namespace elastocal
