// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Cells and nodes of a regular grid as a VTK file (.vti) for ParaView.

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <vadose/io/vtk_points.hpp>

namespace vadose::io {

/// A part of a regular grid: cells [low, high) along each axis; 0 and 1 along axes that are not.
struct GridPart {
  std::array<Real, 3> origin{};      ///< lower corner of cell (0, 0, 0) [m]
  Real cell_size = 1;                ///< [m]
  std::array<int, 3> low{};          ///< first cell
  std::array<int, 3> high{1, 1, 1};  ///< behind the last
  int dim = 3;                       ///< along the others the grid has no extent

  /// Number of cells, or of nodes.
  std::size_t count(bool nodes) const noexcept {
    std::size_t n = 1;
    for (int d = 0; d < dim; ++d) {
      const auto at = static_cast<std::size_t>(d);
      n *= static_cast<std::size_t>(high[at] - low[at] + (nodes ? 1 : 0));
    }
    return n;
  }
};

/// Writes one .vti file with values of the cells and of the nodes, axis 0 fastest. See write_vtp.
inline void write_vti(const std::string& path, const GridPart& part, std::span<const Column> cells,
                      std::span<const Column> nodes, std::string_view comment = {}) {
  detail::check_columns(path, 1, part.count(false), cells);
  detail::check_columns(path, 1, part.count(true), nodes);
  std::uint64_t offset = 0;
  std::vector<detail::VtkArray> arrays;
  for (const auto& columns : {cells, nodes})
    for (const Column& c : columns)
      arrays.push_back(detail::vtk_array("Float64", c.name, c.components, c.values, offset));

  ReplacingFile replacing(path);
  File& file = replacing.file();
  detail::write_vtk_head(file, "ImageData", comment);
  const auto end = [&](std::size_t d) {
    return static_cast<int>(d) < part.dim ? part.high[d] : part.low[d];
  };
  const auto extent = [&](const char* name) {
    file.print("%s=\"%d %d %d %d %d %d\"", name, part.low[0], end(0), part.low[1], end(1),
               part.low[2], end(2));
  };
  extent("<ImageData WholeExtent");
  file.print(" Origin=\"%.17g %.17g %.17g\" Spacing=\"%.17g %.17g %.17g\">\n", part.origin[0],
             part.origin[1], part.origin[2], part.cell_size, part.cell_size, part.cell_size);
  extent("<Piece Extent");
  file.write(">\n<PointData>\n");
  for (std::size_t i = cells.size(); i < arrays.size(); ++i) file.write(arrays[i].head);
  file.write("</PointData>\n<CellData>\n");
  for (std::size_t i = 0; i < cells.size(); ++i) file.write(arrays[i].head);
  file.write("</CellData>\n</Piece>\n</ImageData>\n");
  detail::write_vtk_data(file, arrays);
  replacing.commit();
}

}  // namespace vadose::io
