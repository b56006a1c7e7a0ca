// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>
#include <set>
#include <utility>

#include "elastocal/math/input_error.hpp"
#include "elastocal/mistakes/recording_mistakes.hpp"
#include "elastocal/mistakes/stated_corrections.hpp"
#include "elastocal/mistakes/tried_correction.hpp"
#include "elastocal/screening/log_check.hpp"

namespace elastocal {
namespace {

constexpr std::size_t kMostUndone = 100;  // mistakes that AcceptMistakes corrects in a recording

/// Mistakes with these names in a table, since the nominal robot does not show all of them.
std::vector<TriedCorrection> NamedOfTable(const std::vector<std::string>& names,
                                          const Recording& recording, const RobotTree& tree) {
  std::vector<TriedCorrection> named;
  for (const LogSuspicion& one : PossibleLogMistakes(recording, tree)) {
    const bool wanted = std::find(names.begin(), names.end(), NameOf(one, tree)) != names.end();
    if (wanted) AddUndone(one, tree, recording, named);
  }
  return named;
}

/// Makes the corrections that the user accepts, in the recordings that show the mistakes.
class Acceptance {
 public:
  /// `told` are names that the clocks of trials have shown.
  Acceptance(const Project& project, const std::vector<std::string>& names,
             const std::set<std::string>& told)
      : project_(project), names_(names), told_(told), shown_(told) {}

  void Undo(Recording& recording, std::vector<std::optional<Transform>>& truth) {
    if (recording.posture_count() == 0) return;
    const ErrorModel nominal = NominalModel(project_, recording);
    std::set<std::string> done;  // completely corrected: what is left of them was correct
    for (const std::string& name : told_) {
      if (UndoInTrials(nominal, name, recording)) done.insert(name);
    }
    for (std::size_t round = 0; round < kMostUndone; ++round) {
      const std::optional<TriedCorrection> next = Next(nominal, recording, done);
      if (!next) return;
      if (UndoInTrials(nominal, next->name, recording)) {
        done.insert(next->name);
        told_.insert(next->name);
        continue;
      }
      undone_.push_back(next->what);
      if (!truth.empty()) {
        std::for_each(next->left_out.rbegin(), next->left_out.rend(),
                      [&](int posture) { truth.erase(truth.begin() + posture); });
      }
      recording = next->corrected;
    }
  }

  /// Names that the recordings have shown (a table need not show them), and descriptions of the
  /// corrections.
  const std::set<std::string>& shown() const { return shown_; }
  const std::vector<std::string>& undone() const { return undone_; }

 private:
  bool IsWanted(const std::string& name) const {
    return std::find(names_.begin(), names_.end(), name) != names_.end();
  }

  /// The next named mistake that the recording shows or, in a table, that it need not show.
  std::optional<TriedCorrection> Next(const ErrorModel& nominal, const Recording& recording,
                                      std::set<std::string>& done) {
    std::optional<TriedCorrection> next;
    for (TriedCorrection& one :
         Suspicions(project_, nominal, recording, kMostUndone, SuspicionsOf::kNamed)) {
      shown_.insert(one.name);
      if (!next && IsWanted(one.name) && !done.contains(one.name)) next = std::move(one);
    }
    if (next) return next;
    for (TriedCorrection& one : NamedOfTable(names_, recording, project_.tree)) {
      const bool of_this = !shown_.contains(one.name) || named_.contains(one.name);
      if (!of_this || !done.insert(one.name).second) continue;
      named_.insert(one.name);
      shown_.insert(one.name);
      return std::move(one);
    }
    return std::nullopt;
  }

  /// Corrects a sign or an exchange in all trials but those that would then show it, because the
  /// logging program assigns columns once.
  /// Returns whether it did; not in a table, nor where rods would not close.
  bool UndoInTrials(const ErrorModel& nominal, const std::string& name, Recording& recording) {
    if (recording.trials.empty()) return false;
    Recording as_table = recording;
    as_table.trials.clear();
    as_table.q.row(0).array() += 1.0;  // so that joints that stand still here are possible, too
    for (LogSuspicion& one : PossibleLogMistakes(as_table, project_.tree)) {
      if (NameOf(one, project_.tree) != name) continue;
      try {
        const Recording in_all = WithoutMistake(recording, one, project_.tree);
        for (const LogSuspicion& other : FindLogSuspicions(nominal, in_all)) {
          if (NameOf(other, project_.tree) == name) Remove(other.postures, one.postures);
        }
        recording = WithoutMistake(recording, one, project_.tree);
      } catch (const InputError&) {
        return false;
      }
      if (one.postures.empty()) return false;
      undone_.push_back(DescribeSuspicion(one, project_.tree, recording));
      return true;
    }
    return false;
  }

  static void Remove(const std::vector<int>& removed, std::vector<int>& ascending) {
    std::erase_if(ascending, [&](int posture) {
      return std::binary_search(removed.begin(), removed.end(), posture);
    });
  }

  const Project& project_;
  const std::vector<std::string>& names_;
  std::set<std::string> told_;
  std::set<std::string> shown_;
  std::set<std::string> named_;  // names that no recording shows
  std::vector<std::string> undone_;
};

/// Undoes mistakes whose names have no size.
std::vector<std::string> UndoNamed(const Project& project, const std::vector<std::string>& names,
                                   Measurements& measured) {
  std::set<std::string> told;
  for (const TrialSummary& trial : measured.trials) {
    told.insert(trial.clock_without.begin(), trial.clock_without.end());
  }
  Acceptance acceptance(project, names, told);
  acceptance.Undo(measured.calibration, measured.calibration_truth);
  acceptance.Undo(measured.validation, measured.validation_truth);
  for (const std::string& name : names) {
    if (!acceptance.shown().contains(name)) RefuseAccepted(name, acceptance.shown());
  }
  return acceptance.undone();
}

}  // namespace

std::vector<std::string> AcceptMistakes(const Project& project,
                                        const std::vector<std::string>& accepted,
                                        Measurements& measured) {
  std::vector<std::string> undone;
  std::vector<std::string> names;  // names of mistakes that the recording must show
  std::vector<StatedCorrection> stated;
  for (const std::string& name : accepted) {
    if (const auto one = ParseStatedCorrection(name, project.tree)) {
      stated.push_back(*one);
    } else {
      names.push_back(name);
    }
  }
  if (!names.empty()) undone = UndoNamed(project, names, measured);
  // Their sizes and numbers of postures were told without the mistakes that have none.
  for (const StatedCorrection& one : stated) {
    undone.push_back(ApplyCorrection(one, project.tree, measured));
  }
  return undone;
}

}  // namespace elastocal
