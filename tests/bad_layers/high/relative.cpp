// SPDX-License-Identifier: Apache-2.0
#include "relative.hpp"

#include "elastocal/low/transitive_and_allowed.hpp"
#include "elastocal/unknown/header.hpp"
