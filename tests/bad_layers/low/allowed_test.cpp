// SPDX-License-Identifier: Apache-2.0
#include "elastocal/low/allowed.hpp"

#include "tests/test_files.hpp"
