// SPDX-License-Identifier: Apache-2.0
#include "elastocal/cli/mpi_ranks.hpp"

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <thread>

#include <dlfcn.h>

#include "elastocal/math/input_error.hpp"

namespace elastocal::cli {

/// A slot on another rank.
class RankSlot : public TaskSlot {
 public:
  RankSlot(MpiRanks& ranks, int rank) : ranks_(ranks), rank_(rank) {}

  void Start(int task) override {
    const double message[3] = {static_cast<double>(task), 0.0, 0.0};
    ranks_.mpi_.send(rank_, message);
  }

  std::optional<TaskEnd> Poll() override {
    double message[3];
    if (ranks_.mpi_.poll(rank_, message) == 0) return std::nullopt;
    return TaskEnd{static_cast<int>(message[1]), message[2]};
  }

 private:
  MpiRanks& ranks_;
  int rank_;
};

namespace {

namespace fs = std::filesystem;

constexpr double kDismissed = -1.0;

/// Path of the MPI module: beside the built program, or where it is installed.
fs::path FindModule() {
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error).parent_path();
  for (const fs::path& place : {program / "elastocal_mpi.so", program / ELASTOCAL_INSTALLED_MPI}) {
    if (fs::exists(place, error)) return place;
  }
  throw InputError(
      "mpirun: this elastocal was built without MPI (elastocal_mpi.so is not there); run batch "
      "without mpirun, with --workers");
}

template <typename Function>
void Load(void* module, const char* name, Function& function) {
  function = reinterpret_cast<Function>(dlsym(module, name));  // NOLINT
  if (function == nullptr) throw InputError(std::string("elastocal_mpi.so: no function ") + name);
}

}  // namespace

std::unique_ptr<MpiRanks> MpiRanks::Join() {
  // Set by Open MPI; a run without mpirun needs no MPI.
  if (std::getenv("OMPI_COMM_WORLD_SIZE") == nullptr) return nullptr;
  const fs::path file = FindModule();
  // The solver of Ipopt contains functions with the names of MPI that do nothing: RTLD_DEEPBIND
  // prefers those of the module.
  void* module = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_DEEPBIND);
  if (module == nullptr) throw InputError(file.string() + ": cannot be loaded: " + dlerror());
  Functions functions;
  Load(module, "elastocal_mpi_start", functions.start);
  Load(module, "elastocal_mpi_send", functions.send);
  Load(module, "elastocal_mpi_poll", functions.poll);
  Load(module, "elastocal_mpi_finish", functions.finish);
  return std::unique_ptr<MpiRanks>(new MpiRanks(functions));
}

MpiRanks::MpiRanks(const Functions& functions) : mpi_(functions) { mpi_.start(&rank_, &size_); }

MpiRanks::~MpiRanks() { mpi_.finish(); }

std::vector<std::unique_ptr<TaskSlot>> MpiRanks::OtherRanks() {
  std::vector<std::unique_ptr<TaskSlot>> slots;
  for (int rank = 1; rank < size_; ++rank) slots.push_back(std::make_unique<RankSlot>(*this, rank));
  return slots;
}

void MpiRanks::Dismiss() const {
  const double message[3] = {kDismissed, 0.0, 0.0};
  for (int rank = 1; rank < size_; ++rank) mpi_.send(rank, message);
}

void MpiRanks::Serve(TaskSlot& slot) const {
  constexpr std::chrono::milliseconds kLook{2};
  for (;;) {
    double message[3];
    while (mpi_.poll(0, message) == 0) std::this_thread::sleep_for(kLook);
    if (message[0] == kDismissed) return;
    slot.Start(static_cast<int>(message[0]));
    std::optional<TaskEnd> end;
    while (!(end = slot.Poll())) std::this_thread::sleep_for(kLook);
    message[1] = end->exit_code;
    message[2] = end->seconds;
    mpi_.send(0, message);
  }
}

}  // namespace elastocal::cli
