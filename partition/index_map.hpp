#pragma once
#include "partition/mesh_slab.hpp"
#include "partition/plan.hpp"

#include <span>
#include <vector>

namespace taut {

/// How the entities of one kind (vertices, edges) are shared out. A rank owns the global numbers [first,
/// first + owned); its local numbers are [owned | ghosts], ghosts by owner. `original` is the number an
/// entity has in the input.
struct IndexMap {
  Global first = 0;
  Global total = 0;
  Local owned = 0;
  std::vector<Global> ghost_globals;
  std::vector<int> ghost_owners;
  std::vector<Global> original; ///< of every local entity

  Local size() const { return owned + Local(ghost_globals.size()); }
  Local ghosts() const { return Local(ghost_globals.size()); }
  Global global(Local i) const { return i < owned ? first + i : ghost_globals[i - owned]; }
};

/// Keeps ghosts current. A field is a plain array over [owned | ghosts].
class Halo {
public:
  Halo() = default;

  /// Numbers the ghosts of `map` (fills `first`, `total`, `ghost_globals`) and learns who sends what. On
  /// entry `owned`, `original` and `ghost_owners` are set, ghosts in ascending order of owner. Collective.
  Halo(MPI_Comm comm, IndexMap& map);

  /// Owner -> ghosts. Collective over neighbours.
  template<class T>
  void update(std::vector<T>& field) const {
    plan_.forward<T>(field, field);
  }
  template<class T>
  void begin_update(const std::vector<T>& field) const {
    plan_.begin_forward<T>(field);
  }
  template<class T>
  void end_update(std::vector<T>& field) const {
    plan_.end_forward<T>(field);
  }

  /// Ghosts -> owner: adds what ghosts hold to the owner's value. Ghosts are left as they were.
  template<class T>
  void accumulate(std::vector<T>& field) const {
    plan_.reverse_add<T>(field, field);
  }

  const Plan& plan() const { return plan_; }

private:
  Plan plan_;
};

/// Carries owned values to slabs in original order and back: how fields get into files that do not depend on
/// the partition.
class OriginalOrder {
public:
  OriginalOrder() = default;

  /// `original[i]` is the original number of this rank's i-th owned entity, of `total` over all ranks.
  /// Collective.
  OriginalOrder(MPI_Comm comm, Global total, std::span<const Global> original);

  const Slab& slab() const { return slab_; }

  /// The values of this rank's slab from everybody's owned values (the first `owned` of `values`).
  /// Collective.
  template<class T>
  std::vector<T> to_slab(std::span<const T> values) const {
    std::vector<T> rows(slab_.count);
    plan_.forward<T>(values, rows);
    plan_.release_buffers();
    return rows;
  }

  /// The inverse: fills the owned part of `values` from slabs. Collective.
  template<class T>
  void from_slab(std::span<const T> rows, std::span<T> values) const {
    plan_.reverse<T>(rows, values);
    plan_.release_buffers();
  }

private:
  Slab slab_;
  Plan plan_;
};

} // namespace taut
