// SPDX-License-Identifier: Apache-2.0
#include "elastocal/mistakes/collect_alike.hpp"

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>

namespace elastocal {
namespace {

class AlikeCollection {
 public:
  AlikeCollection(double most, int most_fits, const ErrorTogether& error_of)
      : most_(most), fits_left_(most_fits), error_of_(error_of) {}

  /// Adds the elements that fit to the set, until the fits are used up. `others` are the rest.
  void Extend(std::span<const std::size_t> by, AlikeSet& set, std::vector<std::size_t>& others) {
    if (by.empty() || used_up_) return;
    used_up_ = fits_left_-- == 0;
    if (used_up_) return;
    std::vector<std::size_t> with = set.elements;
    with.insert(with.end(), by.begin(), by.end());
    const double error = error_of_(with);
    if (error < most_) {
      set = {std::move(with), error};
    } else if (by.size() == 1) {
      others.push_back(by.front());
    } else {
      Extend(by.first(by.size() / 2), set, others);
      Extend(by.subspan(by.size() / 2), set, others);
    }
  }

  bool used_up() const { return used_up_; }

 private:
  double most_;
  int fits_left_;
  bool used_up_ = false;
  const ErrorTogether& error_of_;
};

}  // namespace

std::optional<std::vector<AlikeSet>> CollectAlike(const std::vector<double>& errors, double most,
                                                  int most_fits, const ErrorTogether& error_of) {
  AlikeCollection collection(most, most_fits, error_of);
  std::vector<AlikeSet> sets;
  std::vector<std::size_t> open(errors.size());
  std::iota(open.begin(), open.end(), std::size_t{0});
  while (!open.empty()) {
    AlikeSet set{{open.front()}, errors[open.front()]};
    std::vector<std::size_t> others;
    collection.Extend(std::span<const std::size_t>(open).subspan(1), set, others);
    if (collection.used_up()) return std::nullopt;
    sets.push_back(std::move(set));
    open = std::move(others);
  }
  std::ranges::stable_sort(sets, [](const AlikeSet& a, const AlikeSet& b) {
    return a.elements.size() > b.elements.size();
  });
  return sets;
}

}  // namespace elastocal
