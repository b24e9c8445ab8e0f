#pragma once
// PETSc's handles with an owner, for the .cpp files of this folder only.
#include <petsc/private/petscimpl.h> // PetscObjectStateIncrease
#include <petscksp.h>

#include <algorithm>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>

namespace taut {

/// Turns a PETSc error code into an exception that carries PETSc's text.
inline void check(PetscErrorCode code) {
  if (code == 0) return;
  const char* text = nullptr;
  char* specific = nullptr;
  PetscErrorMessage(code, &text, &specific);
  throw std::runtime_error(std::string("PETSc: ") + (text ? text : "unknown error") +
                           (specific && *specific ? std::string(": ") + specific : ""));
}

/// Tells PETSc that the values behind an object changed, so that preconditioners are made anew.
inline void mark_changed(Mat matrix) {
  check(PetscObjectStateIncrease(reinterpret_cast<PetscObject>(matrix)));
}

/// Copies `values` into this rank's part of a vector, which is as long.
inline void put(std::span<const double> values, Vec vector) {
  double* to = nullptr;
  check(VecGetArrayWrite(vector, &to));
  std::copy(values.begin(), values.end(), to);
  check(VecRestoreArrayWrite(vector, &to));
}

/// Copies this rank's part of a vector into `values`, which are as many.
inline void take(Vec vector, std::span<double> values) {
  const double* from = nullptr;
  check(VecGetArrayRead(vector, &from));
  std::copy_n(from, values.size(), values.begin());
  check(VecRestoreArrayRead(vector, &from));
}

/// Calls `function(from, to)` on this rank's parts of two vectors, for PETSc's callbacks.
template<class Function>
PetscErrorCode on_arrays(Vec from, Vec to, Function&& function) {
  PetscFunctionBegin;
  PetscInt n = 0;
  const PetscScalar* in = nullptr;
  PetscScalar* out = nullptr;
  PetscCall(VecGetLocalSize(from, &n));
  PetscCall(VecGetArrayRead(from, &in));
  PetscCall(VecGetArrayWrite(to, &out));
  function(std::span<const double>(in, std::size_t(n)), std::span<double>(out, std::size_t(n)));
  PetscCall(VecRestoreArrayWrite(to, &out));
  PetscCall(VecRestoreArrayRead(from, &in));
  PetscFunctionReturn(0);
}

/// Owns one PETSc object.
template<class Object, PetscErrorCode (*Destroy)(Object*)>
class Owned {
public:
  Owned() = default;
  ~Owned() { Destroy(&object_); }
  Owned(Owned&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Owned& operator=(Owned&& other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  operator Object() const { return object_; }
  Object* address() { return &object_; } ///< for PETSc's ...Create functions
private:
  Object object_ = nullptr;
};

using OwnedMat = Owned<Mat, MatDestroy>;
using OwnedVec = Owned<Vec, VecDestroy>;
using OwnedKsp = Owned<KSP, KSPDestroy>;

} // namespace taut
