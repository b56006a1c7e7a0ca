// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "elastocal/posture/certificate.hpp"
#include "elastocal/posture/chain_problem.hpp"
#include "elastocal/posture/mirror.hpp"
#include "elastocal/posture/nocp.hpp"

namespace elastocal {

/// The algorithm that chooses postures. All except NOCP take the number of postures as given; COCP,
/// IOOPS and exchange start from random feasible postures.
enum class DesignAlgorithm { kNocp, kCocp, kIoops, kExchange, kRandom };

const char* AlgorithmName(DesignAlgorithm algorithm);  ///< nocp, cocp, ioops, exchange, random

struct DesignOptions {
  DesignAlgorithm algorithm = DesignAlgorithm::kNocp;
  int postures = 24;  ///< number of postures, for algorithms other than NOCP
  NocpOptions nocp = {};
  Criterion criterion = Criterion::kO1;
  bool certify = true;
  CertificateOptions certificate = {};
  std::uint64_t seed = 1;
};

/// Sets the options to exactly `count` postures for any algorithm (NOCP then has no plateau).
void SetPostureCount(int count, DesignOptions& options);

/// Calibration postures of one chain.
struct ChainDesign {
  ChainSetup setup;
  std::vector<Eigen::VectorXd> postures;  ///< postures of the whole robot, by coordinate of q
  DesignResult::Status status = DesignResult::Status::kMaxPostures;
  std::string blame = {};  ///< the limit that leaves no feasible posture
  int parameter_count = 0;
  double index = 0.0;                ///< of the set
  std::vector<int> sizes = {};       ///< number of postures after each addition
  std::vector<double> indices = {};  ///< index of the set after each addition
  Certificate certificate = {};
  SamplingCount sampling = {};          ///< of the random postures drawn
  std::string mirrored_from = {};       ///< chain whose postures were mirrored; empty: none
  std::vector<std::string> notes = {};  ///< what a user should know

  double Efficiency() const { return certificate.bound > 0.0 ? index / certificate.bound : 0.0; }
};

/// Finds the smallest set of postures for a chain (or the set that the algorithm gives), with a
/// certificate of how far its index is from the maximum.
ChainDesign DesignChain(const ErrorModel& model, const std::vector<int>& base,
                        const MotionSetup& motion, const ChainSetup& chain,
                        const DesignOptions& options);

/// Mirrors the postures for the chain on the other side, to which `model`, `base` and `other`
/// belong. Each is checked there: a posture that is not feasible (limits and loads need not be
/// symmetric) is replaced by a random one and optimised, and `notes` say so. The index is that of
/// the other side; the certificate is taken over from `design`.
ChainDesign MirrorDesign(const ChainDesign& design, const MirrorMap& mirror,
                         const ErrorModel& model, const std::vector<int>& base,
                         const MotionSetup& motion, const ChainSetup& other,
                         const DesignOptions& options);

/// A point of the curve of O1 against the number of postures (paper Fig. 6).
struct CurvePoint {
  DesignAlgorithm algorithm;
  std::string chain;
  int postures = 0;
  double index = 0.0;
};
/// The index that COCP, IOOPS, exchange (for O1 only) and random design reach with sets of these
/// sizes, each from random postures.
std::vector<CurvePoint> CompareAlgorithms(const ErrorModel& model, const std::vector<int>& base,
                                          const MotionSetup& motion, const ChainSetup& chain,
                                          const std::vector<int>& sizes,
                                          const DesignOptions& options);

}  // namespace elastocal
