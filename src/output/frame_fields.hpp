#pragma once
#include "src/contact/obstacles.hpp"
#include "src/state/state.hpp"

#include <functional>
#include <variant>

namespace taut {

enum class FieldCentre { vertex, edge, cell };

/// Where the values of a field are kept: in every frame, or in the mesh that all frames share.
enum class FieldHome { each_frame, shared_mesh };

/// The values of this rank's owned vertices, edges or cells in their local order; ghosts may follow.
/// Collective.
template<class T>
using Compute = std::function<std::vector<T>(const State& state)>;

/// A row of the table of what frames hold besides positions. How many numbers a value has, and of which type,
/// is what `compute` gives.
struct FrameField {
  std::string name;    ///< as it is shown
  std::string dataset; ///< in HDF5
  FieldCentre centre;
  FieldHome home;
  std::string unit; ///< empty: without
  std::variant<Compute<double>, Compute<Vec3>, Compute<Global>, Compute<std::int32_t>> compute;
};

/// The fields that `input.output` wants and this case has, in the order in which they are shown. `cloth` and
/// `obstacles` must outlive them. Collective.
std::vector<FrameField> frame_fields(const Cloth& cloth, const Obstacles& obstacles, const Case& input);

} // namespace taut
