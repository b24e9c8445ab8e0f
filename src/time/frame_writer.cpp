#include "src/time/frame_writer.hpp"

#include "io/hdf5.hpp"
#include "partition/traffic.hpp"
#include "partition/yarns.hpp"
#include "src/time/frame_fields.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace taut {

namespace {

/// The cells of this rank's slab as XDMF's or HDF5's lists of vertices.
struct CellLists {
  std::vector<Global> vertices, offsets{0};
};

CellLists cells_in_order(const DistributedMesh& mesh) {
  std::vector<std::array<Global, 4>> owned;
  for (const Local c : mesh.owned_cells) {
    auto& cell = owned.emplace_back(std::array<Global, 4>{-1, -1, -1, -1});
    for (int k = 0; k < mesh.cells[c].size(); ++k)
      cell[k] = mesh.vertices.original[mesh.cells[c].vertices[k]];
  }
  CellLists lists;
  for (const auto& cell : mesh.cell_order.to_slab<std::array<Global, 4>>(owned)) {
    for (const Global v : cell)
      if (v >= 0) lists.vertices.push_back(v);
    lists.offsets.push_back(Global(lists.vertices.size()));
  }
  return lists;
}

/// Rows of a list whose lengths differ from rank to rank.
Slab rows_of(MPI_Comm comm, std::size_t count) {
  return {exclusive_sum(comm, Global(count)), Global(count), sum_over(comm, Global(count))};
}

XdmfCells shape_of(const DistributedMesh& mesh) {
  Global smallest = 4, largest = 2;
  for (const LocalCell& c : mesh.cells) {
    smallest = std::min<Global>(smallest, c.size());
    largest = std::max<Global>(largest, c.size());
  }
  smallest = -max_over(mesh.comm, -smallest);
  largest = max_over(mesh.comm, largest);
  if (smallest != largest) return XdmfCells::mixed;
  return largest == 2 ? XdmfCells::lines : largest == 3 ? XdmfCells::triangles : XdmfCells::quads;
}

} // namespace

std::string FrameWriter::file_of(Global frame) { return fmt::format("frames/frame_{:06}.h5", frame); }

FrameWriter::FrameWriter(const Cloth& cloth, const Obstacles& obstacles, const Case& input,
                         std::filesystem::path folder, std::vector<XdmfFrame> earlier)
    : cloth_(cloth), fields_(input.output.fields), folder_(std::move(folder)), obstacles_(cloth, obstacles),
      frames_(std::move(earlier)), taken_(frames_.size()) {
  if (input.has_contact() && wants(config::Field::contact)) contact_.emplace(cloth, obstacles, input);
}

bool FrameWriter::wants(config::Field field) const {
  return std::find(fields_.begin(), fields_.end(), field) != fields_.end();
}

void FrameWriter::at_start(const State& state) {
  const double begin = MPI_Wtime();
  write_mesh();
  seconds_ += MPI_Wtime() - begin;
  if (frames_.empty()) write_frame(state, 0);
  list_frames();
}

void FrameWriter::after_frame(const State& state, Global frame) { write_frame(state, frame); }

void FrameWriter::write_mesh() {
  const PhaseScope phase(Phase::output);
  const DistributedMesh& mesh = cloth_.mesh;
  const CellLists cells = cells_in_order(mesh);
  const Slab faces = mesh.cell_order.slab(), vertices = mesh.vertex_order.slab(),
             edges = mesh.edge_order.slab();
  const Slab corners = rows_of(mesh.comm, cells.vertices.size());
  std::vector<Global> offsets(cells.offsets.begin(), cells.offsets.end() - 1);
  const bool last = rank_of(mesh.comm) == size_of(mesh.comm) - 1;
  if (last) offsets.push_back(cells.offsets.back());
  for (Global& o : offsets) o += corners.first;

  std::vector<std::array<Global, 2>> ends;
  for (Local e = 0; e < mesh.edges.owned; ++e)
    ends.push_back(
        {mesh.vertices.original[mesh.edge_vertices[e][0]], mesh.vertices.original[mesh.edge_vertices[e][1]]});
  ends = mesh.edge_order.to_slab<std::array<Global, 2>>(ends);

  const bool mixed = shape_of(mesh) == XdmfCells::mixed;
  Slab stream{};
  write_whole(mesh.comm, folder_ / "mesh.h5", [&](H5Writer& file) {
    file.write("/rest_positions", mesh.vertex_order.to_slab<Vec3>(mesh.rest_positions), vertices);
    file.write<Global>("/faces", cells.vertices, 1, corners);
    file.write<Global>("/face_offsets", offsets, 1, rows_of(mesh.comm, offsets.size()));
    file.write<Global>("/constraints/edges", {ends.data()->data(), 2 * ends.size()}, 2, edges);
    file.write<double>("/constraints/rest_lengths", mesh.edge_order.to_slab<double>(cloth_.rest_length), 1,
                       edges);
    if (wants(config::Field::owner_rank)) {
      const std::vector<std::int32_t> rank(mesh.vertices.owned, rank_of(mesh.comm));
      file.write<std::int32_t>("/owner_rank", mesh.vertex_order.to_slab<std::int32_t>(rank), 1, vertices);
    }
    if (wants(config::Field::yarn)) write_yarns(file);
    if (cloth_.pieces.size() > 1) write_cloth_numbers(file);
    if (mixed) {
      const auto numbers = xdmf_mixed_cells(cells.vertices, cells.offsets);
      stream = rows_of(mesh.comm, numbers.size());
      file.write<Global>("/xdmf_cells", numbers, 1, stream);
    }
    file.attribute("faces", faces.total);
    if (!obstacles_.empty()) obstacles_.write_faces(file);
  });
  describe(mixed ? stream.total : corners.total);
}

