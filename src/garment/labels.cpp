#include "src/garment/labels.hpp"

#include "io/hdf5.hpp"
#include "partition/comm.hpp"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <fmt/format.h>

namespace taut::garment {

using Json = nlohmann::json;

Labels share_labels(MPI_Comm comm, const Labels& labels) {
  const auto replace = Json::error_handler_t::replace;
  return Json::parse(broadcast_text(comm, Json(labels).dump(-1, ' ', false, replace))).get<Labels>();
}

Labels read_labels(MPI_Comm comm, const std::filesystem::path& path) {
  constexpr const char *of_offsets = "/labels/offsets", *of_vertices = "/labels/vertices";
  if (path.extension() != ".h5") return {};
  const H5Reader file(comm, path);
  if (!file.has(of_offsets) || !file.has(of_vertices)) return {};
  const auto all = [&](const char* name) {
    const Global rows = file.rows(name);
    return file.read<Global>(name, {0, rows, rows});
  };
  const auto offsets = all(of_offsets), vertices = all(of_vertices);
  const Json names = Json::parse(file.attribute<std::string>("labels"), nullptr, false);
  const bool sound = names.is_array() && names.size() + 1 == offsets.size() && offsets.front() == 0 &&
                     std::is_sorted(offsets.begin(), offsets.end()) &&
                     offsets.back() == Global(vertices.size()) &&
                     std::all_of(names.begin(), names.end(), [](const Json& n) { return n.is_string(); });
  if (!sound)
    throw InputError(fmt::format("{}: attribute labels, {} and {} do not go together; write the file again",
                                 path.string(), of_offsets, of_vertices));
  Labels labels;
  for (std::size_t k = 0; k < names.size(); ++k)
    labels[names[k].get<std::string>()].assign(vertices.begin() + offsets[k],
                                               vertices.begin() + offsets[k + 1]);
  return labels;
}

} // namespace taut::garment
