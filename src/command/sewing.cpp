#include "src/command/sewing.hpp"

#include "src/command/garment_lift.hpp"
#include "src/command/run_folder.hpp"
#include "src/command/run_lock.hpp"
#include "src/command/sewing_cases.hpp"
#include "src/command/start_contact.hpp"
#include "src/command/warnings.hpp"
#include "src/config/cloths.hpp"
#include "src/contact/body_growth.hpp"
#include "src/garment/load_garment.hpp"
#include "src/garment/write_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace taut::command {

namespace {

namespace fs = std::filesystem;

/// The positions of the vertices of one piece, in order, on rank 0.
std::vector<Vec3> positions_of(const Cloth& cloth, const State& state, const Piece& piece) {
  const auto slab = cloth.mesh.vertex_order.to_slab<Vec3>(state.positions);
  const Global first = cloth.mesh.vertex_order.slab().first;
  std::vector<Vec3> of_piece;
  for (std::size_t i = 0; i < slab.size(); ++i)
    if (Slab{piece.first_vertex, piece.vertices, 0}.contains(first + Global(i))) of_piece.push_back(slab[i]);
  return exchange(cloth.mesh.comm, of_piece, std::vector<int>(of_piece.size(), 0)).items;
}

/// m, of the edges of each garment. Collective.
std::vector<double> shortest_edges(MPI_Comm comm, const Case& input) {
  std::vector<double> shortest(input.cloths.size(), HUGE_VAL);
  for (std::size_t k = 0; k < shortest.size(); ++k) {
    const garment::GarmentMesh mesh = garment::load_garment(comm, input, k).mesh;
    for (const Cell& cell : mesh.cells)
      for (int i = 0, n = cell.size(); i < n; ++i) {
        const Vec3 side = mesh.positions[cell.vertices[(i + 1) % n]] - mesh.positions[cell.vertices[i]];
        shortest[k] = std::min(shortest[k], side.norm());
      }
    shortest[k] = -max_over(comm, -shortest[k]);
  }
  return shortest;
}

/// The mesh that a stage makes of cloth `k`.
fs::path mesh_after(SewingStage stage, const Case& input, std::size_t k, const fs::path& out) {
  return garment_file(input, k, folder_of(stage, out), stage == SewingStage::sewing ? "sewn" : "fitted");
}

std::vector<fs::path> meshes_after(SewingStage stage, const Case& input, const fs::path& out) {
  std::vector<fs::path> files;
  for (std::size_t k = 0; k < input.cloths.size(); ++k) files.push_back(mesh_after(stage, input, k, out));
  return files;
}

void write_meshes_after(SewingStage stage, const Case& input, const Simulation& ended, const fs::path& out) {
  const Cloth& cloth = ended.cloth();
  const MPI_Comm comm = cloth.mesh.comm;
  for (std::size_t k = 0; k < input.cloths.size(); ++k) {
    const auto [name, mesh] = garment::load_garment(comm, input, k);
    const auto positions = positions_of(cloth, ended.state(), cloth.pieces[k]);
    garment::SewnMesh sewn;
    on_rank_0(comm, [&, &mesh = mesh, &name = name] {
      const auto shorter = garment::shorter_sides(mesh, input, k);
      if (stage == SewingStage::sewing) {
        sewn = garment::sew(mesh, positions, name, shorter);
      } else {
        sewn = garment::sew(mesh, mesh.positions, name, shorter);
        sewn.positions = positions;
      }
    });
    garment::write_h5(comm, mesh, sewn, mesh_after(stage, input, k, out));
  }
}

/// The file that tells by how much body `k` stays back in its garment.
fs::path fitted_body(const fs::path& out, std::size_t k) {
  return fs::absolute(folder_of(SewingStage::fitting, out) / fmt::format("body_{}.h5", k)).lexically_normal();
}

/// Writes down by how much bodies stay back after the fitting, and tells it.
void write_bodies(MPI_Comm comm, const Simulation& fitted, const fs::path& out) {
  const Obstacles& obstacles = fitted.obstacles();
  for (int k = 0; k < obstacles.bodies(); ++k) {
    const HeldBack held = held_back(obstacles, k, fitted.state().time);
    if (held.vertices == 0) continue;
    write_ways(comm, fitted_body(out, std::size_t(k)), held.ways);
    if (rank_of(comm) == 0)
      fmt::print("{}: {} of its vertices stay back by up to {:.3g} mm, at ({:.4g}, {:.4g}, {:.4g}) m: the "
                 "garment is too tight for it there\n",
                 obstacles.body(k).name, held.vertices, 1000 * held.farthest, held.place[0], held.place[1],
                 held.place[2]);
  }
}

/// A body that stands somewhere else than its garment, or lies, comes of units and axes.
void check_place(const Case& input, const Simulation& simulation, const Obstacles& obstacles) {
  constexpr double farthest = 0.5; // m
  const auto places = obstacles.start();
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
  if (stage.has_contact()) {
    if (!stage.contact) stage.contact.emplace();
    stage.contact->start = config::StartContact::untangle;
  }
  return prepare_start(simulation, stage, fs::path(out) += ".findings.vtp");
}

/// What is wrong with the last stage is told before the first.
Case checked_and_ready(MPI_Comm comm, const Case& input) {
  const Simulation unsewn(comm, input);
  warn_of_start(unsewn, input);
  return ready_to_sew(unsewn, input);
}

/// Of a garment; there is nothing to fit without bodies.
int stages_of(const Case& input) { return input.obstacles.empty() ? 2 : 3; }

void tell_stage(MPI_Comm comm, const Case& input, int number, std::string_view what) {
  if (rank_of(comm) == 0) fmt::print("{}: stage {} of {}: {}\n", input.name, number, stages_of(input), what);
}

int run_stage(SewingStage which, const Case& stage, std::unique_ptr<Simulation>& simulation, MPI_Comm comm,
              const Case& input, const RunOptions& options, const StopSignal& stop, double began) {
  const fs::path out = folder_of(which, options.out);
  make_run_folder(comm, out, input.file);
  clear_run_folder(comm, out, ExistingRun::overwrite);
  announce(comm, *simulation, stage, out);
  const int code = simulate(comm, stage, simulation,
                            {stop, out, options.progress, began, {}, {}, case_as_run(input), options.out});
  if (which == SewingStage::fitting && code == step_failure && rank_of(comm) == 0)
    fmt::print(stderr,
               "taut: {}: no body can grow further in the garment: it is too tight there, or pinched "
               "where a body faces itself; give it more width, or obstacles more `room`, or a longer "
               "sewing.growth, or less sewing.pressure\n",
               input.file.string());
  return code;
}

} // namespace

