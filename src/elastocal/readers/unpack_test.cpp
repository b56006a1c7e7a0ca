// SPDX-License-Identifier: Apache-2.0
#include "elastocal/readers/unpack.hpp"

#include <string>
#include <vector>

#include <bzlib.h>
#include <gtest/gtest.h>
#include <lz4frame.h>
#include <zstd.h>

namespace elastocal {
namespace {

using Unpack = bool (*)(std::span<const char>, std::size_t, std::vector<char>&);

/// The same text, compressed by one of the packers to some hundred bytes.
struct Packed {
  std::string name, bytes;
  Unpack unpack;
};

std::vector<Packed> PackAll(const std::string& text) {
  std::string zstd(ZSTD_compressBound(text.size()), '\0');
  zstd.resize(ZSTD_compress(zstd.data(), zstd.size(), text.data(), text.size(), 1));
  std::string lz4(LZ4F_compressFrameBound(text.size(), nullptr), '\0');
  lz4.resize(LZ4F_compressFrame(lz4.data(), lz4.size(), text.data(), text.size(), nullptr));
  std::string bz2(text.size() + 1000, '\0'), copy = text;
  auto length = static_cast<unsigned>(bz2.size());
  BZ2_bzBuffToBuffCompress(bz2.data(), &length, copy.data(), static_cast<unsigned>(copy.size()), 1,
                           0, 0);
  bz2.resize(length);
  return {{"zstd", zstd, UnpackZstd}, {"lz4", lz4, UnpackLz4}, {"bz2", bz2, UnpackBz2}};
}

TEST(Unpack, GivesUpWhereMoreComesOutThanIsWanted) {
  const std::string text(1u << 20, 'a');
  for (const Packed& packed : PackAll(text)) {
    std::vector<char> out;
    EXPECT_TRUE(packed.unpack(packed.bytes, text.size(), out)) << packed.name;
    EXPECT_EQ(std::string(out.begin(), out.end()), text) << packed.name;
    for (const std::size_t most : {std::size_t{1000}, text.size() / 2, text.size() - 1}) {
      EXPECT_FALSE(packed.unpack(packed.bytes, most, out)) << packed.name << " " << most;
      EXPECT_LE(out.size(), most + (1u << 18)) << packed.name;
    }
  }
}

TEST(Unpack, RefusesWhatEndsEarlyAndWhatGoesOn) {
  const std::string text = "short";
  for (const Packed& packed : PackAll(text)) {
    std::vector<char> out;
    const std::string cut = packed.bytes.substr(0, packed.bytes.size() - 1);
    EXPECT_FALSE(packed.unpack(cut, 1000, out)) << packed.name;
    EXPECT_FALSE(packed.unpack(packed.bytes + "x", 1000, out)) << packed.name;
  }
}

}  // namespace
}  // namespace elastocal
