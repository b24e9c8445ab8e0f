#pragma once
#include "partition/types.hpp"

#include <mpi.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace taut {
class H5Writer;
}

namespace taut::garment {

/// Names of sets of vertices, each ascending.
using Labels = std::map<std::string, std::vector<Global>>;

struct NamedSeam {
  std::string name;
  std::vector<Global> vertices; ///< ascending
};

/// The cells from `first_cell` on, up to those of the next panel.
struct NamedPanel {
  std::string name;
  Global first_cell = 0;
};

/// What parts of a mesh are called, in its own numbers. All ranks know all of it.
struct NamedParts {
  std::vector<NamedPanel> panels; ///< in the order of their cells; empty: the mesh is no garment
  std::vector<NamedSeam> seams;
  Labels labels;

  /// The number of the panel that has a cell; -1 without panels.
  int panel_of(Global cell) const;
};

/// "no edge and no panel has the label 'x' (did you mean 'y'?); there are ..".
std::string no_such_label(const Labels& labels, const std::string& label);

/// Those of rank 0, on all ranks. Collective.
NamedParts share(MPI_Comm comm, const NamedParts& parts);

/// Those in a mesh file (write_mesh.hpp), on all ranks; none in a file without. Collective; throws
/// `InputError`.
NamedParts read_named_parts(MPI_Comm comm, const std::filesystem::path& path);

/// Names as an attribute of a file: a list in JSON.
void write_names(H5Writer& file, const char* attribute, const std::vector<std::string>& names);

/// The attribute `panels`; which panel a cell is of, `/cells/panel` says.
void write_panels(H5Writer& file, const std::vector<NamedPanel>& panels);

/// `/seams/vertices`, those of the k-th at [offsets[k], offsets[k + 1]) of `/seams/offsets`, and the
/// attribute `seams`. All ranks give the same. Collective.
void write_seams(MPI_Comm comm, H5Writer& file, const std::vector<NamedSeam>& seams);

/// The same of `labels`. Collective.
void write_labels(MPI_Comm comm, H5Writer& file, const Labels& labels);

} // namespace taut::garment
