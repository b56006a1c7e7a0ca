// SPDX-License-Identifier: Apache-2.0
#include "elastocal/recorded/find_base.hpp"

namespace elastocal {

BaseParameters FindBaseOf(const Project& project, const ErrorModel& model,
                          const Recording& recording, std::optional<std::uint64_t> seed) {
  IdentifiabilityOptions options = project.identifiability;
  if (seed) options.seed = *seed;
  if (HasFreeRoot(recording)) options.root = RootPose::kFree;
  return FindBaseParameters(model, options);
}

}  // namespace elastocal
