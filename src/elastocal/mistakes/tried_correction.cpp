// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/tried_correction.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "elastocal/math/input_error.hpp"
#include "elastocal/mistakes/column_order.hpp"
#include "elastocal/mistakes/log_alternatives.hpp"
#include "elastocal/mistakes/suspected_signs.hpp"
#include "elastocal/recorded/recorded_model.hpp"
#include "elastocal/screening/label_check.hpp"
#include "elastocal/screening/row_shift.hpp"
#include "elastocal/screening/table_check.hpp"

namespace elastocal {
namespace {

std::string NameOf(const LabelSuspicion& suspicion) {
  return "labels:" + std::min(suspicion.a, suspicion.b) + "," + std::max(suspicion.a, suspicion.b);
}

/// Whether a sign is reversed in some trials but not shown by all. Columns are assigned once, so
/// that it may also be reversed in the others, where the joint hardly moves or moves about zero.
bool IsOfSomeTrials(const LogSuspicion& one, const Recording& recording) {
  return one.kind == LogContradiction::kSign && one.linkage < 0 && !recording.trials.empty() &&
         std::ssize(one.postures) < recording.posture_count();
}

}  // namespace

double MostLeft(const RobotTree& tree) {
  constexpr double kExplained = 0.02;
  constexpr double kExplainedShare = 0.008;
  return std::min(kExplained, kExplainedShare * RobotSize(tree));
}

ErrorModel NominalModel(const Project& project, const Recording& recording) {
  return SelectMarkers(MakeProjectModel(project, recording.trials), recording.marker_names);
}

TriedCorrection Undone(const LogSuspicion& one, const RobotTree& tree, const Recording& recording) {
  return {NameOf(one, tree), DescribeSuspicion(one, tree, recording),
          WithoutMistake(recording, one, tree),
          one.kind == LogContradiction::kFrozen ? one.postures : std::vector<int>(),
          one.kind == LogContradiction::kFrozen};
}

void AddUndone(const LogSuspicion& one, const RobotTree& tree, const Recording& recording,
               std::vector<TriedCorrection>& tried) {
  try {
    TriedCorrection undone = Undone(one, tree, recording);
    const bool known = std::ranges::any_of(tried, [&](const TriedCorrection& before) {
      return before.name == undone.name && before.what == undone.what;
    });
    if (!known) tried.push_back(std::move(undone));
  } catch (const InputError&) {
  }
}

std::vector<TriedCorrection> Suspicions(const Project& project, const ErrorModel& nominal,
                                        const Recording& recording, std::size_t most,
                                        SuspicionsOf which) {
  const bool all = which == SuspicionsOf::kAll;
  const std::vector<LabelCluster> clusters = SeenClusters(project, recording);
  TableSuspicions suspicions = FindTableSuspicions(nominal, recording, clusters);
  if (!recording.trials.empty()) {
    suspicions = {FindLogSuspicions(nominal, recording),
                  FindLabelSuspicions(nominal, recording, clusters)};
  }
  std::vector<TriedCorrection> tried;
  for (const LabelSuspicion& one : suspicions.labels) {
    if (tried.size() >= most) break;
    tried.push_back(
        {NameOf(one), DescribeSuspicion(one, recording), WithoutExchange(recording, one)});
  }
  std::size_t frozen = 0, others = 0;
  for (const LogSuspicion& one : suspicions.log) {
    std::size_t& used = one.kind == LogContradiction::kFrozen ? frozen : others;
    if (used++ >= most) continue;
    AddUndone(one, project.tree, recording, tried);
    if (all && IsOfSomeTrials(one, recording)) {
      AddUndone(SignOf(one.coordinate, recording), project.tree, recording, tried);
    }
  }
  if (all) {
    std::vector<TriedCorrection> orders = FindColumnOrders(nominal, recording);
    std::move(orders.begin(), orders.end(), std::back_inserter(tried));
  }
  if (const std::optional<RowShift> shift = FindRowShift(nominal, recording)) {
    tried.push_back({fmt::format("rows:{:+d}", shift->rows), DescribeShift(*shift, recording),
                     WithoutShift(recording, *shift), WithoutPartner(*shift, recording)});
  }
  if (all && !recording.trials.empty() &&
      LooksMirrored(nominal, recording, MostLeft(project.tree))) {
    tried.insert(tried.begin(), {"", kLeftHanded, Mirrored(recording)});
  }
  return tried;
}

}  // namespace elastocal
