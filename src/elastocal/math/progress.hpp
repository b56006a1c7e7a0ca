// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace elastocal {

/// Function that long work calls with the number of finished steps and of all steps, first with
/// none done and last with all. It may be empty. Work on several threads never calls it from two at
/// a time.
using Progress = std::function<void(int done, int total)>;

}  // namespace elastocal
