// SPDX-License-Identifier: Apache-2.0
#include "elastocal/measurement/trial_summary.hpp"

#include <algorithm>
#include <cstdarg>
#include <cstdio>

#include "elastocal/math/input_error.hpp"

namespace elastocal {
namespace {

constexpr double kLostLong = 0.1;  // share of a trial from which on a lost marker is reported
constexpr double kOffLong = 0.01;  // the same, for outliers
constexpr double kUnlogged = 0.1;  // the same, for a log to be too short

std::string Format(const char* pattern, ...) __attribute__((format(printf, 1, 2)));

std::string Format(const char* pattern, ...) {
  char text[512];
  va_list values;
  va_start(values, pattern);
  std::vsnprintf(text, sizeof(text), pattern, values);
  va_end(values);
  return text;
}

std::string Join(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 8;
  std::string text;
  for (std::size_t i = 0; i < std::min(names.size(), kMost); ++i) {
    text += (i == 0 ? "" : ", ") + names[i];
  }
  if (names.size() > kMost) text += Format(" and %zu more", names.size() - kMost);
  return text;
}

// The findings of one trial as sentences.
class Finder {
 public:
  explicit Finder(const TrialSummary& summary) : summary_(summary) {}

  std::vector<std::string> Find() {
    if (!summary_.refused.empty()) Add("not used: " + summary_.refused);
    for (const BadTorqueSensor& bad : summary_.bad_torque_sensors) {
      Add("the torque sensor of " + bad.joint + " is " + Describe(bad.finding) +
          "; its torques are not used");
    }
    if (!summary_.torques_missing.empty()) {
      Add("no torques were logged for " + Join(summary_.torques_missing));
    }
    for (const ClusterLabels& labels : summary_.labels) AddLabels(labels);
    AddOutliers();
    if (!summary_.markers_missing.empty()) {
      Add("never seen: " + Join(summary_.markers_missing) + Misspelt());
    }
    if (summary_.reference_missing) {
      Add("no reference length of the project is seen; the scale of the cameras is not checked");
    }
    for (std::size_t m = 0; m < summary_.smoothing.size(); ++m) AddLostMarker(m);
    AddLog();
    return findings_;
  }

 private:
  void Add(const std::string& text) {
    findings_.push_back("trial " + summary_.trial.name + ": " + text);
  }

  double Seconds(int frames) const { return frames / summary_.rate_hz; }

  void AddLabels(const ClusterLabels& labels) {
    for (const SwappedLabels& swap : labels.swaps) {
      std::vector<std::string> names;
      for (std::size_t i = 0; i < swap.permutation.size(); ++i) {
        if (swap.permutation[i] != static_cast<int>(i)) {
          names.push_back(summary_.markers[labels.markers[i]]);
        }
      }
      Add(Format("the labels of %s were exchanged from %.2f s to %.2f s; corrected",
                 Join(names).c_str(), Seconds(swap.frames.begin), Seconds(swap.frames.end)));
    }
    if (!labels.undecided.empty()) {
      Add(
          Format("labels of cluster %s look exchanged in %d frames, but its distances are too much "
                 "alike to correct them; removed there",
                 labels.name.c_str(), FrameCount(labels.undecided)));
    }
  }

  // Markers that are off in most frames, if no two of them are in one cluster.
  std::vector<int> OffThroughout(const std::vector<int>& frames) const {
    std::vector<int> markers;
    for (const ClusterLabels& labels : summary_.labels) {
      int here = 0;
      for (const int m : labels.markers) {
        if (2 * frames[m] <= summary_.frame_count) continue;
        markers.push_back(m);
        ++here;
      }
      if (here > 1) return {};
    }
    return markers;
  }

