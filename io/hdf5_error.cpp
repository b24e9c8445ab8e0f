#include "io/hdf5_error.hpp"

namespace taut {

H5Handle& H5Handle::operator=(H5Handle&& other) noexcept {
  if (this != &other) {
    if (id_ >= 0) close_(id_);
    id_ = other.release();
    close_ = other.close_;
  }
  return *this;
}

H5Handle::~H5Handle() {
  if (id_ >= 0) close_(id_);
}

namespace h5 {

std::string cause() {
  std::string text;
  const auto innermost = [](unsigned, const H5E_error2_t* entry, void* out) -> herr_t {
    auto& found = *static_cast<std::string*>(out);
    if (found.empty() && entry->desc) found = entry->desc;
    return 0;
  };
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, innermost, &text);
  return text.empty() ? "HDF5 gives no reason" : text;
}

void silence() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

H5Handle text_type() {
  H5Handle type = own(H5Tcopy(H5T_C_S1), H5Tclose);
  require(H5Tset_size(type.get(), H5T_VARIABLE));
  require(H5Tset_cset(type.get(), H5T_CSET_UTF8));
  return type;
}

H5Handle shared_access(MPI_Comm comm) {
  H5Handle access = own(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
  require(H5Pset_fapl_mpio(access.get(), comm, MPI_INFO_NULL));
  require(H5Pset_all_coll_metadata_ops(access.get(), true));
  require(H5Pset_coll_metadata_write(access.get(), true));
  return access;
}

H5Handle writing_access(MPI_Comm comm) {
  return size_of(comm) > 1 ? shared_access(comm) : own(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
}

H5Handle collective_transfer() {
  H5Handle transfer = own(H5Pcreate(H5P_DATASET_XFER), H5Pclose);
  require(H5Pset_dxpl_mpio(transfer.get(), H5FD_MPIO_COLLECTIVE));
  return transfer;
}

Selection select(const std::vector<hsize_t>& shape, Slab rows) {
  const int dimensions = static_cast<int>(shape.size());
  std::vector<hsize_t> start(shape.size(), 0), count = shape;
  start[0] = static_cast<hsize_t>(rows.first);
  count[0] = static_cast<hsize_t>(rows.count);
  Selection selection{own(H5Screate_simple(dimensions, count.data(), nullptr), H5Sclose),
                      own(H5Screate_simple(dimensions, shape.data(), nullptr), H5Sclose)};
  if (rows.count == 0) {
    require(H5Sselect_none(selection.memory.get()));
    require(H5Sselect_none(selection.file.get()));
  } else {
    require(H5Sselect_hyperslab(selection.file.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(),
                                nullptr));
  }
  return selection;
}

} // namespace h5
} // namespace taut