/// On edges, and on faces the yarn along warp and that along weft which meet at the first corner; -1: none.
void FrameWriter::write_yarns(H5Writer& file) const {
  const DistributedMesh& mesh = cloth_.mesh;
  const std::vector<Global> yarn = yarn_numbers(mesh, find_yarns(mesh));
  file.write<Global>("/constraints/yarn", mesh.edge_order.to_slab<Global>(yarn), 1, mesh.edge_order.slab());
  const auto of_side = [&](Local first, Local second) {
    return first >= 0 ? yarn[first] : second >= 0 ? yarn[second] : Global(-1);
  };
  std::vector<Global> warp, weft;
  for (const Local c : mesh.owned_cells) {
    const auto s = sides_of(mesh, c);
    warp.push_back(of_side(s[0], s[2]));
    weft.push_back(of_side(s[3], s[1]));
  }
  file.write<Global>("/cells/yarn_warp", mesh.cell_order.to_slab<Global>(warp), 1, mesh.cell_order.slab());
  file.write<Global>("/cells/yarn_weft", mesh.cell_order.to_slab<Global>(weft), 1, mesh.cell_order.slab());
}

/// Of each cell the number of the cloth that it is part of.
void FrameWriter::write_cloth_numbers(H5Writer& file) const {
  const DistributedMesh& mesh = cloth_.mesh;
  std::vector<std::int32_t> number;
  for (const Local c : mesh.owned_cells)
    number.push_back(std::int32_t(cloth_.piece_of(mesh.cells[c].vertices[0])));
  file.write<std::int32_t>("/cells/cloth", mesh.cell_order.to_slab<std::int32_t>(number), 1,
                           mesh.cell_order.slab());
}

void FrameWriter::describe(Global cells_length) {
  xdmf_.emplace_back("frames.xdmf", XdmfText(describe_cells(cells_length)));
  if (!obstacles_.empty()) xdmf_.emplace_back("obstacles.xdmf", obstacles_.xdmf());
  if (cloth_.mesh.edges.total > 0) xdmf_.emplace_back("edges.xdmf", XdmfText(describe_edges()));
}

XdmfDescription FrameWriter::describe_cells(Global cells_length) const {
  using enum config::Field;
  const DistributedMesh& mesh = cloth_.mesh;
  XdmfDescription d;
  d.points = mesh.vertices.total;
  d.shape = shape_of(mesh);
  d.cells = mesh.total_cells;
  d.cells_length = cells_length;
  d.cells_dataset = d.shape == XdmfCells::mixed ? "/xdmf_cells" : "/faces";
  const auto of_mesh = [](const char* name, const char* dataset, XdmfCentre centre, XdmfNumber number) {
    return XdmfField{name, dataset, centre, 1, number, XdmfHome::mesh};
  };
  if (wants(velocity)) d.fields.push_back({"velocity", "/velocities", XdmfCentre::point, 3});
  if (wants(reaction)) d.fields.push_back({"reaction", "/reactions", XdmfCentre::point, 3});
  if (contact_) contact_->describe(d.fields);
  if (wants(owner_rank))
    d.fields.push_back(of_mesh("owner_rank", "/owner_rank", XdmfCentre::point, XdmfNumber::int32));
  if (cloth_.pieces.size() > 1)
    d.fields.push_back(of_mesh("cloth", "/cells/cloth", XdmfCentre::cell, XdmfNumber::int32));
  if (wants(yarn))
    for (const auto& [name, dataset] :
         {std::pair{"yarn_warp", "/cells/yarn_warp"}, std::pair{"yarn_weft", "/cells/yarn_weft"}})
      d.fields.push_back(of_mesh(name, dataset, XdmfCentre::cell, XdmfNumber::int64));
  for (const auto& [field, name] : {std::pair{strain, "strain"}, std::pair{tension, "tension"}})
    if (wants(field))
      for (const char* direction : {"warp", "weft"})
        d.fields.push_back({fmt::format("{}_{}", name, direction),
                            fmt::format("/cells/{}_{}", name, direction), XdmfCentre::cell});
  return d;
}

