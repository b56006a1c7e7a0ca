// SPDX-License-Identifier: Apache-2.0
#include "elastocal/simulation/stream_seed.hpp"

namespace elastocal {

std::uint64_t StreamSeed(std::uint64_t seed, std::string_view purpose) {
  // FNV-1a over the purpose, then the finaliser of splitmix64, which separates seeds that are close
  // to each other.
  std::uint64_t hash = 0xcbf29ce484222325u ^ (seed * 0x9e3779b97f4a7c15u);
  for (const char character : purpose) {
    hash = (hash ^ static_cast<unsigned char>(character)) * 0x100000001b3u;
  }
  hash = (hash ^ (hash >> 30)) * 0xbf58476d1ce4e5b9u;
  hash = (hash ^ (hash >> 27)) * 0x94d049bb133111ebu;
  return hash ^ (hash >> 31);
}

}  // namespace elastocal
