#include "io/hdf5.hpp"
#include "io/pc2.hpp"
#include "src/command/command.hpp"
#include "src/output/run_files.hpp"
#include "src/output/surface_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <limits>

namespace taut::command {

namespace {

namespace fs = std::filesystem;

struct Unit {
  const char* name;
  double metres;
};
constexpr std::array units{Unit{"m", 1.0}, Unit{"cm", 0.01}, Unit{"mm", 0.001}};

/// The frames of a run folder, as another program wants them.
class Exporter {
public:
  Exporter(MPI_Comm comm, const ExportOptions& options) : comm_(comm), options_(options) {
    const auto unit =
        std::find_if(units.begin(), units.end(), [&](const Unit& u) { return u.name == options.unit; });
    if (unit == units.end())
      throw InputError(
          fmt::format("--unit {}: not a unit that is known here; give m, cm or mm", options.unit));
    metres_ = unit->metres;
    if (options.up != "y" && options.up != "z")
      throw InputError(fmt::format("--up {}: give the axis that is to point up, y or z", options.up));
    find_frames();
  }

  void write() {
    const std::string extension = options_.to.extension().string();
    if (extension == ".pc2") return write_pc2();
    const auto text = extension == ".obj"    ? obj_text
                      : extension == ".ply"  ? ply_text
                      : extension == ".usda" ? usda_text
                                             : nullptr;
    if (!text)
      throw InputError(fmt::format("--to {}: the extension '{}' is not known; give .pc2, .obj, .ply or .usda",
                                   options_.to.string(), extension));
    read_surface();
    for (const fs::path& frame : wanted()) {
      read_positions(frame);
      write_text_whole(comm_, named_after(frame), rank_of(comm_) == 0 ? text(surface_) : std::string());
    }
  }

  /// What `write` writes, in words.
  std::string files() const {
    const std::string to = options_.to.string();
    if (options_.to.extension() == ".pc2")
      return fmt::format("{} and {}", to, fs::path(options_.to).replace_extension(".obj").string());
    const auto frames = wanted();
    return frames.size() == 1 ? named_after(frames[0]).string()
                              : fmt::format("{} to {}", named_after(frames.front()).string(),
                                            named_after(frames.back()).string());
  }

private:
  /// On rank 0, for all.
  void find_frames() {
    const std::string names = broadcast(comm_, [&] {
      std::vector<std::string> found;
      std::error_code none;
      for (const auto& entry : fs::directory_iterator(options_.folder / "frames", none))
        if (entry.path().extension() == ".h5") found.push_back(entry.path().filename().string());
      if (!fs::exists(options_.folder))
        throw InputError(fmt::format("{}: there is no such folder", options_.folder.string()));
      if (found.empty())
        throw InputError(fmt::format("{}: holds no frames in HDF5 (frames/frame_000000.h5, ...)",
                                     options_.folder.string()));
      std::sort(found.begin(), found.end());
      std::string lines;
      for (const std::string& name : found) lines += name + "\n";
      return lines;
    });
    for (std::size_t at = 0, end = 0; (end = names.find('\n', at)) != std::string::npos; at = end + 1)
      frames_.push_back(options_.folder / "frames" / names.substr(at, end - at));
    if (options_.frame && (*options_.frame < 0 || *options_.frame >= Global(frames_.size())))
      throw InputError(
          fmt::format("--frame {}: the run has frames 0 to {}", *options_.frame, frames_.size() - 1));
  }

  bool is_single() const { return options_.frame || options_.to.extension() == ".usda"; }

  std::vector<fs::path> wanted() const {
    if (!is_single()) return frames_;
    return {frames_[options_.frame ? std::size_t(*options_.frame) : frames_.size() - 1]};
  }

  /// cloth.obj, or of many cloth_000012.obj.
  fs::path named_after(const fs::path& frame) const {
    if (is_single()) return options_.to;
    const std::string stem = frame.stem().string(), number = stem.substr(stem.rfind('_'));
    return fs::path(options_.to)
        .replace_filename(options_.to.stem().string() + number + options_.to.extension().string());
  }

  std::vector<Vec3> turned(std::vector<Vec3> positions) const {
    for (Vec3& p : positions) {
      p /= metres_;
      if (options_.up == "y") p = Vec3(p[0], p[2], -p[1]);
    }
    return positions;
  }

  /// All rows on rank 0, none on the others.
  Slab on_rank_0(Global rows) const { return {0, rank_of(comm_) == 0 ? rows : 0, rows}; }

  void read_surface() {
    const H5Reader mesh(comm_, options_.folder / run_files::mesh);
    surface_.corners = mesh.read<Global>("/faces", on_rank_0(mesh.rows("/faces")));
    surface_.offsets = mesh.read<Global>("/face_offsets", on_rank_0(mesh.rows("/face_offsets")));
    if (mesh.has("/texture"))
      surface_.texture = mesh.read<double>("/texture", on_rank_0(mesh.rows("/texture")));
    surface_.metres_per_unit = metres_;
    surface_.up = options_.up[0];
  }

  void read_positions(const fs::path& frame) {
    const H5Reader file(comm_, frame);
    surface_.positions = turned(file.read_vectors("/positions", on_rank_0(file.rows("/positions"))));
  }

  /// And beside it the mesh that it moves, as it is in the first frame.
  void write_pc2() {
    read_surface();
    read_positions(frames_.front());
    write_text_whole(comm_, fs::path(options_.to).replace_extension(".obj"),
                     rank_of(comm_) == 0 ? obj_text(surface_) : std::string());
    const auto frames = wanted();
    for (std::size_t k = 0; k < frames.size(); ++k) {
      const H5Reader file(comm_, frames[k]);
      const Slab mine = slab_of(file.rows("/positions"), size_of(comm_), rank_of(comm_));
      if (mine.total > std::numeric_limits<std::int32_t>::max())
        throw InputError(fmt::format("--to {}: pc2 cannot count so many vertices", options_.to.string()));
      if (k == 0) write_text_whole(comm_, options_.to, pc2_header({std::int32_t(mine.total), 0, 0}));
      write_pc2_frame(comm_, options_.to, std::int32_t(k), turned(file.read_vectors("/positions", mine)),
                      mine);
    }
  }

  MPI_Comm comm_;
  const ExportOptions& options_;
  double metres_ = 1; ///< m per unit of what is written
  std::vector<fs::path> frames_;
  Surface surface_;
};

} // namespace

int export_frames(MPI_Comm comm, const ExportOptions& options) {
  Exporter exporter(comm, options);
  exporter.write();
  if (rank_of(comm) == 0)
    fmt::print("{}: written, {} up, in {}\n", exporter.files(), options.up, options.unit);
  return success;
}

} // namespace taut::command