XdmfDescription FrameWriter::describe_edges() const {
  using enum config::Field;
  const DistributedMesh& mesh = cloth_.mesh;
  XdmfDescription d;
  d.points = mesh.vertices.total;
  d.shape = XdmfCells::lines;
  d.cells = mesh.edges.total;
  d.cells_length = 2 * mesh.edges.total;
  d.cells_dataset = "/constraints/edges";
  if (wants(yarn))
    d.fields.push_back({"yarn", "/constraints/yarn", XdmfCentre::cell, 1, XdmfNumber::int64, XdmfHome::mesh});
  if (wants(strain)) d.fields.push_back({"strain", "/strain", XdmfCentre::cell});
  if (wants(tension)) d.fields.push_back({"tension", "/tension", XdmfCentre::cell});
  return d;
}

void FrameWriter::write_frame(const State& state, Global frame) {
  const PhaseScope phase(Phase::output);
  using enum config::Field;
  const double begin = MPI_Wtime();
  const DistributedMesh& mesh = cloth_.mesh;
  const Slab vertices = mesh.vertex_order.slab(), edges = mesh.edge_order.slab(),
             faces = mesh.cell_order.slab();
  const auto write_edges = [&](H5Writer& file, const char* name, const std::vector<double>& values) {
    file.write<double>(fmt::format("/{}", name), mesh.edge_order.to_slab<double>(values), 1, edges);
  };
  const auto write_cells = [&](H5Writer& file, const char* name, const WarpWeft& values) {
    file.write<double>(fmt::format("/cells/{}_warp", name), mesh.cell_order.to_slab<double>(values.warp), 1,
                       faces);
    file.write<double>(fmt::format("/cells/{}_weft", name), mesh.cell_order.to_slab<double>(values.weft), 1,
                       faces);
  };
  const auto fill = [&](H5Writer& file) {
    file.attribute("time", state.time);
    file.write("/positions", mesh.vertex_order.to_slab<Vec3>(state.positions), vertices);
    if (wants(velocity))
      file.write("/velocities", mesh.vertex_order.to_slab<Vec3>(state.velocities), vertices);
    if (wants(reaction))
      file.write("/reactions", mesh.vertex_order.to_slab<Vec3>(state.reported.reaction), vertices);
    if (contact_) contact_->write(file, state);
    if (wants(strain)) {
      write_edges(file, "strain", strains_of_edges(cloth_, state));
      write_cells(file, "strain", strains_of_cells(cloth_, state.positions));
    }
    if (wants(tension)) {
      const auto tensions = tensions_of_edges(cloth_, state);
      write_edges(file, "tension", tensions);
      write_cells(file, "tension", mean_over_sides(mesh, tensions));
    }
    if (!obstacles_.empty()) obstacles_.write_positions(file, state.time);
  };
  write_whole(mesh.comm, folder_ / file_of(frame), fill, Outlives::program);
  frames_.push_back({state.time, file_of(frame)});
  if (is_list_due()) list_frames();
  seconds_ += MPI_Wtime() - begin;
}

/// By the clock of rank 0.
bool FrameWriter::is_list_due() const {
  const MPI_Comm comm = cloth_.mesh.comm;
  return any_of(comm, rank_of(comm) == 0 && MPI_Wtime() - list_clock_ >= 1.0);
}

void FrameWriter::list_frames() {
  if (listed_ == frames_.size()) return;
  for (auto& [file, text] : xdmf_) {
    for (std::size_t k = listed_; k < frames_.size(); ++k) text.add(frames_[k]);
    write_text_whole(cloth_.mesh.comm, folder_ / file, text.whole(), Outlives::program);
  }
  listed_ = frames_.size();
  list_clock_ = MPI_Wtime();
}

std::vector<std::filesystem::path> FrameWriter::take_written() {
  std::vector<std::filesystem::path> files;
  for (; taken_ < frames_.size(); ++taken_) files.push_back(folder_ / frames_[taken_].file);
  return files;
}

} // namespace taut
