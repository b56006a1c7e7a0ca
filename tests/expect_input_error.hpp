// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <initializer_list>
#include <string>

#include <gtest/gtest.h>

#include "elastocal/math/input_error.hpp"

namespace elastocal {

/// Expects `call` to throw an InputError whose message contains all of `parts`.
template <typename Call>
void ExpectInputError(const Call& call, std::initializer_list<std::string> parts) {
  try {
    call();
  } catch (const InputError& error) {
    const std::string message = error.what();
    for (const std::string& part : parts) {
      EXPECT_NE(message.find(part), std::string::npos)
          << "no \"" << part << "\" in \"" << message << "\"";
    }
    return;
  }
  ADD_FAILURE() << "no error, where one was expected to name \"" << *parts.begin() << "\"";
}

}  // namespace elastocal
