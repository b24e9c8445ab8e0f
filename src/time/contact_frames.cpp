#include "src/time/contact_frames.hpp"

#include "io/hdf5.hpp"
#include "src/contact/thickness.hpp"

namespace taut {

ContactFrames::ContactFrames(const Cloth& cloth, const Obstacles& obstacles, const Case& input)
    : cloth_(cloth), obstacles_(obstacles),
      gauge_(cloth, obstacles, 2.0 * Thickness(cloth, input).largest()) {}

void ContactFrames::describe(std::vector<XdmfField>& fields) const {
  fields.push_back({"contact_force", "/contact_forces", XdmfCentre::point, 3});
  fields.push_back({"gap", "/gaps", XdmfCentre::point, 1});
}

void ContactFrames::write(H5Writer& file, const State& state) {
  const OriginalOrder& order = cloth_.mesh.vertex_order;
  file.write("/contact_forces", order.to_slab<Vec3>(state.reported.contact_force), order.slab());
  obstacles_.place(state.time, bodies_);
  file.write<double>("/gaps", order.to_slab<double>(gauge_.measure(state.positions, bodies_)), 1,
                     order.slab());
}

} // namespace taut
