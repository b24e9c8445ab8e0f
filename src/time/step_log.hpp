#pragma once
#include "src/time/observer.hpp"

#include <filesystem>
#include <fstream>

namespace taut {

/// `steps.csv`: a row for each accepted step, written through at every frame. Rank 0 writes.
class StepLog : public Observer {
public:
  /// `potentials` names the energies of StepRecord, in order. Throws InputError if the file cannot be opened.
  /// Collective.
  StepLog(MPI_Comm comm, const std::filesystem::path& file, const std::vector<std::string>& potentials);

  void after_step(const State& state, const StepRecord& record) override;
  void after_frame(const State& state, Global frame) override;

private:
  std::ofstream out_; ///< open on rank 0 only
};

} // namespace taut
