// SPDX-License-Identifier: Apache-2.0
#include "elastocal/fleet/manifest.hpp"

#include <gtest/gtest.h>

#include "tests/expect_input_error.hpp"
#include "tests/scratch_folder.hpp"

namespace elastocal {
namespace {

std::vector<FleetTask> Read(const std::string& text) {
  const ScratchFolder scratch;
  return ReadManifest(scratch.Write("fleet.yaml", text), "out");
}

TEST(Manifest, SessionsAreCalibrations) {
  const ScratchFolder scratch;
  const auto tasks = ReadManifest(scratch.Write("fleet.yaml", R"(
project: p.yaml
calibrate: {kfold: 0}
sessions:
  - {name: a_1, robot: a, batch: x, day: 12.5, recording: [r1, r2], calibrate: {prior: base}}
  - {name: b, recording: t.csv, project: other.yaml}
)"),
                                  "out");
  ASSERT_EQ(tasks.size(), 2u);
  EXPECT_EQ(tasks[0].robot, "a");
  EXPECT_EQ(tasks[0].day, 12.5);
  const std::string here = scratch.path().string() + "/";
  EXPECT_EQ(tasks[0].commands,
            (std::vector<std::vector<std::string>>{
                {"calibrate", here + "p.yaml", "--recording", here + "r1", here + "r2", "-o",
                 "out/a_1", "--threads", "1", "--kfold", "0", "--prior", here + "base"}}));
  EXPECT_EQ(tasks[1].robot, "b");
  EXPECT_EQ(tasks[1].project, here + "other.yaml");
}

TEST(Manifest, DaysMayBeDates) {
  const auto read = [](const std::string& first, const std::string& second) {
    return Read("project: p.yaml\nsessions:\n  - {name: a, recording: r, day: " + first +
                "}\n  - {name: b, recording: r, day: " + second + "}\n");
  };
  const auto tasks = read("2024-02-28", "2024-03-01");
  EXPECT_EQ(tasks[0].day, 19781.0);
  EXPECT_EQ(tasks[1].day, 19783.0);  // 2024 is a leap year
  ExpectInputError([&] { read("2023-02-28", "2023-02-29"); }, {"day", "a day of the calendar"});
  ExpectInputError([&] { read("2023-02-28", "12"); }, {"day", "a date, as the sessions above"});
  ExpectInputError([&] { read("12", "2023-02-28"); }, {"day", "a number of days, as"});
  ExpectInputError([&] { read("12", "monday"); }, {"'monday'", "or a date like 2026-03-31"});
}

TEST(Manifest, StudiesAreRobotsTimesSettings) {
  const auto tasks = Read(R"(
project: p.yaml
studies:
  - name: s
    robots: 3
    first: 10
    simulate: {arm-postures: 8, matched: true}
    settings: [{name: few, simulate: {leg-postures: 4}}, {name: many}]
)");
  ASSERT_EQ(tasks.size(), 6u);
  EXPECT_EQ(tasks[2].name, "s_11_few");
  EXPECT_EQ(tasks[2].robot, "s_11");
  ASSERT_EQ(tasks[2].commands.size(), 2u);
  const std::vector<std::string>& simulate = tasks[2].commands[0];
  EXPECT_EQ(simulate[0], "simulate");
  const std::vector<std::string> end(simulate.end() - 5, simulate.end());
  EXPECT_EQ(end,
            (std::vector<std::string>{"--arm-postures", "8", "--matched", "--leg-postures", "4"}));
  EXPECT_EQ(tasks[2].leftovers.size(), 1u);
}

TEST(Manifest, WrongOnesAreRefusedWithThePlace) {
  ExpectInputError([] { Read("project: p.yaml\n"); }, {"fleet.yaml", "no task"});
  ExpectInputError([] { Read("projet: p.yaml\n"); }, {"fleet.yaml:1", "'projet'", "project"});
  ExpectInputError([] { Read("sessions: [{name: a, recording: r}]\n"); },
                   {"fleet.yaml:1", "project"});
  ExpectInputError([] { Read("project: p\nsessions:\n  - {name: ../a, recording: r}\n"); },
                   {"fleet.yaml:3", "sessions[0].name", "'../a'"});
  ExpectInputError(
      [] {
        Read("project: p\nsessions:\n  - {name: a, recording: r}\n  - {name: a, recording: s}\n");
      },
      {"two tasks", "'a'"});
  ExpectInputError([] { Read("project: p\nstudies: [{name: s, robots: 0}]\n"); },
                   {"fleet.yaml:2", "robots"});
  ExpectInputError(
      [] { Read("project: p\ncalibrate: {output: x}\nsessions: [{name: a, recording: r}]\n"); },
      {"fleet.yaml:2", "output"});
}

}  // namespace
}  // namespace elastocal
