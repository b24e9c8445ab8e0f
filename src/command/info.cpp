#include "partition/yarns.hpp"
#include "src/command/command.hpp"
#include "src/config/cloths.hpp"
#include "src/config/methods.hpp"
#include "src/output/checkpoint.hpp"
#include "src/output/frame_formats.hpp"
#include "src/output/memory.hpp"
#include "src/output/run_files.hpp"
#include "src/output/xdmf_sink.hpp"
#include "src/time/simulation.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>

namespace taut::command {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Json read_summary(const fs::path& file) {
  std::ifstream in(file);
  try {
    return Json::parse(in);
  } catch (const Json::exception& e) {
    throw InputError(fmt::format("{}: not the summary of a run: {}", file.string(), e.what()));
  }
}

/// Of one cloth of several.
std::string cloth_line(const std::string& name, Global vertices, Global cells, const char* of) {
  return fmt::format("    {:<10} {} vertices, {} {}\n", name, vertices, cells, of);
}

/// A line for each cloth.
std::string describe_materials(const Case& input) {
  std::string text;
  for (std::size_t k = 0; k < input.cloths.size(); ++k) {
    const config::Material& m = input.cloths[k].material;
    text += fmt::format("  material    {}{}{:g} kg/m^2, bending {:g} N m, shear {:g} N/m\n",
                        input.cloths.size() > 1 ? config::name_of_cloth(input, k) + ": " : "",
                        input.cloths[k].fabric ? *input.cloths[k].fabric + ", " : "", m.density, m.bending,
                        m.shear);
    for (const auto& [name, panel] : input.cloths[k].panels) {
      const config::Material own = config::material_of(m, panel);
      if (own != m)
        text += fmt::format("    {:<10} {}{:g} kg/m^2, bending {:g} N m, shear {:g} N/m\n", name,
                            panel.fabric ? *panel.fabric + ", " : "", own.density, own.bending, own.shear);
    }
  }
  return text;
}

std::string describe_method(const Case& input) {
  const config::Inextensibility& i = input.inextensibility;
  return fmt::format("  lengths     kept by {}{}\n", config::word_of(i.method),
                     config::holds_limit(input) ? fmt::format(", strain at most {:.3g} %", 100 * i.strain)
                                                : "");
}

/// Of the case as it was run, if it is there.
std::string materials_of_run(const fs::path& folder) {
  std::ifstream in(folder / run_files::case_as_run);
  std::ostringstream all;
  all << in.rdbuf();
  return in ? describe_materials(read_case(all.str(), (folder / run_files::case_as_run).string())) : "";
}

std::string describe_finished(const fs::path& folder, const Json& s) {
  const auto number = [&](const char* group, const char* key) { return s.at(group).at(key).get<double>(); };
  const std::string limit = s.at("strain").at("limit").is_null()
                                ? "none kept"
                                : fmt::format("limit {:.3g} %", 100 * number("strain", "limit"));
  const Json all = s.value("cloths", Json::array());
  std::string cloths;
  for (std::size_t k = 0; k < all.size() && all.size() > 1; ++k)
    cloths += cloth_line(all[k].at("name").get<std::string>(), all[k].at("vertices").get<Global>(),
                         all[k].at("faces").get<Global>(), "faces");
  std::string text = fmt::format(
      "{}: case {}, {} on {} ranks by taut {}\n"
      "  cloth       {} vertices, {} faces, {} constrained edges\n{}{}"
      "  time        {:.6g} s in {} steps ({} rejected), {} frames\n"
      "  strain      {:.3g} % at most ({}), rms {:.3g} %, 99.9 % of edges below {:.3g} %\n"
      "  projection  {}: {:.2f} iterations a step (at most {}), {:.1f} CG iterations each\n"
      "  velocity    {:.1f} CG iterations a step\n"
      "  partition   {} edges cut, imbalance {:.3f}, at most {} ghosts a rank\n"
      "  cost        {:.2f} s: set-up {:.2f}, velocity {:.2f}, projection {:.2f}, contact {:.2f}, output "
      "{:.2f}; memory {:.0f} MB\n",
      folder.string(), s.at("case").get<std::string>(), s.at("status").get<std::string>(),
      s.at("ranks").get<int>(), s.at("version").get<std::string>(), s.at("vertices").get<Global>(),
      s.at("faces").get<Global>(), s.at("constraints").get<Global>(), cloths, materials_of_run(folder),
      s.at("end_time").get<double>(), s.at("steps").get<Global>(), s.at("rejected_steps").get<Global>(),
      s.at("frames").get<Global>(), 100 * number("strain", "max"), limit, 100 * number("strain", "rms"),
      100 * number("strain", "p999"), s.at("projection").at("method").get<std::string>(),
      number("projection", "iterations_mean"), number("projection", "iterations_max"),
      number("projection", "ksp_iterations_mean"), number("velocity", "ksp_iterations_mean"),
      number("partition", "edge_cut"), number("partition", "imbalance"), number("partition", "ghosts_max"),
      number("seconds", "total"), number("seconds", "setup"), number("seconds", "velocity"),
      number("seconds", "projection"), number("seconds", "contact"), number("seconds", "output"),
      number("memory_bytes", "sum") / 1e6);
  if (const auto reason = s.at("reason").get<std::string>(); !reason.empty())
    text += "  stopped     " + reason + "\n";
  return text;
}

std::string describe_run(const fs::path& folder) {
  std::string text;
  if (fs::exists(folder / run_files::summary)) {
    const Json summary = read_summary(folder / run_files::summary);
    try {
      text = describe_finished(folder, summary);
    } catch (const Json::exception& e) {
      throw InputError(
          fmt::format("{}: not the summary of a run: {}", (folder / run_files::summary).string(), e.what()));
    }
  } else if (holds_frames(folder)) {
    text = fmt::format("{}: a run that is still going on, or was cut off: {} frames so far\n",
                       folder.string(), count_frames(folder));
  } else {
    throw InputError(fmt::format("{}: holds no run (no summary.json, no frames.xdmf)", folder.string()));
  }
  if (const auto checkpoints = checkpoints_in(folder); !checkpoints.empty())
    text += fmt::format("  resume      taut resume {}  (goes on after step {})\n", folder.string(),
                        step_of_checkpoint(checkpoints[0]));
  if (fs::exists(folder / XdmfSink::file))
    text += fmt::format("  look        paraview {0}  (edges with strain and tension: edges.xdmf)\n",
                        fs::absolute(folder / XdmfSink::file).lexically_normal().string());
  return text;
}

/// As far as a first step tells: what it takes, contact included, is thrown away.
std::string describe_cost(MPI_Comm comm, const Case& input, Simulation& simulation) {
  const double began = MPI_Wtime();
  const StepReport step = simulation.trial_step();
  const double seconds = MPI_Wtime() - began, memory = sum_over(comm, peak_memory());
  const StepSize& steps = simulation.step_size();
  const double length = steps.choose(0, 1).dt;
  const auto count = Global(std::ceil(steps.frame_time(steps.frames()) / length - 1e-6));
  return fmt::format(
      "  cost        {:.0f} MB of memory; at least {} steps for {} frame{}; a first step takes {:.2g} s: "
      "velocity {:.2g}, projection {:.2g}, contact {:.2g}; later ones may take several times as long\n{}",
      memory / 1e6, count, steps.frames(), steps.frames() == 1 ? "" : "s", seconds, step.velocity_seconds,
      step.projection_seconds, step.contact_seconds,
      input.sewing ? "              not counted: sewing comes first\n" : "");
}

std::string describe_case(MPI_Comm comm, const CaseSource& source) {
  const Case input = load_case(comm, source);
  Simulation simulation(comm, input);
  const Cloth& cloth = simulation.cloth();
  const State& state = simulation.state();
  const DistributedMesh& mesh = cloth.mesh;
  std::array<double, 6> extent;
  extent.fill(-HUGE_VAL);
  double mass = 0, length = 0;
  for (Local i = 0; i < mesh.vertices.owned; ++i) {
    mass += cloth.mass[i];
    for (int k = 0; k < 3; ++k) {
      extent[k] = std::max(extent[k], -state.positions[i][k]);
      extent[3 + k] = std::max(extent[3 + k], state.positions[i][k]);
    }
  }
  for (Local e = 0; e < mesh.edges.owned; ++e) length += cloth.rest_length[e];
  const Global yarns = find_yarns(mesh).count;
  max_in_place(comm, extent);
  mass = sum_over(comm, mass);
  length = sum_over(comm, length);
  std::string cloths;
  for (std::size_t k = 0; k < cloth.pieces.size() && cloth.pieces.size() > 1; ++k)
    cloths +=
        cloth_line(config::name_of_cloth(input, k), cloth.pieces[k].vertices, cloth.pieces[k].cells, "cells");
  return fmt::format(
      "{}: case {}\n"
      "  cloth       {} vertices, {} cells, {} constrained edges of {:.4g} m on average, {:.4g} kg\n{}{}{}"
      "  starts      x {:.4g} to {:.4g}, y {:.4g} to {:.4g}, z {:.4g} to {:.4g} m\n"
      "  yarns       {}, of {:.1f} edges and {:.4g} m on average\n"
      "  partition   {} rank{}: {} edges cut, imbalance {:.3f}, at most {} ghosts a rank\n{}",
      source.file.string(), input.name, mesh.vertices.total, mesh.total_cells, mesh.edges.total,
      length / double(std::max<Global>(mesh.edges.total, 1)), mass, cloths, describe_materials(input),
      describe_method(input), -extent[0], extent[3], -extent[1], extent[4], -extent[2], extent[5], yarns,
      double(mesh.edges.total) / double(std::max<Global>(yarns, 1)),
      length / double(std::max<Global>(yarns, 1)), size_of(comm), size_of(comm) == 1 ? "" : "s",
      mesh.report.edge_cut, mesh.report.imbalance, mesh.report.ghosts_max,
      describe_cost(comm, input, simulation));
}

} // namespace

int info(MPI_Comm comm, const CaseSource& source) {
  const fs::path& path = source.file;
  const bool is_run = broadcast(comm, [&] {
                        if (!fs::exists(path))
                          throw InputError(fmt::format("{}: there is no such file or folder", path.string()));
                        return std::string(fs::is_directory(path) ? "run" : "case");
                      }) == "run";
  if (is_run && !source.overrides.empty())
    throw InputError(fmt::format("--set {}: is for a case; {} is a run, whose keys are what they were",
                                 source.overrides[0].key, path.string()));
  const std::string text =
      is_run ? broadcast(comm, [&] { return describe_run(path); }) : describe_case(comm, source);
  if (rank_of(comm) == 0) fmt::print("{}", text);
  return success;
}

} // namespace taut::command
