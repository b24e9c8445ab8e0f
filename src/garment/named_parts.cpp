#include "src/garment/named_parts.hpp"

#include "io/hdf5.hpp"
#include "partition/comm.hpp"
#include "partition/mesh_slab.hpp"
#include "partition/sort_unique.hpp"
#include "src/config/suggest.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace taut::garment {

using Json = nlohmann::json;

namespace {

/// The datasets and the attribute of one kind of parts.
struct Kind {
  const char *names, *offsets, *vertices, *pairs;
};
constexpr Kind of_seams{"seams", "/seams/offsets", "/seams/vertices", "/seams/pairs"},
    of_labels{"labels", "/labels/offsets", "/labels/vertices", ""};
constexpr const char *of_panels = "panels", *panel_of_cells = "/cells/panel";

std::string text_of(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

[[noreturn]] void refuse(const H5Reader& file, const std::string& what) {
  throw InputError(
      fmt::format("{}: {} do not go together; write the file again", file.path().string(), what));
}

std::vector<Global> read_all(const H5Reader& file, const char* name) {
  const Global rows = file.rows(name);
  return file.read<Global>(name, {0, rows, rows});
}

std::vector<std::string> read_names(const H5Reader& file, const char* attribute, std::size_t count) {
  const Json names = Json::parse(file.attribute<std::string>(attribute), nullptr, false);
  const bool sound = names.is_array() && names.size() == count &&
                     std::all_of(names.begin(), names.end(), [](const Json& n) { return n.is_string(); });
  if (!sound) refuse(file, fmt::format("attribute {} and its datasets", attribute));
  return names.get<std::vector<std::string>>();
}

/// Of a garment that is not sewn there are pairs in the place of vertices.
std::vector<NamedSeam> read_lists(const H5Reader& file, const Kind& kind) {
  const bool has_pairs = !file.has(kind.vertices);
  const char* dataset = has_pairs ? kind.pairs : kind.vertices;
  if (!file.has(kind.offsets) || !file.has(dataset)) return {};
  const auto offsets = read_all(file, kind.offsets), vertices = read_all(file, dataset);
  const Global step = has_pairs ? 2 : 1;
  if (offsets.empty() || offsets.front() != 0 || !std::is_sorted(offsets.begin(), offsets.end()) ||
      step * offsets.back() != Global(vertices.size()))
    refuse(file, fmt::format("{} and {}", kind.offsets, dataset));
  const auto names = read_names(file, kind.names, offsets.size() - 1);
  std::vector<NamedSeam> lists;
  for (std::size_t k = 0; k < names.size(); ++k) {
    lists.push_back(
        {names[k], {vertices.begin() + step * offsets[k], vertices.begin() + step * offsets[k + 1]}});
    sort_unique(lists.back().vertices);
  }
  return lists;
}

/// The cells of a panel are one run.
std::vector<NamedPanel> read_panels(MPI_Comm comm, const H5Reader& file) {
  if (!file.has(panel_of_cells)) return {};
  const Slab slab = slab_of(file.rows(panel_of_cells), size_of(comm), rank_of(comm));
  const Global before = slab.first > 0 ? 1 : 0; // the cell before the slab tells whether a run goes on
  const auto panel =
      file.read<Global>(panel_of_cells, {slab.first - before, slab.count + before, slab.total});
  std::vector<std::array<Global, 2>> mine; // panel, its first cell
  for (std::size_t c = std::size_t(before); c < panel.size(); ++c)
    if (c == 0 || panel[c] != panel[c - 1]) mine.push_back({panel[c], slab.first - before + Global(c)});
  const auto runs = gather_to_all<std::array<Global, 2>>(comm, mine);
  const auto names = read_names(file, of_panels, runs.size());
  std::vector<NamedPanel> panels;
  for (std::size_t k = 0; k < runs.size(); ++k) {
    if (runs[k][0] != Global(k)) refuse(file, fmt::format("attribute {} and {}", of_panels, panel_of_cells));
    panels.push_back({names[k], runs[k][1]});
  }
  return panels;
}

/// All ranks have all; rank 0 writes.
void write_all(MPI_Comm comm, H5Writer& file, const char* name, const std::vector<Global>& numbers) {
  const bool root = rank_of(comm) == 0;
  const Global rows = Global(numbers.size());
  file.write<Global>(name, root ? std::span<const Global>(numbers) : std::span<const Global>(), 1,
                     {0, root ? rows : 0, rows});
}

void write_lists(MPI_Comm comm, H5Writer& file, const Kind& kind, const std::vector<NamedSeam>& lists) {
  std::vector<Global> vertices, offsets{0};
  std::vector<std::string> names;
  for (const NamedSeam& list : lists) {
    vertices.insert(vertices.end(), list.vertices.begin(), list.vertices.end());
    offsets.push_back(Global(vertices.size()));
    names.push_back(list.name);
  }
  write_all(comm, file, kind.vertices, vertices);
  write_all(comm, file, kind.offsets, offsets);
  write_names(file, kind.names, names);
}

} // namespace

int NamedParts::panel_of(Global cell) const {
  const auto after = std::upper_bound(panels.begin(), panels.end(), cell,
                                      [](Global c, const NamedPanel& p) { return c < p.first_cell; });
  return int(after - panels.begin()) - 1;
}

std::string no_such_label(const Labels& labels, const std::string& label) {
  std::vector<std::string> names;
  for (const auto& [name, vertices] : labels) names.push_back(name);
  const auto meant = config::nearest(label, names);
  return fmt::format("no edge and no panel has the label '{}'{}; {}", label,
                     meant ? fmt::format(" (did you mean '{}'?)", *meant) : "",
                     names.empty()
                         ? "the cloth has none; `label` of a panel or edge gives one in the pattern, "
                           "`points` one at a place of it"
                         : fmt::format("there are {}", fmt::join(names, ", ")));
}

void to_json(Json& json, const NamedSeam& s) { json = {s.name, s.vertices}; }
void from_json(const Json& json, NamedSeam& s) { s = {json.at(0), json.at(1)}; }
void to_json(Json& json, const NamedPanel& p) { json = {p.name, p.first_cell}; }
void from_json(const Json& json, NamedPanel& p) { p = {json.at(0), json.at(1)}; }

NamedParts share(MPI_Comm comm, const NamedParts& parts) {
  const Json all = Json::parse(broadcast_text(comm, text_of({parts.panels, parts.seams, parts.labels})));
  return {all[0], all[1], all[2]};
}

NamedParts read_named_parts(MPI_Comm comm, const std::filesystem::path& path) {
  if (path.extension() != ".h5") return {};
  const H5Reader file(comm, path);
  NamedParts parts;
  parts.panels = read_panels(comm, file);
  parts.seams = read_lists(file, of_seams);
  for (NamedSeam& label : read_lists(file, of_labels)) parts.labels[label.name] = std::move(label.vertices);
  return parts;
}

void write_names(H5Writer& file, const char* attribute, const std::vector<std::string>& names) {
  file.attribute(attribute, text_of(names));
}

void write_panels(H5Writer& file, const std::vector<NamedPanel>& panels) {
  std::vector<std::string> names;
  for (const NamedPanel& p : panels) names.push_back(p.name);
  write_names(file, of_panels, names);
}

void write_seams(MPI_Comm comm, H5Writer& file, const std::vector<NamedSeam>& seams) {
  write_lists(comm, file, of_seams, seams);
}

void write_labels(MPI_Comm comm, H5Writer& file, const Labels& labels) {
  std::vector<NamedSeam> lists;
  for (const auto& [name, vertices] : labels) lists.push_back({name, vertices});
  write_lists(comm, file, of_labels, lists);
}

} // namespace taut::garment
