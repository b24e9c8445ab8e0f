#pragma once
#include "src/time/observer.hpp"

#include <filesystem>
#include <fstream>

namespace taut {

/// `steps.csv`: a row for each accepted step, written through at once. Rank 0 writes.
class StepLog : public Observer {
public:
  /// `potentials` names the energies of StepRecord, in order; `pins` is the number of pins. Of an earlier
  /// file the whole rows up to step `last_step` stay, column by column name; 0 begins anew. Throws InputError
  /// if the file cannot be written. Collective.
  StepLog(MPI_Comm comm, std::filesystem::path file, const std::vector<std::string>& potentials,
          std::size_t pins, Global last_step);

  /// Throws InputError if the row cannot be written.
  void after_step(const State& state, const StepRecord& record) override;

private:
  MPI_Comm comm_;
  std::filesystem::path file_;
  std::ofstream out_; ///< open on rank 0 only
};

} // namespace taut
