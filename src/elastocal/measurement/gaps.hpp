// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "elastocal/math/butterworth.hpp"
#include "elastocal/measurement/frame_interval.hpp"
#include "elastocal/measurement/trial.hpp"

namespace elastocal {

/// How raw marker positions are treated before anything is computed from them (paper, section 5.1).
struct SmoothingOptions {
  double longest_fill_s = 0.2;  ///< longer gaps stay open; with 0, all do
  int filter_order = 5;
  double cutoff_hz = 5.0;
};

/// What was done to one marker. The intervals of each kind are in order and do not touch.
struct MarkerSmoothing {
  int frames_seen = 0;                ///< in the raw trajectory
  std::vector<FrameInterval> filled;  ///< gaps closed by a cubic
  std::vector<FrameInterval>
      open;  ///< gaps that stayed open, also at the beginning and end of the trial
  std::vector<FrameInterval> dropped;  ///< seen or filled, but too short to be filtered: now NaN
};

/// Closes gaps of at most `longest_fill_s` in place, by the least-squares cubic polynomial through
/// the frames seen within 0.1 s on either side (or within four frames at a low rate), so that the
/// noise of a single neighbour does not get into the gap. A gap with fewer than two such frames on
/// a side stays open. Returns one entry for each marker, with `dropped` empty.
std::vector<MarkerSmoothing> FillGaps(double longest_fill_s, MarkerTrajectories& trajectories);

/// Filters each unbroken piece of each marker's trajectory in place, forwards and backwards. Sets
/// pieces that are too short for the filter (FiltFiltPadding) to NaN and returns them, one list for
/// each marker. No sample is mixed with samples on the other side of an open gap.
std::vector<std::vector<FrameInterval>> FilterPieces(const SecondOrderSections& sections,
                                                     MarkerTrajectories& trajectories);

/// Calls FillGaps and then FilterPieces with a Butterworth low-pass. Time is linear in the number
/// of frames.
///
/// Throws std::invalid_argument for an order or a cutoff that ButterworthLowPass refuses.
std::vector<MarkerSmoothing> SmoothTrajectories(const SmoothingOptions& options,
                                                MarkerTrajectories& trajectories);

/// Whether marker `marker` has a position in frame `frame`.
bool Seen(const MarkerTrajectories& trajectories, int frame, int marker);

}  // namespace elastocal
