// SPDX-License-Identifier: Apache-2.0
#include "elastocal/report/encoding.hpp"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <stdexcept>

#include <openssl/evp.h>
#include <openssl/sha.h>

namespace elastocal {
namespace {

void AppendFloat(double value, std::string& bytes) {
  const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>(value));
  for (unsigned shift = 0; shift < 32; shift += 8)
    bytes += static_cast<char>(bits >> shift & 0xffU);
}

/// Checksum that is computed piece by piece.
class Digest {
 public:
  Digest() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    Require(context_ && EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) == 1);
  }
  void Add(std::string_view bytes) {
    Require(EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()) == 1);
  }
  /// As hexadecimal digits.
  std::string Take() {
    std::array<unsigned char, SHA256_DIGEST_LENGTH> digest;
    Require(EVP_DigestFinal_ex(context_.get(), digest.data(), nullptr) == 1);
    static constexpr char kDigits[] = "0123456789abcdef";
    std::string text;
    for (const unsigned char byte : digest) {
      text += kDigits[byte >> 4U];
      text += kDigits[byte & 0xfU];
    }
    return text;
  }

 private:
  static void Require(bool fine) {
    if (!fine) throw std::runtime_error("OpenSSL cannot compute SHA-256");
  }
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

}  // namespace

std::string Sha256(std::string_view bytes) {
  Digest digest;
  digest.Add(bytes);
  return digest.Take();
}

std::string Sha256(std::istream& stream, std::size_t& count) {
  Digest digest;
  std::string piece(1u << 18, '\0');
  while (stream.read(piece.data(), static_cast<std::streamsize>(piece.size())) ||
         stream.gcount() > 0) {
    const auto read = static_cast<std::size_t>(stream.gcount());
    digest.Add(std::string_view(piece).substr(0, read));
    count += read;
  }
  return digest.Take();
}

std::string Base64(std::string_view bytes) {
  if (bytes.size() > std::numeric_limits<int>::max()) {
    throw std::length_error("more than 2 GiB to encode in base64");
  }
  std::string text((bytes.size() + 2) / 3 * 4 + 1, '\0');  // with the NUL that OpenSSL appends
  EVP_EncodeBlock(reinterpret_cast<unsigned char*>(text.data()),
                  reinterpret_cast<const unsigned char*>(bytes.data()),
                  static_cast<int>(bytes.size()));
  text.pop_back();
  return text;
}

std::string Base64Floats(const std::vector<double>& values) {
  std::string bytes;
  bytes.reserve(4 * values.size());
  for (const double value : values) AppendFloat(value, bytes);
  return Base64(bytes);
}

std::string Base64Floats(const Eigen::MatrixXd& values) {
  std::string bytes;
  bytes.reserve(static_cast<std::size_t>(4 * values.size()));
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    for (Eigen::Index j = 0; j < values.cols(); ++j) AppendFloat(values(i, j), bytes);
  }
  return Base64(bytes);
}

double Rounded(double value, int digits) {
  if (value == 0.0 || !std::isfinite(value)) return value;
  const double scale = std::pow(10.0, digits - 1 - std::floor(std::log10(std::abs(value))));
  return std::isfinite(scale) ? std::round(value * scale) / scale : value;
}

}  // namespace elastocal
