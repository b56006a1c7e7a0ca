// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string_view>

namespace elastocal {

/// Seed of the random numbers for one purpose. Draws for one purpose do not depend on the number of
/// draws for another, so that an option changes only its own imperfection.
std::uint64_t StreamSeed(std::uint64_t seed, std::string_view purpose);

}  // namespace elastocal
