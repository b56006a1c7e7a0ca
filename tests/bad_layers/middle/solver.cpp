#include <IpTNLP.hpp>

#include "elastocal/low/upwards.hpp"
