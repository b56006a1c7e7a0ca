// SPDX-License-Identifier: Apache-2.0
#include <IpTNLP.hpp>

#include "elastocal/low/upwards.hpp"
