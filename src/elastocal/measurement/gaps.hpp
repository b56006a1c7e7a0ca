#pragma once

#include <vector>

#include "elastocal/math/butterworth.hpp"
#include "elastocal/measurement/frame_interval.hpp"
#include "elastocal/measurement/trial.hpp"

namespace elastocal {

/// What becomes of raw marker positions before anything is computed from them (paper, section 5.1).
struct SmoothingOptions {
  double longest_fill_s = 0.2;  ///< longer gaps stay open; 0 fills none
  int filter_order = 5;
  double cutoff_hz = 5.0;
};

/// What was done to one marker; the intervals of a kind are in order and never touch.
struct MarkerSmoothing {
  int frames_seen = 0;                ///< in the raw trajectory
  std::vector<FrameInterval> filled;  ///< gaps closed by a cubic
  std::vector<FrameInterval> open;    ///< gaps left, also before the first and after the last frame
  std::vector<FrameInterval> dropped;  ///< seen or filled, but too short to be filtered: now NaN
};

/// Closes gaps, in place, of at most `longest_fill_s` by the cubic polynomial that fits best, by
/// least squares, to the frames seen within 0.1 s on either side (or four frames where the rate is
/// low): the noise of a single neighbour is not carried into the gap. A gap with fewer than two
/// frames seen there on a side stays open. Gives one entry a marker, with `dropped` empty.
std::vector<MarkerSmoothing> FillGaps(double longest_fill_s, MarkerTrajectories& trajectories);

/// Filters, in place, each unbroken piece of each marker's trajectory forwards and backwards, and
/// sets pieces that are too short for it (FiltFiltPadding) to NaN. Gives these, one list a marker.
/// No sample is mixed with samples on the other side of an open gap.
std::vector<std::vector<FrameInterval>> FilterPieces(const SecondOrderSections& sections,
                                                     MarkerTrajectories& trajectories);

/// FillGaps and then FilterPieces with a Butterworth low-pass. Linear in the number of frames.
///
/// Throws std::invalid_argument for an order or a cutoff that ButterworthLowPass refuses.
std::vector<MarkerSmoothing> SmoothTrajectories(const SmoothingOptions& options,
                                                MarkerTrajectories& trajectories);

/// Whether marker `marker` has a position in frame `frame`.
bool Seen(const MarkerTrajectories& trajectories, int frame, int marker);

}  // namespace elastocal
