#include "src/output/h5_field.hpp"

namespace taut {

namespace {

const OriginalOrder& order_of(const DistributedMesh& mesh, FieldCentre centre) {
  switch (centre) {
  case FieldCentre::vertex:
    return mesh.vertex_order;
  case FieldCentre::edge:
    return mesh.edge_order;
  case FieldCentre::cell:
    break;
  }
  return mesh.cell_order;
}

template<class T>
constexpr XdmfNumber number_of = std::same_as<T, std::int32_t> ? XdmfNumber::int32
                                 : std::same_as<T, Global>     ? XdmfNumber::int64
                                                               : XdmfNumber::float64;

} // namespace

void write_field(H5Writer& file, const DistributedMesh& mesh, const FrameField& field, const State& state) {
  const OriginalOrder& order = order_of(mesh, field.centre);
  std::visit(
      [&]<class T>(const Compute<T>& compute) {
        const std::vector<T> rows = order.to_slab<T>(compute(state));
        if constexpr (std::same_as<T, Vec3>)
          file.write(field.dataset, rows, order.slab());
        else
          file.write<T>(field.dataset, rows, 1, order.slab());
      },
      field.compute);
}

XdmfField describe(const FrameField& field) {
  const auto centre = field.centre == FieldCentre::vertex ? XdmfCentre::point : XdmfCentre::cell;
  const auto home = field.home == FieldHome::shared_mesh ? XdmfHome::mesh : XdmfHome::frame;
  return std::visit(
      [&]<class T>(const Compute<T>&) {
        return XdmfField{field.name,   field.dataset, centre, std::same_as<T, Vec3> ? 3 : 1,
                         number_of<T>, home};
      },
      field.compute);
}

} // namespace taut
