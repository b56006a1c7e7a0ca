// SPDX-License-Identifier: Apache-2.0
#include "elastocal/optim/termination.hpp"

namespace elastocal {

const char* TerminationName(Termination termination) {
  switch (termination) {
    case Termination::kConverged:
      return "converged";
    case Termination::kNoConvergence:
      return "not converged";
    default:
      return "failed";
  }
}

}  // namespace elastocal
