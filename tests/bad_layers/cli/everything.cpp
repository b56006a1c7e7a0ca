// SPDX-License-Identifier: Apache-2.0
#include "elastocal/high/relative.hpp"
#include "elastocal/low/upwards.hpp"
