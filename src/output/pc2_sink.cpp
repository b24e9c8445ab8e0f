#include "src/output/pc2_sink.hpp"

#include "io/pc2.hpp"
#include "io/whole_file.hpp"

#include <fmt/format.h>

#include <limits>

namespace taut {

namespace fs = std::filesystem;

Pc2Sink::Pc2Sink(const FrameSource& source) : mesh_(source.cloth.mesh), path_(source.folder / file) {
  if (mesh_.vertices.total > std::numeric_limits<std::int32_t>::max())
    throw InputError("output.formats: pc2 cannot count so many vertices; choose xdmf");
}

Global Pc2Sink::count_frames(const fs::path& folder) {
  const auto header = read_pc2_header(folder / file);
  return header ? header->frames : 0;
}

void Pc2Sink::drop_frames(const fs::path& folder, Global first) {
  const fs::path path = folder / file;
  if (first == 0) fs::remove(path);
  const auto header = read_pc2_header(path);
  if (!header) return;
  const Global before = first - Global(header->start);
  if (before <= 0)
    fs::remove(path);
  else if (before < header->frames)
    set_pc2_frames(path, std::int32_t(before));
}

/// Goes on in the file of the run if it has all frames until then; if there is none, it begins here.
void Pc2Sink::begin(Global next) {
  Global first = 0;
  on_rank_0(mesh_.comm, [&] {
    first = next;
    if (next == 0 || !fs::exists(path_)) return;
    const auto header = read_pc2_header(path_);
    if (!header || header->vertices != mesh_.vertices.total || Global(header->start) + header->frames != next)
      throw InputError(
          fmt::format("{}: this is not the point cache of the run up to frame {}; put it back, or "
                      "remove it: it then begins with that frame",
                      path_.string(), next));
    first = Global(header->start);
  });
  first_ = max_over(mesh_.comm, first);
  frames_ = next - first_;
  if (frames_ > 0) return;
  write_text_whole(mesh_.comm, path_, pc2_header({std::int32_t(mesh_.vertices.total), float(first_), 0}),
                   Outlives::program);
}

fs::path Pc2Sink::write(const State& state, Global frame) {
  write_pc2_frame(mesh_.comm, path_, std::int32_t(frame - first_),
                  mesh_.vertex_order.to_slab<Vec3>(state.positions), mesh_.vertex_order.slab());
  frames_ = frame - first_ + 1;
  return path_;
}

} // namespace taut
