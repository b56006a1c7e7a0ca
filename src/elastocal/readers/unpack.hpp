// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace elastocal {

// Unpack what was packed as a whole, piece by piece, so that memory is taken for what comes out and
// not for what a file claims. False for data that are damaged, end early, or unpack to more than
// `most` bytes.

bool UnpackLz4(std::span<const char> packed, std::size_t most, std::vector<char>& unpacked);
bool UnpackZstd(std::span<const char> packed, std::size_t most, std::vector<char>& unpacked);
bool UnpackBz2(std::span<const char> packed, std::size_t most, std::vector<char>& unpacked);

}  // namespace elastocal
