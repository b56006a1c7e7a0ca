// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

#include "elastocal/math/progress.hpp"

namespace elastocal {

/// Does work(0) to work(count - 1), on up to `threads` threads (the caller's is one of them), in no
/// certain order. Progress counts what is done. Where work throws, or an InterruptionPoint of the
/// caller does, nothing more is begun, and an exception is thrown again at the end.
void ForAll(std::size_t count, int threads, const std::function<void(std::size_t)>& work,
            const Progress& progress = {});

}  // namespace elastocal
