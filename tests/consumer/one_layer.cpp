#include <iostream>

#include "elastocal/math/priority_qr.hpp"

int main() {
  // The third column is the sum of the first two.
  const Eigen::Matrix3d A{{1, 0, 1}, {0, 1, 1}, {1, 1, 2}};
  const auto rank = elastocal::PriorityQr(A, 1e-9).kept.size();
  std::cout << "rank " << rank << '\n';
  return rank == 2 ? 0 : 1;
}
