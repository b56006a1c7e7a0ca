// SPDX-License-Identifier: Apache-2.0
#include "elastocal/report/csv_columns.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/expect_input_error.hpp"

namespace elastocal {
namespace {

TEST(CsvColumns, ReadsNumbersTextsAndGaps) {
  std::size_t rows = 0;
  const auto columns = ReadCsvColumns(
      "a.csv", "t,\"a,\"\"b\",name\r\n0.5,1e3,x\r\n1.5,,y\r\n2.5,nan,z\r\n3.5,inf,\r\n", 10, rows);
  EXPECT_EQ(rows, 4u);
  EXPECT_EQ(columns["t"].dump(), "[0.5,1.5,2.5,3.5]");
  EXPECT_EQ(columns["a,\"b"].dump(), "[1000.0,null,null,null]");
  EXPECT_EQ(columns["name"].dump(), "[\"x\",\"y\",\"z\",\"\"]");
}

TEST(CsvColumns, ThinsEvenlyAndKeepsBothEnds) {
  std::string text = "i\n";
  for (int i = 0; i < 101; ++i) text += std::to_string(i) + "\n";
  std::size_t rows = 0;
  EXPECT_EQ(ReadCsvColumns("a.csv", text, 5, rows)["i"].dump(), "[0.0,25.0,50.0,75.0,100.0]");
  EXPECT_EQ(rows, 101u);
}

TEST(CsvColumns, NamesTheLineOfARowThatIsTooShort) {
  std::size_t rows = 0;
  ExpectInputError([&] { ReadCsvColumns("a.csv", "a,b\n1,2\n3\n", 10, rows); },
                   {"a.csv:3", "1 cells", "2"});
  ExpectInputError([&] { ReadCsvColumns("a.csv", "", 10, rows); }, {"a.csv", "empty"});
}

}  // namespace
}  // namespace elastocal
