// HDF5 meshes that are sound as HDF5, but whose datasets have any type, shape and numbers.
#include "io/hdf5_error.hpp"
#include "io/mesh_file.hpp"
#include "partition/topology.hpp"
#include "tests/fuzz/target.hpp"

#include <array>
#include <cstdint>
#include <cstring>

namespace {

using namespace taut;

/// Takes one number after the other from the bytes; zeros behind their end.
class Bytes {
public:
  explicit Bytes(std::string_view bytes) : bytes_(bytes) {}

  template<class T>
  T next() {
    T value{};
    const std::size_t size = std::min(sizeof(T), bytes_.size());
    std::memcpy(&value, bytes_.data(), size);
    bytes_.remove_prefix(size);
    return value;
  }

private:
  std::string_view bytes_;
};

hid_t type_of(std::uint8_t choice) {
  const std::array types{H5T_NATIVE_DOUBLE, H5T_NATIVE_FLOAT,  H5T_NATIVE_INT64, H5T_NATIVE_INT32,
                         H5T_NATIVE_UINT8,  H5T_NATIVE_UINT64, H5T_STD_I64BE,    H5T_C_S1};
  return types[choice % types.size()];
}

/// Small mostly; with `claim` any, in a dataset of which nothing is stored.
std::vector<hsize_t> shape_of(Bytes& bytes, bool claim) {
  std::vector<hsize_t> shape(bytes.next<std::uint8_t>() % 4);
  for (hsize_t& n : shape)
    n = claim ? bytes.next<std::uint64_t>() >> (bytes.next<std::uint8_t>() % 64)
              : bytes.next<std::uint8_t>() % 32;
  return shape;
}

void write_dataset(hid_t file, const char* name, Bytes& bytes) {
  const auto kind = bytes.next<std::uint8_t>();
  const bool missing = kind % 16 == 15, claim = kind % 16 == 14;
  if (missing) return;
  const hid_t type = type_of(bytes.next<std::uint8_t>());
  const std::vector<hsize_t> shape = shape_of(bytes, claim);
  hsize_t count = 1;
  for (const hsize_t n : shape) count *= n;
  const H5Handle space(shape.empty() ? H5Screate(H5S_SCALAR)
                                     : H5Screate_simple(int(shape.size()), shape.data(), nullptr),
                       H5Sclose);
  const H5Handle set(H5Dcreate2(file, name, type, space.get(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                     H5Dclose);
  if (set.get() < 0 || claim || count > 40000) return;
  std::vector<std::int64_t> values(count);
  for (auto& v : values) {
    const int byte = bytes.next<std::uint8_t>();
    v = byte < 128 ? byte : byte - 256;
  }
  if (kind & 16) // as they are, whatever they mean as floating point
    H5Dwrite(set.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
  else
    H5Dwrite(set.get(), H5T_NATIVE_INT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
}

} // namespace

void taut::fuzz::read_input(std::string_view bytes) {
  h5::silence();
  const auto path = write_input("mesh.h5", "");
  {
    Bytes numbers(bytes);
    const H5Handle file(H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
    for (const char* name : {"/face_offsets", "/faces", "/rest_positions"})
      write_dataset(file.get(), name, numbers);
  }
  const MeshSlab slab = read_mesh_h5(MPI_COMM_SELF, path, 1.0);
  find_topology(MPI_COMM_SELF, slab);
}
