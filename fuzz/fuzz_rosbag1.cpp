// SPDX-License-Identifier: Apache-2.0
#include "fuzz/fuzz_recording.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  return FuzzRecording(data, size, elastocal::ReadRosbag1);
}