  // Labels of the file that the project does not have and that nearly are names of missing markers.
  std::string Misspelt() const {
    std::vector<std::string> pairs;
    for (const std::string& marker : summary_.markers_missing) {
      std::string nearest;
      int least = 2 + static_cast<int>(marker.size()) / 4;
      for (const std::string& label : summary_.markers_unknown) {
        // Cameras put the name of a subject first: gantor:L_FOOT_1.
        const int edits = EditDistance(marker, label.substr(label.rfind(':') + 1));
        if (edits >= least) continue;
        least = edits;
        nearest = label;
      }
      if (!nearest.empty()) pairs.push_back("'" + nearest + "' for " + marker);
    }
    if (pairs.empty()) return "";
    return "; is a label misspelt? The file has " + Join(pairs) +
           ", which no link of the project names";
  }

  // Single outliers are normal for cameras; a marker that is off for long was touched.
  void AddOutliers() {
    std::vector<int> frames(summary_.markers.size(), 0);
    std::vector<int> first(summary_.markers.size(), 0);
    for (const ClusterLabels& labels : summary_.labels) {
      for (const OutlyingMarker& outlier : labels.outliers) {
        if (frames[outlier.marker] == 0) first[outlier.marker] = outlier.frames.begin;
        frames[outlier.marker] += outlier.frames.size();
      }
    }
    const std::vector<int> throughout = OffThroughout(frames);
    if (throughout.size() == 2) {
      const std::string &a = summary_.markers[throughout[0]], &b = summary_.markers[throughout[1]];
      Add(
          Format("%s and %s are off the shapes of their clusters most of the time; not used there. "
                 "Were the labels of %s and %s exchanged?",
                 a.c_str(), b.c_str(), a.c_str(), b.c_str()));
      for (const int m : throughout) frames[m] = 0;
    }
    int few = 0;
    int markers = 0;
    for (std::size_t m = 0; m < frames.size(); ++m) {
      if (frames[m] > kOffLong * summary_.frame_count) {
        Add(Format("%s is off its cluster's shape in %d frames, from %.2f s on; not used there",
                   summary_.markers[m].c_str(), frames[m], Seconds(first[m])));
      } else if (frames[m] > 0) {
        few += frames[m];
        ++markers;
      }
    }
    if (few == 0) return;
    Add(Format("%d outlying positions of %d markers removed", few, markers));
  }

  void AddLostMarker(std::size_t marker) {
    int longest = 0;
    for (const FrameInterval& gap : summary_.smoothing[marker].open) {
      longest = std::max(longest, gap.size());
    }
    const double share = static_cast<double>(FrameCount(summary_.smoothing[marker].open)) /
                         std::max(1, summary_.frame_count);
    if (share < kLostLong) return;
    Add(Format("%s was lost for %.0f %% of the time, at most %.1f s on end",
               summary_.markers[marker].c_str(), 100.0 * share, Seconds(longest)));
  }

  void AddLog() {
    const double end_s = Seconds(summary_.frame_count);
    if (summary_.outside_log <= kUnlogged * summary_.frame_count) return;
    Add(
        Format("the joint log covers %.1f s to %.1f s of the marker file's %.1f s; %d frames "
               "without joint positions are not used",
               std::max(0.0, summary_.log_begin_s), std::min(end_s, summary_.log_end_s), end_s,
               summary_.outside_log));
  }

  const TrialSummary& summary_;
  std::vector<std::string> findings_;
};

}  // namespace

std::string Describe(const TrialSummary& summary) {
  const std::string beginning = "trial " + summary.trial.name + ": ";
  if (!summary.refused.empty()) return beginning + "not used: " + summary.refused;
  return beginning +
         Format("%d postures from %d of %d frames at %.4g Hz, %zu markers; ", summary.postures,
                summary.samples, summary.frame_count, summary.rate_hz, summary.markers.size()) +
         Describe(summary.clock) +
         (summary.scale ? "; scale of the cameras " + Describe(*summary.scale) : "");
}

std::vector<std::string> Findings(const TrialSummary& summary) { return Finder(summary).Find(); }

}  // namespace elastocal
