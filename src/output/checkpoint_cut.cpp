#include "src/output/checkpoint_cut.hpp"

#include "src/output/checkpoint_format.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace taut {

namespace {

constexpr const char *ranks_name = "ranks", *owners_name = "owners";

std::vector<int> cut_by_positions(const H5Reader& file, MPI_Comm comm, const UndistributedCloth& cloth,
                                  const Case& input) {
  const Places places = [&] { return file.read_vectors("positions", cloth.mesh.slab.vertices); };
  return cut_by_places(comm, cloth, input, places, size_of(comm));
}

} // namespace

void write_cut(H5Writer& checkpoint, const DistributedMesh& mesh) {
  checkpoint.attribute(ranks_name, Global(size_of(mesh.comm)));
  const std::vector<Global> owners(mesh.vertices.size(), rank_of(mesh.comm));
  const OriginalOrder& order = mesh.vertex_order;
  checkpoint.write<Global>(owners_name, order.to_slab<Global>(owners), 1, order.slab());
}

Cut cut_by_checkpoint(const std::filesystem::path& path) {
  return [path](MPI_Comm comm, const UndistributedCloth& cloth, const Case& input) {
    const H5Reader file(comm, path, Checksum::required);
    check_checkpoint_format(file);
    return cut_by_positions(file, comm, cloth, input);
  };
}

Cut cut_of_checkpoint(const std::filesystem::path& path) {
  return [path](MPI_Comm comm, const UndistributedCloth& cloth, const Case& input) {
    const H5Reader file(comm, path, Checksum::required);
    check_checkpoint_format(file);
    if (file.attribute<Global>(ranks_name) != size_of(comm))
      return cut_by_positions(file, comm, cloth, input);
    const auto owners = file.read<Global>(owners_name, cloth.mesh.slab.vertices);
    const auto is_rank = [&](Global owner) { return owner >= 0 && owner < size_of(comm); };
    if (any_of(comm, !std::ranges::all_of(owners, is_rank)))
      throw InputError(fmt::format("{}: {}: it names ranks that are none; this is no sound checkpoint of the "
                                   "run",
                                   path.string(), owners_name));
    return std::vector<int>(owners.begin(), owners.end());
  };
}

} // namespace taut
