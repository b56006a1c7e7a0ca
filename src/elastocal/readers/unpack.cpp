// SPDX-License-Identifier: Apache-2.0
#include "elastocal/readers/unpack.hpp"

#include <memory>

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

namespace elastocal {
namespace {

constexpr std::size_t kPiece = 1u << 18;

}  // namespace

bool UnpackLz4(std::span<const char> packed, std::size_t most, std::vector<char>& unpacked) {
  unpacked.clear();
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION))) return false;
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> owner(
      context, LZ4F_freeDecompressionContext);
  std::size_t hint = 1;
  while (hint != 0 && unpacked.size() <= most) {
    const std::size_t held = unpacked.size();
    unpacked.resize(held + kPiece);
    std::size_t made = kPiece, used = packed.size();
    hint = LZ4F_decompress(context, &unpacked[held], &made, packed.data(), &used, nullptr);
    unpacked.resize(held + made);
    if (LZ4F_isError(hint) || (made == 0 && used == 0 && hint != 0)) return false;
    packed = packed.subspan(used);
  }
  return hint == 0 && packed.empty() && unpacked.size() <= most;
}

bool UnpackZstd(std::span<const char> packed, std::size_t most, std::vector<char>& unpacked) {
  unpacked.clear();
  const std::unique_ptr<ZSTD_DStream, decltype(&ZSTD_freeDStream)> stream(ZSTD_createDStream(),
                                                                          ZSTD_freeDStream);
  if (!stream) return false;
  constexpr int kLargestWindow = 27;  // 128 MiB
  ZSTD_DCtx_setParameter(stream.get(), ZSTD_d_windowLogMax, kLargestWindow);
  ZSTD_inBuffer in{packed.data(), packed.size(), 0};
  std::size_t left = 1;
  while (left != 0 && unpacked.size() <= most) {
    const std::size_t held = unpacked.size(), used = in.pos;
    unpacked.resize(held + kPiece);
    ZSTD_outBuffer out{&unpacked[held], kPiece, 0};
    left = ZSTD_decompressStream(stream.get(), &out, &in);
    unpacked.resize(held + out.pos);
    if (ZSTD_isError(left) || (out.pos == 0 && in.pos == used && left != 0)) return false;
  }
  return left == 0 && in.pos == in.size && unpacked.size() <= most;
}

bool UnpackBz2(std::span<const char> packed, std::size_t most, std::vector<char>& unpacked) {
  unpacked.clear();
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return false;
  const std::unique_ptr<bz_stream, decltype(&BZ2_bzDecompressEnd)> owner(&stream,
                                                                         BZ2_bzDecompressEnd);
  stream.next_in = const_cast<char*>(packed.data());  // bzlib only reads it
  stream.avail_in = static_cast<unsigned>(packed.size());
  int result = BZ_OK;
  while (result == BZ_OK && unpacked.size() <= most) {
    const std::size_t held = unpacked.size();
    unpacked.resize(held + kPiece);
    stream.next_out = &unpacked[held];
    stream.avail_out = static_cast<unsigned>(kPiece);
    const unsigned before = stream.avail_in;
    result = BZ2_bzDecompress(&stream);
    unpacked.resize(held + kPiece - stream.avail_out);
    if (result == BZ_OK && stream.avail_in == before && stream.avail_out == kPiece) return false;
  }
  return result == BZ_STREAM_END && stream.avail_in == 0 && unpacked.size() <= most;
}

}  // namespace elastocal
