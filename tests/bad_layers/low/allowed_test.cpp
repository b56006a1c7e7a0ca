#include "elastocal/low/allowed.hpp"

#include "tests/test_files.hpp"
