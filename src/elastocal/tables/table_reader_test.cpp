// SPDX-License-Identifier: Apache-2.0
#include "elastocal/tables/table_reader.hpp"

#include <sstream>

#include <gtest/gtest.h>

#include "elastocal/tables/table_writer.hpp"
#include "tests/expect_input_error.hpp"

namespace elastocal {
namespace {

using Cells = std::vector<std::string>;

/// The header and all rows.
std::vector<Cells> Rows(const std::string& text) {
  std::istringstream stream(text);
  Table table(stream, "t.csv");
  std::vector<Cells> rows = {table.header()};
  while (table.Next()) {
    Cells& cells = rows.emplace_back();
    for (std::size_t c = 0; c < table.header().size(); ++c) {
      cells.emplace_back(table.Cell(static_cast<int>(c)));
    }
  }
  return rows;
}

/// Cells of a line; empty if the line cannot be split.
Cells Split(std::string line, char separator = ',', Quotes quotes = Quotes::kEnclose) {
  std::vector<std::string_view> cells;
  if (!SplitCells(line, separator, quotes, cells)) return {};
  return {cells.begin(), cells.end()};
}

TEST(Table, ReadsWhatSpreadsheetsWrite) {
  const std::vector<Cells> expected = {{"a", "b"}, {"1", ""}};
  EXPECT_EQ(Rows("a,b\n1,\n"), expected);
  EXPECT_EQ(Rows("\xEF\xBB\xBF"
                 "a,b\r\n1,\r\n"),
            expected);
  EXPECT_EQ(Rows("a,b\r1,\r"), expected);
  EXPECT_EQ(Rows("a,b\r1,"), expected);
  EXPECT_EQ(Rows("a;b\n1;"), expected);
  EXPECT_EQ(Rows(" a\tb \n 1 \t\n\n \n"), expected);
  EXPECT_EQ(Rows("\"a\" , \"b\"\n\"1\",\"\""), expected);
}

TEST(Table, SplitsAtSeparatorsOutsideQuotes) {
  EXPECT_EQ(Split("\"a,\"\"b\"\"\",c\"d,"), (Cells{"a,\"b\"", "c\"d", ""}));
  EXPECT_EQ(Split(" \"a\" ,b"), (Cells{"a", "b"}));
  EXPECT_EQ(Split("\"a\"\"\",\"\"\"\""), (Cells{"a\"", "\""}));
  EXPECT_EQ(Split(""), (Cells{""}));
  EXPECT_EQ(Split("\"a"), Cells());
  EXPECT_EQ(Split("\"a\"b,c"), Cells());
  EXPECT_EQ(Split("\"a\t\"b", '\t', Quotes::kOrdinary), (Cells{"\"a", "\"b"}));
}

TEST(Table, SeparatorsInNamesAreNotCounted) {
  EXPECT_EQ(Rows("\"a;b;c\",d\n1,2\n"), (std::vector<Cells>{{"a;b;c", "d"}, {"1", "2"}}));
}

TEST(Table, EmptyLinesAboveTheFirstRowArePassedOver) {
  EXPECT_EQ(Rows("\n \na,b\n\n\n1,2\n"), (std::vector<Cells>{{"a", "b"}, {"1", "2"}}));
}

TEST(Table, NamesWhatIsNoTable) {
  ExpectInputError([] { Rows(""); }, {"t.csv", "is empty"});
  ExpectInputError([] { Rows("\n\n"); }, {"t.csv", "is empty"});
  ExpectInputError([] { Rows("a,b\n1,\"2\n"); }, {"t.csv:2: ", "quotes"});
  ExpectInputError([] { Rows("a\n1\n\n2\n"); }, {"t.csv:3: ", "empty line"});
  ExpectInputError([] { Rows("a,b\n1\n"); }, {"t.csv:2: ", "1 cells", "2"});
  ExpectInputError([] { Rows(std::string("a\n1\n2\0\n", 7)); }, {"t.csv:3: ", "NUL"});
  ExpectInputError([] { Rows("a\n" + std::string((1 << 20) + 1, '0')); }, {"t.csv:2: ", "1 MiB"});
  ExpectInputError([] { Rows(std::string((1 << 24) + 1, '0')); }, {"t.csv:1: ", "1 MiB"});
  EXPECT_EQ(Rows("a\n" + std::string(1 << 20, '0')).size(), 2u);
}

/// Lines of all lengths from 0 to 40, some of them quoted, over many blocks of the reader.
TEST(Table, LinesAcrossBlocksAreWhole) {
  for (const std::string end : {"\n", "\r\n", "\r"}) {
    std::string text = "a,b" + end;
    std::vector<Cells> expected = {{"a", "b"}};
    for (int i = 0; i < 20000; ++i) {
      const std::string cell = std::string(static_cast<std::size_t>(i % 41), 'x') + "\"y";
      expected.push_back({cell, std::to_string(i)});
      text += MakeCell(cell) + "," + std::to_string(i) + end;
    }
    EXPECT_EQ(Rows(text), expected);
    text.resize(text.size() - end.size());
    EXPECT_EQ(Rows(text), expected);
  }
}

TEST(Table, NumbersHaveLineAndColumn) {
  std::istringstream stream("x,y\n0.5,\"1,5\"\n2,\n");
  Table table(stream, "t.csv");
  ASSERT_TRUE(table.Next());
  EXPECT_EQ(table.Number(0), 0.5);
  ExpectInputError([&] { table.Number(1); }, {"t.csv:2: column 'y'", "'1,5'", "decimal point"});
  ASSERT_TRUE(table.Next());
  EXPECT_EQ(table.line(), 3);
  EXPECT_EQ(table.row_count(), 2);
  ExpectInputError([&] { table.Number(1); }, {"t.csv:3: column 'y'", "found nothing"});
  EXPECT_FALSE(table.Next());
}

TEST(Table, NumbersMayHaveDecimalCommasWhereNoCommaSeparates) {
  std::istringstream stream("x;y;z\n3;1,5;-2,5e-3\n0,25;1.5;1,000,000\n");
  Table table(stream, "t.csv");
  ASSERT_TRUE(table.Next());
  EXPECT_EQ(table.Number(0), 3.0);
  EXPECT_EQ(table.Number(1), 1.5);
  EXPECT_EQ(table.Number(2), -2.5e-3);
  ASSERT_TRUE(table.Next());
  EXPECT_EQ(table.Number(0), 0.25);
  ExpectInputError([&] { table.Number(1); },
                   {"t.csv:3: column 'y'", "'1.5'", "a decimal comma, as others above"});
  ExpectInputError([&] { table.Number(2); }, {"'1,000,000'"});
}

std::vector<int> Find(const std::string& header) {
  std::istringstream stream(header);
  const ColumnRoles roles = {{"time", 0}, {"t", 0}, {"speed", 1}, {"note", kPassedOver}};
  return FindColumns(Table(stream, "t.csv"), roles, 3, "look it up");
}

TEST(Columns, AreFoundByAnyOfTheirNames) {
  EXPECT_EQ(Find("note,speed,note,t\n"), (std::vector<int>{3, 1, -1}));
  EXPECT_EQ(Find("time"), (std::vector<int>{0, -1, -1}));
}

TEST(Columns, RowNumbersOfPandasArePassedOver) {
  for (const char* name : {"", "Unnamed: 0"}) {
    EXPECT_EQ(Find(std::string(name) + ",speed,t\n"), (std::vector<int>{2, 1, -1}));
    std::istringstream stream(std::string(name) + ",t\n0,0.1\n1.0,0.2\n0.5,0.3\n");
    Table table(stream, "t.csv");
    ASSERT_TRUE(table.Next());
    ASSERT_TRUE(table.Next());
    EXPECT_EQ(table.Number(1), 0.2);
    ExpectInputError([&] { table.Next(); }, {"t.csv:4: the first column has no name", "'0.5'"});
  }
}

TEST(Columns, AreRefusedWhereTheyMeanNothingOrTheSame) {
  ExpectInputError([] { Find("t,sped"); },
                   {"t.csv:1: ", "'sped'", "did you mean 'speed'", "look it up"});
  ExpectInputError([] { Find("t,time"); }, {"'t' and 'time' stand for the same"});
  ExpectInputError([] { Find("t,t"); }, {"'t' comes twice"});
  ExpectInputError([] { Find("t,,speed"); }, {"t.csv:1: empty column name, cell 2"});
  ExpectInputError([] { Find("0.5,speed"); }, {"number '0.5'", "header row"});
}

TEST(Columns, GroupsAreWholeOrAbsent) {
  std::istringstream stream("a,b");
  const Table table(stream, "t.csv");
  const std::vector<std::string> names = {"p", "q"};
  EXPECT_TRUE(HasGroup(table, std::vector<int>{1, 0}, names, "it"));
  EXPECT_FALSE(HasGroup(table, std::vector<int>{-1, -1}, names, "it"));
  ExpectInputError(
      [&] {
        HasGroup(table, std::vector<int>{1, -1}, names, "it");
      },
      {"t.csv:1: ", "the column 'q' of it is missing", "'b'"});
}

TEST(TableWriter, WritesWhatTableReads) {
  TableWriter table;
  const Cells names = {"plain name", "a,b",         "a;b;c;d;e", "say \"a\"",
                       "\"",         " both ends ", "a\tb",      ""};
  for (const std::string& name : names) table.Add(name);
  table.EndRow();
  for (std::size_t i = 0; i + 1 < names.size(); ++i) table.Add(1.0 / 3.0);
  table.AddFixed(2.0 / 3.0, 2);
  table.EndRow();
  const Cells third(names.size() - 1, "0.3333333333333333");
  std::vector<Cells> expected = {names, third};
  expected[1].emplace_back("0.67");
  EXPECT_EQ(Rows(table.text()), expected);
}

TEST(TableWriter, NotANumberIsAGap) {
  TableWriter table;
  table.Add("a");
  table.Add("b");
  table.EndRow();
  table.Add(std::numeric_limits<double>::quiet_NaN());
  table.Add(1.0);
  table.EndRow();
  EXPECT_EQ(table.text(), "a,b\n,1\n");
}

TEST(TableWriter, RefusesLineEndsInNames) {
  ExpectInputError([] { MakeCell("a\nb"); }, {"cannot hold", "'a?b'"});
}

}  // namespace
}  // namespace elastocal
