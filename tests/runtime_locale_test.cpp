// SPDX-License-Identifier: Apache-2.0
// Files of the run-time library in processes whose locale writes numbers otherwise.
#include <clocale>
#include <cstdio>
#include <cstdlib>
#include <locale>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "elastocal/runtime/c_header.hpp"
#include "elastocal/runtime/compensator.hpp"
#include "tests/elastic_arm.hpp"
#include "tests/scratch_folder.hpp"

namespace elastocal {
namespace {

std::string Written() {
  std::ostringstream out;
  WriteRuntimeModel(ElasticArm(), out);
  return out.str();
}

std::string Header() { return MakeCHeader(ElasticArm(), {.prefix = "arm", .heading = "arm"}); }

/// Takes the locale de_DE for functions of C, which an installed one or a new one gives.
class GermanNumbers {
 public:
  GermanNumbers() {
    for (const char* name : {"de_DE.UTF-8", "de_DE.utf8", "de_DE"}) {
      if (Set(name)) return;
    }
    const std::string folder = scratch_.path().string();
    const std::string make =
        "localedef -i de_DE -f UTF-8 " + folder + "/de_DE.UTF-8 2>" + folder + "/said >&2";
    if (std::system(make.c_str()) > 1 << 8) return;  // 1: warnings
    setenv("LOCPATH", folder.c_str(), 1);
    Set("de_DE.UTF-8");
    unsetenv("LOCPATH");
  }
  ~GermanNumbers() { std::setlocale(LC_ALL, "C"); }
  GermanNumbers(const GermanNumbers&) = delete;
  GermanNumbers& operator=(const GermanNumbers&) = delete;

  bool has_commas() const { return has_commas_; }

 private:
  bool Set(const char* name) {
    char text[8];
    if (std::setlocale(LC_ALL, name) == nullptr) return false;
    std::snprintf(text, sizeof text, "%.1f", 0.5);
    has_commas_ = text[1] == ',';
    return has_commas_;
  }

  ScratchFolder scratch_;
  bool has_commas_ = false;
};

TEST(RuntimeLocale, FilesAreTheSameWithTheCommasOfC) {
  const std::string written = Written(), header = Header();
  std::string in_german, header_in_german, written_again;
  {
    const GermanNumbers german;
    if (!german.has_commas()) GTEST_SKIP() << "neither the locale de_DE nor localedef is here";
    in_german = Written();
    header_in_german = Header();
    std::istringstream in(written);
    std::ostringstream out;
    WriteRuntimeModel(ReadRuntimeModel(in, "model"), out);
    written_again = out.str();
  }
  EXPECT_EQ(in_german, written);
  EXPECT_EQ(header_in_german, header);
  EXPECT_EQ(written_again, written);
}

/// Decimal commas and points between every two digits.
class Separators : public std::numpunct<char> {
 protected:
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\1"; }
};

TEST(RuntimeLocale, FilesAreTheSameWithTheSeparatorsOfStreams) {
  const std::string written = Written(), header = Header();
  const std::locale before = std::locale::global(std::locale(std::locale(), new Separators));
  std::ostringstream shown;
  shown << 1234.5;
  const std::string there = Written(), header_there = Header();
  std::istringstream in(written);
  std::ostringstream out;
  WriteRuntimeModel(ReadRuntimeModel(in, "model"), out);
  std::locale::global(before);
  EXPECT_EQ(shown.str(), "1.2.3.4,5");
  EXPECT_EQ(there, written);
  EXPECT_EQ(header_there, header);
  EXPECT_EQ(out.str(), written);
}

}  // namespace
}  // namespace elastocal
