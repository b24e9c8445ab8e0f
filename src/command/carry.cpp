#include "src/command/carry.hpp"

#include "src/command/run_folder.hpp"
#include "src/command/run_lock.hpp"
#include "src/command/sewing.hpp"
#include "src/config/cloths.hpp"
#include "src/garment/load_garment.hpp"
#include "src/garment/sewn_mesh.hpp"
#include "src/garment/worn_garment.hpp"
#include "src/garment/write_mesh.hpp"
#include "src/output/run_files.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace taut::command {

namespace {

namespace fs = std::filesystem;

/// On rank 0.
struct CarriedGarment {
  garment::GarmentMesh mesh;
  garment::SewnMesh sewn;
};

CarriedGarment carry(MPI_Comm comm, const Case& input, std::size_t k) {
  const config::Cloth& cloth = input.cloths[k];
  const fs::path run = input.folder() / *cloth.start.run;
  const std::string key =
      fmt::format("{}: {}.start.run: ", input.file.string(), config::key_of_cloth(input, k));
  const garment::WornGarment worn(comm, run / run_files::mesh, last_frame(comm, run, key));
  auto [name, mesh] = garment::load_garment(comm, input, k);
  CarriedGarment carried{std::move(mesh), {}};
  on_rank_0(comm, [&, &name = name] {
    const std::string prefix = input.cloths.size() == 1 ? "" : fmt::format("{}.", k);
    carried.sewn = garment::sew(carried.mesh, worn.carry(carried.mesh, prefix), name,
                                garment::shorter_sides(carried.mesh, input, k));
  });
  return carried;
}

} // namespace

fs::path last_frame(MPI_Comm comm, const fs::path& run, const std::string& key) {
  return broadcast(comm, [&] {
    std::string last;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(run / "frames", none))
      if (entry.path().extension() == ".h5") last = std::max(last, entry.path().string());
    if (last.empty()) throw InputError(fmt::format("{}{}: holds no run with frames", key, run.string()));
    return last;
  });
}

bool is_carried(const Case& input) {
  return std::any_of(input.cloths.begin(), input.cloths.end(),
                     [](const config::Cloth& c) { return c.start.run.has_value(); });
}

int run_carried(MPI_Comm comm, const Case& input, const RunOptions& options, const StopSignal& stop,
                double began) {
  std::vector<CarriedGarment> garments;
  for (std::size_t k = 0; k < input.cloths.size(); ++k) garments.push_back(carry(comm, input, k));
  make_run_folder(comm, options.out, input.file);
  const RunLock lock(comm, options.out);
  clear_run_folder(comm, options.out, options.existing);
  std::vector<fs::path> files;
  for (std::size_t k = 0; k < input.cloths.size(); ++k) {
    files.push_back(garment_file(input, k, options.out, "carried"));
    garment::write_h5(comm, garments[k].mesh, garments[k].sewn, files.back());
  }
  const fs::path before = input.folder() / *input.cloths.front().start.run;
  return run_garments(comm, with_fitted_bodies(comm, input, before), files, options, stop, began);
}

} // namespace taut::command
