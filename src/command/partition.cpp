#include "io/whole_file.hpp"
#include "partition/partition_figures.hpp"
#include "src/command/command.hpp"
#include "src/state/start.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cstdio>

namespace taut::command {

namespace {

constexpr Global bytes_of_position = sizeof(Vec3);

std::string row(const char* name, const Spread& s) {
  return fmt::format("  {:<34} {:>12} {:>14.1f} {:>12}\n", name, s.min, s.mean, s.max);
}

Spread times(const Spread& s, Global factor) {
  return {s.min * factor, s.max * factor, s.mean * double(factor)};
}

std::string table(const std::string& name, const char* method, const PartitionFigures& f) {
  return fmt::format("{}: {:.0f} vertices for {} ranks, by {}\n"
                     "  {} edges cut, imbalance {:.3f}; {} of {} yarns lie on more than one rank\n"
                     "  {:<34} {:>12} {:>14} {:>12}\n",
                     name, f.vertices.mean * f.parts, f.parts, method, f.edge_cut, f.imbalance, f.cut_yarns,
                     f.yarns, "of a rank", "least", "mean", "most") +
         row("vertices", f.vertices) + row("ghost vertices", f.ghosts) + row("ghost edges", f.ghost_edges) +
         row("neighbours", f.neighbours) + row("yarn segments", f.yarn_segments) +
         row("bytes received: positions", times(f.ghosts, bytes_of_position)) +
         row("bytes received: a number an edge", times(f.ghost_edges, sizeof(double)));
}

/// Whether so many ranks are worth it.
std::string verdict(const PartitionFigures& f) {
  constexpr double enough = 2000; // vertices of a rank, from which on work outweighs messages
  if (f.vertices.min == 0)
    return "  verdict: some ranks have no vertices at all, and would only wait; use fewer ranks\n";
  if (f.vertices.mean < enough)
    return fmt::format(
        "  verdict: {:.0f} vertices a rank are few, and messages may take longer than work; better "
        "--ranks {}\n",
        f.vertices.mean, std::max(1, int(f.vertices.mean * f.parts / enough)));
  if (f.imbalance > 1.2)
    return fmt::format(
        "  verdict: the largest part has {:.0f} % more vertices than the mean, for which all wait\n",
        100 * (f.imbalance - 1));
  return fmt::format("  verdict: good; {:.2g} ghosts a vertex of the rank with most\n",
                     double(f.ghosts.max) / double(f.vertices.max));
}

std::string json(const std::string& name, const char* method, const PartitionFigures& f) {
  using Json = nlohmann::ordered_json;
  const auto spread = [](const Spread& s) { return Json{{"min", s.min}, {"mean", s.mean}, {"max", s.max}}; };
  const Json json = {{"case", name},
                     {"ranks", f.parts},
                     {"method", method},
                     {"edge_cut", f.edge_cut},
                     {"imbalance", f.imbalance},
                     {"yarns", f.yarns},
                     {"cut_yarns", f.cut_yarns},
                     {"vertices", spread(f.vertices)},
                     {"ghosts", spread(f.ghosts)},
                     {"ghost_edges", spread(f.ghost_edges)},
                     {"neighbours", spread(f.neighbours)},
                     {"yarn_segments", spread(f.yarn_segments)},
                     {"position_bytes", spread(times(f.ghosts, bytes_of_position))},
                     {"edge_bytes", spread(times(f.ghost_edges, sizeof(double)))}};
  return json.dump(2) + "\n";
}

} // namespace

int partition(MPI_Comm comm, const PartitionOptions& options) {
  if (options.ranks < 1)
    throw InputError(
        fmt::format("--ranks {}: give the number of ranks to cut the cloth for, at least 1", options.ranks));
  const Case input = load_case(comm, options.source);
  const UndistributedCloth cloth = read_cloth(comm, input);
  if (options.ranks > cloth.mesh.slab.vertices.total)
    throw InputError(fmt::format("--ranks {}: the cloth has only {} vertices; give no more ranks than that",
                                 options.ranks, cloth.mesh.slab.vertices.total));
  const auto owners = cut_by_places(comm, cloth, input, places_at_start(comm, cloth, input), options.ranks);
  const PartitionFigures figures =
      partition_figures(comm, cloth.mesh.slab, cloth.mesh.topology, owners, options.ranks);
  const char* method = config::word_of(input.partition.method).data();
  if (!options.json.empty()) write_text_whole(comm, options.json, json(input.name, method, figures));
  if (rank_of(comm) == 0) fmt::print("{}{}", table(input.name, method, figures), verdict(figures));
  return success;
}

} // namespace taut::command
