// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace elastocal {

/// Why a solver ended.
enum class Termination {
  kConverged,      ///< a tolerance was met
  kNoConvergence,  ///< the iterations were used up
  kFailure,        ///< the problem could not be evaluated or solved
};

const char* TerminationName(Termination termination);

}  // namespace elastocal
