#include "src/output/frame_writer.hpp"

#include "partition/traffic.hpp"
#include "src/output/run_files.hpp"
#include "src/output/run_mesh.hpp"

#include <algorithm>

namespace taut {

FrameWriter::FrameWriter(const Cloth& cloth, const Obstacles& obstacles, const StepSize& steps,
                         const Case& input, const std::filesystem::path& folder, Written& written)
    : fields_(frame_fields(cloth, obstacles, input)),
      obstacles_(cloth, obstacles), source_{cloth, obstacles_, fields_, steps, folder},
      sinks_(make_sinks(source_, input.output.formats)), written_(written) {}

void FrameWriter::at_start(const State& state) {
  const PhaseScope phase(Phase::output);
  const double began = MPI_Wtime();
  write_run_mesh(source_.folder / run_files::mesh, source_.cloth, fields_, obstacles_, state);
  const Global next = state.step > 0 ? source_.steps.frame_after(state.time) : 0;
  for (const auto& sink : sinks_) sink->begin(next);
  written_.seconds += MPI_Wtime() - began;
  if (next == 0) after_frame(state, 0);
  flush();
}

void FrameWriter::after_frame(const State& state, Global frame) {
  const PhaseScope phase(Phase::output);
  const double began = MPI_Wtime();
  for (const auto& sink : sinks_) written_.files.insert(sink->write(state, frame));
  written_.seconds += MPI_Wtime() - began;
}

void FrameWriter::flush() {
  for (const auto& sink : sinks_) sink->flush();
}

Global FrameWriter::frames() const {
  Global most = 0;
  for (const auto& sink : sinks_) most = std::max(most, sink->frames());
  return most;
}

} // namespace taut
