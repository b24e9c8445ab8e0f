#include "io/checksum.hpp"
#include "io/hdf5_error.hpp"

#include <algorithm>

namespace taut {
namespace {

namespace fs = std::filesystem;

/// Bytes; far more than one call adds of HDF5's own: names, headers, tables.
constexpr Global own_needs = 1 << 16;

/// Bytes; so much more than is needed now may be set aside at once.
constexpr Global most_ahead = 1 << 24;

std::string unwritable(const fs::path& path, const std::string& name) {
  return fmt::format("{}: {} cannot be written", path.string(), name);
}

void remove_on_rank_0(MPI_Comm comm, const fs::path& path) {
  std::error_code ignored; // there is already a failure to tell
  if (rank_of(comm) == 0) fs::remove(path, ignored);
}

/// Groups on the way to a dataset come into being with it.
H5Handle with_groups() {
  H5Handle links = h5::own(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
  h5::require(H5Pset_create_intermediate_group(links.get(), 1));
  return links;
}

/// Every row is written once, so filling with zeros first would be lost work. A time of creation would be
/// each rank's own clock, in what all ranks must write alike. Room in the file is given at once, as MPI-IO
/// does, so that the file is the same without it.
H5Handle unfilled_and_undated() {
  H5Handle creation = h5::own(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  h5::require(H5Pset_fill_time(creation.get(), H5D_FILL_TIME_NEVER));
  h5::require(H5Pset_alloc_time(creation.get(), H5D_ALLOC_TIME_EARLY));
  h5::require(H5Pset_obj_track_times(creation.get(), false));
  return creation;
}

/// Its bytes; they never were on a disk.
std::string file_without_datasets() {
  const H5Handle access = h5::own(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  h5::require(H5Pset_fapl_core(access.get(), own_needs, false));
  const H5Handle file = h5::own(H5Fcreate("in memory", H5F_ACC_TRUNC, H5P_DEFAULT, access.get()), H5Fclose);
  h5::require(H5Fflush(file.get(), H5F_SCOPE_LOCAL));
  std::string bytes(static_cast<std::size_t>(h5::require(H5Fget_file_image(file.get(), nullptr, 0))), '\0');
  h5::require(H5Fget_file_image(file.get(), bytes.data(), bytes.size()));
  return bytes;
}

void check_size(std::size_t given, int columns, Slab rows) {
  if (given != static_cast<std::size_t>(rows.count) * static_cast<std::size_t>(columns))
    throw std::logic_error("H5Writer::write: the number of values is not rows times columns");
}

} // namespace

/// HDF5 opens what is a file already: were it to create one, it would first give back all room set aside for
/// it, and a disk that another fills just then it does not survive (see `set_aside`).
H5Writer::H5Writer(MPI_Comm comm, fs::path path) : comm_(comm), path_(std::move(path)) {
  h5::silence();
  const std::string subject = fmt::format("{}: cannot be created", path_.string());
  try {
    on_rank_0(comm_, [&] {
      h5::collectively(MPI_COMM_SELF, subject, writing_cure,
                       [&] { begin_part(path_, file_without_datasets()); });
    });
    set_aside(0);
    h5::collectively(comm_, subject, writing_cure, [&] {
      const H5Handle access = h5::writing_access(comm_);
      file_ = h5::own(H5Fopen(part_of(path_).c_str(), H5F_ACC_RDWR, access.get()), H5Fclose);
    });
  } catch (const InputError&) {
    remove_on_rank_0(comm_, part_of(path_));
    throw;
  }
}

H5Writer::~H5Writer() {
  if (file_.get() < 0) return;
  file_ = {};
  remove_on_rank_0(comm_, part_of(path_));
}

template<class T>
void H5Writer::write(const std::string& name, std::span<const T> my_rows, int columns, Slab rows) {
  check_size(my_rows.size(), columns, rows);
  write_rows(name, my_rows.data(), h5::native_type<T>(), columns, rows);
}
template void H5Writer::write(const std::string&, std::span<const double>, int, Slab);
template void H5Writer::write(const std::string&, std::span<const std::int64_t>, int, Slab);
template void H5Writer::write(const std::string&, std::span<const std::int32_t>, int, Slab);

void H5Writer::write(const std::string& name, std::span<const Vec3> my_rows, Slab rows) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  check_size(3 * my_rows.size(), 3, rows);
  write_rows(name, my_rows.data(), H5T_NATIVE_DOUBLE, 3, rows);
}

/// Each rank writes its rows, which lie together in the file, by itself: to do so in one operation, ranks
/// would have to agree some ten times.
void H5Writer::write_rows(const std::string& name, const void* my_rows, hid_t type, int columns, Slab rows) {
  std::vector<hsize_t> shape{static_cast<hsize_t>(rows.total)};
  if (columns != 1) shape.push_back(static_cast<hsize_t>(columns));
  set_aside(rows.total * columns * static_cast<Global>(H5Tget_size(type)));
  h5::collectively(comm_, unwritable(path_, name), writing_cure, [&] {
    const h5::Selection selection = h5::select(shape, rows);
    const H5Handle links = with_groups(), creation = unfilled_and_undated();
    const H5Handle dataset = h5::own(H5Dcreate2(file_.get(), name.c_str(), type, selection.file.get(),
                                                links.get(), creation.get(), H5P_DEFAULT),
                                     H5Dclose);
    if (rows.count == 0) return;
    h5::require(
        H5Dwrite(dataset.get(), type, selection.memory.get(), selection.file.get(), H5P_DEFAULT, my_rows));
  });
}

/// Takes the disk room for so many more bytes, and for what HDF5 adds of its own. HDF5 hangs or crashes when
/// it meets a full disk while closing, and a collective write to one may pass for a success (Open MPI's
/// does), so room is always taken beforehand, where a refusal does no harm. Room is taken for the next calls
/// too, as each taking opens the file and makes all ranks wait.
void H5Writer::set_aside(Global more) {
  needed_ += more + own_needs;
  if (needed_ <= room_) return;
  const Global end = needed_ + std::min(needed_, most_ahead);
  on_rank_0(comm_, [&] { reserve(path_, room_, end); });
  room_ = end;
}

/// HDF5 lets different ranks write the parts of an attribute: values that differ, as clocks do, would come
/// out as a mixture of both, or cut off.
void H5Writer::attribute(const std::string& name, double value) {
  MPI_Bcast(&value, 1, MPI_DOUBLE, 0, comm_);
  write_attribute(name, &value, H5T_NATIVE_DOUBLE, sizeof value);
}

void H5Writer::attribute(const std::string& name, std::int64_t value) {
  MPI_Bcast(&value, 1, MPI_INT64_T, 0, comm_);
  write_attribute(name, &value, H5T_NATIVE_INT64, sizeof value);
}

void H5Writer::attribute(const std::string& name, const std::string& value) {
  const std::string shared = broadcast_text(comm_, value);
  const char* const text = shared.c_str();
  write_attribute(name, &text, h5::text_type().get(), shared.size());
}

void H5Writer::write_attribute(const std::string& name, const void* value, hid_t type, std::size_t size) {
  set_aside(static_cast<Global>(size));
  h5::collectively(comm_, unwritable(path_, "attribute " + name), writing_cure, [&] {
    const H5Handle scalar = h5::own(H5Screate(H5S_SCALAR), H5Sclose);
    const H5Handle attribute = h5::own(
        H5Acreate2(file_.get(), name.c_str(), type, scalar.get(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    h5::require(H5Awrite(attribute.get(), type, value));
  });
}

void H5Writer::close(Outlives outlives) {
  try {
    h5::collectively(comm_, fmt::format("{}: cannot be completed", path_.string()), writing_cure,
                     [&] { close_file(); });
    append_checksum(comm_, path_);
    on_rank_0(comm_, [&] { publish(path_, outlives); });
  } catch (const InputError&) {
    remove_on_rank_0(comm_, part_of(path_));
    throw;
  }
}

/// Without MPI-IO, HDF5 does not see that the file has been given more room than it needs, and leaves it so.
void H5Writer::close_file() {
  if (size_of(comm_) > 1) {
    h5::require(H5Fclose(file_.release()));
    return;
  }
  h5::require(H5Fflush(file_.get(), H5F_SCOPE_LOCAL));
  hsize_t size = 0;
  h5::require(H5Fget_filesize(file_.get(), &size));
  h5::require(H5Fclose(file_.release()));
  std::error_code error;
  fs::resize_file(part_of(path_), size, error);
  if (error) throw h5::Failure(error.message());
}

void write_whole(MPI_Comm comm, const fs::path& path, const std::function<void(H5Writer&)>& fill,
                 Outlives outlives) {
  H5Writer writer(comm, path);
  fill(writer);
  writer.close(outlives);
}

} // namespace taut
