// SPDX-License-Identifier: Apache-2.0
// What `batch` needs of MPI, as a module of its own: the program does not depend on an MPI library,
// and loads this only when mpirun has started it.

#include <mpi.h>

namespace {

constexpr int kTag = 1;

}  // namespace

// NOLINTBEGIN(readability-identifier-naming): names of C
extern "C" {

/// Gives the rank of this process and their number.
void elastocal_mpi_start(int* rank, int* size) {
  MPI_Init(nullptr, nullptr);
  MPI_Comm_rank(MPI_COMM_WORLD, rank);
  MPI_Comm_size(MPI_COMM_WORLD, size);
}

/// Three numbers to a rank.
void elastocal_mpi_send(int rank, const double* numbers) {
  MPI_Send(numbers, 3, MPI_DOUBLE, rank, kTag, MPI_COMM_WORLD);
}

/// Whether a message of a rank has come; its three numbers. Does not wait.
int elastocal_mpi_poll(int rank, double* numbers) {
  int there = 0;
  MPI_Iprobe(rank, kTag, MPI_COMM_WORLD, &there, MPI_STATUS_IGNORE);
  if (there != 0) {
    MPI_Recv(numbers, 3, MPI_DOUBLE, rank, kTag, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
  }
  return there;
}

void elastocal_mpi_finish() { MPI_Finalize(); }
}
// NOLINTEND(readability-identifier-naming)
