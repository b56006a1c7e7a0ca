// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace elastocal {

// Unpack data piece by piece. Memory grows with the unpacked data (at most one piece of 256 KiB
// beyond `most` bytes, where they stop) and not with the size that the file claims. Return false
// for data that are damaged or end early.

bool UnpackLz4(std::span<const char> packed, std::size_t most, std::vector<char>& unpacked);
bool UnpackZstd(std::span<const char> packed, std::size_t most, std::vector<char>& unpacked);
bool UnpackBz2(std::span<const char> packed, std::size_t most, std::vector<char>& unpacked);

}  // namespace elastocal
