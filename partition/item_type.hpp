#pragma once
#include <mpi.h>

#include <cstddef>

namespace taut::detail {

/// An MPI type of so many bytes. Counting items, not bytes, keeps MPI's int counts valid for messages beyond
/// 2 GiB. May go while messages of its items are under way.
class ItemType {
public:
  explicit ItemType(std::size_t bytes) {
    MPI_Type_contiguous(int(bytes), MPI_BYTE, &type_);
    MPI_Type_commit(&type_);
  }
  ~ItemType() { MPI_Type_free(&type_); }
  ItemType(const ItemType&) = delete;
  operator MPI_Datatype() const { return type_; }

private:
  MPI_Datatype type_ = MPI_DATATYPE_NULL;
};

} // namespace taut::detail
