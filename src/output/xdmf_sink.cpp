#include "src/output/xdmf_sink.hpp"

#include "io/checksum.hpp"
#include "src/output/h5_field.hpp"
#include "src/output/xdmf_descriptions.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace taut {

namespace {

namespace fs = std::filesystem;

constexpr const char *cells_list = XdmfSink::file, *edges_list = "edges.xdmf",
                     *obstacles_list = "obstacles.xdmf";

/// Relative to the folder of the run.
std::string file_of(Global frame) { return fmt::format("frames/frame_{:06}.h5", frame); }

/// The frames before `next` that are there and sound; those that are damaged are named.
std::vector<XdmfFrame> frames_before(Global next, const FrameSource& source) {
  const std::string there = broadcast(source.cloth.mesh.comm, [&] {
    std::string flags;
    for (Global k = 0; k < next; ++k) flags += fs::exists(source.folder / file_of(k)) ? '1' : '0';
    return flags;
  });
  std::vector<XdmfFrame> frames;
  for (Global k = 0; k < next; ++k) {
    if (there[k] != '1') continue;
    const std::string damage =
        damage_of(source.cloth.mesh.comm, source.folder / file_of(k), Checksum::required);
    if (damage.empty())
      frames.push_back({source.steps.frame_time(k), file_of(k)});
    else if (rank_of(source.cloth.mesh.comm) == 0)
      fmt::print(stderr, "taut: warning: {}; this frame is left out of the lists\n", damage);
  }
  return frames;
}

} // namespace

XdmfSink::XdmfSink(const FrameSource& source) : source_(source) {
  const DistributedMesh& mesh = source.cloth.mesh;
  lists_.emplace_back(cells_list, XdmfText(describe_cells(mesh, source.fields)));
  if (!source.obstacles.empty()) lists_.emplace_back(obstacles_list, source.obstacles.xdmf());
  if (mesh.edges.total > 0) lists_.emplace_back(edges_list, XdmfText(describe_edges(mesh, source.fields)));
}

Global XdmfSink::count_frames(const fs::path& folder) {
  Global frames = 0;
  if (!fs::is_directory(folder / "frames")) return 0;
  for (const auto& entry : fs::directory_iterator(folder / "frames"))
    frames += entry.path().extension() == ".h5";
  return frames;
}

void XdmfSink::drop_frames(const fs::path& folder, Global first) {
  if (first == 0)
    for (const char* list : {cells_list, edges_list, obstacles_list}) fs::remove(folder / list);
  const fs::path frames = folder / "frames";
  if (!fs::is_directory(frames)) return;
  const std::string name_of_first = fs::path(file_of(first)).filename().string();
  std::vector<fs::path> unwanted;
  for (const auto& entry : fs::directory_iterator(frames)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("frame_") && name >= name_of_first) unwanted.push_back(entry.path());
  }
  for (const fs::path& path : unwanted) fs::remove(path);
}

void XdmfSink::begin(Global next) { frames_ = frames_before(next, source_); }

fs::path XdmfSink::write(const State& state, Global frame) {
  const DistributedMesh& mesh = source_.cloth.mesh;
  const fs::path path = source_.folder / file_of(frame);
  const auto fill = [&](H5Writer& out) {
    out.attribute("time", state.time);
    out.write("/positions", mesh.vertex_order.to_slab<Vec3>(state.positions), mesh.vertex_order.slab());
    for (const FrameField& field : source_.fields)
      if (field.home == FieldHome::each_frame) write_field(out, mesh, field, state);
    if (!source_.obstacles.empty()) source_.obstacles.write_frame(out, state.time);
  };
  write_whole(mesh.comm, path, fill, Outlives::program);
  frames_.push_back({state.time, file_of(frame)});
  if (is_list_due()) flush();
  return path;
}

/// By the clock of rank 0.
bool XdmfSink::is_list_due() const {
  const MPI_Comm comm = source_.cloth.mesh.comm;
  return any_of(comm, rank_of(comm) == 0 && MPI_Wtime() - list_clock_ >= 1.0);
}

void XdmfSink::flush() {
  if (listed_ == frames_.size()) return;
  for (auto& [list, text] : lists_) {
    for (std::size_t k = listed_; k < frames_.size(); ++k) text.add(frames_[k]);
    write_text_whole(source_.cloth.mesh.comm, source_.folder / list, text.whole(), Outlives::program);
  }
  listed_ = frames_.size();
  list_clock_ = MPI_Wtime();
}

} // namespace taut
