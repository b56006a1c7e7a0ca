// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>

#include "elastocal/identifiability/base_parameters.hpp"
#include "elastocal/measurement/recording.hpp"
#include "elastocal/project/project.hpp"

namespace elastocal {

/// Base parameters of a model of the project's robot that is to explain this recording (section
/// 2.1). `seed` is taken instead of the project's: the base is the same by any.
BaseParameters FindBaseOf(const Project& project, const ErrorModel& model,
                          const Recording& recording, std::optional<std::uint64_t> seed = {});

}  // namespace elastocal