Case ready_to_sew(const Simulation& unsewn, Case input) {
  const MPI_Comm comm = unsewn.cloth().mesh.comm;
  fill_in(input, shortest_edges(comm, input));
  if (!input.sewing->method) input.sewing->method = seam_method(input, unsewn.cloth().mesh.vertices.total);
  const Obstacles slim(comm, sewing_case(input));
  check_place(input, unsewn, slim);
  const std::vector<double> lifts = lifts_of(unsewn.cloth(), unsewn.state().positions, slim);
  for (std::size_t k = 0; k < lifts.size(); ++k) {
    if (lifts[k] == 0) continue;
    input.cloths[k].start.translate += lifts[k] * Vec3::UnitZ();
    if (rank_of(comm) == 0)
      fmt::print("{}: {} starts {:.3g} cm {}, where its seams pass the bodies\n", input.name,
                 config::name_of_cloth(input, k), 100 * std::abs(lifts[k]),
                 lifts[k] > 0 ? "higher" : "lower");
  }
  return input;
}

fs::path garment_file(const Case& input, std::size_t k, const fs::path& folder, const std::string& stem) {
  const std::string name = input.cloths.size() == 1 ? stem : fmt::format("{}_{}", stem, k);
  return fs::absolute(folder / (name + ".h5")).lexically_normal();
}

