#pragma once
#include "src/output/totals.hpp"
#include "src/time/contact_balance.hpp"
#include "src/time/simulation.hpp"

#include <filesystem>

/// Checkpoints: one HDF5 file each, `checkpoint/step_NNNNNNNNN.h5` in the folder of the run, in input order,
/// so that any number of ranks can read what any other has written.
namespace taut {

/// All that determines, together with the mesh, how a run goes on.
struct CheckpointView {
  const std::string& case_text; ///< as run, YAML
  const State& state;
  const StepSize::Memory& step_size;
  Global rejected_steps;
  const Totals& totals;
  const ContactBalance::Memory& balance;
};

/// The same on its own.
struct Checkpoint {
  std::string case_text;
  State state;
  StepSize::Memory step_size;
  Global rejected_steps = 0;
  Totals totals;
  ContactBalance::Memory balance{};

  operator CheckpointView() const { return {case_text, state, step_size, rejected_steps, totals, balance}; }
};

/// Appears whole or not at all. Throws InputError if it cannot be written. Collective.
void write_checkpoint(const std::filesystem::path& path, const DistributedMesh& mesh,
                      const CheckpointView& checkpoint);

/// Throws InputError if the file is no checkpoint, not whole, or of another mesh. Collective.
Checkpoint read_checkpoint(const std::filesystem::path& path, const DistributedMesh& mesh);

/// The case in it alone. Throws like `read_checkpoint`. Collective.
std::string read_case_of_checkpoint(MPI_Comm comm, const std::filesystem::path& path);

/// The file for a checkpoint after `step`.
std::filesystem::path checkpoint_file(const std::filesystem::path& run_folder, Global step);

/// The step in the name of a checkpoint, or -1 if it is not the name of one.
Global step_of_checkpoint(const std::filesystem::path& file);

/// All checkpoints of a run, the latest first. Not collective.
std::vector<std::filesystem::path> checkpoints_in(const std::filesystem::path& run_folder);

} // namespace taut
