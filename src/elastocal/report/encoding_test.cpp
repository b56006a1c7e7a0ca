// SPDX-License-Identifier: Apache-2.0
#include "elastocal/report/encoding.hpp"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace elastocal {
namespace {

// These are NIST's examples.
TEST(Encoding, Sha256) {
  EXPECT_EQ(Sha256(""), "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(Sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  EXPECT_EQ(Sha256("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq"),
            "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
  EXPECT_EQ(Sha256(std::string(1000000, 'a')),
            "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
  EXPECT_EQ(Sha256(std::string(55, 'a')),
            "9f4390f8d30c2dd92ec9f095b65e2b9ae9b0a925a5258e241c9f1e910f734318");
  EXPECT_EQ(Sha256(std::string(56, 'a')),
            "b35439a4ac6f0948b6d6f9e3c6af0f5f590ce20f1bde7090ef7970686ec6738a");
  EXPECT_EQ(Sha256(std::string(64, 'a')),
            "ffe054fe7ae0cb6dc65c3af9b61d5209f439851db43d0ba5997337df154668eb");
}

// These are the examples of RFC 4648, section 10.
TEST(Encoding, Base64) {
  EXPECT_EQ(Base64(""), "");
  EXPECT_EQ(Base64("f"), "Zg==");
  EXPECT_EQ(Base64("fo"), "Zm8=");
  EXPECT_EQ(Base64("foobar"), "Zm9vYmFy");
}

TEST(Encoding, FloatsAreLittleEndianRowByRow) {
  // In bytes, 1 is 3f800000 and -2 is c0000000.
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
