#include "src/garment/draw_svg.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>

namespace taut::garment {

namespace {

/// Where the parts of the drawing stand, in mm; y downwards, as SVG has it.
struct Sheet {
  std::vector<Vec2> low, high; ///< of each panel, in material coordinates, m
  std::vector<Vec2> corner;    ///< of each panel: its upper left one
  Vec2 size = Vec2::Zero();

  Vec2 place(std::size_t panel, const Vec2& material) const {
    const Vec2 from_corner(material[0] - low[panel][0], high[panel][1] - material[1]);
    return corner[panel] + 1000 * from_corner;
  }
};

constexpr double gap = 40; ///< mm, around panels

/// Rows of panels, about as wide as high all together.
Sheet lay_out(const GarmentMesh& mesh) {
  Sheet sheet;
  double area = 0, widest = 0;
  for (const MeshedPanel& p : mesh.panels) {
    Vec2 low = Vec2::Constant(HUGE_VAL), high = -low;
    for (Global v = p.first_vertex; v < p.first_vertex + Global(p.outline.points.size()); ++v)
      low = low.cwiseMin(mesh.material[v]), high = high.cwiseMax(mesh.material[v]);
    sheet.low.push_back(low);
    sheet.high.push_back(high);
    const Vec2 size = (1000 * (high - low)).array() + gap;
    area += size[0] * size[1];
    widest = std::max(widest, size[0]);
  }
  const double width = std::max(widest, 1.3 * std::sqrt(area)) + gap;
  Vec2 at(gap, gap);
  double row = 0;
  for (std::size_t p = 0; p < mesh.panels.size(); ++p) {
    const Vec2 size = 1000 * (sheet.high[p] - sheet.low[p]);
    if (at[0] + size[0] + gap > width && at[0] > gap) at = {gap, at[1] + row + gap}, row = 0;
    sheet.corner.push_back(at);
    at[0] += size[0] + gap;
    row = std::max(row, size[1]);
    sheet.size = sheet.size.cwiseMax(Vec2(at[0], at[1] + row + gap));
  }
  return sheet;
}

std::string escaped(const std::string& text) {
  std::string safe;
  for (const char c : text)
    safe += c == '<' ? "&lt;" : c == '>' ? "&gt;" : c == '&' ? "&amp;" : std::string(1, c);
  return safe;
}

std::string hue(std::size_t seam) { // neighbours in number are far apart in colour
  return fmt::format("hsl({:.0f},80%,{}%)", std::fmod(137.508 * double(seam), 360), 35 + 12 * (seam % 2));
}

class Drawing {
public:
  explicit Drawing(const GarmentMesh& mesh) : mesh_(mesh), sheet_(lay_out(mesh)) {
    put("<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0:.0f}mm\" height=\"{1:.0f}mm\" viewBox=\"0 0 "
        "{0:.0f} "
        "{1:.0f}\" font-family=\"sans-serif\" stroke-linejoin=\"round\">\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n",
        sheet_.size[0], sheet_.size[1]);
    for (std::size_t p = 0; p < mesh.panels.size(); ++p) draw_panel(p);
    for (std::size_t s = 0; s < mesh.seams.size(); ++s) draw_seam(s);
    put("</svg>\n");
  }

  std::string take() { return {text_.begin(), text_.end()}; }

private:
  template<class... T>
  void put(fmt::format_string<T...> format, T&&... values) {
    fmt::format_to(std::back_inserter(text_), format, std::forward<T>(values)...);
  }

  void line(const char* step, const Vec2& p) { put("{}{:.2f} {:.2f}", step, p[0], p[1]); }

  std::size_t panel_of(Global vertex) const {
    const auto after = std::ranges::upper_bound(mesh_.panels, vertex, {}, &MeshedPanel::first_vertex);
    return std::size_t(after - mesh_.panels.begin()) - 1;
  }

  void draw_panel(std::size_t p) {
    const MeshedPanel& panel = mesh_.panels[p];
    const auto place = [&](Global v) { return sheet_.place(p, mesh_.material[v]); };
    put("<path fill=\"#f4f1ea\" stroke=\"black\" stroke-width=\"0.8\" d=\"");
    for (std::size_t i = 0; i < panel.outline.points.size(); ++i)
      line(i == 0 ? "M" : "L", place(panel.first_vertex + Global(i)));
    put("Z\"/>\n");
    constexpr std::size_t most_cells = 300000;
    if (mesh_.cells.size() <= most_cells) {
      put("<path fill=\"none\" stroke=\"#555\" stroke-width=\"{:.3f}\" d=\"",
          std::min(0.3, 40 * panel.edge_length));
      for (Global c = panel.first_cell; c < panel.first_cell + panel.cells; ++c)
        draw_sides(mesh_.cells[c], place);
      put("\"/>\n");
    }
    const Vec2 middle = sheet_.place(p, (sheet_.low[p] + sheet_.high[p]) / 2);
    const double height = 1000 * (sheet_.high[p] - sheet_.low[p])[1];
    const double letter = std::clamp(std::min(100 * std::sqrt(panel.area), height / 7), 2.0, 14.0);
    put("<path stroke=\"#a00\" stroke-width=\"1\" fill=\"none\" d=\"M{0:.1f} {1:.1f}v{2:.1f}m{3:.1f} "
        "{4:.1f}l{5:.1f} "
        "{6:.1f}l{5:.1f} {4:.1f}\"/>\n",
        middle[0], middle[1] + 3 * letter, -2 * letter, -letter / 3, letter / 2, letter / 3, -letter / 2);
    put("<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"{:.1f}\" text-anchor=\"middle\" fill=\"#a00\" "
        "stroke=\"white\" "
        "stroke-width=\"{:.1f}\" paint-order=\"stroke\">{}</text>\n",
        middle[0], middle[1], letter, letter / 5, escaped(panel.name));
  }

  /// Each side once: by the cell in which it runs from the lower vertex to the higher one, or on the outline.
  template<class Place>
  void draw_sides(const Cell& cell, Place&& place) {
    for (int k = 0; k < cell.size(); ++k) {
      const Global a = cell.vertices[k], b = cell.vertices[(k + 1) % cell.size()];
      if (a > b) continue;
      line("M", place(a));
      line("L", place(b));
    }
  }

  void draw_seam(std::size_t s) {
    const MeshedSeam& seam = mesh_.seams[s];
    if (seam.pairs.empty()) return;
    for (int k : {0, 1}) {
      const std::size_t p = panel_of(seam.pairs[0][k]);
      put("<path fill=\"none\" stroke=\"{}\" stroke-width=\"2.5\" stroke-linecap=\"round\" d=\"", hue(s));
      for (std::size_t i = 0; i < seam.pairs.size(); ++i)
        line(i == 0 ? "M" : "L", sheet_.place(p, mesh_.material[seam.pairs[i][k]]));
      const Vec2 at = sheet_.place(p, mesh_.material[seam.pairs[seam.pairs.size() / 2][k]]);
      put("\"/>\n<text x=\"{:.1f}\" y=\"{:.1f}\" font-size=\"8\" text-anchor=\"middle\" fill=\"{}\" "
          "stroke=\"white\" "
          "stroke-width=\"1.5\" paint-order=\"stroke\">{}</text>\n",
          at[0], at[1] + 3, hue(s), s);
    }
  }

  const GarmentMesh& mesh_;
  Sheet sheet_;
  fmt::memory_buffer text_;
};

} // namespace

std::string draw_svg(const GarmentMesh& mesh) { return Drawing(mesh).take(); }

} // namespace taut::garment
