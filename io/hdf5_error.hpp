#pragma once
#include "io/hdf5.hpp"

#include <fmt/format.h>

#include <concepts>
#include <optional>
#include <stdexcept>
#include <string>

/// How the HDF5 wrapper turns failures of the library into messages. Private to io/hdf5_*.cpp.
namespace taut::h5 {

/// What went wrong on this rank; never leaves the wrapper.
class Failure : public std::runtime_error {
public:
  using std::runtime_error::runtime_error;
};

/// The innermost entry of HDF5's error stack: the cause rather than its consequences.
std::string cause();

/// HDF5 prints nothing by itself; its words go into our messages.
void silence();

/// The status or identifier HDF5 gave, or `Failure` if it is negative.
template<std::signed_integral Status>
Status require(Status status) {
  if (status < 0) throw Failure(cause());
  return status;
}

inline H5Handle own(hid_t id, H5Handle::Close close) { return {require(id), close}; }

/// Runs `step` on all ranks; if it fails on any, all throw the same `InputError` "`subject`: reason; `cure`".
template<class Step>
void collectively(MPI_Comm comm, const std::string& subject, const std::string& cure, Step&& step) {
  std::optional<std::string> error;
  try {
    step();
  } catch (const Failure& failure) {
    error = fmt::format("{}: {}; {}", subject, failure.what(), cure);
  }
  agree(comm, error);
}

template<class T>
hid_t native_type() {
  if constexpr (std::same_as<T, double>)
    return H5T_NATIVE_DOUBLE;
  else if constexpr (std::same_as<T, std::int64_t>)
    return H5T_NATIVE_INT64;
  else if constexpr (std::same_as<T, std::int32_t>)
    return H5T_NATIVE_INT32;
}

/// Text of any length in UTF-8, as h5py writes and reads it.
H5Handle text_type();

/// Access to a file through MPI-IO. Metadata are read by all ranks together, but written by one each: a
/// failure to write them must not be lost (see H5Writer::set_aside).
H5Handle shared_access(MPI_Comm comm);

/// The same to a file that is being written; without MPI-IO on one rank, as that takes as long to open a
/// small file as to write it.
H5Handle writing_access(MPI_Comm comm);

/// All ranks move their parts in one operation.
H5Handle collective_transfer();

/// The part of a dataset in memory and in the file that a rank moves; nothing if the slab is empty.
struct Selection {
  H5Handle memory;
  H5Handle file;
};
Selection select(const std::vector<hsize_t>& shape, Slab rows);

} // namespace taut::h5
