// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "elastocal/identifiability/base_parameters.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// Base parameters of a model of the project's robot for this recording (section 2.1). `seed`
/// replaces the project's; the base does not depend on it.
BaseParameters FindBaseOf(const Project& project, const ErrorModel& model,
                          const Recording& recording, std::optional<std::uint64_t> seed = {});

}  // namespace elastocal
