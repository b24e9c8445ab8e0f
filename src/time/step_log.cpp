#include "src/time/step_log.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>

namespace taut {

StepLog::StepLog(MPI_Comm comm, const std::filesystem::path& file,
                 const std::vector<std::string>& potentials) {
  broadcast(comm, [&] {
    out_.open(file);
    if (!out_)
      throw InputError(fmt::format("{}: cannot be written: {}", file.string(), std::strerror(errno)));
    return std::string();
  });
  if (!out_.is_open()) return;
  out_ << "step,time_s,dt_s,rejected,strain_max,strain_rms,depth_m,projection_iterations,projection_ksp_"
          "iterations,velocity_ksp_iterations,contacts,kinetic_J";
  for (const std::string& p : potentials) out_ << ',' << p << "_J";
  out_ << ",velocity_s,projection_s,contact_s\n";
}

void StepLog::after_step(const State& state, const StepRecord& r) {
  if (!out_.is_open()) return;
  out_ << fmt::format("{},{:.9g},{:.9g},{},{:.6g},{:.6g},{:.9g},{},{},{},{},{:.9g}", state.step, state.time,
                      r.dt, r.rejected, r.strain.max, r.strain.rms, r.depth, r.iterations,
                      r.linear_iterations, r.velocity_iterations, r.contacts, r.energies.kinetic);
  for (const double e : r.energies.potential) out_ << fmt::format(",{:.9g}", e);
  out_ << fmt::format(",{:.4g},{:.4g},{:.4g}\n", r.seconds.velocity, r.seconds.projection, r.seconds.contact);
}

void StepLog::after_frame(const State&, Global) { out_.flush(); }

} // namespace taut
