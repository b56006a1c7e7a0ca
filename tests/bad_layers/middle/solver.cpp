#include <IpTNLP.hpp>
#include <ceres/ceres.h>

#include "elastocal/low/upwards.hpp"
