#include "src/command/sewing.hpp"

#include "src/command/run_folder.hpp"
#include "src/command/start_contact.hpp"
#include "src/garment/load_garment.hpp"
#include "src/garment/write_mesh.hpp"

#include <fmt/format.h>

#include <cstdio>

namespace taut::command {

namespace {

namespace fs = std::filesystem;

/// Where keyframes are at time 0.
void hold_first(std::vector<config::Keyframe>& motion) {
  if (!motion.empty()) motion.resize(1);
}

/// The positions of the vertices of one piece, in order, on rank 0.
std::vector<Vec3> positions_of(const Cloth& cloth, const State& state, const Piece& piece) {
  const auto slab = cloth.mesh.vertex_order.to_slab<Vec3>(state.positions);
  const Global first = cloth.mesh.vertex_order.slab().first;
  std::vector<Vec3> of_piece;
  for (std::size_t i = 0; i < slab.size(); ++i)
    if (Slab{piece.first_vertex, piece.vertices, 0}.contains(first + Global(i))) of_piece.push_back(slab[i]);
  return exchange(cloth.mesh.comm, of_piece, std::vector<int>(of_piece.size(), 0)).items;
}

fs::path sewn_file(const Case& input, std::size_t k, const fs::path& out) {
  const std::string name = input.cloths.size() == 1 ? "sewn.h5" : fmt::format("sewn_{}.h5", k);
  return fs::absolute(sewing_folder(out) / name).lexically_normal();
}

void write_sewn(const Case& input, const Simulation& simulation, const fs::path& out) {
  const Cloth& cloth = simulation.cloth();
  const MPI_Comm comm = cloth.mesh.comm;
  for (std::size_t k = 0; k < input.cloths.size(); ++k) {
    const auto [name, mesh] =
        garment::load_garment(comm, input.folder() / *input.cloths[k].pattern, *input.cloths[k].edge);
    const auto positions = positions_of(cloth, simulation.state(), cloth.pieces[k]);
    garment::SewnMesh sewn;
    on_rank_0(comm, [&, &mesh = mesh, &name = name] { sewn = garment::sew(mesh, positions, name); });
    garment::write_h5(comm, mesh, sewn, sewn_file(input, k, out));
  }
}

/// The case of the second stage.
Case sewn_stage(Case input, const fs::path& out) {
  for (std::size_t k = 0; k < input.cloths.size(); ++k) {
    config::Cloth& cloth = input.cloths[k];
    cloth.mesh = sewn_file(input, k, out);
    cloth.pattern.reset();
    cloth.edge.reset();
    cloth.up.reset();
    cloth.scale = 1;
    cloth.start = {};
  }
  input.sewing.reset();
  return input;
}

} // namespace

fs::path sewing_folder(const fs::path& out) { return out / "sewing"; }

Case sewing_stage(Case input) {
  const config::Sewing& sewing = *input.sewing;
  input.gravity = sewing.gravity;
  input.air.reset();
  input.time.end = sewing.limit;
  input.time.until_rest.reset();
  if (input.contact) input.contact->friction = 0;
  for (config::Cloth& c : input.cloths) c.material.damping.mass += sewing.damping;
  for (config::Pin& pin : input.pins) {
    hold_first(pin.motion);
    pin.release.reset();
  }
  for (config::Obstacle& o : input.obstacles) {
    hold_first(o.motion);
    o.sequence.reset();
    o.friction = 0;
  }
  return input;
}

int run_sewing(MPI_Comm comm, const Case& input, const RunOptions& options, double began) {
  const Case stage = sewing_stage(input);
  Simulation simulation(comm, stage);
  if (options.source.has_petsc_options) try_petsc_options(simulation);
  if (!clear_start(simulation, stage, fs::path(options.out) += ".findings.vtp")) return step_failure;
  make_run_folder(comm, options.out, input.file, options.existing);
  const fs::path out = sewing_folder(options.out);
  make_run_folder(comm, out, input.file, ExistingRun::overwrite);
  announce(comm, simulation, stage, out);
  const int code =
      simulate(comm, stage, simulation, {out, options.progress, began, {}, {}, case_as_run(input)});
  return code == success ? run_sewn(comm, input, simulation, options, began) : code;
}

int run_sewn(MPI_Comm comm, const Case& input, const Simulation& sewn, const RunOptions& options, double began) {
  write_sewn(input, sewn, options.out);
  const Case stage = sewn_stage(input, options.out);
  Simulation simulation(comm, stage);
  if (!clear_start(simulation, stage, fs::path(options.out) += ".findings.vtp")) return step_failure;
  make_run_folder(comm, options.out, input.file, options.existing);
  announce(comm, simulation, stage, options.out);
  return simulate(comm, stage, simulation, {options.out, options.progress, began, {}, options.counters});
}

} // namespace taut::command
