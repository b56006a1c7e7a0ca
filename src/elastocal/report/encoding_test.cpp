#include "elastocal/report/encoding.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace elastocal {
namespace {

// The examples of RFC 4648, section 10.
TEST(Encoding, Base64) {
  EXPECT_EQ(Base64(""), "");
  EXPECT_EQ(Base64("f"), "Zg==");
  EXPECT_EQ(Base64("fo"), "Zm8=");
  EXPECT_EQ(Base64("foobar"), "Zm9vYmFy");
}

TEST(Encoding, FloatsAreLittleEndianRowByRow) {
  // 1 is 3f800000, -2 is c0000000.
  EXPECT_EQ(Base64Floats(std::vector<double>{1.0, -2.0}),
            Base64(std::string("\0\0\x80\x3f\0\0\0\xc0", 8)));
  Eigen::MatrixXd matrix(2, 2);
  matrix << 1, 2, 3, 4;
  EXPECT_EQ(Base64Floats(matrix), Base64Floats(std::vector<double>{1, 2, 3, 4}));
}

TEST(Encoding, RoundsToSignificantDigits) {
  EXPECT_EQ(Rounded(1234567.0, 3), 1230000.0);
  EXPECT_DOUBLE_EQ(Rounded(-0.00123456, 4), -0.001235);
  EXPECT_EQ(Rounded(0.0), 0.0);
  EXPECT_TRUE(std::isnan(Rounded(std::numeric_limits<double>::quiet_NaN())));
}

}  // namespace
}  // namespace elastocal
