#pragma once
#include "io/checksum.hpp"
#include "io/whole_file.hpp"
#include "partition/mesh_slab.hpp"
#include "partition/types.hpp"

#include <hdf5.h>
#include <mpi.h>

#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <utility>
#include <vector>

/// HDF5 files shared by all ranks. Everything here is collective and must be called by all ranks of the
/// communicator in the same order with the same names. Failures are `InputError`, the same on every rank:
/// they name the file, the dataset and what HDF5 says. Numbers `T` are double, std::int64_t or std::int32_t;
/// on reading, a file may hold them in another width, and integers where doubles are asked for.
namespace taut {

/// Owns one HDF5 identifier.
class H5Handle {
public:
  using Close = herr_t (*)(hid_t);

  H5Handle() = default;
  H5Handle(hid_t id, Close close) : id_(id), close_(close) {}
  H5Handle(H5Handle&& other) noexcept : id_(other.release()), close_(other.close_) {}
  H5Handle& operator=(H5Handle&& other) noexcept;
  ~H5Handle();

  hid_t get() const { return id_; }
  hid_t release() { return std::exchange(id_, H5I_INVALID_HID); } ///< the caller closes it from here on

private:
  hid_t id_ = H5I_INVALID_HID;
  Close close_ = nullptr;
};

/// A file being written, and given its checksum (checksum.hpp) at the end. It bears the name `part_of(path)`
/// (whole_file.hpp) until `close`, which gives it its own; if it dies before, the temporary is removed and an
/// earlier file of that name stays as it was.
class H5Writer {
public:
  H5Writer(MPI_Comm comm, std::filesystem::path path);
  H5Writer(const H5Writer&) = delete;
  H5Writer& operator=(const H5Writer&) = delete;
  ~H5Writer();

  /// Dataset `name` ("/constraints/edges"; its groups are made) of shape (rows.total, columns), or
  /// (rows.total) if `columns` is 1. This rank gives `rows.count` rows, row-major; there may be none.
  template<class T>
  void write(const std::string& name, std::span<const T> my_rows, int columns, Slab rows);
  void write(const std::string& name, std::span<const Vec3> my_rows, Slab rows); ///< shape (rows.total, 3)

  /// Attribute of the file itself; the value of rank 0 counts.
  void attribute(const std::string& name, double value);
  void attribute(const std::string& name, std::int64_t value);
  void attribute(const std::string& name, const std::string& value);

  /// Publishes under the final name.
  void close(Outlives outlives);

private:
  void write_rows(const std::string& name, const void* my_rows, hid_t type, int columns, Slab rows);
  void write_attribute(const std::string& name, const void* value, hid_t type, std::size_t size);
  void set_aside(Global more);
  void close_file();

  MPI_Comm comm_;
  std::filesystem::path path_;
  H5Handle file_;
  Global needed_ = 0; ///< bytes that the file may take so far
  Global room_ = 0;   ///< bytes at the beginning of the file that the disk has set aside
};

/// Writes the file `path` with what `fill` puts into it, or leaves things as they were: if `fill` throws (on
/// every rank), or the disk is full, no trace remains and the exception goes on.
void write_whole(MPI_Comm comm, const std::filesystem::path& path, const std::function<void(H5Writer&)>& fill,
                 Outlives outlives = Outlives::machine);

/// A file open for reading.
class H5Reader {
public:
  /// A checksum, if there is one, is verified first (checksum.hpp).
  H5Reader(MPI_Comm comm, std::filesystem::path path, Checksum needed = Checksum::optional);

  bool has(const std::string& name) const;
  Global rows(const std::string& name) const;
  int columns(const std::string& name) const; ///< 1 for a one-dimensional dataset

  /// Rows [rows.first, rows.first + rows.count), row-major; slabs of ranks may overlap, or be empty. The
  /// dataset must have `rows.total` rows.
  template<class T>
  std::vector<T> read(const std::string& name, Slab rows) const;
  std::vector<Vec3> read_vectors(const std::string& name,
                                 Slab rows) const; ///< the dataset must have 3 columns

  /// Attribute of the file itself; T is double, std::int64_t or std::string.
  template<class T>
  T attribute(const std::string& name) const;

  const std::filesystem::path& path() const { return path_; }

private:
  std::vector<hsize_t> shape(const std::string& name) const;
  void read_rows(const std::string& name, void* rows_out, hid_t type, Slab rows) const;

  MPI_Comm comm_;
  std::filesystem::path path_;
  H5Handle file_;
};

} // namespace taut