fs::path folder_of(SewingStage stage, const fs::path& out) {
  return out / (stage == SewingStage::sewing ? "sewing" : "fitting");
}

Case case_of(SewingStage stage, const Case& input, const fs::path& out) {
  return stage == SewingStage::sewing ? sewing_case(input)
                                      : fitting_case(input, meshes_after(SewingStage::sewing, input, out));
}

bool clear_stage(SewingStage stage, Simulation& simulation, const Case& input, const fs::path& out) {
  return stage == SewingStage::fitting ? clear_weld(simulation, input, out)
                                       : clear_start(simulation, input, fs::path(out) += ".findings.vtp");
}

Case with_fitted_bodies(MPI_Comm comm, Case input, const fs::path& run) {
  for (std::size_t k = 0; k < input.obstacles.size(); ++k) {
    config::Obstacle& o = input.obstacles[k];
    const std::string file = broadcast(
        comm, [&] { return fs::exists(fitted_body(run, k)) ? fitted_body(run, k).string() : std::string(); });
    if (file.empty() || o.fitted) continue;
    make_mesh(o);
    o.fitted = file;
  }
  return input;
}

int run_sewing(MPI_Comm comm, const Case& given, const RunOptions& options, const StopSignal& stop,
               double began) {
  const Case input = checked_and_ready(comm, given);
  const Case stage = sewing_case(input);
  auto simulation = std::make_unique<Simulation>(comm, stage);
  try_petsc_options(*simulation, input, options.source.petsc);
  if (!clear_stage(SewingStage::sewing, *simulation, stage, options.out)) return step_failure;
  make_run_folder(comm, options.out, input.file);
  const RunLock lock(comm, options.out);
  clear_run_folder(comm, options.out, options.existing);
  tell_stage(comm, input, 1, "panels are drawn together at their seams");
  const int code = run_stage(SewingStage::sewing, stage, simulation, comm, input, options, stop, began);
  return code == success ? run_after(SewingStage::sewing, comm, input, *simulation, options, stop, began)
                         : code;
}

int run_after(SewingStage before, MPI_Comm comm, const Case& input, const Simulation& ended,
              const RunOptions& options, const StopSignal& stop, double began) {
  const fs::path& out = options.out;
  write_meshes_after(before, input, ended, out);
  if (before == SewingStage::fitting) write_bodies(comm, ended, out);
  if (before == SewingStage::sewing && !input.obstacles.empty()) {
    tell_stage(comm, input, 2, "bodies grow to their size");
    const Case stage = fitting_case(input, meshes_after(SewingStage::sewing, input, out));
    auto simulation = std::make_unique<Simulation>(comm, stage);
    if (!clear_stage(SewingStage::fitting, *simulation, stage, out)) return step_failure;
    const int code = run_stage(SewingStage::fitting, stage, simulation, comm, input, options, stop, began);
    return code == success ? run_after(SewingStage::fitting, comm, input, *simulation, options, stop, began)
                           : code;
  }
  tell_stage(comm, input, stages_of(input), "the case itself, with the garment");
  return run_garments(comm, with_fitted_bodies(comm, input, out), meshes_after(before, input, out), options,
                      stop, began);
}

int run_garments(MPI_Comm comm, Case input, std::span<const fs::path> meshes, const RunOptions& options,
                 const StopSignal& stop, double began) {
  fill_in(input, shortest_edges(comm, input));
  Case stage = with_meshes(std::move(input), meshes);
  stage.sewing.reset();
  auto simulation = std::make_unique<Simulation>(comm, stage);
  if (!clear_weld(*simulation, stage, options.out)) return step_failure;
  clear_run_folder(comm, options.out, options.existing);
  announce(comm, *simulation, stage, options.out);
  return simulate(comm, stage, simulation,
                  {stop, options.out, options.progress, began, {}, options.counters});
}

} // namespace taut::command
