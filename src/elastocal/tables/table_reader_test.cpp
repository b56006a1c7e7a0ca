#include <sstream>

#include <gtest/gtest.h>

#include "elastocal/io/table_lines.hpp"
#include "tests/expect_input_error.hpp"

namespace elastocal {
namespace {

using Cells = std::vector<std::string>;

std::vector<Cells> Rows(const std::string& text) {
  std::istringstream stream(text);
  TableLines lines(stream, "t.csv");
  std::vector<Cells> rows;
  for (Cells cells; lines.Next(cells);) rows.push_back(cells);
  return rows;
}

TEST(TableLines, ReadsWhatSpreadsheetsWrite) {
  const std::vector<Cells> expected = {{"a", "b"}, {"1", ""}};
  EXPECT_EQ(Rows("a,b\n1,\n"), expected);
  EXPECT_EQ(Rows("\xEF\xBB\xBF"
                 "a,b\r\n1,\r\n"),
            expected);
  EXPECT_EQ(Rows("a;b\n1;"), expected);
  EXPECT_EQ(Rows(" a\tb \n 1 \t\n\n \n"), expected);
  EXPECT_EQ(Rows("\"a\" , \"b\"\n\"1\",\"\""), expected);
  EXPECT_TRUE(Rows("").empty());
  EXPECT_TRUE(Rows("\n\n").empty());
}

TEST(TableLines, SplitsAtSeparatorsOutsideQuotes) {
  Cells cells;
  EXPECT_TRUE(SplitCells("\"a,\"\"b\"\"\",c\"d,", ',', cells));
  EXPECT_EQ(cells, (Cells{"a,\"b\"", "c\"d", ""}));
  EXPECT_FALSE(SplitCells("\"a", ',', cells));
  EXPECT_FALSE(SplitCells("\"a\"b,c", ',', cells));
}

TEST(TableLines, UsesTheCellsOfTheRowBeforeAgain) {
  const std::vector<Cells> expected = {{"long", "b,c", "d"}, {"1"}, {"", "e"}};
  EXPECT_EQ(Rows("long,\"b,c\",d\n1\n,\"e\"\n"), expected);
}

TEST(TableLines, MakesCellsThatAreReadAgain) {
  for (const std::string text : {"plain name", "a,b", "a;b", "say \"a\""}) {
    Cells cells;
    EXPECT_TRUE(SplitCells(MakeCell(text) + ",x", ',', cells));
    EXPECT_EQ(cells, (Cells{text, "x"}));
  }
}

TEST(TableLines, CountsLines) {
  std::istringstream stream("a\n1\n2");
  TableLines lines(stream, "t.csv");
  Cells cells;
  for (int line = 1; lines.Next(cells); ++line) EXPECT_EQ(lines.line(), line);
}

TEST(TableLines, NamesWhatIsNoTable) {
  ExpectInputError([] { Rows("a,b\n1,\"2\n"); }, {"t.csv:2: ", "quotes"});
  ExpectInputError([] { Rows("a\n1\n\n2\n"); }, {"t.csv:3: ", "empty line"});
  ExpectInputError([] { Rows(std::string("a\n1\n2\0\n", 7)); }, {"t.csv:3: ", "NUL"});
  ExpectInputError([] { Rows("a\n" + std::string((1 << 20) + 1, '0')); }, {"t.csv:2: ", "1 MiB"});
  ExpectInputError([] { Rows(std::string((1 << 24) + 1, '0')); }, {"t.csv:1: ", "1 MiB"});
}

/// libfccp reads blocks of 16 MiB and, for want of a last line end, looks one byte beyond its data.
/// With rows whose length divides a block, that byte is a line end left of an earlier block.
TEST(TableLines, LinesAcrossBlocksAreWhole) {
  const std::string row = "123,123\n";
  std::string text = "a,b    \n";
  const int rows = (3 << 24) / static_cast<int>(row.size()) + 10;
  for (int i = 0; i < rows; ++i) text += row;
  text.pop_back();
  std::istringstream stream(text);
  TableLines lines(stream, "t.csv");
  Cells cells;
  ASSERT_TRUE(lines.Next(cells));
  int count = 0;
  for (; lines.Next(cells); ++count) ASSERT_EQ(cells, (Cells{"123", "123"})) << count;
  EXPECT_EQ(count, rows);
}

}  // namespace
}  // namespace elastocal
