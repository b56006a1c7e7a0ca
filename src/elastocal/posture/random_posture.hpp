#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include <Eigen/Core>

#include "elastocal/math/random.hpp"
#include "elastocal/posture/feasible_set.hpp"

namespace elastocal {

/// How the random postures came about.
struct SamplingCount {
  long tries = 0;
  long feasible_at_once = 0;  ///< without repair
  long found = 0;
  double Yield() const { return tries > 0 ? static_cast<double>(found) / tries : 0.0; }
};

/// Random feasible postures (paper section 3.5.2): a random pose of the chain's end in its
/// workspace, brought about by the joints as well as they can (bounded least squares from a random
/// start); where something else is broken then, the first joints (shoulder or hip) are moved until
/// it is not, or another pose is drawn. A chain without workspace: joints drawn within their
/// limits.
class FeasibleSampler {
 public:
  /// Keeps a reference.
  FeasibleSampler(FeasibleSet& set, std::uint64_t seed) : set_(set), random_(seed) {}

  /// Nothing where `most_tries` end poses gave no feasible posture: the workspace is empty, or next
  /// to.
  std::optional<Eigen::VectorXd> Draw(int most_tries = 2000);

  const SamplingCount& count() const { return count_; }
  /// Where the last draw failed: the limit that kept most of the tries from being feasible.
  std::string Blame() const;

 private:
  Eigen::VectorXd DrawStart();
  void PlaceEnd(const Eigen::Vector3d& p, const Eigen::Matrix3d& R, Eigen::VectorXd& x);
  void Repair(Eigen::VectorXd& x);

  FeasibleSet& set_;
  Random random_;
  SamplingCount count_;
  std::map<std::string, int> blame_;
};

}  // namespace elastocal
