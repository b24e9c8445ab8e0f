#pragma once
#include "partition/types.hpp"

#include <span>
#include <string>
#include <vector>

/// The XDMF text that tells ParaView how to find a run in its HDF5 files. Pure functions: no file is touched.
namespace taut {

enum class XdmfCells { lines, triangles, quads, mixed };
enum class XdmfCentre { point, cell };
enum class XdmfNumber { float64, int64, int32 };
enum class XdmfHome {
  frame,
  mesh
}; ///< the file that holds a dataset: that of the frame, or the one all frames share

struct XdmfField {
  std::string name;    ///< as ParaView shows it
  std::string dataset; ///< "/velocities"
  XdmfCentre centre = XdmfCentre::point;
  int components = 1; ///< 1 or 3
  XdmfNumber number = XdmfNumber::float64;
  XdmfHome home = XdmfHome::frame;
};

struct XdmfFrame {
  double time = 0.0; ///< s
  std::string file;  ///< relative to the XDMF file, "frames/frame_000000.h5"
};

/// Names of files and datasets must be plain: no characters that mean something in XML.
struct XdmfDescription {
  std::string mesh_file = "mesh.h5";    ///< relative to the XDMF file
  std::string positions = "/positions"; ///< (points, 3)
  XdmfHome positions_home = XdmfHome::frame;
  Global points = 0;

  XdmfCells shape = XdmfCells::quads;
  std::string cells_dataset =
      "/faces"; ///< in the mesh file: vertex numbers, or for mixed cells what `xdmf_mixed_cells` made
  Global cells = 0;
  Global cells_length = 0; ///< how many numbers `cells_dataset` holds

  std::vector<XdmfField> fields;
};

/// The text of an XDMF file, one temporal collection with a grid a frame, that grows frame by frame.
class XdmfText {
public:
  explicit XdmfText(XdmfDescription description) : description_(std::move(description)) {}

  void add(const XdmfFrame& frame);
  std::string whole() const; ///< with all frames so far

private:
  XdmfDescription description_;
  std::string grids_;
};

/// The cells at [offsets[c], offsets[c + 1]) of `vertices` as XDMF wants to read them when not all have one
/// size: in front of each its kind, and in front of a line its number of vertices too. `offsets` has one
/// entry more than there are cells and need not begin with 0, so a slab of a larger list may be given; the
/// streams of consecutive slabs, one after the other, are the stream of the whole.
std::vector<Global> xdmf_mixed_cells(std::span<const Global> vertices, std::span<const Global> offsets);

} // namespace taut
