#include "elastocal/high/relative.hpp"
#include "elastocal/low/upwards.hpp"
