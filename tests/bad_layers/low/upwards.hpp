// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/low/allowed.hpp"
// #include "elastocal/high/in_a_comment.hpp"
#include "elastocal/middle/allowed.hpp"
