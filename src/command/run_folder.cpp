#include "src/command/run_folder.hpp"

#include "src/output/checkpoint.hpp"
#include "src/output/frame_formats.hpp"
#include "src/output/run_files.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace taut::command {

namespace {

namespace fs = std::filesystem;

constexpr const char* other_folder = "choose another folder with --out";
constexpr std::array results{run_files::mesh, run_files::steps, run_files::summary};

bool holds_run(const fs::path& out) {
  return std::any_of(results.begin(), results.end(),
                     [&](const char* file) { return fs::exists(out / file); }) ||
         holds_frames(out) || !checkpoints_in(out).empty();
}

bool is_part(const fs::path& file) { return file.extension() == ".part"; }

/// Removes the files of a folder for which `unwanted` holds.
template<class Unwanted>
void remove_files(const fs::path& folder, Unwanted&& unwanted) {
  if (!fs::is_directory(folder)) return;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder))
    if (unwanted(entry.path())) files.push_back(entry.path());
  for (const fs::path& file : files) fs::remove(file);
}

/// Removes what a run wrote and nothing else.
void remove_run(const fs::path& out) {
  for (const char* file : results) fs::remove(out / file);
  fs::remove(out / run_files::case_as_run);
  drop_frames(out, 0);
  for (const fs::path& file : checkpoints_in(out)) fs::remove(file);
}

/// Runs `change` on rank 0.
template<class Change>
void on_disk(MPI_Comm comm, const fs::path& out, const char* cure, Change&& change) {
  on_rank_0(comm, [&] {
    try {
      change();
    } catch (const fs::filesystem_error& e) {
      throw InputError(fmt::format("{}: cannot be written: {}; {}", out.string(), e.code().message(), cure));
    }
  });
}

} // namespace

void make_run_folder(MPI_Comm comm, const fs::path& out, const fs::path& case_file) {
  on_disk(comm, out, other_folder, [&] {
    if (fs::exists(out) && fs::equivalent(out, fs::absolute(case_file).parent_path()))
      throw InputError(fmt::format(
          "{}: the case file lies in this folder and would be replaced by the case as run; choose "
          "another folder with --out",
          out.string()));
    fs::create_directories(out);
  });
}

void clear_run_folder(MPI_Comm comm, const fs::path& out, ExistingRun existing) {
  on_disk(comm, out, other_folder, [&] {
    if (holds_run(out)) {
      if (existing == ExistingRun::refuse)
        throw InputError(fmt::format("{}: this folder holds a run already; choose another with --out, go on "
                                     "with it by taut resume, or give --overwrite to replace that run",
                                     out.string()));
      remove_run(out);
    }
    fs::create_directories(out / "frames");
    fs::create_directories(out / "checkpoint");
  });
}

void drop_after(MPI_Comm comm, const fs::path& out, Global step, Global next_frame) {
  on_disk(comm, out, "the folder must be writable to go on in it", [&] {
    fs::create_directories(out / "frames");
    fs::create_directories(out / "checkpoint");
    fs::remove(out / run_files::summary);
    remove_files(out, is_part);
    drop_frames(out, next_frame);
    remove_files(out / "checkpoint",
                 [&](const fs::path& f) { return is_part(f) || step_of_checkpoint(f) > step; });
  });
}

} // namespace taut::command
