#pragma once

#include "elastocal/tables/text.hpp"
