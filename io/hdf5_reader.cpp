#include "io/hdf5_error.hpp"

#include <algorithm>
#include <fstream>
#include <limits>

namespace taut {
namespace {

namespace fs = std::filesystem;

constexpr const char* reading_cure = "check that this is the right file and that it is complete";

std::string unreadable(const fs::path& path, const std::string& name) {
  return fmt::format("{}: {} cannot be read", path.string(), name);
}

/// HDF5 converts floats to integers without a word; a dataset of vertex numbers must not hold floats.
void check_class(hid_t in_file, hid_t wanted) {
  const H5T_class_t found = H5Tget_class(in_file);
  if (found == H5T_INTEGER || found == H5Tget_class(wanted)) return;
  throw h5::Failure(H5Tget_class(wanted) == H5T_INTEGER ? "it does not hold integers"
                                                        : "it does not hold numbers");
}

/// Refuses a dataset that claims more numbers than the file can hold, before memory is asked for them:
/// filters pack a thousand to one at best.
void check_storage(hid_t dataset, std::span<const hsize_t> shape) {
  const H5Handle type = h5::own(H5Dget_type(dataset), H5Tclose);
  double bytes = double(H5Tget_size(type.get())); // may be beyond any integer
  for (const hsize_t n : shape) bytes *= double(n);
  const double stored = double(H5Dget_storage_size(dataset));
  constexpr double small = 1 << 24, densest = 2000;
  if (bytes > small && bytes > densest * stored)
    throw h5::Failure(fmt::format("it claims {:.3g} bytes, of which the file holds {:.3g}", bytes, stored));
}

/// Whether every link on the way to `name` exists; H5Lexists looks at the last one only.
bool link_exists(hid_t file, const std::string& name) {
  for (std::size_t end = name.find('/', 1);; end = name.find('/', end + 1)) {
    if (H5Lexists(file, name.substr(0, end).c_str(), H5P_DEFAULT) <= 0) return false;
    if (end == std::string::npos) return true;
  }
}

std::string read_text(hid_t attribute) {
  const H5Handle type = h5::own(H5Aget_type(attribute), H5Tclose);
  if (H5Tis_variable_str(type.get()) <= 0) throw h5::Failure("it does not hold a text of variable length");
  char* text = nullptr;
  h5::require(H5Aread(attribute, type.get(), &text));
  const std::string value = text ? text : "";
  h5::require(H5free_memory(text));
  return value;
}

template<class T>
T read_number(hid_t attribute) {
  const H5Handle type = h5::own(H5Aget_type(attribute), H5Tclose);
  check_class(type.get(), h5::native_type<T>());
  const H5Handle space = h5::own(H5Aget_space(attribute), H5Sclose);
  if (H5Sget_simple_extent_npoints(space.get()) != 1) throw h5::Failure("it holds more than one number");
  T value{};
  h5::require(H5Aread(attribute, h5::native_type<T>(), &value));
  return value;
}

} // namespace

H5Reader::H5Reader(MPI_Comm comm, fs::path path, Checksum needed) : comm_(comm), path_(std::move(path)) {
  h5::silence();
  on_rank_0(comm_, [&] { // said plainly, before MPI-IO says it in its own way
    if (!std::ifstream(path_))
      throw InputError(fmt::format("{}: no such file, or it may not be read", path_.string()));
  });
  verify_checksum(comm_, path_, needed);
  h5::collectively(comm_, fmt::format("{}: cannot be opened as HDF5", path_.string()), reading_cure, [&] {
    const H5Handle access = h5::shared_access(comm_);
    file_ = h5::own(H5Fopen(path_.c_str(), H5F_ACC_RDONLY, access.get()), H5Fclose);
  });
}

bool H5Reader::has(const std::string& name) const { return link_exists(file_.get(), name); }

std::vector<hsize_t> H5Reader::shape(const std::string& name) const {
  std::vector<hsize_t> shape;
  h5::collectively(comm_, unreadable(path_, name), reading_cure, [&] {
    if (!has(name)) throw h5::Failure("the file has no such dataset");
    const H5Handle dataset = h5::own(H5Dopen2(file_.get(), name.c_str(), H5P_DEFAULT), H5Dclose);
    const H5Handle space = h5::own(H5Dget_space(dataset.get()), H5Sclose);
    const int dimensions = h5::require(H5Sget_simple_extent_ndims(space.get()));
    if (dimensions != 1 && dimensions != 2) throw h5::Failure("it has neither one dimension nor two");
    shape.resize(dimensions);
    h5::require(H5Sget_simple_extent_dims(space.get(), shape.data(), nullptr));
    check_storage(dataset.get(), shape);
  });
  return shape;
}

Global H5Reader::rows(const std::string& name) const { return static_cast<Global>(shape(name)[0]); }

int H5Reader::columns(const std::string& name) const {
  const std::vector<hsize_t> dims = shape(name);
  constexpr hsize_t most = std::numeric_limits<int>::max();
  return dims.size() == 1 ? 1 : static_cast<int>(std::min(dims[1], most));
}

template<class T>
std::vector<T> H5Reader::read(const std::string& name, Slab rows) const {
  std::vector<T> values(rows.count * columns(name));
  read_rows(name, values.data(), h5::native_type<T>(), rows);
  return values;
}
template std::vector<double> H5Reader::read(const std::string&, Slab) const;
template std::vector<std::int64_t> H5Reader::read(const std::string&, Slab) const;
template std::vector<std::int32_t> H5Reader::read(const std::string&, Slab) const;

std::vector<Vec3> H5Reader::read_vectors(const std::string& name, Slab rows) const {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  if (columns(name) != 3)
    throw InputError(
        fmt::format("{}: it does not have 3 columns; {}", unreadable(path_, name), reading_cure));
  std::vector<Vec3> values(rows.count);
  read_rows(name, values.data(), H5T_NATIVE_DOUBLE, rows);
  return values;
}

void H5Reader::read_rows(const std::string& name, void* rows_out, hid_t type, Slab rows) const {
  const std::vector<hsize_t> dims = shape(name);
  h5::collectively(comm_, unreadable(path_, name), reading_cure, [&] {
    if (dims[0] != static_cast<hsize_t>(rows.total))
      throw h5::Failure(fmt::format("it has {} rows instead of {}", dims[0], rows.total));
    const H5Handle dataset = h5::own(H5Dopen2(file_.get(), name.c_str(), H5P_DEFAULT), H5Dclose);
    const H5Handle type_in_file = h5::own(H5Dget_type(dataset.get()), H5Tclose);
    check_class(type_in_file.get(), type);
    const h5::Selection selection = h5::select(dims, rows);
    const H5Handle transfer = h5::collective_transfer();
    if (rows.total == 0) return; // HDF5 cannot move nothing from nowhere
    h5::require(
        H5Dread(dataset.get(), type, selection.memory.get(), selection.file.get(), transfer.get(), rows_out));
  });
}

template<class T>
T H5Reader::attribute(const std::string& name) const {
  T value{};
  h5::collectively(comm_, unreadable(path_, "attribute " + name), reading_cure, [&] {
    if (H5Aexists(file_.get(), name.c_str()) <= 0) throw h5::Failure("the file has no such attribute");
    const H5Handle attribute = h5::own(H5Aopen(file_.get(), name.c_str(), H5P_DEFAULT), H5Aclose);
    if constexpr (std::same_as<T, std::string>)
      value = read_text(attribute.get());
    else
      value = read_number<T>(attribute.get());
  });
  return value;
}
template double H5Reader::attribute(const std::string&) const;
template std::int64_t H5Reader::attribute(const std::string&) const;
template std::string H5Reader::attribute(const std::string&) const;

} // namespace taut
