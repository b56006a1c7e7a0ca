#pragma once

#include <cstdint>
#include <string_view>

namespace elastocal {

/// Seed of the random numbers drawn for one purpose: what is drawn for one is not changed by how
/// many are drawn for another, so that an option changes its own imperfection only.
std::uint64_t StreamSeed(std::uint64_t seed, std::string_view purpose);

}  // namespace elastocal
