#include "src/output/findings.hpp"

#include "partition/comm.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace taut {

namespace {

constexpr std::size_t most = 5000; ///< of one rank

template<class Write>
std::string array(const char* attributes, std::span<const Intersection> found, Write&& write) {
  std::string text = fmt::format("<DataArray {} format=\"ascii\">\n", attributes);
  for (const Intersection& i : found) text += write(i);
  return text + "</DataArray>\n";
}

} // namespace

std::string findings_as_vtp(MPI_Comm comm, std::span<const Intersection> found) {
  const auto mine = found.first(std::min(found.size(), most));
  const std::vector<int> to_root(mine.size(), 0);
  const auto all = exchange(comm, std::vector<Intersection>(mine.begin(), mine.end()), to_root).items;
  std::string text = fmt::format("<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"0.1\">\n"
                                 "<PolyData>\n<Piece NumberOfPoints=\"{0}\" NumberOfVerts=\"{0}\">\n",
                                 all.size());
  text += "<Points>\n" +
          array("type=\"Float64\" NumberOfComponents=\"3\"", all,
                [](const Intersection& i) {
                  return fmt::format("{:.17g} {:.17g} {:.17g}\n", i.place[0], i.place[1], i.place[2]);
                }) +
          "</Points>\n<Verts>\n";
  Global number = 0, end = 0;
  text += array("type=\"Int64\" Name=\"connectivity\"", all,
                [&](const Intersection&) { return fmt::format("{}\n", number++); });
  text += array("type=\"Int64\" Name=\"offsets\"", all,
                [&](const Intersection&) { return fmt::format("{}\n", ++end); });
  text += "</Verts>\n<PointData>\n";
  text += array("type=\"Int64\" Name=\"first\" NumberOfComponents=\"2\"", all,
                [](const Intersection& i) { return fmt::format("{} {}\n", i.first[0], i.first[1]); });
  text += array("type=\"Int64\" Name=\"second\" NumberOfComponents=\"2\"", all,
                [](const Intersection& i) { return fmt::format("{} {}\n", i.second[0], i.second[1]); });
  text += array("type=\"Int64\" Name=\"obstacle\"", all,
                [](const Intersection& i) { return fmt::format("{}\n", i.body); });
  return text + "</PointData>\n</Piece>\n</PolyData>\n</VTKFile>\n";
}

} // namespace taut
