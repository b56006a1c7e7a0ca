// SPDX-License-Identifier: Apache-2.0
#include "elastocal/planning/design_postures.hpp"

#include <chrono>

#include <fmt/format.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/planning/chain_setups.hpp"

namespace elastocal {
namespace {

/// Measures the seconds since its construction.
class Stopwatch {
 public:
  double Seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// The mirrored postures for the chain on the other side.
DesignedPostures DesignOtherSide(const Project& project, const ChainDesign& design,
                                 const PostureDesignOptions& options) {
  const Stopwatch watch;
  const ChainSetup other = OtherSide(project, design.setup);
  const DesignedChain chain = PrepareChain(project, other, options.elastic);
  std::string reason;
  const auto mirror =
      FindMirror(project.tree, design.setup.coordinates, other.coordinates, &reason);
  DesignedPostures opposite;
  if (mirror) {
    opposite.design = MirrorDesign(design, *mirror, *chain.model, chain.base.kept, project.motion,
                                   other, options.design);
  } else {
    opposite.design =
        DesignChain(*chain.model, chain.base.kept, project.motion, other, options.design);
    opposite.design.notes.push_back("designed by itself: " + reason);
  }
  opposite.seconds = watch.Seconds();
  return opposite;
}

/// Designs one side of a chain, with the curves of its index.
void DesignOneSide(const Project& project, const ChainSetup& setup,
                   const PostureDesignOptions& options, PostureDesign& result) {
  const Stopwatch watch;
  const DesignedChain chain = PrepareChain(project, setup, options.elastic);
  const ChainDesign design =
      DesignChain(*chain.model, chain.base.kept, project.motion, setup, options.design);
  result.chains.push_back({design, watch.Seconds()});
  for (std::size_t i = 0; i < design.sizes.size(); ++i) {
    result.curves.push_back(
        {options.design.algorithm, setup.name, design.sizes[i], design.indices[i]});
  }
  if (design.index == 0.0 || !options.compare_algorithms) return;
  for (const CurvePoint& point : CompareAlgorithms(*chain.model, chain.base.kept, project.motion,
                                                   setup, design.sizes, options.design)) {
    result.curves.push_back(point);
  }
}

/// Reason why a chain has no postures that determine its parameters; empty where it has.
std::string WhyInfeasible(const ChainDesign& design) {
  if (design.index > 0.0) return "";
  const std::string chain = "chain '" + design.setup.name + "': ";
  if (design.status == DesignResult::Status::kNoPosture) {
    return chain + "no feasible posture was found; what stands in the way most often is the " +
           design.blame;
  }
  return fmt::format(
      "{}{} feasible postures do not determine all {} parameters; allow more postures (--count, "
      "--max-count), hold some parameters (identifiability: hold) or widen its workspace",
      chain, design.postures.size(), design.parameter_count);
}

int SideCount(const std::vector<ChainSetup>& setups) {
  int count = 0;
  for (const ChainSetup& setup : setups) count += setup.mirror.empty() ? 1 : 2;
  return count;
}

}  // namespace

PostureDesign DesignPostures(const Project& project, const PostureDesignOptions& options,
                             const Progress& progress) {
  if (options.design.algorithm == DesignAlgorithm::kExchange &&
      options.design.criterion != Criterion::kO1) {
    throw InputError("the algorithm 'exchange' is for the criterion O1 only");
  }
  const std::vector<ChainSetup> setups = ChosenSetups(project, options.chains);
  const int total = SideCount(setups);
  PostureDesign result;
  const auto report = [&] {
    if (progress) progress(static_cast<int>(result.chains.size()), total);
  };
  report();
  for (const ChainSetup& setup : setups) {
    DesignOneSide(project, setup, options, result);
    result.infeasible = WhyInfeasible(result.chains.back().design);
    if (!result.infeasible.empty()) return result;
    report();
    if (setup.mirror.empty()) continue;
    result.chains.push_back(DesignOtherSide(project, result.chains.back().design, options));
    result.infeasible = WhyInfeasible(result.chains.back().design);
    if (!result.infeasible.empty()) return result;
    report();
  }
  return result;
}

std::vector<ChainPostures> PostureDesign::postures() const {
  std::vector<ChainPostures> postures;
  for (const auto& [design, seconds] : chains) {
    postures.push_back({design.setup.name, design.setup.support, design.postures});
  }
  return postures;
}

int PostureDesign::posture_count() const {
  std::size_t count = 0;
  for (const auto& [design, seconds] : chains) count += design.postures.size();
  return static_cast<int>(count);
}

std::vector<std::string> PostureDesign::warnings() const {
  std::vector<std::string> warnings;
  for (const auto& [design, seconds] : chains) {
    for (const std::string& note : design.notes) {
      warnings.push_back(design.setup.name + ": " + note);
    }
  }
  return warnings;
}

}  // namespace elastocal
