// SPDX-License-Identifier: MIT
#pragma once

/// \file
/// Points with values as a VTK file (.vtp) for ParaView: XML head, binary data behind it.

#include <bit>
#include <cstdint>
#include <cstdio>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <vadose/core/real.hpp>
#include <vadose/io/file.hpp>

namespace vadose::io {

/// Values of all points, point by point.
struct Column {
  std::string name;          ///< with the unit, e.g. "liquid_pressure [Pa]"
  int components = 1;        ///< values per point, >= 1
  std::vector<Real> values;  ///< components x number of points
};

namespace detail {

/// Text usable inside an XML attribute.
inline std::string xml_text(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

/// One <DataArray> of the head and its bytes.
struct VtkArray {
  std::string head;
  const void* data;
  std::uint64_t bytes;
};

template <class T>
VtkArray vtk_array(const char* type, const std::string& name, int components,
                   const std::vector<T>& values, std::uint64_t& offset) {
  static_assert(std::endian::native == std::endian::little,
                "vadose: binary VTK output is written for little-endian machines");
  const std::uint64_t bytes = values.size() * sizeof(T);
  std::string head = std::string("<DataArray type=\"") + type + "\" Name=\"" + xml_text(name) +
                     "\" NumberOfComponents=\"" + std::to_string(components) +
                     "\" format=\"appended\" offset=\"" + std::to_string(offset) + "\"/>\n";
  offset += sizeof(std::uint64_t) + bytes;
  return {std::move(head), values.data(), bytes};
}

inline void check_columns(const std::string& path, int dim, std::size_t coordinates,
                          std::span<const Column> columns) {
  if (dim < 1 || dim > 3 || coordinates % static_cast<std::size_t>(dim) != 0)
    throw OutputError("cannot write file '" + path + "': " + std::to_string(coordinates) +
                      " coordinates are no points of " + std::to_string(dim) + " dimensions");
  const std::size_t points = coordinates / static_cast<std::size_t>(dim);
  for (const Column& c : columns)
    if (c.components < 1 || c.values.size() != points * static_cast<std::size_t>(c.components))
      throw OutputError("cannot write file '" + path + "': column '" + c.name + "' has " +
                        std::to_string(c.values.size()) + " values, expected " +
                        std::to_string(points) + " x " + std::to_string(c.components));
}

/// Beginning of a file of a kind of VTK data.
inline void write_vtk_head(File& file, const std::string& kind, std::string_view comment) {
  file.write("<?xml version=\"1.0\"?>\n");
  if (!comment.empty()) {
    std::string text;  // no two dashes in a row
    for (std::size_t i = 0; i < comment.size(); ++i)
      text.push_back(i > 0 && comment[i] == '-' && comment[i - 1] == '-' ? ' ' : comment[i]);
    file.write("<!-- " + text + " -->\n");
  }
  file.write("<VTKFile type=\"" + kind +
             "\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n");
}

/// The bytes of all arrays and the end of the file.
inline void write_vtk_data(File& file, std::span<const VtkArray> arrays) {
  file.write("<AppendedData encoding=\"raw\">\n_");
  for (const VtkArray& array : arrays) {
    file.write(&array.bytes, sizeof array.bytes);
    file.write(array.data, array.bytes);
  }
  file.write("\n</AppendedData>\n</VTKFile>\n");
}

}  // namespace detail

/// Writes one .vtp file: `positions` [m] has dim coordinates per point (missing ones are written
/// as 0). Data are appended raw, little endian, with 64-bit sizes; every point is a vertex, so
/// that ParaView shows it. `comment` goes into the head. The file appears complete or not at all.
/// Values are written as they are. Raises OutputError.
inline void write_vtp(const std::string& path, int dim, std::span<const Real> positions,
                      std::span<const Column> columns, std::string_view comment = {}) {
  detail::check_columns(path, dim, positions.size(), columns);
  const std::size_t points = positions.size() / static_cast<std::size_t>(dim);
  std::vector<Real> coordinates(3 * points, 0.0);
  std::vector<std::int64_t> connectivity(points), offsets(points);
  for (std::size_t i = 0; i < points; ++i) {
    for (std::size_t d = 0; d < static_cast<std::size_t>(dim); ++d)
      coordinates[3 * i + d] = positions[static_cast<std::size_t>(dim) * i + d];
    connectivity[i] = static_cast<std::int64_t>(i);
    offsets[i] = static_cast<std::int64_t>(i + 1);
  }
  std::uint64_t offset = 0;
  std::vector<detail::VtkArray> arrays;
  arrays.push_back(detail::vtk_array("Float64", "Points", 3, coordinates, offset));
  arrays.push_back(detail::vtk_array("Int64", "connectivity", 1, connectivity, offset));
  arrays.push_back(detail::vtk_array("Int64", "offsets", 1, offsets, offset));
  for (const Column& c : columns)
    arrays.push_back(detail::vtk_array("Float64", c.name, c.components, c.values, offset));

  ReplacingFile replacing(path);
  File& file = replacing.file();
  detail::write_vtk_head(file, "PolyData", comment);
  file.write("<PolyData>\n");
  const std::string count = std::to_string(points);
  file.write("<Piece NumberOfPoints=\"" + count + "\" NumberOfVerts=\"" + count +
             "\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"0\">\n");
  file.write("<Points>\n" + arrays[0].head + "</Points>\n");
  file.write("<Verts>\n" + arrays[1].head + arrays[2].head + "</Verts>\n<PointData>\n");
  for (std::size_t i = 3; i < arrays.size(); ++i) file.write(arrays[i].head);
  file.write("</PointData>\n</Piece>\n</PolyData>\n");
  detail::write_vtk_data(file, arrays);
  replacing.commit();
}

}  // namespace vadose::io
