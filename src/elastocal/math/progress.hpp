// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace elastocal {

/// Called while long work goes on, with the number of finished steps and of all steps: first with
/// none done, last with all. It may be empty. Work on several threads calls it from one at a time.
using Progress = std::function<void(int done, int total)>;

}  // namespace elastocal
