#include "io/xdmf.hpp"

#include <fmt/format.h>

#include <array>
#include <iterator>

namespace taut {
namespace {

using Out = std::back_insert_iterator<std::string>;

std::string number_attributes(XdmfNumber number) {
  switch (number) {
  case XdmfNumber::float64:
    return R"(NumberType="Float" Precision="8")";
  case XdmfNumber::int64:
    return R"(NumberType="Int" Precision="8")";
  case XdmfNumber::int32:
    return R"(NumberType="Int" Precision="4")";
  }
  return {};
}

std::string data_item(XdmfNumber number, const std::string& dimensions, const std::string& file,
                      const std::string& dataset) {
  return fmt::format(R"(<DataItem Format="HDF" {} Dimensions="{}">{}:{}</DataItem>)",
                     number_attributes(number), dimensions, file, dataset);
}

std::string topology_type(XdmfCells shape) {
  switch (shape) {
  case XdmfCells::lines:
    return R"(TopologyType="Polyline" NodesPerElement="2")";
  case XdmfCells::triangles:
    return R"(TopologyType="Triangle")";
  case XdmfCells::quads:
    return R"(TopologyType="Quadrilateral")";
  case XdmfCells::mixed:
    return R"(TopologyType="Mixed")";
  }
  return {};
}

std::string cells_dimensions(const XdmfDescription& d) {
  if (d.shape == XdmfCells::mixed) return fmt::format("{}", d.cells_length);
  const int vertices = d.shape == XdmfCells::lines ? 2 : d.shape == XdmfCells::triangles ? 3 : 4;
  return fmt::format("{} {}", d.cells, vertices);
}

void put_field(Out out, const XdmfDescription& d, const XdmfFrame& frame, const XdmfField& field) {
  const bool at_points = field.centre == XdmfCentre::point;
  const Global rows = at_points ? d.points : d.cells;
  const std::string& file = field.home == XdmfHome::mesh ? d.mesh_file : frame.file;
  const std::string dimensions =
      field.components == 1 ? fmt::format("{}", rows) : fmt::format("{} {}", rows, field.components);
  fmt::format_to(out, R"(        <Attribute Name="{}" AttributeType="{}" Center="{}">
          {}
        </Attribute>
)",
                 field.name, field.components == 1 ? "Scalar" : "Vector", at_points ? "Node" : "Cell",
                 data_item(field.number, dimensions, file, field.dataset));
}

void put_frame(Out out, const XdmfDescription& d, const XdmfFrame& frame) {
  fmt::format_to(out, R"(      <Grid Name="cloth" GridType="Uniform">
        <Time Value="{}"/>
        <Topology {} NumberOfElements="{}">
          {}
        </Topology>
        <Geometry GeometryType="XYZ">
          {}
        </Geometry>
)",
                 frame.time, topology_type(d.shape), d.cells,
                 data_item(XdmfNumber::int64, cells_dimensions(d), d.mesh_file, d.cells_dataset),
                 data_item(XdmfNumber::float64, fmt::format("{} 3", d.points),
                           d.positions_home == XdmfHome::mesh ? d.mesh_file : frame.file, d.positions));
  for (const XdmfField& field : d.fields) put_field(out, d, frame, field);
  fmt::format_to(out, "      </Grid>\n");
}

} // namespace

void XdmfText::add(const XdmfFrame& frame) { put_frame(std::back_inserter(grids_), description_, frame); }

std::string XdmfText::whole() const {
  constexpr std::string_view head = R"(<?xml version="1.0" encoding="utf-8"?>
<Xdmf Version="3.0">
  <Domain>
    <Grid Name="frames" GridType="Collection" CollectionType="Temporal">
)",
                             foot = R"(    </Grid>
  </Domain>
</Xdmf>
)";
  return fmt::format("{}{}{}", head, grids_, foot);
}

std::vector<Global> xdmf_mixed_cells(std::span<const Global> vertices, std::span<const Global> offsets) {
  constexpr std::array<Global, 5> kind{0, 0, 2, 4, 5}; // by number of vertices: polyline, triangle, quad
  std::vector<Global> stream;
  if (offsets.empty()) return stream;
  stream.reserve(vertices.size() + 2 * offsets.size());
  for (std::size_t c = 0; c + 1 < offsets.size(); ++c) {
    const Global size = offsets[c + 1] - offsets[c];
    stream.push_back(kind[size]);
    if (size == 2) stream.push_back(size);
    const auto cell = vertices.subspan(offsets[c] - offsets[0], size);
    stream.insert(stream.end(), cell.begin(), cell.end());
  }
  return stream;
}

} // namespace taut
