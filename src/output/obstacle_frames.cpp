#include "src/output/obstacle_frames.hpp"

#include "io/hdf5.hpp"

namespace taut {

namespace {

/// Twice the largest extent of the rest shape along an axis, m.
double width_of(const Cloth& cloth) {
  std::array<double, 6> ends;
  ends.fill(-HUGE_VAL);
  for (const Vec3& x : cloth.mesh.rest_positions)
    for (int k = 0; k < 3; ++k) {
      ends[k] = std::max(ends[k], x[k]);
      ends[3 + k] = std::max(ends[3 + k], -x[k]);
    }
  max_in_place(cloth.mesh.comm, ends);
  return 2 * std::max({ends[0] + ends[3], ends[1] + ends[4], ends[2] + ends[5]});
}

/// All ranks know the obstacles; rank 0 writes them.
Slab rows_on_first(MPI_Comm comm, std::size_t rows) {
  const Global total = Global(rows);
  return rank_of(comm) == 0 ? Slab{0, total, total} : Slab{total, 0, total};
}

template<class T>
std::span<const T> part(const Slab& slab, std::span<const T> all, int columns = 1) {
  return all.first(std::size_t(slab.count) * std::size_t(columns));
}

} // namespace

ObstacleFrames::ObstacleFrames(const Cloth& cloth, const Obstacles& obstacles)
    : comm_(cloth.mesh.comm), all_rest_(obstacles.all_rest()), surface_(obstacles, width_of(cloth)) {}

void ObstacleFrames::write_once(H5Writer& file) const {
  const Slab slab = rows_on_first(comm_, surface_.faces().size());
  const std::span<const Global> corners(reinterpret_cast<const Global*>(surface_.faces().data()),
                                        3 * surface_.faces().size());
  file.write<Global>("/obstacles/faces", part(slab, corners, 3), 3, slab);
  file.write<std::int32_t>("/obstacles/bodies", part(slab, surface_.bodies()), 1, slab);
  if (all_rest_) write_positions(file, 0);
}

void ObstacleFrames::write_frame(H5Writer& file, double time) const {
  if (!all_rest_) write_positions(file, time);
}

void ObstacleFrames::write_positions(H5Writer& file, double time) const {
  const std::vector<Vec3> positions = surface_.at(time);
  const Slab slab = rows_on_first(comm_, positions.size());
  file.write("/obstacles/positions", part(slab, std::span<const Vec3>(positions)), slab);
}

XdmfText ObstacleFrames::xdmf() const {
  XdmfDescription d;
  d.positions = "/obstacles/positions";
  d.positions_home = all_rest_ ? XdmfHome::mesh : XdmfHome::frame;
  d.points = Global(surface_.at(0).size());
  d.shape = XdmfCells::triangles;
  d.cells_dataset = "/obstacles/faces";
  d.cells = Global(surface_.faces().size());
  d.cells_length = 3 * d.cells;
  d.fields = {{"body", "/obstacles/bodies", XdmfCentre::cell, 1, XdmfNumber::int32, XdmfHome::mesh}};
  return XdmfText(d);
}

} // namespace taut
