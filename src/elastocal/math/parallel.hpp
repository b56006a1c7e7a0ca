// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

#include "elastocal/math/progress.hpp"

namespace elastocal {

/// Does work(0) to work(count - 1) on up to `threads` threads, of which the caller's is one, in no
/// certain order. Progress counts finished work. If a piece of work or an InterruptionPoint of the
/// caller throws, no further work is begun, and the exception is thrown again once all threads have
/// ended.
void ForAll(std::size_t count, int threads, const std::function<void(std::size_t)>& work,
            const Progress& progress = {});

}  // namespace elastocal
