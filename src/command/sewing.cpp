#include "src/command/sewing.hpp"

#include "src/command/run_folder.hpp"
#include "src/command/run_lock.hpp"
#include "src/command/start_contact.hpp"
#include "src/garment/load_garment.hpp"
#include "src/garment/write_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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

/// Returns the files.
std::vector<fs::path> write_sewn(const Case& input, const Simulation& simulation, const fs::path& out) {
  const Cloth& cloth = simulation.cloth();
  const MPI_Comm comm = cloth.mesh.comm;
  std::vector<fs::path> files;
  for (std::size_t k = 0; k < input.cloths.size(); ++k) {
    const auto [name, mesh] =
        garment::load_garment(comm, input.folder() / *input.cloths[k].pattern, *input.cloths[k].edge);
    const auto positions = positions_of(cloth, simulation.state(), cloth.pieces[k]);
    garment::SewnMesh sewn;
    on_rank_0(comm, [&, &mesh = mesh, &name = name] {
      sewn = garment::sew(mesh, positions, name, garment::shorter_sides(mesh, input, k));
    });
    files.push_back(garment_file(input, k, sewing_folder(out), "sewn"));
    garment::write_h5(comm, mesh, sewn, files.back());
  }
  return files;
}

/// The case with garments that are sewn.
Case sewn_stage(Case input, std::span<const fs::path> meshes) {
  for (std::size_t k = 0; k < input.cloths.size(); ++k) {
    config::Cloth& cloth = input.cloths[k];
    cloth.mesh = meshes[k];
    cloth.pattern.reset();
    cloth.edge.reset();
    cloth.elastic.clear();
    cloth.up.reset();
    cloth.scale = 1;
    cloth.start = {};
  }
  input.sewing.reset();
  return input;
}

/// A body that stands somewhere else than its garment, or lies, comes of units and axes.
void check_place(const Case& input, const Simulation& simulation) {
  constexpr double farthest = 1; // m
  const auto places = simulation.obstacles().start();
  if (places.empty()) return;
  const DistributedMesh& mesh = simulation.cloth().mesh;
  std::array<double, 6> extent;
  extent.fill(-HUGE_VAL);
  for (Local i = 0; i < mesh.vertices.owned; ++i)
    for (int k = 0; k < 3; ++k) {
      extent[k] = std::max(extent[k], simulation.state().positions[i][k]);
      extent[3 + k] = std::max(extent[3 + k], -simulation.state().positions[i][k]);
    }
  max_in_place(mesh.comm, extent);
  double nearest = HUGE_VAL;
  for (const Vec3& p : places) {
    Vec3 outside;
    for (int k = 0; k < 3; ++k) outside[k] = std::max({p[k] - extent[k], -extent[3 + k] - p[k], 0.0});
    nearest = std::min(nearest, outside.norm());
  }
  if (nearest > farthest)
    throw InputError(fmt::format("{}: cloth and obstacles are {:.3g} m apart, and nothing is to be dressed: "
                                 "the cloth is at x {:.3g} to "
                                 "{:.3g}, y {:.3g} to {:.3g}, z {:.3g} to {:.3g} m, z being up; correct "
                                 "units (scale), the axis that points "
                                 "up in the files (up), or places",
                                 input.file.string(), nearest, -extent[3], extent[0], -extent[4], extent[1],
                                 -extent[5], extent[2]));
}

/// What is made one goes half the gap, which may take it through what lies there.
bool clear_weld(Simulation& simulation, Case stage, const fs::path& out) {
  if (!stage.has_contact()) return true;
  if (!stage.contact) stage.contact.emplace();
  stage.contact->start = config::StartContact::untangle;
  return clear_start(simulation, stage, fs::path(out) += ".findings.vtp");
}

} // namespace

fs::path sewing_folder(const fs::path& out) { return out / "sewing"; }

fs::path garment_file(const Case& input, std::size_t k, const fs::path& folder, const std::string& stem) {
  const std::string name = input.cloths.size() == 1 ? stem : fmt::format("{}_{}", stem, k);
  return fs::absolute(folder / (name + ".h5")).lexically_normal();
}

Case sewing_stage(Case input) {
  const config::Sewing& sewing = *input.sewing;
  input.air.reset();
  input.attachments.clear();
  input.time.end = sewing.limit;
  input.time.until_rest.reset();
  if (input.contact) input.contact->friction = 0;
  // Averages over triangles are pulled at one side of a panel harder than the prediction knows, and would
  // keep seams open: the triangles at outlines stretch by the limit where a seam pulls with all its force.
  input.inextensibility.constrain = config::Constrain::edges;
  for (config::Cloth& c : input.cloths) {
    c.material.damping.mass += sewing.damping;
    c.material.bending = std::max(c.material.bending, sewing.bending);
    if (auto& weft = c.material.bending_weft) weft = std::max(*weft, sewing.bending);
    c.material.stretch =
        std::max(c.material.stretch.value_or(0), sewing.force / input.inextensibility.strain);
  }
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

int run_sewing(MPI_Comm comm, const Case& input, const RunOptions& options, const StopSignal& stop,
               double began) {
  const Case stage = sewing_stage(input);
  Simulation simulation(comm, stage);
  check_place(input, simulation);
  try_petsc_options(simulation, input, options.source.petsc);
  if (!clear_start(simulation, stage, fs::path(options.out) += ".findings.vtp")) return step_failure;
  make_run_folder(comm, options.out, input.file);
  const RunLock lock(comm, options.out);
  clear_run_folder(comm, options.out, options.existing);
  const fs::path out = sewing_folder(options.out);
  make_run_folder(comm, out, input.file);
  clear_run_folder(comm, out, ExistingRun::overwrite);
  announce(comm, simulation, stage, out);
  const int code =
      simulate(comm, stage, simulation, {stop, out, options.progress, began, {}, {}, case_as_run(input)});
  return code == success ? run_sewn(comm, input, simulation, options, stop, began) : code;
}

int run_sewn(MPI_Comm comm, const Case& input, const Simulation& sewn, const RunOptions& options,
             const StopSignal& stop, double began) {
  return run_garments(comm, input, write_sewn(input, sewn, options.out), options, stop, began);
}

int run_garments(MPI_Comm comm, const Case& input, std::span<const fs::path> meshes,
                 const RunOptions& options, const StopSignal& stop, double began) {
  const Case stage = sewn_stage(input, meshes);
  Simulation simulation(comm, stage);
  if (!clear_weld(simulation, stage, options.out)) return step_failure;
  if (!relax_start(simulation, stage)) return step_failure;
  clear_run_folder(comm, options.out, options.existing);
  announce(comm, simulation, stage, options.out);
  return simulate(comm, stage, simulation,
                  {stop, options.out, options.progress, began, {}, options.counters});
}

} // namespace taut::command
